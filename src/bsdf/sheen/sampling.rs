//! Directions for the sheen: a two-parameter linearly transformed cosine mixed with the uniform hemisphere; and, to compare
//! with it, the uniform hemisphere, the cosine and the half vector.
//!
//! Half-vector sampling does not pay here: most visible micronormals reflect below the horizon, and even perfect
//! visible-normal sampling has 7 times the variance of the uniform hemisphere at r = 0.25.
//!
//! Decision (2026-11-22): the linearly transformed cosine with 10 % uniform is the default, because its relative variance
//! (softened exact term, mean over cosines) is 0.39, 0.18, 0.07 at r = 0.06, 0.25, 1 instead of 2.44, 0.65, 0.25 of the
//! paper's uniform hemisphere, and because
//! the uniform part bounds the weights at 5.8 albedos (23 without it).

use super::fits::{ProposalFit, proposal_fit};
use super::term::Shadowing;
use crate::bsdf::power::exp;
use crate::bsdf::{Choice, select};
use crate::math::warp::{cosine_hemisphere, uniform_hemisphere, uniform_hemisphere_pdf};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use std::fmt;
use std::str::FromStr;

/// How sheen directions are sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SheenSampling {
    /// Linearly transformed cosine with 10 % of uniform samples. The default: 2 to 6 times less variance.
    #[default]
    Proposal,
    /// The uniform hemisphere, as the paper has it.
    Uniform,
    /// The cosine.
    Cosine,
    /// The half vector with density D cos, by the inverse of its distribution; most directions fall below the horizon.
    Normals,
}

impl SheenSampling {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, SheenSampling); 4] = [
        ("ltc", SheenSampling::Proposal),
        ("uniform", SheenSampling::Uniform),
        ("cosine", SheenSampling::Cosine),
        ("normals", SheenSampling::Normals),
    ];
}

impl From<SheenSampling> for Choice {
    fn from(scheme: SheenSampling) -> Self {
        Choice(scheme as u8)
    }
}

impl From<Choice> for SheenSampling {
    #[inline(always)]
    fn from(Choice(number): Choice) -> Self {
        match number {
            0 => SheenSampling::Proposal,
            1 => SheenSampling::Uniform,
            2 => SheenSampling::Cosine,
            _ => SheenSampling::Normals,
        }
    }
}

impl FromStr for SheenSampling {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        let unknown = || format!("unknown sampling \"{text}\"; choose \"ltc\", \"uniform\", \"cosine\" or \"normals\"");
        found.map(|&(_, scheme)| scheme).ok_or_else(unknown)
    }
}

impl fmt::Display for SheenSampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::ALL.iter().find(|(_, scheme)| scheme == self).map_or("", |(name, _)| name))
    }
}

/// The sampler of one sheen lobe.
///
/// Source: own fit; linearly transformed cosines are Heitz, Dupuy, Hill and Neubelt 2016. A cosine direction w stands for
/// the light direction v with w ~ (a v.x + b v.z, a v.y, v.z), in the frame whose x axis points along the viewer's
/// projection. Domain: roughness; below 0.06 the fit of 0.06 serves. Gives: a density that is positive on the hemisphere.
/// Constants: fitted on r 0.06..1. A viewer along the normal has no azimuth, and needs none because b is 0 there.
#[derive(Clone, Copy, Debug)]
pub struct Proposal {
    log_a: [f32; 3],
    b: [f32; 3],
    /// The share of uniform samples, 0..1.
    pub uniform_share: f32,
}

/// The coefficients of a polynomial in two variables, once the fast one is known.
#[inline(always)]
fn collapse(c: &[f32; 9], y: f32) -> [f32; 3] {
    [c[0] + y * (c[1] + y * c[2]), c[3] + y * (c[4] + y * c[5]), c[6] + y * (c[7] + y * c[8])]
}

/// What the view direction decides: the two parameters and the viewer's azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Azimuth {
    /// Width of the transformed cosine.
    pub a: f32,
    /// Its tilt toward the viewer.
    pub b: f32,
    /// Cosine of the viewer's azimuth.
    pub cos: f32,
    /// Sine of the viewer's azimuth.
    pub sin: f32,
}

impl Proposal {
    /// The sampler of a roughness, by default.
    #[inline(always)]
    pub fn new(term: Shadowing, soft: bool, r: f32) -> Self {
        let ProposalFit { log_a, b } = proposal_fit(term, soft);
        let y = r.max(0.06).sqrt();
        Proposal { log_a: collapse(log_a, y), b: collapse(b, y), uniform_share: 0.1 }
    }

    /// The same sampler by a scheme; the half vector has a model of its own.
    #[inline(always)]
    pub fn by(self, scheme: SheenSampling) -> Self {
        // Untransformed, the cosine is left. Numbers and no branches, for the lane loops.
        let (uniform_share, keep) = match scheme {
            SheenSampling::Proposal => (0.1, 1.0),
            SheenSampling::Uniform => (1.0, 1.0),
            SheenSampling::Cosine | SheenSampling::Normals => (0.0, 0.0),
        };
        let ([a0, a1, a2], [b0, b1, b2]) = (self.log_a, self.b);
        Proposal { log_a: [keep * a0, keep * a1, keep * a2], b: [keep * b0, keep * b1, keep * b2], uniform_share }
    }

    /// The parameters for a viewer.
    #[inline(always)]
    pub fn view(&self, wo: Vec3) -> Azimuth {
        let sin2 = wo.x * wo.x + wo.y * wo.y;
        let sin_o = sin2.sqrt().min(1.0);
        let inverse = select(sin2 > 1e-20, 1.0 / sin2.max(1e-20).sqrt(), 0.0);
        let quadratic = |c: &[f32; 3]| c[0] + sin_o * (c[1] + sin_o * c[2]);
        Azimuth {
            a: exp(quadratic(&self.log_a)),
            b: sin_o * quadratic(&self.b),
            cos: select(sin2 > 1e-20, wo.x * inverse, 1.0),
            sin: wo.y * inverse,
        }
    }

    /// Density of a direction, 1/sr; zero below the horizon.
    #[inline(always)]
    pub fn pdf(&self, view: Azimuth, wi: Vec3) -> f32 {
        let (x, y) = (wi.x * view.cos + wi.y * view.sin, wi.y * view.cos - wi.x * view.sin);
        let (wx, wy) = (view.a * x + view.b * wi.z, view.a * y);
        let length2 = (wx * wx + wy * wy + wi.z * wi.z).max(1e-12);
        let ratio = view.a / length2;
        let transformed = FRAC_1_PI * wi.z.max(0.0) * ratio * ratio;
        self.uniform_share * uniform_hemisphere_pdf(wi.z) + (1.0 - self.uniform_share) * transformed
    }

    /// A direction; the third number chooses between the two parts.
    #[inline(always)]
    pub fn sample(&self, view: Azimuth, xi: Vec3) -> Vec3 {
        let w = cosine_hemisphere(xi.x, xi.y);
        let flat = uniform_hemisphere(xi.x, xi.y);
        let uniform = xi.z < self.uniform_share;
        let (x, y) = ((w.x - view.b * w.z) / view.a, w.y / view.a);
        let (x, y) = (select(uniform, flat.x, x), select(uniform, flat.y, y));
        let z = select(uniform, flat.z, w.z);
        let scale = 1.0 / (x * x + y * y + z * z).max(1e-30).sqrt();
        // The uniform part has no preferred azimuth, so turning it to the viewer's does no harm.
        Vec3::new(x * view.cos - y * view.sin, y * view.cos + x * view.sin, z) * scale
    }
}
