//! Ashikhmin's velvet in its form of 2000, which the sheen's paper compares with: no facet along the normal, so no light there.

use crate::bsdf::sheen::albedo::{AlbedoCurve, MIN_VELVET_WIDTH};
use crate::bsdf::sheen::charlie::sin2_half;
use crate::bsdf::sheen::proposals::VELVET;
use crate::bsdf::sheen::sampling::{Aim, Proposal};
use crate::bsdf::{Eval, Params, Scatter, View, limited, select};
use crate::math::elementary::exp;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// `ashikhmin_velvet(N, sigma)`, with `"form", "2000"` or without.
///
/// Source: Ashikhmin, Premoze and Shirley 2000, the inverted Gaussian slope D = exp(-cot² / sigma²) / (pi sigma² sin⁴), as production
/// renderers have it: with the V-shaped grooves of Torrance and Sparrow 1967, G = min(1, 2 (n.h) min(n.o, n.i) / (o.h)), and
/// f = D G / (4 (n.o) (n.i)). The integral of D cos is 1, without a constant to add.
/// Domain: sigma, clamped to 0.06..1. Gives: f in 1/sr, reciprocal, albedo at most 1.
/// Degenerate cases: a half vector along the normal gives 0; grazing directions stay finite.
#[derive(Clone, Copy, Debug)]
pub struct Velvet2000 {
    /// -1 / sigma²
    slope: f32,
    /// 1 / (pi sigma²)
    norm: f32,
    albedo: AlbedoCurve,
    proposal: Proposal,
}

impl Velvet2000 {
    /// D of micronormals at an angle of squared sine `sin2`, 1/sr.
    #[inline(always)]
    pub fn distribution(&self, sin2: f32) -> f32 {
        // Below this the exponential has vanished for every sigma in the domain, and its divisor must not.
        let s2 = sin2.max(1e-12);
        self.norm * exp(self.slope * (1.0 - s2) / s2) / (s2 * s2)
    }
}

impl Scatter for Velvet2000 {
    const PARAMS: usize = 1;
    const VIEW: usize = 4;

    #[inline(always)]
    fn prepare([sigma, ..]: Params) -> Self {
        let sigma = limited(sigma, MIN_VELVET_WIDTH, 1.0);
        let inverse = 1.0 / (sigma * sigma);
        Velvet2000 {
            slope: -inverse,
            norm: FRAC_1_PI * inverse,
            albedo: AlbedoCurve::velvet_2000(sigma),
            proposal: Proposal::of(&VELVET, sigma),
        }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let Aim { tilt, across, x, y } = self.proposal.view(wo);
        [tilt, across, x, y, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, [tilt, across, x, y, _]: View, wi: Vec3) -> Eval {
        let (co, ci) = (wo.z.max(1e-30), wi.z.max(0.0));
        let h = wo + wi;
        // G / (4 n.o): n.h / (o.h) is 2 h.z / |h|² of the half vector before it is normalised.
        let grooves = h.z * (ci / co).min(1.0) / h.dot(h).max(f32::MIN_POSITIVE);
        let value = self.distribution(sin2_half(wo, wi)) * grooves.min(0.25 / co);
        let pdf = self.proposal.pdf(Aim { tilt, across, x, y }, wi);
        Eval { f_cos: select(wo.z > 0.0 && wi.z > 0.0, value, 0.0), pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, [tilt, across, x, y, _]: View, xi: Vec3) -> Vec3 {
        self.proposal.sample(Aim { tilt, across, x, y }, xi)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.albedo.at::<true>(cos)
    }
}
