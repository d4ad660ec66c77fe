//! Arithmetic as OSL has it: nothing traps, and what would be infinite or undefined becomes a number.

use crate::math::elementary as e;
use std::f32::consts::{FRAC_PI_2, PI};

/// Float division. Gives 0 where the quotient is not finite, as when `b` is 0.
#[inline(always)]
pub fn div(a: f32, b: f32) -> f32 {
    let q = a / b;
    if q.abs() < f32::INFINITY { q } else { 0.0 }
}

/// Integer division towards zero; 0 when `b` is 0. The one overflow, MIN / -1, wraps.
#[inline(always)]
pub fn int_div(a: i32, b: i32) -> i32 {
    let divisor = if b == 0 { 1 } else { b };
    let q = a.wrapping_div(divisor);
    if b == 0 { 0 } else { q }
}

/// Integer remainder with the sign of `a`; 0 when `b` is 0.
#[inline(always)]
pub fn int_mod(a: i32, b: i32) -> i32 {
    let divisor = if b == 0 { 1 } else { b };
    let r = a.wrapping_rem(divisor);
    if b == 0 { 0 } else { r }
}

/// Shift left. Differs from OSL: only the low five bits of the count are used, where C leaves other counts undefined.
#[inline(always)]
pub fn shl(a: i32, count: i32) -> i32 {
    a.wrapping_shl(count as u32)
}

/// Arithmetic shift right. Differs from OSL: only the low five bits of the count are used.
#[inline(always)]
pub fn shr(a: i32, count: i32) -> i32 {
    a.wrapping_shr(count as u32)
}

/// Float remainder with the sign of `a`; 0 when `b` is 0.
///
/// Source: a - b trunc(a/b), as OSL computes it; unlike C `fmodf` it is not exact for large quotients.
#[inline(always)]
pub fn fmod(a: f32, b: f32) -> f32 {
    let r = a - e::trunc(a / b) * b;
    if b == 0.0 { 0.0 } else { r }
}

/// Square root; 0 below 0.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    let root = x.sqrt();
    if x >= 0.0 { root } else { 0.0 }
}

/// 1 / sqrt(x); 0 at and below 0.
#[inline(always)]
pub fn inversesqrt(x: f32) -> f32 {
    let inverse = e::rsqrt(x);
    if x > 0.0 { inverse } else { 0.0 }
}

/// The range that logarithms see: from the least normal to the greatest finite number, NaN as the least.
#[inline(always)]
fn log_range(x: f32) -> f32 {
    let x = if x >= f32::MIN_POSITIVE { x } else { f32::MIN_POSITIVE };
    if x > f32::MAX { f32::MAX } else { x }
}

/// Natural logarithm; arguments below the least normal number count as that number.
#[inline(always)]
pub fn log(x: f32) -> f32 {
    e::ln(log_range(x))
}

/// Base-two logarithm; arguments below the least normal number count as that number.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    e::log2(log_range(x))
}

/// Base-ten logarithm; arguments below the least normal number count as that number.
#[inline(always)]
pub fn log10(x: f32) -> f32 {
    e::log10(log_range(x))
}

/// The exponent of |x|; magnitudes below the least normal number count as that number, infinity as the greatest.
#[inline(always)]
pub fn logb(x: f32) -> f32 {
    e::logb(log_range(x.abs()))
}

/// x^y. Gives 1 for y = 0, 0 for x = 0 and for a negative x with a fractional y; never exceeds the finite range.
#[inline(always)]
pub fn pow(x: f32, y: f32) -> f32 {
    let p = e::pow(x, y);
    let p = if p > f32::MAX { f32::MAX } else { p };
    let p = if p < -f32::MAX { -f32::MAX } else { p };
    let zero = (x == 0.0) | ((x < 0.0) & (e::floor(y) != y));
    let p = if zero { 0.0 } else { p };
    if y == 0.0 { 1.0 } else { p }
}

/// Arc sine; arguments outside [-1, 1] count as the nearest end.
#[inline(always)]
pub fn asin(x: f32) -> f32 {
    let inside = e::asin(x);
    let inside = if x >= 1.0 { FRAC_PI_2 } else { inside };
    if x <= -1.0 { -FRAC_PI_2 } else { inside }
}

