//! Counts of samples against what densities say, for tests.

/// How far counts are from expectations, in standard deviations of a normal number: the chi-square statistic with its tail by
/// Wilson and Hilferty 1931. What expects fewer than 5 is put together.
pub fn deviation(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells, mut rest) = (0.0, 0.0, [0.0, 0.0]);
    for (o, e) in observed.iter().zip(expected) {
        if *e < 5.0 {
            rest = [rest[0] + o, rest[1] + e];
        } else {
            statistic += (o - e) * (o - e) / e;
            cells += 1.0;
        }
    }
    if rest[1] >= 5.0 {
        statistic += (rest[0] - rest[1]).powi(2) / rest[1];
        cells += 1.0;
    } else if rest[0] > 10.0 * (rest[1] + 1.0) {
        return f64::INFINITY;
    }
    if cells < 2.0 {
        return 0.0;
    }
    let freedom: f64 = cells - 1.0;
    let width = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - width)) / width.sqrt()
}
