//! Smooth mirrors and smooth refraction: one direction each, so they have no density.

use super::fresnel::{Fresnel, refracted};
use super::{Params, Side};
use glam::Vec3;
use std::marker::PhantomData;

/// A smooth boundary seen from `wo`: where its light comes from, and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Local direction toward the light; zero when there is none.
    pub wi: Vec3,
    /// Part of the light that goes this way, 0..1 in each component.
    pub part: Vec3,
}

/// A model of one direction, which the viewer and the parameters decide.
pub trait Single: 'static {
    /// On which side of the surface that direction lies.
    const SIDE: Side;
    /// The direction for a local direction to the viewer.
    fn meet(wo: Vec3, params: Params) -> Specular;
}

/// The mirror direction with the part that a Fresnel term of the parameters reflects.
///
/// Degenerate cases: a dielectric of index 0 or less reflects all.
#[derive(Debug)]
pub struct Reflected<F>(PhantomData<F>);

impl<F: Fresnel> Single for Reflected<F> {
    const SIDE: Side = Side::Same;

    fn meet(wo: Vec3, params: Params) -> Specular {
        Specular { wi: Vec3::new(-wo.x, -wo.y, wo.z), part: F::prepare(params, 0).color(wo.z) }
    }
}

/// What is not reflected, along Snell's direction.
///
/// Degenerate cases: nothing for metals, an index of 0 or less and total reflection.
/// Departs from source: radiance is not scaled by the change of solid angle (1 / eta²), as in OSL's renderers, so that
/// reflection and refraction of a white sky sum to 1.
#[derive(Debug)]
pub struct Refracted<F>(PhantomData<F>);

impl<F: Fresnel> Single for Refracted<F> {
    const SIDE: Side = Side::Other;

    fn meet(wo: Vec3, params: Params) -> Specular {
        let fresnel = F::prepare(params, 0);
        let wi = refracted(wo, Vec3::Z, fresnel.eta());
        let part = if wi == Vec3::ZERO { Vec3::ZERO } else { Vec3::ONE - fresnel.color(wo.z) };
        Specular { wi, part }
    }
}
