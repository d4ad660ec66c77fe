//! Rough diffuse reflection of Oren and Nayar, the qualitative model of 1994.

use super::{Eval, Params, Scatter, Spread, View, select};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, FRAC_2_PI};

/// `oren_nayar(N, sigma)`.
///
/// Source: Oren and Nayar 1994, eq. 30 with A = 1 - 0.5 s²/(s² + 0.33), B = 0.45 s²/(s² + 0.09).
/// Domain: sigma >= 0, the standard deviation of the facet slope in radians.
/// Gives: f in 1/sr, reciprocal; albedo in closed form (see `gain`).
/// Degenerate cases: sigma 0 is Lambert's; grazing directions are divided by the larger cosine, never by zero.
/// Departs from source: the published formula reflects up to 1.5 % more light than arrives when a direction is grazing and
/// sigma is below 0.42. There f is divided by the larger of the two albedos, which keeps it reciprocal and below 1.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar {
    a: f32,
    b: f32,
}

impl OrenNayar {
    /// The published f, before its energy is limited.
    #[inline(always)]
    pub fn published(&self, wo: Vec3, wi: Vec3) -> f32 {
        let aligned = (wo.x * wi.x + wo.y * wi.y).max(0.0);
        // sin(alpha) tan(beta) cos(phi) is the aligned part of the projected directions over the larger cosine.
        FRAC_1_PI * (self.a + self.b * aligned / wo.z.max(wi.z).max(f32::MIN_POSITIVE))
    }

    /// What B adds to the directional albedo: (1/pi) times the integral of max(0, cos phi) sin(alpha) tan(beta) cos_i.
    ///
    /// Source: own integration. Domain: 0..1. Gives: 0..0.5, falling. Error: below 1e-4 (the arc cosine is
    /// Abramowitz and Stegun 4.4.45, absolute error 7e-5).
    #[inline(always)]
    pub(super) fn gain(cos: f32) -> f32 {
        let c = cos.clamp(0.0, 1.0);
        let s2 = (1.0 - c) * (1.0 + c);
        let s = s2.sqrt();
        let angle = (1.0 - c).sqrt() * (1.570_728_8 + c * (-0.212_114_4 + c * (0.074_261 - c * 0.018_729_3)));
        let below = c * (1.0 + s + s2) / (3.0 * (1.0 + s));
        (FRAC_2_PI * s * (below + 0.5 * (angle - s * c))).max(0.0)
    }

    #[inline(always)]
    fn published_albedo(&self, cos: f32) -> f32 {
        self.a + self.b * Self::gain(cos)
    }
}

impl Scatter for OrenNayar {
    const PARAMS: usize = 1;
    const SPREAD: Spread = Spread::Even;

    #[inline(always)]
    fn prepare([sigma, ..]: Params) -> Self {
        // Beyond a slope of 1e3 the constants have reached their limits.
        let s2 = sigma.clamp(0.0, 1e3) * sigma.clamp(0.0, 1e3);
        OrenNayar { a: 1.0 - 0.5 * s2 / (s2 + 0.33), b: 0.45 * s2 / (s2 + 0.09) }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let limit = self.published_albedo(wo.z).max(self.published_albedo(wi.z)).max(1.0);
        let f = self.published(wo, wi) / limit;
        let pdf = cosine_hemisphere_pdf(wi.z);
        Eval { f_cos: select(wi.z > 0.0, f * wi.z, 0.0), pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    /// Source: own; the mean of what is positive of the cosine of the azimuth is 1 / pi.
    #[inline(always)]
    fn turned(&self, cos_i: f32, cos_o: f32) -> f32 {
        let sines = ((1.0 - cos_i * cos_i) * (1.0 - cos_o * cos_o)).max(0.0).sqrt();
        let limit = self.published_albedo(cos_i).max(self.published_albedo(cos_o)).max(1.0);
        (self.a + self.b * FRAC_1_PI * sines / cos_i.max(cos_o).max(1e-6)) / limit
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.published_albedo(cos).min(1.0)
    }
}
