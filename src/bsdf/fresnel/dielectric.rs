//! Fresnel reflection of dielectrics, and the refracted direction.

use super::{Fresnel, Params};
use glam::Vec3;

/// Reflected part of unpolarised light at a dielectric boundary.
///
/// Source: Fresnel; the form in `g` is Cook and Torrance 1982, eq. 16.
/// Domain: cosine of the angle of incidence, its sign is ignored; `eta` = transmitted over incident.
/// Gives: 0..1. Degenerate cases: `eta <= 0` is a full mirror (1), total internal reflection gives 1.
/// Departs from source: no.
#[inline(always)]
pub fn dielectric(cos: f32, eta: f32) -> f32 {
    let c = cos.abs().min(1.0);
    let g2 = eta * eta - 1.0 + c * c;
    let g = g2.max(0.0).sqrt();
    // g + c is zero only when both are, and then the light is totally reflected.
    let a = (g - c) / (g + c).max(f32::MIN_POSITIVE);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0).max(f32::MIN_POSITIVE);
    let f = (0.5 * a * a * (1.0 + b * b)).min(1.0);
    if g2 > 0.0 && eta > 0.0 { f } else { 1.0 }
}

/// A dielectric. Parameter: eta, transmitted over incident; 0 and less reflects all.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    eta: f32,
}

impl Dielectric {
    /// The dielectric of an index, transmitted over incident.
    #[inline(always)]
    pub fn of(eta: f32) -> Self {
        Dielectric { eta: eta.min(1e3) }
    }
}

impl Fresnel for Dielectric {
    const PARAMS: usize = 1;
    const COLORED: bool = false;

    #[inline(always)]
    fn prepare(p: Params, from: usize) -> Self {
        Dielectric::of(p[from])
    }

    #[inline(always)]
    fn eta(&self) -> f32 {
        self.eta
    }

    #[inline(always)]
    fn color(&self, cos: f32) -> Vec3 {
        Vec3::splat(self.largest(cos))
    }

    #[inline(always)]
    fn largest(&self, cos: f32) -> f32 {
        dielectric(cos, self.eta)
    }

    #[inline(always)]
    fn mean(&self, cos: f32) -> f32 {
        self.largest(cos)
    }

    #[inline(always)]
    fn passed(&self, cos: f32) -> f32 {
        1.0 - dielectric(cos, self.eta)
    }
}

/// The direction of light refracted at a facet.
///
/// Source: Snell. Domain: unit `wo`, unit `m` with `wo . m > 0`, `eta` = transmitted over incident, > 0.
/// Gives: unit direction on the other side of the facet. Degenerate cases: total internal reflection gives zero.
#[inline(always)]
pub fn refracted(wo: Vec3, m: Vec3, eta: f32) -> Vec3 {
    let cos_o = wo.dot(m);
    let inverse = 1.0 / eta.max(1e-6);
    let cos_t2 = 1.0 - inverse * inverse * (1.0 - cos_o * cos_o).max(0.0);
    let wi = m * (inverse * cos_o - cos_t2.max(0.0).sqrt()) - wo * inverse;
    // From a dense medium the difference of two long vectors is left, whose rounding errors are as long.
    let unit = 1.0 / wi.dot(wi).max(1e-12).sqrt();
    let keep = if cos_t2 > 0.0 && eta > 0.0 { unit } else { 0.0 };
    wi * keep
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_reflectances() {
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-7);
        assert!((dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-7);
        assert_eq!(dielectric(0.0, 1.5), 1.0);
        assert_eq!(dielectric(0.3, 0.0), 1.0);
        assert_eq!(dielectric(0.3, 1.0 / 1.5), 1.0, "total internal reflection");
        assert!(dielectric(0.5, 1.0) < 1e-12);
        // Brewster's angle reflects no p-polarised light: half of the s-polarised part is left.
        let brewster = (1.0f32 / (1.0 + 1.5 * 1.5)).sqrt();
        let s = ((1.5f32 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0)).powi(2);
        assert!((dielectric(brewster, 1.5) - 0.5 * s).abs() < 1e-6);
    }

    #[test]
    fn refraction_obeys_snell_and_reverses() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let wi = refracted(wo, Vec3::Z, 1.5);
        assert!((wi.x + 0.4).abs() < 1e-6 && (wi.length() - 1.0).abs() < 1e-6 && wi.z < 0.0);
        let back = refracted(wi, -Vec3::Z, 1.0 / 1.5);
        assert!((back - wo).length() < 1e-6);
        assert_eq!(refracted(wo, Vec3::Z, 0.5), Vec3::ZERO);
    }
}
