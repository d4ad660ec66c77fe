//! Numerical integration in f64: Gauss-Legendre and double-exponential nodes.

use std::f64::consts::PI;

/// A node of a rule: where to evaluate, and the weight of the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Place.
    pub x: f64,
    /// Weight.
    pub weight: f64,
}

/// Gauss-Legendre nodes of the interval `[a, b]`.
///
/// Source: Newton's iteration on the Legendre polynomial from Tricomi's guess.
/// Domain: count >= 1. Gives: `count` nodes, exact for polynomials of degree `2 count - 1` up to rounding.
pub fn gauss_legendre(count: usize, a: f64, b: f64) -> Vec<Node> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    (0..count)
        .map(|i| {
            let mut x = -(PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=count {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                slope = count as f64 * (x * p1 - p0) / (x * x - 1.0);
                x -= p1 / slope;
            }
            Node { x: middle + half * x, weight: half * 2.0 / ((1.0 - x * x) * slope * slope) }
        })
        .collect()
}

/// Double-exponential (tanh-sinh) nodes of `[a, b]`, for integrands with end-point singularities.
///
/// Source: Takahasi and Mori 1974. Domain: steps >= 1. Gives: `2 steps + 1` nodes strictly inside, densest at the ends.
pub fn tanh_sinh(steps: usize, a: f64, b: f64) -> Vec<Node> {
    // Beyond |t| = 3.2 the nodes come nearer to the ends than 1e-16 of the interval.
    let h = 3.2 / steps as f64;
    (-(steps as i64)..=steps as i64)
        .map(|k| {
            let t = k as f64 * h;
            let q = (-PI * t.sinh()).exp();
            let (upper, lower) = (1.0 / (1.0 + q), q / (1.0 + q));
            let x = if upper < 0.5 { a + (b - a) * upper } else { b - (b - a) * lower };
            Node { x, weight: (b - a) * h * PI * t.cosh() * upper * lower }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_integrate_what_they_should() {
        let sum: f64 = gauss_legendre(8, 0.0, 2.0).iter().map(|n| n.weight * n.x.powi(15)).sum();
        assert!((sum / (2f64.powi(16) / 16.0) - 1.0).abs() < 1e-13);
        let root: f64 = tanh_sinh(40, 0.0, 1.0).iter().map(|n| n.weight / n.x.sqrt()).sum();
        assert!((root - 2.0).abs() < 1e-7, "{root}");
    }
}
