//! Ashikhmin's velvet: an inverted Gaussian of micronormals, the model that sheen is compared with, in two published forms.

pub mod form_2000;

use super::sheen::albedo::{AlbedoCurve, MIN_VELVET_WIDTH};
use super::sheen::charlie::sin2_half;
use super::{Eval, Params, Scatter, View, select};
use crate::math::elementary::exp;
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf, uniform_hemisphere};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// The two forms of the velvet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// Ashikhmin, Premoze and Shirley 2000: [`form_2000::Velvet2000`]. No light along the normal, grooves that hide each other. What the
    /// paper of the sheen compares with, and what renderers know under this name; hence the default.
    #[default]
    Of2000,
    /// Ashikhmin and Premoze 2007: [`Velvet`]. A constant part fills the dark spot, and nothing hides anything.
    Of2007,
}

impl Form {
    /// Both with the word that selects them.
    pub const ALL: &[(&str, Form)] = &[("2000", Form::Of2000), ("2007", Form::Of2007)];
}

/// `ashikhmin_velvet(N, sigma, "form", "2007")`.
///
/// Source: Ashikhmin and Premoze 2007, normalised inverted Gaussian
/// D = (1 + 4 exp(-cot²/m²) / sin⁴) / (pi (1 + 4 m²)), visibility 1 / (4 (ci + co - ci co)).
/// Domain: m = sigma, clamped to 0.06..1. Gives: f in 1/sr, reciprocal, albedo at most 0.87.
/// Degenerate cases: a half vector along the normal leaves the constant part; both directions grazing stay finite, as
/// the sum of the cosines is kept from zero.
#[derive(Clone, Copy, Debug)]
pub struct Velvet {
    /// -1 / m²
    slope: f32,
    /// 1 / (pi (1 + 4 m²))
    norm: f32,
    albedo: AlbedoCurve,
}

impl Velvet {
    /// D of micronormals at an angle of squared sine `sin2`, 1/sr.
    #[inline(always)]
    pub fn distribution(&self, sin2: f32) -> f32 {
        // Below this the exponential has vanished for every m in the domain, and its divisor must not.
        let s2 = sin2.max(1e-12);
        let bump = 4.0 * exp(self.slope * (1.0 - s2) / s2) / (s2 * s2);
        self.norm * (1.0 + bump)
    }
}

impl Scatter for Velvet {
    const PARAMS: usize = 1;

    #[inline(always)]
    fn prepare([m, ..]: Params) -> Self {
        let m = m.clamp(MIN_VELVET_WIDTH, 1.0);
        let norm = FRAC_1_PI / (1.0 + 4.0 * m * m);
        Velvet { slope: -1.0 / (m * m), norm, albedo: AlbedoCurve::velvet(m) }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let (co, ci) = (wo.z.max(0.0), wi.z.max(0.0));
        let visibility = 0.25 / (ci + co - ci * co).max(1e-12);
        let f = self.distribution(sin2_half(wo, wi)) * visibility;
        let pdf = 0.5 * (cosine_hemisphere_pdf(wi.z) + 1.0 / TAU);
        let above = wi.z > 0.0;
        Eval { f_cos: select(above, f * ci, 0.0), pdf: select(above, pdf, 0.0) }
    }

    /// Half of the directions by cosine for the constant part, half uniform for the rim.
    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        if xi.z < 0.5 { cosine_hemisphere(xi.x, xi.y) } else { uniform_hemisphere(xi.x, xi.y) }
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.albedo.at::<true>(cos)
    }
}
