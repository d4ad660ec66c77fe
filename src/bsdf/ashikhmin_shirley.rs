//! The anisotropic Phong model of Ashikhmin and Shirley: a highlight with Fresnel's rise, and the diffuse light under it.

use super::bivariate::{collapse, horner};
use super::cosine_power::MAX_EXPONENT;
use super::cosine_power::log2_one_minus;
use super::power::{exp2, log2};
use super::{Eval, Params, Scatter, Spread, View, above_horizon, limited, select};
use crate::math::elementary::{expm1, ln};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf, turn};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// (1 - x)^5, Schlick's rise.
#[inline(always)]
fn fifth(x: f32) -> f32 {
    let y = limited(1.0 - x, 0.0, 1.0);
    y * y * y * y * y
}

#[inline(always)]
fn reflectance(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(limited(x, 0.0, 1.0), limited(y, 0.0, 1.0), limited(z, 0.0, 1.0))
}

/// The highlight of `ashikhmin_shirley(N, U, exponent_x, exponent_y, specular, diffuse)`.
///
/// Source: Ashikhmin and Shirley 2000, "An Anisotropic Phong BRDF Model", eq. 4:
/// f = sqrt((nx + 1)(ny + 1)) / (8 pi) (n . h)^((nx hx² + ny hy²) / (1 - hz²)) F(k . h) / ((k . h) max(ci, co)), with
/// Schlick's F = Rs + (1 - Rs)(1 - k . h)^5.
/// Domain: exponents 0..1e6, limited to it; Rs 0..1. Gives: f in 1/sr, reciprocal, albedo at most 1.
/// Degenerate cases: opposite directions in the horizon give 0.
/// Albedo: own fit, error 0.01 against quadrature at equal exponents; unequal ones take the one that belongs to the mean square
/// width, which for a ratio of 100 errs by up to 0.03 from the mean over the azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Highlight {
    nx: f32,
    ny: f32,
    rs: Vec3,
    /// sqrt((nx + 1)(ny + 1)) / (2 pi)
    norm: f32,
    alpha: f32,
    white: [f32; 5],
    tilt: [f32; 3],
}

/// Albedo for Rs = 1, fitted in z = c / (c + 2 a) and a² = 2 / (n + 2), n 0..1e6, cosine 1e-4..1; error 0.0073.
const WHITE: [[f32; 4]; 5] = [
    [0.506_883_9, -0.131_218_6, 0.352_234_4, -0.235_233_6],
    [0.115_848_4, 3.331_385, -9.351_157, 4.351_68],
    [0.846_767_9, -19.131_25, 36.482_27, -18.114_4],
    [-0.145_263_7, 34.527_29, -55.914_9, 33.169_86],
    [-0.328_100_7, -13.693_93, -30.206_92, 22.314_16],
];

/// How far the cosine in Schlick's term is raised by the spread of half vectors, over a, in z and a; error 0.0018 of albedo.
const TILT: [[f32; 3]; 3] = [
    [0.568_854_4, -0.431_376_3, 0.167_070_4],
    [-0.330_128_6, 0.076_387_36, 0.040_433_5],
    [-0.380_932, -2.599_138, -1.467_269],
];

impl Scatter for Highlight {
    const PARAMS: usize = 5;
    const SPREAD: Spread = Spread::Narrow;
    const COLORED: bool = true;