/// Arc cosine; arguments outside [-1, 1] count as the nearest end.
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let inside = e::acos(x);
    let inside = if x >= 1.0 { 0.0 } else { inside };
    if x <= -1.0 { PI } else { inside }
}

/// -1, 0 or 1 by the sign of `x`; 1 for NaN, as OSL's comparisons have it.
#[inline(always)]
pub fn sign(x: f32) -> f32 {
    let rest = if x == 0.0 { 0.0 } else { 1.0 };
    if x < 0.0 { -1.0 } else { rest }
}

/// Conversion to integer: towards zero, saturating, NaN as 0.
///
/// Differs from OSL, where what is beyond the range of an int depends on the machine.
#[inline(always)]
pub fn to_int(x: f32) -> i32 {
    e::trunc_to_int(x)
}

/// The lesser of two; the second when either is NaN.
#[inline(always)]
pub fn min(x: f32, y: f32) -> f32 {
    if x <= y { x } else { y }
}

/// The greater of two; the second when either is NaN.
#[inline(always)]
pub fn max(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}

/// 0 below the edge, else 1.
#[inline(always)]
pub fn step(edge: f32, x: f32) -> f32 {
    if x < edge { 0.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn division_never_leaves_the_numbers() {
        assert_eq!(div(1.0, 0.0), 0.0);
        assert_eq!(div(0.0, 0.0), 0.0);
        assert_eq!(div(1e30, 1e-30), 0.0);
        assert_eq!(div(3.0, -2.0), -1.5);
        assert_eq!(int_div(7, 0), 0);
        assert_eq!(int_div(-7, 2), -3);
        assert_eq!(int_div(i32::MIN, -1), i32::MIN);
        assert_eq!(int_mod(-7, 3), -1);
        assert_eq!(int_mod(7, 0), 0);
        assert_eq!(int_mod(i32::MIN, -1), 0);
        assert_eq!(fmod(-5.5, 2.0), -1.5);
        assert_eq!(fmod(5.5, 0.0), 0.0);
    }

    #[test]
    fn shifts_take_any_count() {
        assert_eq!(shl(1, 33), 2);
        assert_eq!(shr(-8, 1), -4);
        assert_eq!(shr(-8, -1), -1);
    }

    #[test]
    fn roots_and_logarithms_are_limited() {
        assert_eq!(sqrt(-1.0), 0.0);
        assert_eq!(sqrt(f32::NAN), 0.0);
        assert_eq!(inversesqrt(0.0), 0.0);
        assert_eq!(inversesqrt(4.0), 0.5);
        assert_eq!(log(0.0), log(f32::MIN_POSITIVE));
        assert_eq!(log2(-5.0), -126.0);
        assert_eq!(logb(0.0), -126.0);
        assert_eq!(logb(-10.0), 3.0);
        assert!(log(f32::INFINITY) < 89.0);
    }

    #[test]
    fn pow_is_limited() {
        assert_eq!(pow(0.0, 0.0), 1.0);
        assert_eq!(pow(0.0, -1.0), 0.0);
        assert_eq!(pow(-2.0, 0.5), 0.0);
        assert_eq!(pow(-2.0, 3.0), -8.0);
        assert_eq!(pow(10.0, 50.0), f32::MAX);
        assert_eq!(pow(-10.0, 51.0), -f32::MAX);
    }

    #[test]
    fn arcs_are_limited() {
        assert_eq!(asin(2.0), FRAC_PI_2);
        assert_eq!(asin(-2.0), -FRAC_PI_2);
        assert_eq!(acos(1.5), 0.0);
        assert_eq!(acos(-1.5), PI);
    }

    #[test]
    fn comparisons_treat_nan_as_osl_does() {
        assert_eq!(min(f32::NAN, 1.0), 1.0);
        assert!(min(1.0, f32::NAN).is_nan());
        assert_eq!(max(f32::NAN, 1.0), 1.0);
        assert_eq!(sign(f32::NAN), 1.0);
        assert_eq!(sign(-0.0), 0.0);
        assert_eq!(to_int(-2.9), -2);
        assert_eq!(to_int(1e20), i32::MAX);
        assert_eq!(to_int(f32::NAN), 0);
    }

    #[test]
    fn steps_meet_their_edges() {
        assert_eq!(step(1.0, 1.0), 1.0);
    }
}
