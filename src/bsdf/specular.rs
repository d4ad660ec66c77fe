//! Smooth mirrors and smooth refraction: one direction each, so they have no density.

use super::Params;
use super::fresnel::{Term, refracted};
use glam::Vec3;

/// A smooth boundary seen from `wo`: where its light comes from, and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Local direction toward the light; zero when there is none.
    pub wi: Vec3,
    /// Part of the light that goes this way, 0..1 in each component.
    pub part: Vec3,
}

/// The mirror direction with the part that the Fresnel term of these parameters reflects.
///
/// Degenerate cases: a dielectric of index 0 or less reflects all.
pub fn reflection(wo: Vec3, term: Term, params: Params) -> Specular {
    Specular { wi: Vec3::new(-wo.x, -wo.y, wo.z), part: term.color(params, wo.z) }
}

/// What is not reflected, along Snell's direction.
///
/// Degenerate cases: nothing for metals, an index of 0 or less and total reflection.
/// Departs from source: radiance is not scaled by the change of solid angle (1 / eta²), as in OSL's renderers, so that
/// reflection and refraction of a white sky sum to 1.
pub fn refraction(wo: Vec3, term: Term, params: Params) -> Specular {
    let wi = refracted(wo, Vec3::Z, term.eta(params));
    let part = if wi == Vec3::ZERO { Vec3::ZERO } else { Vec3::ONE - term.color(params, wo.z) };
    Specular { wi, part }
}
