//! Directional albedo of the sheen (F = 1): a polynomial in the cube root of the cosine, collapsed for one roughness.
//!
//! The albedo rises like a power of the cosine below 1, so uniform axes in the cosine are the mistake to avoid: a 48 x 48
//! table still errs by 0.03 to 0.1. In cbrt(cos) and log r a polynomial of degree 8 x 6 errs by at most 7.8e-4.
//!
//! Decision (2026-11-22): the exact terms use fitted polynomials, which collapse to 9 numbers once r is known, because
//! a lane loop evaluates them without gathers (error 7.8e-4), instead of 32 x 16 tables (7e-4 from r = 0.06 up). The published
//! fit and Ashikhmin's visibility need degree 12 x 12 for the kink of the one at cos = 0.5 and the gain of the other; their
//! numbers are constants too, because tables built at the first use cost start-up time and a lock in the lane loop.
//!
//! Decision (2026-11-29): one polynomial serves r = 0.01 to 1, because cloth of low roughness is what the paper's Figure 2 is about
//! and degree 8 x 6 errs there by no more than 6 x 4 did from 0.06 up, instead of a second polynomial below 0.06, which would cost
//! every lane a choice, or the albedo of 0.06 (too large by up to 0.34). Two more steps of the recurrence are the price.
//!
//! Decision (2026-11-22): how exact the albedo is, is a setting of a render, because it is a matter of accuracy and not of looks,
//! instead of a keyword of the closure, by which flattening would have to tell lanes apart.

pub use super::fits::SHORT;

use super::albedo_table::look_up;
use super::charlie::{MIN_ROUGHNESS, clamp_roughness};
use super::fits::{
    ALBEDO_ASHIKHMIN, ALBEDO_EXACT, ALBEDO_EXACT_LONG, ALBEDO_EXACT_SOFT, ALBEDO_EXACT_SOFT_LONG, ALBEDO_PUBLISHED,
    ALBEDO_PUBLISHED_SOFT, ALBEDO_VELVET, ALBEDO_VELVET_2000, CURVE, CURVE_COLUMNS, CurveFit, SHORT_COLUMNS, ShortFit,
    VELVET_COLUMNS, VelvetFit,
};
use super::term::Shadowing;
use crate::bsdf::power::log2;
use crate::math::polynomial::chebyshev;
use std::fmt;
use std::str::FromStr;

/// Coefficients that the cheapest evaluation uses.
const SHORTEST: usize = 5;
/// Coefficients in log r that the cheapest evaluation uses.
const SHORTEST_COLUMNS: usize = 5;
/// The smallest cosine of the fit; below it the curve is constant.
const MIN_COS: f32 = 1e-4;
const MIN_T: f32 = 0.046_415_888;
/// The smallest roughness of the fits: the smallest of the model.
pub const MIN_FITTED_ROUGHNESS: f32 = MIN_ROUGHNESS;
/// log2(0.01), exact to f32.
const LOG2_MIN: f32 = -6.643_856;
/// The smallest width of the velvet's fit.
pub const MIN_VELVET_WIDTH: f32 = 0.06;
/// log2(0.06), exact to f32.
const LOG2_MIN_VELVET: f32 = -4.058_893_7;

/// How the albedo of a sheen with an exact shadowing term is found; other terms have one polynomial only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SheenAlbedo {
    /// The first 5 x 5 terms of the default's polynomial: errs by up to 1.3e-2.
    Short,
    /// A polynomial of 9 x 7 terms that errs by up to 7.8e-4. The default: layers cannot show more.
    #[default]
    Fit,
    /// A polynomial of 13 x 13 terms that errs by up to 8.3e-5 (softened) or 2.0e-5 (not), from r = 0.06 up 1.8e-5 and 3.6e-6.
    Long,
    /// A table of 33 x 25 numbers, read by linear interpolation: errs by up to 2.9e-3 (softened, at r = 0.01), else 1.4e-3.
    Table,
}

/// [`SheenAlbedo::Short`] as a constant parameter.
pub const SHORT_METHOD: u8 = 0;
/// [`SheenAlbedo::Fit`] as a constant parameter.
pub const FIT_METHOD: u8 = 1;
/// [`SheenAlbedo::Long`] as a constant parameter.
pub const LONG_METHOD: u8 = 2;
/// [`SheenAlbedo::Table`] as a constant parameter.
pub const TABLE_METHOD: u8 = 3;

