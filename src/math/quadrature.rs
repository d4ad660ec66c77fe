//! Numerical integration: Gauss-Legendre and double-exponential nodes, and the Gauss rule of any measure.

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

/// Positive nodes and weights of the 8-point Gauss-Legendre rule on -1..1, exact to f32.
pub const GAUSS_8: [(f32, f32); 4] = [
    (0.183_434_64, 0.362_683_78),
    (0.525_532_4, 0.313_706_65),
    (0.796_666_5, 0.222_381_03),
    (0.960_289_86, 0.101_228_54),
];

/// Cosines and weights of a mean over the hemisphere, weighted by the cosine: eight nodes, dense toward the horizon.
///
/// Source: Gauss-Legendre in the cube root of the cosine.
pub fn cosine_means() -> impl Iterator<Item = (f32, f32)> {
    GAUSS_8.into_iter().flat_map(|(x, weight)| {
        [0.5 - 0.5 * x, 0.5 + 0.5 * x].map(|t| {
            let square = t * t;
            (square * t, 3.0 * weight * (square * square * t))
        })
    })
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

/// The Gauss rule of a measure, nodes rising.
///
/// Source: Stieltjes's recurrence and the eigenvalues of its matrix (Golub and Welsch 1969), by Jacobi's rotations.
/// Domain: weights >= 0, NODES >= 1. Gives: a rule that is exact for polynomials of degree 2 NODES - 1.
/// Degenerate cases: a measure of fewer points gets nodes of weight 0, an empty one only those.
pub fn gauss_rule<const NODES: usize>(points: &[Node]) -> [Node; NODES] {
    let total: f64 = points.iter().map(|p| p.weight).sum();
    let mut rule = [Node { x: 0.0, weight: 0.0 }; NODES];
    if total <= 0.0 {
        return rule;
    }
    let mut matrix = [[0.0; NODES]; NODES];
    // Two polynomials of the recurrence at every point.
    let mut values = vec![(0.0, 1.0 / total.sqrt()); points.len()];
    let mut before = 0.0f64;
    for k in 0..NODES {
        let center: f64 = points.iter().zip(&values).map(|(p, v)| p.weight * p.x * v.1 * v.1).sum();
        matrix[k][k] = center;
        let mut square = 0.0;
        for (p, v) in points.iter().zip(&mut values) {
            *v = (v.1, (p.x - center) * v.1 - before * v.0);
            square += p.weight * v.1 * v.1;
        }
        before = square.max(0.0).sqrt();
        let inverse = if before > 1e-12 { 1.0 / before } else { 0.0 };
        values.iter_mut().for_each(|v| v.1 *= inverse);
        if k + 1 < NODES {
            (matrix[k][k + 1], matrix[k + 1][k]) = (before, before);
        }
    }
    let first = diagonalise(&mut matrix);
    for (k, node) in rule.iter_mut().enumerate() {
        *node = Node { x: matrix[k][k], weight: total * first[k] * first[k] };
    }
    rule.sort_by(|a, b| a.x.total_cmp(&b.x));
    rule
}

/// Brings a symmetric matrix to its eigenvalues and gives the first components of their vectors.
fn diagonalise<const NODES: usize>(a: &mut [[f64; NODES]; NODES]) -> [f64; NODES] {
    let mut first = [0.0; NODES];
    if let Some(one) = first.first_mut() {
        *one = 1.0;
    }
    for _ in 0..8 {
        for p in 0..NODES {
            for q in p + 1..NODES {
                if a[p][q].abs() < 1e-13 {
                    continue;
                }
                // The smaller rotation that makes a[p][q] vanish.
                let half = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = 1f64.copysign(half) / (half.abs() + (half * half + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in a.iter_mut() {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..NODES {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                (first[p], first[q]) = (c * first[p] - s * first[q], s * first[p] + c * first[q]);
            }
        }
    }
    first
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

    #[test]
    fn rules_integrate_polynomials_of_degree_eleven() {
        let points: Vec<Node> =
            (0..50).map(|k| Node { x: f64::from(k) / 49.0, weight: 1.0 + f64::from(k % 7) }).collect();
        let rule = gauss_rule::<6>(&points);
        for degree in 0..12 {
            let sum = |nodes: &[Node]| nodes.iter().map(|n| n.weight * n.x.powi(degree)).sum::<f64>();
            assert!((sum(&rule) / sum(&points) - 1.0).abs() < 1e-12, "{degree}");
        }
        let single = gauss_rule::<6>(&[Node { x: 0.3, weight: 0.7 }]);
        assert!((single.iter().map(|n| n.weight * n.x).sum::<f64>() - 0.21).abs() < 1e-12);
    }
}
