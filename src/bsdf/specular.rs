//! Smooth mirrors and smooth refraction: one direction each, so they have no density.

use super::fresnel::{dielectric, refracted};
use glam::Vec3;

/// A smooth dielectric boundary seen from `wo`: where its light comes from, and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Local direction toward the light; zero when there is none.
    pub wi: Vec3,
    /// Part of the light that goes this way, 0..1.
    pub part: f32,
}

/// `reflection(N, eta)`: all light when `eta <= 0`, otherwise the Fresnel part.
#[inline(always)]
pub fn reflection(wo: Vec3, eta: f32) -> Specular {
    Specular { wi: Vec3::new(-wo.x, -wo.y, wo.z), part: dielectric(wo.z, eta) }
}

/// `refraction(N, eta)`: what is not reflected, along Snell's direction.
///
/// Departs from source: radiance is not scaled by the change of solid angle (1 / eta²), as in OSL's renderers, so that
/// reflection and refraction of a white sky sum to 1.
#[inline(always)]
pub fn refraction(wo: Vec3, eta: f32) -> Specular {
    Specular { wi: refracted(wo, Vec3::Z, eta), part: 1.0 - dielectric(wo.z, eta) }
}
