//! Exponentials.

use super::wide;

/// 1.5 * 2^23. Adding it leaves the nearest whole number in the low bits of an `f32`.
const ROUND: f32 = 12_582_912.0;

/// `x` times 2^n for n in [-250, 250]: two steps, because one power of two would leave the normal range.
#[inline(always)]
fn scale(x: f32, n: i32) -> f32 {
    let half = n >> 1;
    let rest = n - half;
    let first = f32::from_bits(((half + 127) << 23) as u32);
    let second = f32::from_bits(((rest + 127) << 23) as u32);
    x * first * second
}

/// Limits `x` to `[low, high]` and lets NaN through.
#[inline(always)]
fn limit(x: f32, low: f32, high: f32) -> f32 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

/// The exponential e^x.
///
/// Source: Cody and Waite 1980, reduction by multiples of ln 2 in two parts, and a fitted polynomial. Domain: all.
/// Gives: at most 1.1 ulp. Degenerate cases: inf above 88.72, denormals below -87.3, 0 below -103.97, NaN for NaN.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // The first part has so few bits that n times it is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let x = limit(x, -105.0, 90.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    // (e^r - 1 - r) / r^2 on |r| <= 0.347, relative error of e^r: 2^-26.5.
    let p = 1.392_625_1e-3 * r + 8.363_233e-3;
    let p = p * r + 4.166_655_4e-2;
    let p = p * r + 1.666_657_7e-1;
    let p = p * r + 0.5;
    let value = 1.0 + (r + r * r * p);
    scale(value, (shifted.to_bits() as i32).wrapping_sub(ROUND.to_bits() as i32))
}

/// The power of two 2^x.
///
/// Source: split in whole and fraction, and a fitted polynomial. Domain: all. Gives: at most 1.2 ulp, whole powers exact.
/// Degenerate cases: inf from 128 on, denormals below -126, 0 below -150, NaN for NaN.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    let x = limit(x, -151.0, 129.0);
    let shifted = x + ROUND;
    let f = x - (shifted - ROUND);
    // (2^f - 1) / f on |f| <= 0.501, relative error of 2^f: 2^-27.5.
    let p = 1.545_336_2e-4 * f + 1.339_109_3e-3;
    let p = p * f + 9.618_082e-3;
    let p = p * f + 5.550_356_7e-2;
    let p = p * f + 2.402_265_1e-1;
    let p = p * f + std::f32::consts::LN_2;
    let value = 1.0 + f * p;
    scale(value, (shifted.to_bits() as i32).wrapping_sub(ROUND.to_bits() as i32))
}

/// e^x - 1, precise near 0 where subtracting 1 from `exp` would lose every digit.
///
/// Source: reduction by multiples of ln 2 in `f64`, and a fitted polynomial. Domain: all. Gives: at most 1 ulp.
/// Degenerate cases: sign of zero kept, inf above 88.72, -1 far below 0, NaN for NaN.
#[inline(always)]
pub fn expm1(x: f32) -> f32 {
    let value = wide::expm1(x as f64) as f32;
    if x == 0.0 { x } else { value }
}
