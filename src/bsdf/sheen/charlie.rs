//! The Charlie distribution: an exponentiated sine, whose micronormals lie mostly near the horizon.

use crate::bsdf::limited;
use crate::bsdf::power::power;
use glam::Vec3;
use std::f32::consts::TAU;

/// Smallest roughness; D is finite and its exponent 1/(2r) exact enough down to here.
pub const MIN_ROUGHNESS: f32 = 0.01;

/// The roughness a closure asks for, brought into the domain of the model.
///
/// Domain: any number. Gives: 0.01..1. Degenerate cases: zero, denormal, negative and NaN give 0.01. The paper allows (0, 1];
/// (1 - r)² of its fit would fold r = 2 back to 0 if it were not clamped.
#[inline(always)]
pub fn clamp_roughness(r: f32) -> f32 {
    limited(r, MIN_ROUGHNESS, 1.0)
}

/// sin² of the angle between the normal and the half vector of two local directions.
///
/// Source: |N x H|² / |H|² with H not normalised. Domain: unit `wo`, `wi`. Gives: 0..1.
/// Degenerate cases: opposite directions in the horizon (H = 0) give 0.
/// 1 - cos² would lose all digits near the mirror direction: 9 % of D at theta_h = 1e-3, r = 0.25.
#[inline(always)]
pub fn sin2_half(wo: Vec3, wi: Vec3) -> f32 {
    let (x, y, z) = (wo.x + wi.x, wo.y + wi.y, wo.z + wi.z);
    let across = x * x + y * y;
    across / (across + z * z).max(f32::MIN_POSITIVE)
}

/// D of micronormals at an angle of squared sine `sin2`.
///
/// Source: Estevez and Kulla 2017, eq. 2: (2 + 1/r) sin(theta)^(1/r) / (2 pi).
/// Domain: sin2 0..1, n = 1/r in 1..100. Gives: 1/sr, integral of D cos over the hemisphere = 1.
/// Degenerate cases: sin2 0 gives less than 1e-18 (n = 1) or 1e-35 (n >= 2). Error: relative 2e-5 where D > 1e-12.
#[inline(always)]
pub fn distribution(sin2: f32, n: f32) -> f32 {
    (2.0 + n) * (1.0 / TAU) * power(sin2.max(f32::MIN_POSITIVE), 0.5 * n)
}
