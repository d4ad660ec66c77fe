//! Polynomials: sums of Chebyshev's series.

/// The first N terms of a Chebyshev series, by Clenshaw's recurrence.
///
/// Domain: x in -1..1, at least N coefficients, N >= 1. Gives: the sum of `c[k] T_k(x)`.
#[inline(always)]
pub fn chebyshev<const N: usize>(c: &[f32], x: f32) -> f32 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for k in (1..N).rev() {
        (b1, b2) = (2.0 * x * b1 - b2 + c[k], b1);
    }
    x * b1 - b2 + c[0]
}
