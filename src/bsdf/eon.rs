//! Rough diffuse reflection that loses no light: Fujii's form of Oren and Nayar with the light scattered several times.

use super::oren_nayar::OrenNayar;
use super::{Eval, Params, Scatter, Spread, View, limited};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// `oren_nayar_diffuse_bsdf(N, albedo, roughness)` with "energy_compensation", without the factor `albedo`.
///
/// Source: Portsmouth, Kutz and Hill 2025, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", eq. 9 to 27: Fujii's
/// single scattering a (1 + r s/t) / pi, plus (1 - E(ci))(1 - E(co)) / (pi (1 - mean E)) for light scattered more often.
/// Domain: roughness 0..1 and color rho 0..1, limited to it. Gives: f over rho in 1/sr, reciprocal.
/// Degenerate cases: roughness 0 is Lambert's. The color of repeated scattering is rho mean E / (1 - rho (1 - mean E)).
/// Energy: albedo 1 for white within 1e-4. Albedo: in closed form, the arc cosine within 7e-5.
#[derive(Clone, Copy, Debug)]
pub struct Eon {
    a: f32,
    b: f32,
    mean: f32,
    /// Color of repeated scattering.
    repeated: Vec3,
}

impl Eon {
    /// The albedo of single scattering for a white surface.
    #[inline(always)]
    pub fn single(&self, cos: f32) -> f32 {
        let c = cos.clamp(0.0, 1.0);
        let sin = ((1.0 - c) * (1.0 + c)).sqrt();
        // What lies toward the viewer adds the gain of the model of 1994, what lies away takes this.
        (self.a + self.b * (OrenNayar::gain(c) - 2.0 / (3.0 * PI) * sin)).min(1.0)
    }

    /// Scattered once and more often, over the white surface's cosine law.
    #[inline(always)]
    fn parts(&self, wo: Vec3, lost_o: f32, wi: Vec3) -> (f32, f32) {
        let aligned = wo.x * wi.x + wo.y * wi.y;
        let over = if aligned > 0.0 { wo.z.max(wi.z).max(f32::MIN_POSITIVE) } else { 1.0 };
        let once = self.a + self.b * aligned / over;
        let more = lost_o * (1.0 - self.single(wi.z)) / (1.0 - self.mean).max(1e-6);
        (once.max(0.0), more)
    }
}

impl Scatter for Eon {
    const PARAMS: usize = 4;
    const SPREAD: Spread = Spread::Even;
    const VIEW: usize = 1;
    const COLORED: bool = true;

    #[inline(always)]
    fn prepare([roughness, x, y, z, ..]: Params) -> Self {
        let r = limited(roughness, 0.0, 1.0);
        let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
        let mean = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
        let one = |rho: f32| {
            let rho = limited(rho, 0.0, 1.0);
            rho * mean / (1.0 - rho * (1.0 - mean))
        };
        Eon { a, b: a * r, mean, repeated: Vec3::new(one(x), one(y), one(z)) }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        [1.0 - self.single(wo.z), 0.0, 0.0, 0.0, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, [lost_o, ..]: View, wi: Vec3) -> Eval {
        let (once, more) = self.parts(wo, lost_o, wi);
        let pdf = cosine_hemisphere_pdf(wi.z);
        Eval { f_cos: (once + more) * FRAC_1_PI * wi.z.max(0.0), pdf }
    }

    #[inline(always)]
    fn color_from(&self, wo: Vec3, [lost_o, ..]: View, wi: Vec3) -> Vec3 {
        let (once, more) = self.parts(wo, lost_o, wi);
        (Vec3::splat(once) + self.repeated * more) / (once + more).max(1e-20)
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    /// Source: own; the mean of the cosine of the azimuth is 1 / pi over the half that is aligned, and -1 / pi over the other.
    #[inline(always)]
    fn turned(&self, cos_i: f32, cos_o: f32) -> f32 {
        let sines = ((1.0 - cos_i * cos_i) * (1.0 - cos_o * cos_o)).max(0.0).sqrt();
        let once = self.a + self.b * FRAC_1_PI * sines * (1.0 / cos_i.max(cos_o).max(1e-6) - 1.0);
        once + (1.0 - self.single(cos_i)) * (1.0 - self.single(cos_o)) / (1.0 - self.mean).max(1e-6)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let single = self.single(cos);
        single + (1.0 - single) * self.repeated.x.max(self.repeated.y).max(self.repeated.z)
    }
}
