//! A window as the density of samples around a pixel.

use std::f64::consts::PI;

/// Steps of the table.
const STEPS: usize = 8192;
/// How far the window reaches from the middle of its pixel, in pixels.
const REACH: f64 = 1.5;

/// Where samples go that are drawn by the window of four cosines of Blackman and Harris (Harris 1978, table 1), each of which then counts
/// as much as any other.
///
/// Decision (2026-11-30): samples are drawn by the filter and count for their own pixel alone (Ernst, Stamminger and Greiner 2006),
/// instead of being weighed into nine pixels: neighbours then have no noise in common, which is what this filter is asked for.
#[derive(Debug)]
pub struct Window {
    /// The inverse of the cumulative window, even steps apart.
    inverse: Vec<f32>,
}

/// The cumulative window at `t` in [-1/2, 1/2].
fn cumulative(t: f64) -> f64 {
    const A: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];
    let wave = |k: usize| A[k] / (2.0 * PI * k as f64) * (2.0 * PI * k as f64 * t).sin();
    0.5 + t + (wave(1) + wave(2) + wave(3)) / A[0]
}

impl Window {
    /// Inverts the window, by halving.
    pub fn new() -> Self {
        let place = |step: usize| {
            let target = step as f64 / STEPS as f64;
            let (mut low, mut high) = (-0.5, 0.5);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if cumulative(middle) < target { low = middle } else { high = middle }
            }
            (0.5 + 2.0 * REACH * 0.5 * (low + high)) as f32
        };
        Window { inverse: (0..=STEPS).map(place).collect() }
    }

    /// The place of a number in [0, 1), in pixels from the left edge of the pixel.
    pub fn place(&self, x: f32) -> f32 {
        let at = x * STEPS as f32;
        let step = (at as usize).min(STEPS - 1);
        let [a, b] = [self.inverse[step], self.inverse[step + 1]];
        a + (b - a) * (at - step as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_the_moments_of_the_window() {
        let window = Window::new();
        let count = 100_000;
        let places = (0..count).map(|i| f64::from(window.place((i as f32 + 0.5) / count as f32)) - 0.5);
        let (mut mean, mut square) = (0.0, 0.0);
        places.for_each(|x| {
            mean += x / f64::from(count);
            square += x * x / f64::from(count);
        });
        // The variance by quadrature over the window itself.
        let weight = |t: f64| {
            0.35875 + 0.48829 * (2.0 * PI * t).cos() + 0.14128 * (4.0 * PI * t).cos() + 0.01168 * (6.0 * PI * t).cos()
        };
        let at = |i: i32| (f64::from(i) + 0.5) / 10_000.0 - 0.5;
        let [sum, squares] =
            [0, 2].map(|power| (0..10_000).map(|i| weight(at(i)) * (3.0 * at(i)).powi(power)).sum::<f64>());
        assert!(
            mean.abs() < 1e-5 && (square / (squares / sum) - 1.0).abs() < 1e-3,
            "{mean} {square} {}",
            squares / sum
        );
        assert!(window.place(0.0) == -1.0 && window.place(1.0) == 2.0);
    }
}
