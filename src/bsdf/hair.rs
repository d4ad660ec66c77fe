//! Hair and fur: a dielectric cylinder with tilted scales and colored inside, one lobe for each number of inner crossings.

use super::fresnel::dielectric;
use super::power::exp;
use super::{Eval, Params, Scatter, Side, Spread, View, limited, select};
use crate::math::elementary::{asin, atan2, ln, sincos};
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The least variance and the least width.
pub const MIN_ROUGHNESS: f32 = 1e-3;

/// One lobe of `chiang_hair_bsdf`: P = 0 reflects (R), 1 passes (TT), 2 is reflected once inside (TRT), 3 all longer paths.
///
/// Source: Chiang, Bitterli, Tappan and Burley 2016, "A Practical and Controllable Hair and Fur Model for Production Path
/// Tracing", eq. 1 to 8, with the parameters as MaterialX states them. The local x axis runs along the fiber, and where the
/// viewer's projection across the fiber meets the normal says how far from its middle the fiber is seen.
/// Gives: f |cos_i| = Ap Mp Np, 1/sr; the density is Mp Np, so that each weight is Ap.
/// Domain: ior 1.001..10; longitudinal roughness (the variance v of Mp) and azimuthal roughness (the width of the logistic
/// Np, before its factor sqrt(pi / 8)) 1e-3..1; cuticle angle 0..1 for a tilt of -90..90 degrees, 0.5 is none; absorption >= 0
/// per radius of the fiber; all limited to it.
/// Degenerate cases: a viewer or light along the fiber has the azimuth 0.
/// Energy: without absorption and with white tints the four lobes sum to 1. Not reciprocal: the viewer alone says
/// where the fiber is met.
/// Albedo: exact without absorption; with it for a viewer across the fiber, whose path inside is the shortest.
#[derive(Clone, Copy, Debug)]
pub struct Hair<const P: u32> {
    ior: f32,
    inverse_v: f32,
    v: f32,
    /// exp(-2 / v)
    far: f32,
    /// Width of the logistic.
    s: f32,
    /// The logistic's distribution function at -pi.
    cut: f32,
    tilt: (f32, f32),
    absorption: Vec3,
    tint: Vec3,
}

/// exp(-x) I0(x), the modified Bessel function of order 0.
///
/// Source: Abramowitz and Stegun 9.8.1 and 9.8.2. Domain: x >= 0. Gives: 0..1, relative error below 6e-7.
#[inline(always)]
pub fn scaled_bessel(x: f32) -> f32 {
    let t = (x / 3.75).min(1.0);
    let t = t * t;
    let near = 1.0
        + t * (3.515_622_9
            + t * (3.089_942_5 + t * (1.206_749_2 + t * (0.265_973_2 + t * (0.036_076_8 + t * 0.004_581_3)))));
    let t = 3.75 / x.max(3.75);
    let far = 0.398_942_3
        + t * (0.013_285_92
            + t * (0.002_253_19
                + t * (-0.001_575_65
                    + t * (0.009_162_81
                        + t * (-0.020_577_06 + t * (0.026_355_37 + t * (-0.016_476_33 + t * 0.003_923_77)))))));
    select(x < 3.75, near * exp(-x), far / x.max(3.75).sqrt())
}

/// An angle brought to -pi..pi.
#[inline(always)]
fn wrapped(angle: f32) -> f32 {
    /// 1.5 * 2^23: adding it rounds to a whole number.
    const ROUND: f32 = 12_582_912.0;
    let turns = (angle * (1.0 / TAU) + ROUND) - ROUND;
    angle - turns * TAU
}

impl<const P: u32> Hair<P> {
    /// Density of the sine of the light's inclination to the fiber, over its cosine.
    ///
    /// Source: d'Eon et al. 2011, eq. 7, in a form without overflow: the exponent is minus a squared chord.
    #[inline(always)]
    fn longitudinal(&self, sin_o: f32, cos_o: f32, sin_i: f32, cos_i: f32) -> f32 {
        let (x, y) = (cos_i - cos_o, sin_i + sin_o);
        let bessel = scaled_bessel(cos_i * cos_o * self.inverse_v);
        bessel * exp(-0.5 * (x * x + y * y) * self.inverse_v) * self.inverse_v / (1.0 - self.far)
    }

    /// Density of the angle from the lobe's middle.
    #[inline(always)]
    fn azimuthal(&self, angle: f32) -> f32 {
        if P > 2 {
            return 1.0 / TAU;
        }
        let e = exp(-wrapped(angle).abs() / self.s);
        e / (self.s * (1.0 + e) * (1.0 + e) * (1.0 - 2.0 * self.cut))
    }

    /// What one lobe attenuates light by, from Fresnel's part and the path inside.
    #[inline(always)]
    fn attenuation(&self, fresnel: f32, path: f32) -> Vec3 {
        let one = |absorption: f32, tint: f32| {
            let inside = exp(-absorption * path);
            let through = (1.0 - fresnel) * (1.0 - fresnel) * inside;
            tint * match P {
                0 => fresnel,
                1 => through,
                2 => through * inside * fresnel,
                _ => through * inside * fresnel * inside * fresnel / (1.0 - inside * fresnel).max(1e-6),
            }
        };
        Vec3::new(
            one(self.absorption.x, self.tint.x),
            one(self.absorption.y, self.tint.y),
            one(self.absorption.z, self.tint.z),
        )
    }

