//! Facets of Blinn: a power of the cosine, with the Smith term that belongs to it.

use super::distribution::{Distribution, Widths};
use super::geometry::Facets;
use crate::bsdf::power::{exp2, log2};
use crate::bsdf::select;
use crate::math::elementary::expm1;
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, LN_2, LOG2_E, PI};

/// Blinn's distribution D = (s + 2) / (2 pi) cos^s of the width alpha, s = 2 / alpha² - 2.
///
/// Source: Blinn 1977; the exponent of a width after Walter et al. 2007, section 5.2, where it comes near Beckmann's. Domain:
/// widths 1e-3..1, that is s from 0 to 2e6. Isotropic: two widths give the one of their geometric mean.
#[derive(Clone, Copy, Debug)]
pub struct Blinn {
    alpha: f32,
    /// alpha² = 2 / (s + 2).
    x: f32,
    /// 1 / (2 Lambda cos) at grazing directions.
    inverse_f0: f32,
    /// Coefficients of k's numerator.
    n: [f32; 2],
    /// Coefficients of k's denominator.
    e: [f32; 4],
}

/// A cubic in x.
#[inline(always)]
fn cubic(x: f32, c: [f32; 4]) -> f32 {
    c[0] + x * (c[1] + x * (c[2] + x * c[3]))
}

/// log2(cos²), with all digits on both ends, from the squares of sine and cosine.
#[inline(always)]
fn log2_cos2(sin2: f32, cos2: f32) -> f32 {
    let flat = sin2 < 0.5;
    let rounded = 1.0 - sin2;
    // What 1 - sin² loses in rounding is as large as its distance from 1 matters for a narrow distribution.
    let lost = select(flat, ((1.0 - rounded) - sin2) * LOG2_E, 0.0);
    log2(select(flat, rounded, cos2.max(1e-37))) + lost
}

impl Distribution for Blinn {
    const FACETS: Facets = Facets::Blinn;

    #[inline(always)]
    fn new(w: Widths) -> Self {
        let x = w.x * w.y;
        let alpha = x.sqrt();
        let q = cubic(x, [0.031_399_052, 0.022_146_609, 0.017_279_593, -0.002_515_131_2]);
        let inverse_f0 = (PI * (1.0 + x * (x * q - 0.75))).sqrt() / alpha;
        let m = (1.0 - alpha) * (1.0 + alpha);
        let n1 = cubic(x, [0.239_966_22, 0.919_051_2, 0.589_73, -0.574_901_34]);
        let n2 = cubic(x, [0.030_431_489, 0.139_422_86, -0.375_234_8, 0.520_161_4]);
        let e0 = cubic(x, [0.363_295_38, 0.211_110_1, 0.059_765_328, 0.129_545_57]);
        let e1 = cubic(x, [0.132_367_7, 0.331_170_7, 0.474_828_43, -0.233_347]);
        let e2 = cubic(x, [0.018_890_17, 0.101_027_16, -0.208_604_94, 0.147_634_63]);
        let e = [1.0 + n1, n1 + n2 + m * e0, n2 + m * e1, m * e2];
        Blinn { alpha, x, inverse_f0, n: [n1, n2], e }
    }

    #[inline(always)]
    fn widths(&self) -> Widths {
        Widths { x: self.alpha, y: self.alpha }
    }

    /// Source: Blinn 1977, eq. 2, normalised to a projected area of 1. Degenerate cases: alpha 1 is D = 1 / pi.
    #[inline(always)]
    fn d(&self, m: Vec3) -> f32 {
        let half_s = (1.0 - self.x) / self.x;
        let d = FRAC_1_PI / self.x * exp2(half_s * log2_cos2(m.x * m.x + m.y * m.y, m.z * m.z));
        if m.z > 0.0 { d } else { 0.0 }
    }

    /// Source: the definition of Smith's Lambda, integrated: Gamma((s+1)/2) / (2 sqrt(pi) Gamma(s/2+1)) times the integral
    /// over t from cos to 1 of (1-t²)^(s/2) / t². With z = cos / f0, f0 = Gamma(s/2+1/2) / (sqrt(pi) Gamma(s/2+1)), it is
    /// sin^(s+2) k / (2 z), where k = 1 - z + ... is a smooth function.
    /// Domain: any direction, its side is ignored. Gives: >= 0. Constants: f0 to 3.7e-7, k fitted as a quotient of polynomials,
    /// relative error of Lambda above 1e-5: 7.7e-6, absolute error of 1 / (1 + Lambda): 1.4e-6, for all widths 1e-3..1.
    #[inline(always)]
    fn lambda(&self, v: Vec3) -> f32 {
        let c = v.z.abs().min(1.0);
        let z = (c * self.inverse_f0).max(1e-15);
        let power = (log2_cos2(c * c, v.x * v.x + v.y * v.y) / self.x).max(-115.0);
        let top = exp2(power) * (1.0 + z * (self.n[0] + z * self.n[1]));
        let e = self.e;
        let bottom = 2.0 * z * (1.0 + z * (e[0] + z * (e[1] + z * (e[2] + z * e[3]))));
        top / bottom
    }

    /// Source: the half-vector sampling of Blinn's model, cos = xi^(1/(s+2)) (Walter et al. 2007, eq. 32).
    #[inline(always)]
    fn sample_normal(&self, u: f32, v: f32) -> Vec3 {
        let (cos, sin) = turn(v);
        // sin² = 1 - (1 - u)^(2/(s+2)), without the difference that a narrow distribution would lose.
        let sin2 = -expm1(self.x * (log2((1.0 - u).max(1e-8)) * LN_2));
        let r = sin2.max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, (1.0 - sin2).max(0.0).sqrt())
    }
}
