//! Circular functions and their inverses.

use super::wide;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Sine and cosine of a reduced angle, before the quarter turns are put back.
#[inline(always)]
fn reduced_sincos(r: f32) -> (f32, f32) {
    let z = r * r;
    // (sin r / r - 1) / r^2 on |r| <= 0.79, relative error of the sine: 2^-26.1.
    let p = -1.958_536_7e-4 * z + 8.332_736_5e-3;
    let p = p * z - 1.666_666_5e-1;
    let sine = r + r * (z * p);
    // (cos r - 1 + r^2/2) / r^4 on |r| <= 0.79, error of the cosine: 2^-29.7.
    let q = 2.454_541_3e-5 * z - 1.388_829_1e-3;
    let q = q * z + 4.166_664_6e-2;
    let cosine = 1.0 - (0.5 * z - z * z * q);
    (sine, cosine)
}

/// Picks sine or cosine of the reduced angle for a count of quarter turns, and its sign.
#[inline(always)]
fn turned(sine: f32, cosine: f32, turns: i32) -> f32 {
    let value = if turns & 1 == 0 { sine } else { cosine };
    f32::from_bits(value.to_bits() ^ (((turns & 2) as u32) << 30))
}

/// The sine of an angle in radians.
///
/// Source: Cody and Waite 1980, reduction in `f64`, fitted polynomials in `f32`. Domain: all. Gives: at most 2 ulp for
/// |x| up to 1e6, absolute error 2e-7 up to 1e9, a meaningless number within [-1, 1] beyond.
/// Degenerate cases: sign of zero kept, NaN at infinities and for NaN.
#[inline(always)]
pub fn sin(x: f32) -> f32 {
    let (rest, turns) = wide::quarter_turns(x);
    let (sine, cosine) = reduced_sincos(rest as f32);
    let value = turned(sine, cosine, turns);
    if x == 0.0 { x } else { value }
}

/// The cosine of an angle in radians.
///
/// Source, domain and error: as [`sin`]. Degenerate cases: NaN at infinities and for NaN.
#[inline(always)]
pub fn cos(x: f32) -> f32 {
    let (rest, turns) = wide::quarter_turns(x);
    let (sine, cosine) = reduced_sincos(rest as f32);
    turned(sine, cosine, turns.wrapping_add(1))
}

/// Sine and cosine of the same angle, with the same bits as [`sin`] and [`cos`].
#[inline(always)]
pub fn sincos(x: f32) -> (f32, f32) {
    let (rest, turns) = wide::quarter_turns(x);
    let (sine, cosine) = reduced_sincos(rest as f32);
    let value = turned(sine, cosine, turns);
    (if x == 0.0 { x } else { value }, turned(sine, cosine, turns.wrapping_add(1)))
}

/// The tangent of an angle in radians.
///
/// Source: quotient of fitted sine and cosine in `f64`. Domain: all. Gives: at most 1 ulp for |x| up to 1e6, and a
/// finite number beyond. Degenerate cases: sign of zero kept, NaN at infinities and for NaN.
#[inline(always)]
pub fn tan(x: f32) -> f32 {
    let (r, turns) = wide::quarter_turns(x);
    let z = r * r;
    // sin r / r on |r| <= 0.79, relative error 2^-37.5.
    let sine = r * wide::polynomial(
        z,
        [
            9.999_999_999_954_522e-1,
            -1.666_666_663_016_693_5e-1,
            8.333_328_644_656_138e-3,
            -1.983_916_072_757_371e-4,
            2.716_963_355_734_164e-6,
        ],
    );
    // cos r on |r| <= 0.79, relative error 2^-33.7.
    let cosine = wide::polynomial(
        z,
        [
            9.999_999_999_500_656e-1,
            -4.999_999_959_922_62e-1,
            4.166_661_518_017_424e-2,
            -1.388_657_247_260_842_8e-3,
            2.437_563_552_477_722_8e-5,
        ],
    );
    let even = turns & 1 == 0;
    let above = if even { sine } else { -cosine };
    let below = if even { cosine } else { sine };
    let value = (above / below) as f32;
    if x == 0.0 { x } else { value }
}