    #[inline(always)]
    fn prepare([nx, ny, r, g, b, ..]: Params) -> Self {
        let (nx, ny) = (limited(nx, 0.0, MAX_EXPONENT), limited(ny, 0.0, MAX_EXPONENT));
        let alpha2 = 1.0 / (nx + 2.0) + 1.0 / (ny + 2.0);
        let alpha = alpha2.sqrt();
        Highlight {
            nx,
            ny,
            rs: reflectance(r, g, b),
            norm: ((nx + 1.0) * (ny + 1.0)).sqrt() / TAU,
            alpha,
            white: collapse(&WHITE, alpha2),
            tilt: collapse(&TILT, alpha),
        }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let h = wo + wi;
        let length2 = h.dot(h).max(1e-12);
        let h = h * (1.0 / length2.sqrt());
        let (x2, y2) = (h.x * h.x, h.y * h.y);
        let s2 = x2 + y2;
        // (n . h)^e with (n . h)² = 1 - s2; the quotient stays finite as s2 goes to zero.
        let e = (self.nx * x2 + self.ny * y2) / s2.max(1e-20);
        // Near the horizon the cosine itself has the digits that 1 - s2 has lost.
        let log_cos2 = select(s2 < 0.5, log2_one_minus(s2), log2((h.z * h.z).max(f32::MIN_POSITIVE)));
        let d = self.norm * exp2(0.5 * e * log_cos2);
        let kh = 0.5 * length2.sqrt();
        let (ci, co) = (wi.z.max(0.0), wo.z.max(0.0));
        let pdf = d / (4.0 * kh);
        let lit = wi.z > 0.0 && wo.z > 0.0 && h.z > 0.0;
        Eval { f_cos: select(lit, pdf * ci / ci.max(co).max(1e-30), 0.0), pdf: select(lit, pdf, 0.0) }
    }

    #[inline(always)]
    fn color_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Vec3 {
        let h = wo + wi;
        let rise = fifth(0.5 * h.dot(h).sqrt());
        self.rs + (Vec3::ONE - self.rs) * rise
    }

    /// Source: the same, eq. 9 and 10, with the tangent of the azimuth as a quotient, which serves all four quadrants.
    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let (cos, sin) = turn(xi.x);
        let (x, y) = (cos * (self.ny + 1.0).sqrt(), sin * (self.nx + 1.0).sqrt());
        let length2 = x * x + y * y;
        let e = (self.nx * x * x + self.ny * y * y) / length2;
        let less = -expm1(ln(1.0 - xi.y) / (e + 1.0));
        let s = (less * (2.0 - less)).max(0.0).sqrt() / length2.sqrt();
        let m = Vec3::new(s * x, s * y, 1.0 - less);
        let along = wo.dot(m);
        above_horizon((m * (2.0 * along) - wo) * select(along > 0.0, 1.0, 0.0))
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let c = cos.clamp(1e-5, 1.0);
        let z = c / (c + 2.0 * self.alpha);
        let rise = fifth(limited(c + self.alpha * horner(&self.tilt, z), 0.0, 1.0));
        let rs = self.rs.x.max(self.rs.y).max(self.rs.z);
        limited(horner(&self.white, z) * (rs + (1.0 - rs) * rise), 0.0, 1.0)
    }
}

/// The diffuse light under the highlight.
///
/// Source: the same, eq. 5: f = 28 Rd / (23 pi) (1 - Rs) (1 - (1 - ci/2)^5) (1 - (1 - co/2)^5).
/// Domain: Rd and Rs 0..1, limited to it. Gives: f in 1/sr, reciprocal. Albedo exact: Rd (1 - Rs) (1 - (1 - c/2)^5).
#[derive(Clone, Copy, Debug)]
pub struct Under {
    color: Vec3,
}

impl Scatter for Under {
    const PARAMS: usize = 6;
    const COLORED: bool = true;

    #[inline(always)]
    fn prepare([sr, sg, sb, dr, dg, db, ..]: Params) -> Self {
        Under { color: reflectance(dr, dg, db) * (Vec3::ONE - reflectance(sr, sg, sb)) }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let (ci, co) = (wi.z.max(0.0), wo.z.max(0.0));
        let f = 28.0 / 23.0 * FRAC_1_PI * (1.0 - fifth(0.5 * ci)) * (1.0 - fifth(0.5 * co));
        Eval { f_cos: f * ci, pdf: cosine_hemisphere_pdf(wi.z) }
    }

    #[inline(always)]
    fn color_from(&self, _wo: Vec3, _view: View, _wi: Vec3) -> Vec3 {
        self.color
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.color.x.max(self.color.y).max(self.color.z) * (1.0 - fifth(0.5 * cos))
    }
}
