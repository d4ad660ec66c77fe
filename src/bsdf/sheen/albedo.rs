//! Directional albedo of the sheen (F = 1): a polynomial in the cube root of the cosine, collapsed for one roughness.
//!
//! The albedo rises like a power of the cosine below 1, so uniform axes in the cosine are the mistake to avoid: a 48 x 48
//! table still errs by 0.03 to 0.1. In cbrt(cos) and log r a polynomial of degree 6 x 4 errs by at most 7.4e-4.
//!
//! Decision (2026-11-22): the exact terms use fitted polynomials of 35 numbers, which collapse to 7 once r is known, because
//! a lane loop evaluates them without gathers (error 6.6e-4 and 7.4e-4), instead of 32 x 16 tables (7e-4). The published
//! fit and Ashikhmin's visibility get a polynomial of degree 12 x 8 by quadrature when the first scene asks for one.

use super::fits::{ALBEDO_EXACT, ALBEDO_EXACT_SOFT};
use super::reference::{self, Model};
use super::shadowing::Shadowing;
use crate::math::elementary::ln;
use std::sync::LazyLock;

/// Coefficients of a curve in the cube root of the cosine.
pub const CURVE: usize = 13;
/// Coefficients that the fitted exact terms use.
const SHORT: usize = 7;
const SURFACE_COLUMNS: usize = 9;
/// The smallest cosine of the fit; below it the curve is constant.
const MIN_COS: f32 = 1e-4;
const MIN_T: f32 = 0.046_415_888;
/// The smallest roughness of the fit.
pub const MIN_FITTED_ROUGHNESS: f32 = 0.06;
/// ln(0.06), exact to f32.
const LN_MIN: f32 = -2.813_410_8;

type Surface = [[f32; SURFACE_COLUMNS]; CURVE];

/// The albedo of one roughness as Chebyshev coefficients.
///
/// Source: own fits. Domain: cosine 0..1, roughness 0.06..1, below it the albedo of 0.06. Gives: 0..1.
/// Error against quadrature of the same term, for cosines from 1e-4: 6.6e-4 exact, 7.4e-4 exact and softened; 3e-3 for
/// the two lazily fitted ones.
#[derive(Clone, Copy, Debug)]
pub struct AlbedoCurve {
    c: [f32; CURVE],
    short: bool,
}

impl AlbedoCurve {
    /// The curve of one roughness.
    #[inline(always)]
    pub fn new(term: Shadowing, soft: bool, r: f32) -> Self {
        match (term, soft) {
            (Shadowing::Exact, true) => Self::short(&ALBEDO_EXACT_SOFT, r),
            (Shadowing::Exact, false) => Self::short(&ALBEDO_EXACT, r),
            (Shadowing::Published, true) => Self::long(&PUBLISHED_SOFT, r),
            (Shadowing::Published, false) => Self::long(&PUBLISHED_RAW, r),
            (Shadowing::Ashikhmin, _) => Self::long(&ASHIKHMIN, r),
        }
    }

    #[inline(always)]
    fn short(surface: &[[f32; 5]; SHORT], r: f32) -> Self {
        let mut c = [0.0; CURVE];
        let s = roughness_axis(r);
        for i in 0..SHORT {
            c[i] = chebyshev(&surface[i], s);
        }
        AlbedoCurve { c, short: true }
    }

    #[inline(always)]
    fn long(surface: &Surface, r: f32) -> Self {
        let s = roughness_axis(r);
        AlbedoCurve { c: surface.map(|row| chebyshev(&row, s)), short: false }
    }

    /// The albedo at a cosine; clamped to 0..1.
    #[inline(always)]
    pub fn at(&self, cos: f32) -> f32 {
        let t = cube_root(cos.clamp(MIN_COS, 1.0));
        let x = (t - MIN_T) * (2.0 / (1.0 - MIN_T)) - 1.0;
        let value = if self.short { chebyshev::<SHORT>(self.c.first_chunk().unwrap_or(&[0.0; SHORT]), x) } else { chebyshev(&self.c, x) };
        value.clamp(0.0, 1.0)
    }