impl SheenAlbedo {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, SheenAlbedo); 4] = [
        ("short", SheenAlbedo::Short),
        ("fit", SheenAlbedo::Fit),
        ("long", SheenAlbedo::Long),
        ("table", SheenAlbedo::Table),
    ];
}

impl FromStr for SheenAlbedo {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        let unknown =
            || format!("unknown albedo evaluator \"{text}\"; choose \"short\", \"fit\", \"long\" or \"table\"");
        found.map(|&(_, method)| method).ok_or_else(unknown)
    }
}

impl fmt::Display for SheenAlbedo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::ALL.iter().find(|(_, method)| method == self).map_or("", |(name, _)| name))
    }
}

/// The albedo of one roughness as Chebyshev coefficients.
///
/// Source: own fits. Domain: cosine 0..1, roughness 0.01..1, below it the albedo of 0.01. Gives: 0..1.
/// Error against quadrature of the same term, for cosines from 1e-4 (measured): exact, softened or not, 7.8e-4,
/// published 9.3e-4 with and without softening, Ashikhmin's visibility 1.0e-4 (what gains energy is cut at 1).
#[derive(Clone, Copy, Debug)]
pub struct AlbedoCurve {
    c: [f32; CURVE],
}

impl AlbedoCurve {
    /// The curve of one roughness.
    #[inline(always)]
    pub fn new(term: Shadowing, soft: bool, r: f32) -> Self {
        match (term, soft) {
            (Shadowing::Exact | Shadowing::Series, true) => Self::short(&ALBEDO_EXACT_SOFT, r),
            (Shadowing::Exact | Shadowing::Series, false) => Self::short(&ALBEDO_EXACT, r),
            (Shadowing::Published, true) => Self::long(&ALBEDO_PUBLISHED_SOFT, r),
            (Shadowing::Published, false) => Self::long(&ALBEDO_PUBLISHED, r),
            (Shadowing::Ashikhmin, _) => Self::long(&ALBEDO_ASHIKHMIN, r),
        }
    }

    /// The curve of an exact term by a method, for [`AlbedoCurve::by`] with the same method.
    #[inline(always)]
    pub fn exact(method: SheenAlbedo, soft: bool, r: f32) -> Self {
        match (method, soft) {
            (SheenAlbedo::Long, true) => Self::long(&ALBEDO_EXACT_SOFT_LONG, r),
            (SheenAlbedo::Long, false) => Self::long(&ALBEDO_EXACT_LONG, r),
            (SheenAlbedo::Fit, _) => Self::new(Shadowing::Exact, soft, r),
            (SheenAlbedo::Short, true) => Self::shortest(&ALBEDO_EXACT_SOFT, r),
            (SheenAlbedo::Short, false) => Self::shortest(&ALBEDO_EXACT, r),
            (SheenAlbedo::Table, _) => Self::row(soft, r),
        }
    }

    /// The curve of Ashikhmin's velvet of 2007 of one width; error 2.1e-4.
    #[inline(always)]
    pub fn velvet(m: f32) -> Self {
        Self::of_width(&ALBEDO_VELVET, m)
    }

    /// The curve of Ashikhmin's velvet of 2000 of one width; error 2.7e-3.
    #[inline(always)]
    pub fn velvet_2000(sigma: f32) -> Self {
        Self::of_width(&ALBEDO_VELVET_2000, sigma)
    }

    #[inline(always)]
    fn of_width(fit: &VelvetFit, m: f32) -> Self {
        let s = 1.0 - log2(m.clamp(MIN_VELVET_WIDTH, 1.0)) * (2.0 / LOG2_MIN_VELVET);
        let mut c = [0.0; CURVE];
        for i in 0..CURVE {
            c[i] = chebyshev::<VELVET_COLUMNS>(&fit[i], s);
        }
        AlbedoCurve { c }
    }

    #[inline(always)]
    fn short(fit: &ShortFit, r: f32) -> Self {
        let mut c = [0.0; CURVE];
        let s = roughness_axis(r);
        for i in 0..SHORT {
            c[i] = chebyshev::<SHORT_COLUMNS>(&fit[i], s);
        }
        AlbedoCurve { c }
    }

