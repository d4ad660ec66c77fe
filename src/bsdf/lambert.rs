//! Lambert's reflection and transmission: the same radiance in every direction of one hemisphere.

use super::{Eval, Params, Scatter, Side, Spread, View};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use glam::Vec3;

/// `diffuse(N)`.
///
/// Source: Lambert 1760. Gives: f = 1/pi above the horizon; albedo 1. Reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Lambert;

/// `translucent(N)`: Lambert's law on the other side of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Translucent;

impl Scatter for Lambert {
    const PARAMS: usize = 0;
    const FLAT: bool = true;
    const SPREAD: Spread = Spread::Even;

    #[inline(always)]
    fn prepare(_: Params) -> Self {
        Lambert
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let pdf = cosine_hemisphere_pdf(wi.z);
        Eval { f_cos: pdf, pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    #[inline(always)]
    fn albedo(&self, _cos: f32) -> f32 {
        1.0
    }
}

impl Scatter for Translucent {
    const PARAMS: usize = 0;
    const FLAT: bool = true;
    const SPREAD: Spread = Spread::Even;
    const SIDE: Side = Side::Other;

    #[inline(always)]
    fn prepare(_: Params) -> Self {
        Translucent
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let pdf = cosine_hemisphere_pdf(-wi.z);
        Eval { f_cos: pdf, pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let up = cosine_hemisphere(xi.x, xi.y);
        Vec3::new(up.x, up.y, -up.z)
    }

    #[inline(always)]
    fn albedo(&self, _cos: f32) -> f32 {
        1.0
    }
}