    /// The angle of refraction in the fiber's cross section, and the length of one crossing in radii.
    #[inline(always)]
    fn inside(&self, sin_o: f32, cos_o: f32, gamma: f32) -> (f32, f32) {
        let bent = (self.ior * self.ior - sin_o * sin_o).max(0.0).sqrt() / cos_o.max(1e-12);
        let sin_t = limited(gamma / bent, -1.0, 1.0);
        let cos_t = ((1.0 - sin_t) * (1.0 + sin_t)).sqrt();
        let sin_theta = sin_o / self.ior;
        (asin(sin_t), 2.0 * cos_t / ((1.0 - sin_theta) * (1.0 + sin_theta)).max(1e-6).sqrt())
    }
}

impl<const P: u32> Scatter for Hair<P> {
    const PARAMS: usize = 10;
    const SPREAD: Spread = Spread::Narrow;
    const SIDE: Side = Side::Both;
    const COLORED: bool = true;
    const VIEW: usize = 5;

    #[inline(always)]
    fn prepare([ior, v, s, cuticle, ar, ag, ab, tr, tg, tb, ..]: Params) -> Self {
        let positive = |x, y, z| Vec3::new(limited(x, 0.0, 1e6), limited(y, 0.0, 1e6), limited(z, 0.0, 1e6));
        let v = limited(v, MIN_ROUGHNESS, 1.0);
        let s = limited(s, MIN_ROUGHNESS, 1.0) * 0.626_657_1;
        // Each crossing of the scales tilts the lobe on: by 2, -1 and -4 times their angle; long paths forget it.
        let times = match P {
            0 => 2.0,
            1 => -1.0,
            2 => -4.0,
            _ => 0.0,
        };
        let e = exp(-PI / s);
        Hair {
            ior: limited(ior, 1.001, 10.0),
            inverse_v: 1.0 / v,
            v,
            far: exp(-2.0 / v),
            s,
            cut: e / (1.0 + e),
            tilt: sincos(times * PI * (limited(cuticle, 0.0, 1.0) - 0.5)),
            absorption: positive(ar, ag, ab),
            tint: positive(tr, tg, tb),
        }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let sin_o = limited(wo.x, -1.0, 1.0);
        let across = (wo.y * wo.y + wo.z * wo.z).sqrt();
        let gamma = wo.y / across.max(1e-20);
        let (gamma_t, path) = self.inside(sin_o, across, gamma);
        let fresnel = dielectric(wo.z, self.ior);
        // The viewer's azimuth, turned to where light leaves that crosses the fiber P times.
        let middle = 2.0 * P as f32 * gamma_t - atan2(wo.y, wo.z) + P as f32 * PI;
        let (tilt_sin, tilt_cos) = self.tilt;
        let (sin, cos) = (sin_o * tilt_cos + across * tilt_sin, (across * tilt_cos - sin_o * tilt_sin).abs());
        [sin, cos, middle, fresnel, path]
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, [sin_o, cos_o, middle, ..]: View, wi: Vec3) -> Eval {
        let cos_i = (wi.y * wi.y + wi.z * wi.z).sqrt();
        let m = self.longitudinal(sin_o, cos_o, wi.x, cos_i);
        let pdf = m * self.azimuthal(atan2(wi.y, wi.z) - middle);
        // Of no direction at all nothing is scattered.
        let there = wi.dot(wi) > 0.5;
        let pdf = select(there, pdf, 0.0);
        Eval { f_cos: pdf, pdf }
    }

    #[inline(always)]
    fn color_from(&self, _wo: Vec3, [_, _, _, fresnel, path]: View, _wi: Vec3) -> Vec3 {
        self.attenuation(fresnel, path)
    }

    /// Source: d'Eon, Marschner and Hanika 2013 along the fiber; inversion of the logistic around it.
    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, [sin_o, cos_o, middle, ..]: View, xi: Vec3) -> Vec3 {
        let less = limited(-self.v * ln((xi.x + (1.0 - xi.x) * self.far).max(f32::MIN_POSITIVE)), 0.0, 2.0);
        let (around, _) = turn(xi.y);
        let sin_i = limited((less - 1.0) * sin_o + (less * (2.0 - less)).sqrt() * around * cos_o, -1.0, 1.0);
        let cos_i = ((1.0 - sin_i) * (1.0 + sin_i)).sqrt();
        let u = self.cut + xi.z * (1.0 - 2.0 * self.cut);
        let offset = if P > 2 { TAU * xi.z - PI } else { limited(self.s * (ln(u) - ln(1.0 - u)), -PI, PI) };
        let (sin_phi, cos_phi) = sincos(middle + offset);
        Vec3::new(sin_i, cos_i * sin_phi, cos_i * cos_phi)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let c = cos.clamp(0.0, 1.0);
        let (_, path) = self.inside(0.0, 1.0, ((1.0 - c) * (1.0 + c)).sqrt());
        self.attenuation(dielectric(c, self.ior), path).max_element().min(1.0)
    }
}
