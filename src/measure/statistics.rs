//! Statistics: random numbers for tests, and the chi-square test of a sampler against its density.

/// A small generator of uniform numbers.
///
/// Source: Steele, Lea and Flood 2014 (SplitMix64). Domain: any seed. Gives: numbers in [0, 1).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1).
    pub fn number(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// The probability that a chi-square statistic of so many degrees of freedom is at least this large.
///
/// Source: regularised incomplete gamma function, series and Lentz's continued fraction. Gives: 0..1, error below 1e-10.
pub fn chi_square_tail(statistic: f64, degrees: f64) -> f64 {
    let (a, x) = (0.5 * degrees, 0.5 * statistic);
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for k in 1..10_000 {
            term *= x / (a + f64::from(k));
            sum += term;
            if term < sum * 1e-14 {
                break;
            }
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for k in 1..10_000 {
        let k = f64::from(k);
        let an = -k * (k - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        let step = d * c;
        h *= step;
        if (step - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * h
}

/// ln of the gamma function by Stirling's series. Domain: x > 0. Gives: error below 1e-12.
fn ln_gamma(mut x: f64) -> f64 {
    let mut shift = 0.0;
    while x < 12.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let z = 1.0 / (x * x);
    let series = (1.0 / 12.0 - z * (1.0 / 360.0 - z * (1.0 / 1260.0 - z / 1680.0))) / x;
    shift + (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

/// The chi-square probability of counts against expectations; cells expecting fewer than 5 are pooled.
pub fn chi_square(observed: &[f64], expected: &[f64]) -> f64 {
    chi_square_within(observed, expected, &[])
}

/// The same where expectations have errors of their own (none for cells beyond the list), which widen what is allowed.
pub fn chi_square_within(observed: &[f64], expected: &[f64], errors: &[f64]) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0.0);
    let (mut pool_o, mut pool_e, mut pool_error) = (0.0, 0.0, 0.0);
    for (k, (&o, &e)) in observed.iter().zip(expected).enumerate() {
        let error = errors.get(k).copied().unwrap_or(0.0);
        if e < 5.0 {
            pool_o += o;
            pool_e += e;
            pool_error += error;
        } else {
            statistic += (o - e) * (o - e) / (e + error * error);
            cells += 1.0;
        }
    }
    if pool_e > 5.0 {
        statistic += (pool_o - pool_e) * (pool_o - pool_e) / (pool_e + pool_error * pool_error);
        cells += 1.0;
    } else if pool_o > pool_e + pool_error + 10.0 * (pool_e + 1.0) {
        // Samples where next to none are expected condemn at once.
        return 0.0;
    }
    if cells < 2.0 { 1.0 } else { chi_square_tail(statistic, cells - 1.0) }
}

/// A number of 64 bits made of a text, to seed random numbers with: the same on every machine.
///
/// Source: Fowler, Noll and Vo (FNV-1a).
pub fn seed_of(text: &str, seed: u64) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325 ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    text.bytes().fold(start, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// The level of each of `tests` tests that together err with probability `level` (Sidak 1967).
pub fn sidak(level: f64, tests: u32) -> f64 {
    1.0 - (1.0 - level).powf(1.0 / f64::from(tests))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tail_matches_tables() {
        for (x, k, p) in
            [(3.841_458_8, 1.0, 0.05), (18.307_038, 10.0, 0.05), (124.342_113, 100.0, 0.05), (2.705_543_5, 1.0, 0.1)]
        {
            assert!((chi_square_tail(x, k) - p).abs() < 1e-7, "{x} {k}");
        }
    }
}