    #[inline(always)]
    fn shortest(fit: &ShortFit, r: f32) -> Self {
        let mut c = [0.0; CURVE];
        let s = roughness_axis(r);
        for i in 0..SHORTEST {
            c[i] = chebyshev::<SHORTEST_COLUMNS>(&fit[i], s);
        }
        AlbedoCurve { c }
    }

    #[inline(always)]
    fn long(fit: &CurveFit, r: f32) -> Self {
        let s = roughness_axis(r);
        let mut c = [0.0; CURVE];
        for i in 0..CURVE {
            c[i] = chebyshev::<CURVE_COLUMNS>(&fit[i], s);
        }
        AlbedoCurve { c }
    }

    /// Where the table is read, in place of coefficients.
    #[inline(always)]
    fn row(soft: bool, r: f32) -> Self {
        let mut c = [0.0; CURVE];
        (c[0], c[1]) = (roughness_axis(r), f32::from(u8::from(soft)));
        AlbedoCurve { c }
    }

    /// The coefficients of a curve of an exact term, to keep them.
    #[inline(always)]
    pub fn terms(&self) -> [f32; SHORT] {
        std::array::from_fn(|k| self.c[k])
    }

    /// The curve of coefficients that [`AlbedoCurve::terms`] gave.
    #[inline(always)]
    pub fn of(terms: [f32; SHORT]) -> Self {
        let mut c = [0.0; CURVE];
        c[..SHORT].copy_from_slice(&terms);
        AlbedoCurve { c }
    }

    /// The albedo at a cosine, clamped to 0..1. `LONG` curves have all coefficients, the others [`SHORT`].
    #[inline(always)]
    pub fn at<const LONG: bool>(&self, cos: f32) -> f32 {
        let t = cube_root(crate::bsdf::limited(cos, MIN_COS, 1.0));
        if LONG { self.sum::<CURVE>(t) } else { self.sum::<SHORT>(t) }
    }

    /// The albedo of a curve of [`AlbedoCurve::exact`]; a constant method lets lane loops become SIMD code.
    #[inline(always)]
    pub fn by<const METHOD: u8>(&self, cos: f32) -> f32 {
        let cos = crate::bsdf::limited(cos, MIN_COS, 1.0);
        let t = cube_root(cos);
        match METHOD {
            SHORT_METHOD => self.sum::<SHORTEST>(t),
            FIT_METHOD => self.sum::<SHORT>(t),
            TABLE_METHOD => look_up(self.c[1] > 0.5, cosine_axis(t), self.c[0]),
            // A step of Newton brings the root to the last digits, which this curve is worth.
            _ => self.sum::<CURVE>(t - (t - cos / (t * t)) * (1.0 / 3.0)),
        }
    }

    /// The same for a method that is known only now.
    pub fn by_method(&self, method: SheenAlbedo, cos: f32) -> f32 {
        match method {
            SheenAlbedo::Short => self.by::<SHORT_METHOD>(cos),
            SheenAlbedo::Fit => self.by::<FIT_METHOD>(cos),
            SheenAlbedo::Long => self.by::<LONG_METHOD>(cos),
            SheenAlbedo::Table => self.by::<TABLE_METHOD>(cos),
        }
    }

    #[inline(always)]
    fn sum<const TERMS: usize>(&self, t: f32) -> f32 {
        chebyshev::<TERMS>(&self.c, cosine_axis(t)).clamp(0.0, 1.0)
    }
}

/// The axis of the fits, -1..1, for a cube root.
#[inline(always)]
fn cosine_axis(t: f32) -> f32 {
    (t - MIN_T) * (2.0 / (1.0 - MIN_T)) - 1.0
}

/// The cube root in single precision, for cosines.
///
/// Source: Kahan 1991, exponent over three, then one step of Halley. Domain: 1e-4..1. Gives: relative error below 3e-5, which
/// changes an albedo by at most 3e-5.
/// The library's function is exact to the last bit and costs two divisions in f64; the curve needs neither.
#[inline(always)]
pub(crate) fn cube_root(x: f32) -> f32 {
    let y = f32::from_bits(x.to_bits() / 3 + 709_958_130);
    let cube = y * y * y;
    y * (cube + 2.0 * x) / (2.0 * cube + x)
}

#[inline(always)]
fn roughness_axis(r: f32) -> f32 {
    1.0 - log2(clamp_roughness(r)) * (2.0 / LOG2_MIN)
}
