//! Burley's diffuse reflection of 2012, with the rise or fall toward grazing that roughness brings.

use super::{Eval, Params, Scatter, Spread, View, limited};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// `burley_diffuse_bsdf(N, albedo, roughness)`, without the color.
///
/// Source: Burley 2012, "Physically-Based Shading at Disney", section 5.3:
/// f = (1 + (F90 - 1)(1 - ci)^5) (1 + (F90 - 1)(1 - co)^5) / pi with F90 = 1/2 + 2 r (h . wi)².
/// Domain: roughness 0..1, limited to it. Gives: f in 1/sr, reciprocal. Degenerate cases: none.
/// Energy: gains when rough and grazing, up to 1.558 at roughness 1 and cosine 0; at most 1 for roughness up to 0.4.
/// Albedo: exact in closed form (own derivation), cut at 1.
#[derive(Clone, Copy, Debug)]
pub struct Burley {
    roughness: f32,
}

#[inline(always)]
fn fifth(cos: f32) -> f32 {
    let x = limited(1.0 - cos, 0.0, 1.0);
    x * x * x * x * x
}

impl Burley {
    /// The directional albedo, which may pass 1.
    ///
    /// Source: own integration; the azimuth leaves means of powers of 2 (h . wi)² = 1 + wo . wi, the rest are Beta integrals.
    #[inline(always)]
    pub fn whole_albedo(&self, cos: f32) -> f32 {
        let (c, rise) = (cos.clamp(0.0, 1.0), fifth(cos));
        let smooth = 41.0 / 42.0 * (1.0 - 0.5 * rise);
        let linear = (1.0 / 21.0 + c / 84.0) * (1.0 - rise) + rise * (1.0 + 2.0 / 3.0 * c);
        let square = rise * (35.0 + c * (12.0 - 9.0 * c)) / 504.0;
        smooth + self.roughness * (linear + self.roughness * square)
    }
}

impl Scatter for Burley {
    const PARAMS: usize = 1;
    const SPREAD: Spread = Spread::Even;
    const VIEW: usize = 1;

    #[inline(always)]
    fn prepare([roughness, ..]: Params) -> Self {
        Burley { roughness: limited(roughness, 0.0, 1.0) }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        [fifth(wo.z), 0.0, 0.0, 0.0, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, [rise_o, ..]: View, wi: Vec3) -> Eval {
        // 2 (h . wi)² = 1 + wo . wi, without the half vector.
        let more = self.roughness * (1.0 + wo.dot(wi)).max(0.0) - 0.5;
        let pdf = cosine_hemisphere_pdf(wi.z);
        let f = FRAC_1_PI * (1.0 + more * fifth(wi.z)) * (1.0 + more * rise_o);
        Eval { f_cos: f * wi.z.max(0.0), pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    /// Source: own; `more` is linear in the cosine of the azimuth, of which the mean is 0 and that of the square 1/2.
    #[inline(always)]
    fn turned(&self, cos_i: f32, cos_o: f32) -> f32 {
        let (rise_i, rise_o) = (fifth(cos_i), fifth(cos_o));
        let more = self.roughness * (1.0 + cos_i * cos_o) - 0.5;
        let sines2 = (1.0 - cos_i * cos_i) * (1.0 - cos_o * cos_o);
        let square = more * more + 0.5 * self.roughness * self.roughness * sines2;
        1.0 + more * (rise_i + rise_o) + square * rise_i * rise_o
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.whole_albedo(cos).min(1.0)
    }
}
