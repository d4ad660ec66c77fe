//! Logarithms.

use super::wide;

/// The natural logarithm.
///
/// Source: Tang 1990 and FDLIBM: log(1+f) by s = f/(2+f). Domain: x > 0. Gives: at most 1 ulp.
/// Degenerate cases: -inf at both zeros, NaN below 0, inf at inf, NaN for NaN; denormals are exact inputs.
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    const LN_2_HIGH: f32 = 6.931_381e-1;
    const LN_2_LOW: f32 = 9.058_001e-6;
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let denormal = x < f32::MIN_POSITIVE;
    let scaled = x * 8_388_608.0;
    let bits = if denormal { scaled.to_bits() } else { x.to_bits() };
    let bias = if denormal { 150 } else { 127 };
    let shifted = bits.wrapping_add(0x3f80_0000 - SQRT_HALF_BITS);
    let k = ((shifted >> 23) as i32 - bias) as f32;
    let m = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF_BITS);
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    // 2 (atanh(s)/s - 1) / s^2 on s^2 in [0, 0.0297], error 2^-29.1.
    let p = 2.334_194_3e-1 * z + 2.855_039_7e-1;
    let p = p * z + 4.000_012_6e-1;
    let p = p * z + 6.666_666_7e-1;
    let half_square = 0.5 * f * f;
    let finite = s * (half_square + z * p) + k * LN_2_LOW - half_square + f + k * LN_2_HIGH;
    let result = if x == 0.0 { f32::NEG_INFINITY } else { finite };
    let result = if x == f32::INFINITY { x } else { result };
    if x >= 0.0 { result } else { f32::NAN }
}

/// The base-two logarithm.
///
/// Source: atanh series in `f64`, fitted. Domain: x > 0. Gives: at most 1 ulp, powers of two exact.
/// Degenerate cases: -inf at both zeros, NaN below 0, inf at inf, NaN for NaN.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    wide::log2(x as f64) as f32
}

/// The base-ten logarithm.
///
/// Source: atanh series in `f64`, fitted. Domain: x > 0. Gives: at most 1 ulp.
/// Degenerate cases: -inf at both zeros, NaN below 0, inf at inf, NaN for NaN.
#[inline(always)]
pub fn log10(x: f32) -> f32 {
    (wide::log2(x as f64) * std::f64::consts::LOG10_2) as f32
}

/// The exponent of `x`, floor(log2 |x|), as C `logbf` gives it.
///
/// Domain: all. Gives: exact. Degenerate cases: -inf at 0, inf at both infinities, NaN for NaN; denormals are counted
/// by their true exponent.
#[inline(always)]
pub fn logb(x: f32) -> f32 {
    let a = x.abs();
    let denormal = a < f32::MIN_POSITIVE;
    let scaled = a * 8_388_608.0;
    let bits = if denormal { scaled.to_bits() } else { a.to_bits() };
    let bias = if denormal { 150 } else { 127 };
    let exponent = ((bits >> 23) as i32 - bias) as f32;
    let result = if a == 0.0 { f32::NEG_INFINITY } else { exponent };
    // Infinity gives itself and so does NaN.
    if a < f32::INFINITY { result } else { a }
}
