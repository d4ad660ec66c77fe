//! Schlick's approximation with free reflectances at both ends, as the generalized Schlick closure has it.

use super::{Ends, Fresnel, Params, limited};
use crate::bsdf::power::power;
use crate::bsdf::select;
use glam::Vec3;

/// The index of refraction (inside over outside, >= 1) of a dielectric that reflects this part at normal incidence.
///
/// Source: Fresnel, f0 = ((eta - 1) / (eta + 1))². Domain: all, limited to 2.5e-5..0.996. Gives: 1.01..999.
/// Departs from source: it never is 1, because Schlick's term reflects even where f0 is 0, and light that goes straight on
/// through a rough surface would not know how much its facets reflect.
#[inline(always)]
pub fn eta_of_reflectance(f0: f32) -> f32 {
    let r = limited(f0, 2.5e-5, 0.996).sqrt();
    (1.0 + r) / (1.0 - r)
}

/// Reflectance from `f0` at normal to `f90` at grazing incidence: f0 + (f90 - f0) (1 - cos)^exponent.
///
/// Source: Schlick 1994, eq. 15, with the free ends and exponent of MaterialX's generalized_schlick_bsdf.
/// Parameters: f0 (3), f90 (3), exponent, and a side: 1 for an opaque surface, otherwise 2 for light from
/// outside or its inverse 0.5 for light from inside. Domain: f0 and f90 are limited to 0..1, the exponent to 0..1000.
/// Gives: exactly f0 at cosine 1 and f90 at 0. Degenerate cases: exponent 0 is f90 everywhere.
/// Departs from source: from inside, the cosine is that of the direction outside, and total reflection gives f90; so both
/// sides of a facet pass the same part of the light, as a boundary must. The index is that of the mean f0.
#[derive(Clone, Copy, Debug)]
pub struct Schlick {
    f0: Vec3,
    f90: Vec3,
    exponent: f32,
    eta: f32,
    inside: bool,
}

impl Fresnel for Schlick {
    const PARAMS: usize = 8;
    const COLORED: bool = true;

    #[inline(always)]
    fn prepare(p: Params, from: usize) -> Self {
        let at = |i: usize| limited(p[from + i], 0.0, 1.0);
        let (f0, f90) = (Vec3::new(at(0), at(1), at(2)), Vec3::new(at(3), at(4), at(5)));
        let inside = p[from + 7] < 1.0;
        let eta = eta_of_reflectance((f0.x + f0.y + f0.z) * (1.0 / 3.0));
        let exponent = limited(p[from + 6], 0.0, 1000.0);
        Schlick { f0, f90, exponent, eta: select(inside, 1.0 / eta, eta), inside }
    }

    #[inline(always)]
    fn eta(&self) -> f32 {
        self.eta
    }

    #[inline(always)]
    fn ends(&self) -> Option<Ends> {
        let mean = |color: Vec3| color.element_sum() * (1.0 / 3.0);
        Some(Ends { f0: mean(self.f0), f90: mean(self.f90), exponent: self.exponent })
    }

    #[inline(always)]
    fn color(&self, cos: f32) -> Vec3 {
        let c = cos.abs().min(1.0);
        let inverse = 1.0 / self.eta;
        let outside = (1.0 - inverse * inverse * (1.0 - c) * (1.0 + c)).max(0.0).sqrt();
        let x = 1.0 - select(self.inside, outside.min(1.0), c);
        let rise = power(x.max(1e-37), self.exponent);
        let rise = select(x > 0.0 || self.exponent == 0.0, rise, 0.0);
        self.f0 * (1.0 - rise) + self.f90 * rise
    }
}
