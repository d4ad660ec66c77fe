//! A power of the cosine about an axis: the lobe of Phong and of Lafortune, with its sampling and its albedo.

use super::power::{exp2, log2};
use super::{limited, select};
use crate::math::elementary::{expm1, ln};
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::{LOG2_E, TAU};

/// The largest exponent; a lobe of it is 0.08 degrees wide.
pub const MAX_EXPONENT: f32 = 1e6;

/// log2(1 - u).
///
/// Domain: u below 1; from 1 on the value is that of the smallest positive number. Gives: relative error below 2e-7.
/// Departs from the plain form: what rounding takes from 1 - u is given back, without which an exponent of 1e6 errs by 6 %.
#[inline(always)]
pub fn log2_one_minus(u: f32) -> f32 {
    let x = 1.0 - u;
    log2(x.max(f32::MIN_POSITIVE)) + LOG2_E * ((1.0 - x) - u)
}

/// cos^n about an axis, cut off at a right angle from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosinePower {
    /// The exponent n, 0..[`MAX_EXPONENT`].
    pub n: f32,
}

impl CosinePower {
    /// The lobe of an exponent, which is limited to its domain; what is not a number counts as 0.
    #[inline(always)]
    pub fn new(n: f32) -> Self {
        CosinePower { n: limited(n, 0.0, MAX_EXPONENT) }
    }

    /// max(0, axis . w)^n of two unit vectors.
    ///
    /// Gives: 0..1, relative error below 1e-4 where it matters. Degenerate cases: from a right angle on 0, also with n = 0.
    /// The angle comes from the chord, which keeps its digits where the cosine is all but 1.
    #[inline(always)]
    pub fn value(&self, axis: Vec3, w: Vec3) -> f32 {
        let chord = axis - w;
        let u = 0.5 * chord.dot(chord);
        select(u < 1.0, exp2(self.n * log2_one_minus(u)), 0.0)
    }

    /// Density over the sphere of a value, 1/sr.
    #[inline(always)]
    pub fn pdf(&self, value: f32) -> f32 {
        (self.n + 1.0) / TAU * value
    }

    /// A direction about a unit axis, of density [`CosinePower::pdf`].
    ///
    /// Source: inversion, cos = u^(1/(n+1)), with 1 - cos by expm1, which keeps its digits in narrow lobes.
    #[inline(always)]
    pub fn sample(&self, axis: Vec3, u: f32, v: f32) -> Vec3 {
        // 1 - u is never zero.
        let less = -expm1(ln(1.0 - u) / (self.n + 1.0));
        let (cos_phi, sin_phi) = turn(v);
        let sin = (less * (2.0 - less)).max(0.0).sqrt();
        let frame = crate::math::frame::Frame::from_normal(axis);
        frame.to_world(Vec3::new(sin * cos_phi, sin * sin_phi, 1.0 - less))
    }
}

/// The albedo (n + 2) / (2 pi) times the integral of cos^n cos_i of an axis over the hemisphere of the normal.
///
/// Source: own derivation. With the parts of axis and normal exchanged it is the visible projected area c (1 + Lambda(c)) of
/// micronormals of Blinn's distribution of exponent n; Lambda by own fit.
/// Domain: n 0..1e6, cosine of the axis -1..1. Gives: 0..1. Error: 5e-5 against quadrature.
#[derive(Clone, Copy, Debug)]
pub struct CosinePowerAlbedo {
    /// 1 / width²
    inverse_x: f32,
    /// Half of what a grazing axis reflects twice over.
    half_f0: f32,
    n1: f32,
    d: [f32; 3],
}

impl CosinePowerAlbedo {
    /// The albedo of an exponent.
    #[inline(always)]
    pub fn new(lobe: CosinePower) -> Self {
        let inverse_x = 0.5 * lobe.n + 1.0;
        let x = 1.0 / inverse_x;
        let alpha = x.sqrt();
        let q = 0.031_399_053 + x * (0.022_146_61 + x * (0.017_279_593 - 0.002_515_131_1 * x));
        let inverse_f0 = (std::f32::consts::PI * (1.0 + x * (-0.75 + x * q))).sqrt() / alpha;
        let n1 = 0.163_356_32 + x * (-0.136_234_49 + x * 0.172_222_9);
        let e0 = 0.358_986_7 + x * (0.210_598_1 + x * 0.149_795_93);
        let e1 = 0.112_074_27 + x * (-0.071_527_1 - x * 0.031_667_63);
        let m = (1.0 - alpha) * (1.0 + alpha);
        CosinePowerAlbedo { inverse_x, half_f0: 0.5 / inverse_f0, n1, d: [1.0 + n1, n1 + m * e0, m * e1] }
    }

    /// At the cosine between axis and normal.
    #[inline(always)]
    pub fn at(&self, cos: f32) -> f32 {
        let c = cos.abs().min(1.0);
        let z = 0.5 * c / self.half_f0;
        let rise = exp2((log2_one_minus(c * c) * self.inverse_x).max(-100.0));
        let ratio = (1.0 + self.n1 * z) / (1.0 + z * (self.d[0] + z * (self.d[1] + z * self.d[2])));
        cos.clamp(0.0, 1.0) + self.half_f0 * rise * ratio
    }
}
