//! Facets of Trowbridge and Reitz (GGX), and their visible normals, which all distributions sample.

use super::distribution::{Distribution, Widths, normal_of_slope};
use super::geometry::Facets;
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::PI;

/// Trowbridge-Reitz, anisotropic.
#[derive(Clone, Copy, Debug)]
pub struct Ggx(pub Widths);

impl Distribution for Ggx {
    const FACETS: Facets = Facets::Ggx;

    #[inline(always)]
    fn new(widths: Widths) -> Self {
        Ggx(widths)
    }

    #[inline(always)]
    fn widths(&self) -> Widths {
        self.0
    }

    /// Source: Trowbridge and Reitz 1975; Burley 2012. Domain: unit m, widths > 0. Gives: 1/sr, 0 below the horizon.
    /// Degenerate cases: none; the form in slopes keeps its digits near the normal.
    #[inline(always)]
    fn d(&self, m: Vec3) -> f32 {
        let w = self.0;
        let (x, y) = (m.x / w.x, m.y / w.y);
        let e = (x * x + y * y + m.z * m.z).max(1e-15);
        let d = 1.0 / (PI * w.x * w.y * e * e);
        if m.z > 0.0 { d } else { 0.0 }
    }

    /// Source: Heitz 2014, eq. 72 and 86. Domain: any direction, its side is ignored. Gives: >= 0.
    #[inline(always)]
    fn lambda(&self, v: Vec3) -> f32 {
        let (x, y) = (self.0.x * v.x, self.0.y * v.y);
        let t2 = (x * x + y * y) / (v.z * v.z).max(1e-30);
        // (sqrt(1 + t²) - 1) / 2 loses digits at small t², this form does not.
        0.5 * t2 / ((1.0 + t2).sqrt() + 1.0)
    }

    /// Source: Walter et al. 2007, eq. 35, stretched to two widths (Burley 2012, eq. 14).
    #[inline(always)]
    fn sample_normal(&self, u: f32, v: f32) -> Vec3 {
        normal_of_slope(self.0, u / (1.0 - u).max(1e-8), turn(v))
    }
}

/// A visible micronormal of GGX.
///
/// Source: Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3 and 4.
/// Domain: wo.z >= 0, numbers in [0, 1). Gives: unit m, m.z >= 0, density G1(wo) max(0, wo . m) D(m) / wo.z.
/// Degenerate cases: grazing wo is fine, the cap is then a hemisphere.
#[inline(always)]
pub fn sample_visible(wo: Vec3, w: Widths, u: f32, v: f32) -> Vec3 {
    visible_normal(wo, w, u, turn(v))
}

/// [`sample_visible`] with the azimuth's cosine and sine for the second number.
#[inline(always)]
pub fn visible_normal(wo: Vec3, w: Widths, u: f32, (cos, sin): (f32, f32)) -> Vec3 {
    let stretched = Vec3::new(wo.x * w.x, wo.y * w.y, wo.z);
    let view = stretched * (1.0 / stretched.dot(stretched).max(1e-30).sqrt());
    let z = (1.0 - u) * (1.0 + view.z) - view.z;
    let s = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let h = Vec3::new(s * cos + view.x, s * sin + view.y, z + view.z);
    let m = Vec3::new(h.x * w.x, h.y * w.y, h.z.max(0.0));
    m * (1.0 / m.dot(m).max(1e-30).sqrt())
}
