//! Hyperbolic functions, all from e^x - 1 in `f64`, which keeps them precise near 0.

use super::wide;

/// The hyperbolic sine.
///
/// Source: (u + u/(u+1))/2 with u = e^|x| - 1. Domain: all. Gives: at most 1 ulp.
/// Degenerate cases: infinities of the sign of x beyond 89.4, sign of zero kept, NaN for NaN.
#[inline(always)]
pub fn sinh(x: f32) -> f32 {
    let u = wide::expm1(x.abs() as f64);
    ((0.5 * (u + u / (u + 1.0))) as f32).copysign(x)
}

/// The hyperbolic cosine.
///
/// Source: (e + 1/e)/2 with e = e^|x|. Domain: all. Gives: at most 1 ulp.
/// Degenerate cases: inf beyond 89.4, NaN for NaN.
#[inline(always)]
pub fn cosh(x: f32) -> f32 {
    let e = wide::expm1(x.abs() as f64) + 1.0;
    (0.5 * (e + 1.0 / e)) as f32
}

/// The hyperbolic tangent, in [-1, 1].
///
/// Source: u/(u+2) with u = e^(2|x|) - 1. Domain: all. Gives: at most 1 ulp.
/// Degenerate cases: sign of zero kept, 1 of the sign of x at infinities, NaN for NaN.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    let u = wide::expm1(2.0 * x.abs() as f64);
    ((u / (u + 2.0)) as f32).copysign(x)
}
