//! Axes: where a number lies between two edges, and which numbers are written there.

/// One axis, logarithmic where its numbers span more than a factor of six.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    log: bool,
}

impl Axis {
    /// An axis that shows all numbers with some room. Zeros lie at the lower end.
    pub fn around(values: &[f64]) -> Self {
        let positive = values.iter().copied().filter(|v| *v > 0.0 && v.is_finite());
        let least = positive.clone().fold(f64::INFINITY, f64::min);
        let most = positive.fold(0.0, f64::max);
        if !least.is_finite() {
            return Axis { low: 0.0, high: 1.0, log: false };
        }
        let zeros = values.iter().any(|v| *v <= 0.0);
        if most / least > 6.0 || zeros {
            let room = (most / least).powf(0.08).max(1.5);
            let low = if zeros { least / room / 4.0 } else { least / room };
            return Axis { low, high: most * room, log: true };
        }
        let room = 0.12 * (most - least).max(0.2 * most);
        Axis { low: (least - room).max(0.0), high: most + room, log: false }
    }

    /// A straight axis from 0 to a little more than the largest number.
    pub fn from_zero(values: &[f64]) -> Self {
        let most = values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        Axis { low: 0.0, high: if most > 0.0 { 1.05 * most } else { 1.0 }, log: false }
    }

    /// Where a number lies, 0..1.
    pub fn place(&self, value: f64) -> f64 {
        let place = if self.log {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        place.clamp(0.0, 1.0)
    }

    /// The numbers to mark with what is written there; marks between them are written as nothing.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        if self.log { self.decades() } else { self.steps() }
    }

    fn decades(&self) -> Vec<(f64, String)> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let span = self.high.log10() - self.low.log10();
        let every = (span / 8.0).ceil().max(1.0) as i32;
        let mut out = Vec::new();
        for decade in first..=last {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(decade);
                if value < self.low || value > self.high || (span > 8.0 && digit > 1) {
                    continue;
                }
                let named = digit == 1 && decade % every == 0 || span < 2.0 && (digit == 2 || digit == 5);
                out.push((value, if named { written(value) } else { String::new() }));
            }
        }
        out
    }

    fn steps(&self) -> Vec<(f64, String)> {
        let raw = (self.high - self.low) / 6.0;
        let decade = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|s| s * decade).find(|s| *s >= raw).unwrap_or(raw);
        let first = (self.low / step).ceil() as i64;
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let marks = (first..first + 20).map(|k| k as f64 * step).take_while(|v| *v <= self.high);
        marks.map(|value| (value, format!("{value:.digits$}"))).collect()
    }
}

/// A round number, short.
fn written(value: f64) -> String {
    if (0.001..100_000.0).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_lie_on_their_axis() {
        for values in [vec![1e-7, 0.3], vec![20.0, 31.0], vec![0.0, 4.0], vec![3.0, 3.0], vec![], vec![1.2, 60.0]] {
            let axis = Axis::around(&values);
            let named = axis.ticks().iter().filter(|(_, text)| !text.is_empty()).count();
            assert!((2..=16).contains(&named), "{values:?}: {named}");
            assert!(axis.ticks().iter().all(|(v, _)| *v >= axis.low && *v <= axis.high), "{values:?}");
            assert!(values.iter().all(|v| (0.0..=1.0).contains(&axis.place(*v))));
        }
    }
}