    /// 2 times the integral of albedo times cosine over the cosine: the mean over the hemisphere.
    ///
    /// Source: Gauss-Legendre of 8 nodes in the cube root, which integrates 6 t^5 times a polynomial of degree 10 exactly.
    #[inline(always)]
    pub fn average(&self) -> f32 {
        let mut sum = 0.0;
        for (x, weight) in GAUSS {
            for t in [0.5 - 0.5 * x, 0.5 + 0.5 * x] {
                let t2 = t * t;
                sum += 3.0 * weight * t2 * t2 * t * self.at(t2 * t);
            }
        }
        sum
    }
}

/// Positive nodes and weights of the 8-point Gauss-Legendre rule on -1..1, exact to f32.
const GAUSS: [(f32, f32); 4] = [
    (0.183_434_64, 0.362_683_78),
    (0.525_532_4, 0.313_706_65),
    (0.796_666_5, 0.222_381_03),
    (0.960_289_86, 0.101_228_54),
];

/// The cube root in single precision, for cosines.
///
/// Source: Kahan 1991, exponent over three, then two steps of Halley. Domain: 1e-4..1. Gives: relative error below 3e-7.
/// The library's function is exact to the last bit and costs two divisions in f64; the curve needs neither.
#[inline(always)]
fn cube_root(x: f32) -> f32 {
    let mut y = f32::from_bits(x.to_bits() / 3 + 709_958_130);
    for _ in 0..2 {
        let cube = y * y * y;
        y *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    y
}

#[inline(always)]
fn roughness_axis(r: f32) -> f32 {
    1.0 - 2.0 * ln(r.clamp(MIN_FITTED_ROUGHNESS, 1.0)) / LN_MIN
}

/// A Chebyshev series by Clenshaw's recurrence.
#[inline(always)]
fn chebyshev<const N: usize>(c: &[f32; N], x: f32) -> f32 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for k in (1..N).rev() {
        (b1, b2) = (2.0 * x * b1 - b2 + c[k], b1);
    }
    x * b1 - b2 + c[0]
}

static PUBLISHED_SOFT: LazyLock<Surface> = LazyLock::new(|| fit(Model::Published, true));
static PUBLISHED_RAW: LazyLock<Surface> = LazyLock::new(|| fit(Model::Published, false));
static ASHIKHMIN: LazyLock<Surface> = LazyLock::new(|| fit(Model::Ashikhmin, false));

/// Interpolates the albedo, integrated numerically, at the Chebyshev nodes of both axes.
fn fit(model: Model, soft: bool) -> Surface {
    let node = |k: usize, n: usize| (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos();
    let rows: [[f64; SURFACE_COLUMNS]; CURVE] = std::array::from_fn(|i| {
        let t = f64::from(MIN_T) + (1.0 - f64::from(MIN_T)) * 0.5 * (1.0 + node(i, CURVE));
        std::array::from_fn(|j| {
            let s = 0.5 * (1.0 + node(j, SURFACE_COLUMNS));
            let r = ((1.0 - s) * f64::from(MIN_FITTED_ROUGHNESS).ln()).exp();
            // What reflects more than arrives is cut, as a scale below zero would be.
            reference::albedo(model, soft, t * t * t, r, 16).min(1.2)
        })
    });
    let along = |k: usize, m: usize, n: usize| (std::f64::consts::PI * k as f64 * (m as f64 + 0.5) / n as f64).cos();
    let share = |k: usize, n: usize| if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 };
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut sum = 0.0;
            for (i, row) in rows.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    sum += value * along(a, i, CURVE) * along(b, j, SURFACE_COLUMNS);
                }
            }
            (sum * share(a, CURVE) * share(b, SURFACE_COLUMNS)) as f32
        })
    })
}
