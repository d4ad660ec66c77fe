//! Lafortune's generalised cosine lobe, which may lie off the mirror direction, reflect back, or stretch.

use super::cosine_power::{CosinePower, CosinePowerAlbedo, log2_one_minus};
use super::power::exp2;
use super::{Eval, Params, Scatter, Spread, View, above_horizon, limited, select};
use glam::Vec3;
use std::f32::consts::TAU;

/// `lafortune(N, U, coefficients, exponent)`: one lobe; several are the sum of several closures.
///
/// Source: Lafortune, Foo, Torrance and Greenberg 1997, "Non-Linear Approximation of Reflectance Functions", eq. 7, with
/// the factor (n + 2) / (2 pi) of Phong: f = (n + 2) / (2 pi) max(0, Cx ox ix + Cy oy iy + Cz oz iz)^n.
/// (-1, -1, 1) is Phong's lobe, (1, 1, 1) reflects back.
/// Domain: any coefficients, exponent 0..1e6. Gives: f in 1/sr, reciprocal, albedo at most 1.
/// Degenerate cases: coefficients that are all zero scatter nothing.
/// Departs from source: the coefficients are divided by the largest of their magnitudes, so that a lobe never gains
/// energy; in the source their size is the strength of the lobe, here the weight of the closure is.
/// Albedo: its mean over the azimuth by two nodes, exact to 5e-5 where |Cx| = |Cy|, within 0.015 elsewhere (0.3, 1, 0.8 and
/// exponent 20).
#[derive(Clone, Copy, Debug)]
pub struct Lafortune {
    c: Vec3,
    lobe: CosinePower,
    albedo: CosinePowerAlbedo,
}

/// The direction that a viewer's lobe points along, and the lobe's height.
struct Axis {
    direction: Vec3,
    height: f32,
}

impl Lafortune {
    #[inline(always)]
    fn axis(&self, wo: Vec3) -> Axis {
        let moved = self.c * wo;
        let length2 = moved.dot(moved);
        let there = length2 > 1e-20;
        let direction = moved * (1.0 / length2.max(1e-20).sqrt());
        // 1 - |C wo|², exactly 0 for Phong's coefficients: a power of 1e6 would show every rounding.
        let lost = (1.0 - self.c.x * self.c.x) * wo.x * wo.x
            + (1.0 - self.c.y * self.c.y) * wo.y * wo.y
            + (1.0 - self.c.z * self.c.z) * wo.z * wo.z;
        let direction = Vec3::new(
            select(there, direction.x, 0.0),
            select(there, direction.y, 0.0),
            select(there, direction.z, 1.0),
        );
        Axis { direction, height: select(there, self.height(lost), 0.0) }
    }

    /// |C wo|^n from 1 - |C wo|².
    #[inline(always)]
    fn height(&self, lost: f32) -> f32 {
        exp2(0.5 * self.lobe.n * log2_one_minus(limited(lost, 0.0, 1.0)))
    }

    /// The albedo of a viewer at a cosine whose azimuth has this squared cosine.
    #[inline(always)]
    fn albedo_at(&self, cos: f32, azimuth: f32) -> f32 {
        let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        let wo = Vec3::new(sin * azimuth.sqrt(), sin * (1.0 - azimuth).sqrt(), cos);
        let axis = self.axis(wo);
        axis.height * self.albedo.at(axis.direction.z)
    }
}

impl Scatter for Lafortune {
    const PARAMS: usize = 4;
    const SPREAD: Spread = Spread::Narrow;
    const VIEW: usize = 4;

    #[inline(always)]
    fn prepare([x, y, z, exponent, ..]: Params) -> Self {
        let finite = |v: f32| limited(v, -1e18, 1e18);
        let c = Vec3::new(finite(x), finite(y), finite(z));
        let c = c * (1.0 / c.x.abs().max(c.y.abs()).max(c.z.abs()).max(1e-18));
        let lobe = CosinePower::new(exponent);
        Lafortune { c, lobe, albedo: CosinePowerAlbedo::new(lobe) }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let Axis { direction, height } = self.axis(wo);
        [direction.x, direction.y, direction.z, height, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, [x, y, z, height, _]: View, wi: Vec3) -> Eval {
        let value = select(wi.z > 0.0, self.lobe.value(Vec3::new(x, y, z), wi), 0.0);
        Eval { f_cos: (self.lobe.n + 2.0) / TAU * height * value * wi.z.max(0.0), pdf: self.lobe.pdf(value) }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, [x, y, z, ..]: View, xi: Vec3) -> Vec3 {
        above_horizon(self.lobe.sample(Vec3::new(x, y, z), xi.x, xi.y))
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        // The two nodes of Gauss's rule for means over the azimuth.
        0.5 * (self.albedo_at(cos, 0.853_553_4) + self.albedo_at(cos, 0.146_446_6))
    }
}