/// The arc sine of `a` in [0, 0.5], or half the arc cosine of `a` in (0.5, 1], and whether it is the latter.
///
/// The half-angle formula keeps the argument of the polynomial small where the arc sine has its infinite slope.
#[inline(always)]
fn arc_core(a: f64) -> (f64, bool) {
    let large = a > 0.5;
    let half = 0.5 * (1.0 - a);
    let z = if large { half } else { a * a };
    let root = z.sqrt();
    let s = if large { root } else { a };
    // asin(s)/s in s^2 on [0, 0.2525], relative error 2^-31.6.
    let p = wide::polynomial(
        z,
        [
            1.000_000_000_249_618,
            1.666_665_699_953_303e-1,
            7.500_605_766_383_883e-2,
            4.450_207_638_736_565e-2,
            3.191_420_649_737_611_3e-2,
            1.407_192_274_447_022_9e-2,
            3.800_213_165_173_354e-2,
        ],
    );
    (s * p, large)
}

/// The arc sine, in [-pi/2, pi/2].
///
/// Source: fitted polynomial with the half-angle formula above 1/2, in `f64`. Domain: [-1, 1]. Gives: at most 1 ulp.
/// Degenerate cases: NaN outside the domain and for NaN; sign of zero kept.
#[inline(always)]
pub fn asin(x: f32) -> f32 {
    let (p, large) = arc_core(x.abs() as f64);
    let folded = FRAC_PI_2 - 2.0 * p;
    let value = if large { folded } else { p };
    (value as f32).copysign(x)
}

/// The arc cosine, in [0, pi].
///
/// Source: fitted polynomial with the half-angle formula above 1/2, in `f64`. Domain: [-1, 1]. Gives: at most 1 ulp.
/// Degenerate cases: NaN outside the domain and for NaN.
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let (p, large) = arc_core(x.abs() as f64);
    let negative = x < 0.0;
    let doubled = 2.0 * p;
    let far = if negative { PI - doubled } else { doubled };
    let near = if negative { FRAC_PI_2 + p } else { FRAC_PI_2 - p };
    (if large { far } else { near }) as f32
}

/// The arc tangent, in [-pi/2, pi/2].
///
/// Source, error: as [`atan2`] with x = 1. Domain: all. Degenerate cases: sign of zero kept, NaN for NaN.
#[inline(always)]
pub fn atan(x: f32) -> f32 {
    atan2(x, 1.0)
}

/// The angle of the point (x, y), in [-pi, pi].
///
/// Source: octant reduction, then by pi/8, and a fitted polynomial, with one division, in `f64`. Domain: all.
/// Gives: at most 1 ulp. Degenerate cases: those of C `atan2f`: zeros and infinities have the angle of their signs, and
/// NaN gives NaN.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    // An infinity becomes a number that dwarfs every f32; two of them then have the angle pi/4, as the standard wants.
    let a = wide::limit(y.abs() as f64, 0.0, 1e300);
    let b = wide::limit(x.abs() as f64, 0.0, 1e300);
    let steep = a > b;
    let least = if steep { b } else { a };
    let most = if steep { a } else { b };
    let upper = least > 0.414_213_562_373_095_03 * most;
    let above = if upper { least - most } else { least };
    let below = if upper { least + most } else { most };
    let below = if below == 0.0 { 1.0 } else { below };
    let t = above / below;
    // atan(t)/t in t^2 on |t| <= tan(pi/8), relative error 2^-30.5.
    let p = wide::polynomial(
        t * t,
        [
            9.999_999_993_351_98e-1,
            -3.333_330_565_418_131_7e-1,
            1.999_811_654_331_239_4e-1,
            -1.423_830_624_647_223_5e-1,
            1.056_072_790_031_844_2e-1,
            -6.002_936_770_571_558e-2,
        ],
    );
    let angle = t * p + if upper { FRAC_PI_4 } else { 0.0 };
    let angle = if steep { FRAC_PI_2 - angle } else { angle };
    let angle = if x.is_sign_negative() { PI - angle } else { angle };
    (angle as f32).copysign(y)
}
