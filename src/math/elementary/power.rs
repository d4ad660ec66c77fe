//! Powers and roots.

use super::rounding::floor;
use super::wide;

/// x^y with the rules of C `powf`.
///
/// Source: 2^(y log2 |x|) in `f64`; the special cases are those of ISO C annex F. Domain: all. Gives: at most 1 ulp.
/// Degenerate cases: 1 for y = 0 and for x = 1, whatever the other is; NaN for a negative x and a fractional y; an odd
/// whole y keeps the sign of x, zeros and infinities included.
#[inline(always)]
pub fn pow(x: f32, y: f32) -> f32 {
    let magnitude = wide::exp2(y as f64 * wide::log2(x.abs() as f64)) as f32;
    let whole = floor(y) == y;
    let half = y * 0.5;
    // From 2^24 on every f32 is even, and its half is whole too, so that no range test is needed.
    let odd = whole & (floor(half) != half);
    let negated = -magnitude;
    let signed = if odd & x.is_sign_negative() { negated } else { magnitude };
    let undefined = (x < 0.0) & (x > f32::NEG_INFINITY) & !whole;
    let result = if undefined { f32::NAN } else { signed };
    // 0 * inf in the exponent is NaN; the standard says 1 for all three.
    let unit = (y == 0.0) | (x == 1.0) | ((x == -1.0) & (y.abs() == f32::INFINITY));
    if unit { 1.0 } else { result }
}

/// x^y for x >= 0 without the cases of [`pow`], for scattering models.
///
/// Source: 2^(y log2 x) in `f64` with short polynomials. Domain: x >= 0, y finite.
/// Gives: relative error below 1e-7 + 6e-10 |y log2 x|. Degenerate cases: 0^y is 0 for y > 0 and inf for y < 0; 0^0,
/// inf^0 and 1^inf are NaN, x < 0 is NaN.
#[inline(always)]
pub fn pow_positive(x: f32, y: f32) -> f32 {
    wide::exp2(y as f64 * wide::log2_short(x as f64)) as f32
}

/// The cube root, also of negative numbers.
///
/// Source: exponent divided by three as the first guess (Kahan 1991), then two steps of Halley's method in `f64`.
/// Domain: all. Gives: at most 1 ulp. Degenerate cases: zeros, infinities and NaN pass through.
#[inline(always)]
pub fn cbrt(x: f32) -> f32 {
    let a = x.abs();
    let denormal = a < f32::MIN_POSITIVE;
    let up = a * 16_777_216.0;
    let scaled = if denormal { up } else { a };
    let guess = f32::from_bits(scaled.to_bits() / 3 + 709_958_130);
    let s = scaled as f64;
    let mut y = guess as f64;
    for _ in 0..2 {
        let cube = y * y * y;
        y = y * ((cube + 2.0 * s) / (2.0 * cube + s));
    }
    let down = y * (1.0 / 256.0);
    let root = if denormal { down } else { y } as f32;
    let root = root.copysign(x);
    // Infinity, NaN and zero pass through; the comparison is false for the first two.
    if (a < f32::INFINITY) & (a > 0.0) { root } else { x }
}

/// 1 / sqrt(x).
///
/// Source: one square root and one division. Domain: x > 0. Gives: at most 1.5 ulp.
/// Degenerate cases: infinity of the sign of a zero, NaN below 0, 0 at inf, NaN for NaN.
#[inline(always)]
pub fn rsqrt(x: f32) -> f32 {
    1.0 / x.sqrt()
}
