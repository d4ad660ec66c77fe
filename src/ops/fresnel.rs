//! Reflection and refraction in the conventions of the language: `i` points to the surface, `eta` is outside over inside.

use glam::Vec3;

/// What [`fresnel`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// Reflected part of the power, in [0, 1].
    pub reflectance: f32,
    /// Transmitted part times eta^2, as OSL scales radiance.
    pub transmittance: f32,
    /// The mirror direction.
    pub reflected: Vec3,
    /// The refracted direction, zero on total reflection.
    pub refracted: Vec3,
}

/// The mirror direction of `i`: i - 2 (n.i) n.
#[inline(always)]
pub fn reflect(i: Vec3, n: Vec3) -> Vec3 {
    i - 2.0 * n.dot(i) * n
}

/// The refracted direction of `i` by Snell's law, zero on total reflection.
#[inline(always)]
pub fn refract(i: Vec3, n: Vec3, eta: f32) -> Vec3 {
    let c = i.dot(n);
    let cos2 = 1.0 - eta * eta * (1.0 - c * c);
    let root = cos2.sqrt();
    let direction = eta * i - n * (eta * c + root);
    if cos2 >= 0.0 { direction } else { Vec3::ZERO }
}

/// The reflectance of a smooth dielectric for unpolarised light.
///
/// Source: Cook and Torrance 1982, equation 9. Domain: `c` the cosine in [0, 1], `eta` > 0 outside over inside.
/// Gives: [0, 1]. Degenerate cases: 1 on total reflection, 1 for eta = 0.
#[inline(always)]
pub fn dielectric(c: f32, eta: f32) -> f32 {
    let g2 = 1.0 / (eta * eta) - 1.0 + c * c;
    let g = g2.sqrt();
    let a = (g - c) / (g + c);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    let reflectance = 0.5 * a * a * (1.0 + b * b);
    // At grazing incidence with eta = 1 both quotients are 0/0; everything is reflected there.
    if (g2 >= 0.0) & (reflectance <= 1.0) { reflectance } else { 1.0 }
}

/// The builtin of the same name.
#[inline(always)]
pub fn fresnel(i: Vec3, n: Vec3, eta: f32) -> Fresnel {
    let c = i.dot(n).abs();
    let total = 1.0 / (eta * eta) - 1.0 + c * c < 0.0;
    let reflectance = dielectric(c, eta);
    Fresnel {
        reflectance,
        transmittance: if total { 0.0 } else { (1.0 - reflectance) * eta * eta },
        reflected: reflect(i, n),
        refracted: if total { Vec3::ZERO } else { refract(i, n, eta) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_has_the_known_reflectance() {
        let f = fresnel(-Vec3::Z, Vec3::Z, 1.0 / 1.5);
        assert!((f.reflectance - 0.04).abs() < 1e-6);
        assert!((f.transmittance - 0.96 / 2.25).abs() < 1e-6);
        assert_eq!(f.reflected, Vec3::Z);
        assert!((f.refracted + Vec3::Z).length() < 1e-6);
    }

    #[test]
    fn reflectance_is_the_mean_of_both_polarisations() {
        for k in 1..100 {
            let c = k as f32 / 100.0;
            let n = 1.33f32;
            let ct = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
            let (s, p) = ((c - n * ct) / (c + n * ct), (n * c - ct) / (n * c + ct));
            assert!((dielectric(c, 1.0 / n) - 0.5 * (s * s + p * p)).abs() < 2e-6);
        }
    }

    #[test]
    fn total_reflection_refracts_nothing() {
        let i = Vec3::new(0.9, 0.0, -0.4359);
        let f = fresnel(i, Vec3::Z, 1.5);
        assert_eq!((f.reflectance, f.transmittance, f.refracted), (1.0, 0.0, Vec3::ZERO));
        assert_eq!(refract(i, Vec3::Z, 1.5), Vec3::ZERO);
    }
}
