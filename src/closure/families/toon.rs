//! Toon shading: light from a cone of directions, even inside, with an edge that is sharp or soft.

use super::usual::NORMAL;
use crate::arguments;
use crate::bsdf::{Eval, Params, Scatter, Spread, View, above_horizon, limited, select};
use crate::closure::arguments::{Float, Normal};
use crate::closure::definition::ClosureDef;
use crate::closure::lobe_kind::LobeKind;
use crate::lang::closures::{Claim, ParamSpec, Waiver};
use crate::math::elementary::{atan2, sincos};
use crate::math::frame::Frame;
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// The least angle of a cone, radians.
const LEAST: f32 = 1e-3;

/// A cone of directions: 1 up to an angle, falling to 0 over another, never beyond a right angle.
///
/// Source: Cycles (Blender), toon shaders: intensity 1 below size pi / 2, from there linear in the angle to 0 over
/// smooth pi / 2; f cos is the intensity times the density that spreads directions evenly over the cone's solid angle.
/// Parameters: size and smooth, each 0..1. Gives: at most one unit of light back, all of it where the edge is sharp.
/// Departs from source: a cone narrower than 1e-3 is that wide, as a narrower one would be seen in no pixel.
#[derive(Clone, Copy, Debug)]
struct Cone {
    /// Where the intensity begins to fall.
    inner: f32,
    /// Over which angle it falls.
    fall: f32,
    /// Where the cone ends.
    outer: f32,
    /// 1 - cos(outer).
    height: f32,
}

impl Cone {
    #[inline(always)]
    fn new(size: f32, smooth: f32) -> Self {
        let inner = limited(size * FRAC_PI_2, LEAST, FRAC_PI_2);
        // Above an edge of no angle lies nothing that could be divided by it.
        let fall = limited(smooth * FRAC_PI_2, 1e-6, FRAC_PI_2);
        let outer = (inner + fall).min(FRAC_PI_2);
        // The difference from 1 has no digits in a narrow cone, the square has.
        let (sin, _) = sincos(0.5 * outer);
        Cone { inner, fall, outer, height: 2.0 * sin * sin }
    }

    /// f cos and density at a direction of which the part across the cone's axis and that along it are given.
    #[inline(always)]
    fn eval(&self, across: Vec3, along: f32) -> Eval {
        let angle = atan2(across.dot(across).sqrt(), along);
        let intensity = ((self.inner + self.fall - angle) / self.fall).clamp(0.0, 1.0);
        let pdf = select(angle < self.outer && along > 0.0, 1.0 / (TAU * self.height), 0.0);
        Eval { f_cos: intensity * pdf, pdf }
    }

    /// A direction of the cone, evenly over its solid angle.
    #[inline(always)]
    fn sample(&self, u: f32, v: f32) -> Vec3 {
        let below = u * self.height;
        let r = (below * (2.0 - below)).max(0.0).sqrt();
        let (cos, sin) = turn(v);
        Vec3::new(r * cos, r * sin, 1.0 - below)
    }

    /// The mean intensity over the cone.
    ///
    /// Source: own integration: t + ((b - sin b) - (a - sin a)) / (fall (1 - cos b)) with the angles a and b where the fall
    /// begins and where the cone ends, and the intensity t that is left there.
    #[inline(always)]
    fn mean(&self) -> f32 {
        let left = 1.0 - (self.outer - self.inner) / self.fall;
        let mean = left + (beyond_sine(self.outer) - beyond_sine(self.inner)) / (self.fall * self.height);
        limited(select(self.fall < 1e-3 * self.outer, 1.0, mean), 0.0, 1.0)
    }
}

/// x - sin x for x in 0..pi/2, by its series where the difference would lose its digits.
#[inline(always)]
fn beyond_sine(x: f32) -> f32 {
    let (x2, (sin, _)) = (x * x, sincos(x));
    let series =
        x * x2 * (1.0 / 6.0) * (1.0 - x2 * (1.0 / 20.0) * (1.0 - x2 * (1.0 / 42.0) * (1.0 - x2 * (1.0 / 72.0))));
    select(x < 0.5, series, x - sin)
}

/// A cone about the normal.
#[derive(Clone, Copy, Debug)]
struct DiffuseToon {
    cone: Cone,
    albedo: f32,
}

impl Scatter for DiffuseToon {
    const PARAMS: usize = 2;
    const SPREAD: Spread = Spread::Broad;

    #[inline(always)]
    fn prepare([size, smooth, ..]: Params) -> Self {
        let cone = Cone::new(size, smooth);
        DiffuseToon { cone, albedo: cone.mean() }
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, _view: View, wi: Vec3) -> Eval {
        self.cone.eval(Vec3::new(wi.x, wi.y, 0.0), wi.z)
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        self.cone.sample(xi.x, xi.y)
    }

