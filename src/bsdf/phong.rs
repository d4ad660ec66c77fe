//! Phong's highlight about the mirror direction, in the form of Lafortune and Willems, which conserves energy.

use super::cosine_power::{CosinePower, CosinePowerAlbedo};
use super::{Eval, Params, Scatter, Spread, View, above_horizon, select};
use glam::Vec3;
use std::f32::consts::TAU;

/// `phong(N, exponent)`.
///
/// Source: Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering", the
/// specular part: f = (n + 2) / (2 pi) max(0, r . wi)^n with r the mirror image of wo.
/// Domain: exponent 0..1e6, limited to it. Gives: f in 1/sr, reciprocal, albedo at most 1 (1 along the normal).
/// Degenerate cases: exponent 0 is constant on the half of the sky about r. Albedo within 5e-5.
/// Samples that fall below the horizon are lost: half of them when the view grazes.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    lobe: CosinePower,
    albedo: CosinePowerAlbedo,
}

impl Scatter for Phong {
    const PARAMS: usize = 1;
    const SPREAD: Spread = Spread::Narrow;

    #[inline(always)]
    fn prepare([exponent, ..]: Params) -> Self {
        let lobe = CosinePower::new(exponent);
        Phong { lobe, albedo: CosinePowerAlbedo::new(lobe) }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let value = select(wi.z > 0.0, self.lobe.value(Vec3::new(-wo.x, -wo.y, wo.z), wi), 0.0);
        Eval { f_cos: (self.lobe.n + 2.0) / TAU * value * wi.z.max(0.0), pdf: self.lobe.pdf(value) }
    }

    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        above_horizon(self.lobe.sample(Vec3::new(-wo.x, -wo.y, wo.z), xi.x, xi.y))
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.albedo.at(cos)
    }
}