    /// Exact, and the same toward every viewer.
    #[inline(always)]
    fn albedo(&self, _cos: f32) -> f32 {
        self.albedo
    }
}

/// A cone about the mirror direction, cut off at the horizon.
#[derive(Clone, Copy, Debug)]
struct GlossyToon {
    cone: Cone,
    albedo: f32,
}

impl Scatter for GlossyToon {
    const PARAMS: usize = 2;
    const SPREAD: Spread = Spread::Narrow;

    #[inline(always)]
    fn prepare([size, smooth, ..]: Params) -> Self {
        let cone = Cone::new(size, smooth);
        GlossyToon { cone, albedo: cone.mean() }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let Eval { f_cos, pdf } = self.cone.eval(mirror.cross(wi), mirror.dot(wi));
        let lit = wi.z > 0.0;
        Eval { f_cos: select(lit, f_cos, 0.0), pdf: select(lit, pdf, 0.0) }
    }

    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let about = Frame::from_normal(Vec3::new(-wo.x, -wo.y, wo.z));
        above_horizon(about.to_world(self.cone.sample(xi.x, xi.y)))
    }

    /// At most so much: what the horizon cuts off is not taken away.
    #[inline(always)]
    fn albedo(&self, _cos: f32) -> f32 {
        self.albedo
    }
}

arguments! {
    struct Toon {
        N: Normal = NORMAL,
        size: Float = ParamSpec::about("angle that is lit evenly, over a right angle, 0..1").tried(&[0.5, 0.1, 0.9]),
        smooth: Float = ParamSpec::about("angle over which the light fades at the edge, over a right angle, 0..1")
            .tried(&[0.2, 0.0, 0.6, 1.0]),
    }
}

const TOON_WAIVERS: &[Waiver] = &[Waiver {
    claim: Claim::Reciprocity,
    only: None,
    why: "the angle of the light alone says whether it is in the cone",
}];

pub(super) fn diffuse_toon() -> ClosureDef {
    let doc = "light of a cone about the normal, with a sharp or soft edge (Cycles)";
    ClosureDef::new("diffuse_toon", doc, |a: Toon, leaf| {
        let frame = leaf.frame(a.N, None);
        leaf.lobe(LobeKind::of::<DiffuseToon>(), frame, &[a.size.0, a.smooth.0]);
    })
    .without(TOON_WAIVERS)
}

pub(super) fn glossy_toon() -> ClosureDef {
    let doc = "light of a cone about the mirror direction, with a sharp or soft edge (Cycles)";
    ClosureDef::new("glossy_toon", doc, |a: Toon, leaf| {
        let frame = leaf.frame(a.N, None);
        leaf.lobe(LobeKind::of::<GlossyToon>(), frame, &[a.size.0, a.smooth.0]);
    })
    .without(TOON_WAIVERS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::gauss_legendre;

    /// The mean intensity by quadrature over the angle, with the corners between pieces.
    fn mean(cone: &Cone) -> f64 {
        let corners = [0.0, cone.inner, cone.outer];
        let mut sum = 0.0;
        for pair in corners.windows(2) {
            for node in gauss_legendre(32, f64::from(pair[0]), f64::from(pair[1])) {
                let w = Vec3::new(node.x.sin() as f32, 0.0, node.x.cos() as f32);
                sum += node.weight * node.x.sin() * f64::from(cone.eval(Vec3::new(w.x, 0.0, 0.0), w.z).f_cos);
            }
        }
        sum * std::f64::consts::TAU
    }

    #[test]
    fn the_stated_albedo_is_what_quadrature_gives() {
        for size in [0.0, 0.01, 0.3, 0.8, 1.0] {
            for smooth in [0.0, 0.01, 0.2, 0.7, 1.0] {
                let cone = Cone::new(size, smooth);
                let (stated, expected) = (f64::from(cone.mean()), mean(&cone));
                assert!((stated - expected).abs() < 2e-3, "{size} {smooth}: {stated}, {expected}");
            }
        }
        assert_eq!(Cone::new(0.5, 0.0).mean(), 1.0);
    }

    #[test]
    fn intensity_falls_in_a_line_over_the_edge() {
        let cone = Cone::new(0.4, 0.2);
        let full = cone.eval(Vec3::ZERO, 1.0).f_cos;
        for (angle, part) in [(0.39, 1.0), (0.45, 0.75), (0.5, 0.5), (0.59, 0.05), (0.61, 0.0)] {
            let (sin, cos) = (angle * FRAC_PI_2).sin_cos();
            let value = cone.eval(Vec3::new(0.0, sin, 0.0), cos).f_cos;
            assert!((value / full - part).abs() < 1e-4, "{angle}: {}", value / full);
        }
    }
}
