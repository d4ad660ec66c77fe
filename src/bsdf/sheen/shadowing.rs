//! Shadowing and masking of the Charlie sheen: the exact term, the fit the paper publishes, and a real-time visibility.
//!
//! The paper fits Lambda because the projected-area integral "has no easy solution". It has one: with n = 1/r,
//! c (1 + 2 Lambda(c)) = f(c) = 2F1(-1/2, -n/2; 1; 1 - c²), hence G / (4 ci co) = 1 / (2 (f_i co + f_o ci)).

pub use super::term::Shadowing;

use super::fits::{SERIES, SERIES_COLUMNS, SHADOWING_SERIES};
use crate::bsdf::power::{exp, log2, power};
use crate::bsdf::select;
use crate::math::polynomial::chebyshev;

/// log2 of 100, the most n.
const LOG2_MOST: f32 = 6.643_856;

/// Constants of the exact term for one roughness.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    h: f32,
    p: f32,
    q: f32,
}

impl Exact {
    /// Source: own fit to 2F1 with the exact values of f² and its slope at c = 1 and of f at c = 0.
    /// Domain: n = 1/r in 1..100. Constants: fitted on r 0.06..1 for the least error of the albedo (6.6e-5) with Lambda held
    /// to 0.57 %; Lambda errs by at most 0.67 % (r >= 0.01) and 0.37 % (r >= 0.15), G1 by 7.7e-4.
    #[inline(always)]
    pub fn new(n: f32) -> Self {
        let h = 0.5 * n;
        let q = (n - 2.0) * (0.308_349_3 + 0.030_894_748 * n) / (1.0 + 0.107_378_98 * n);
        let f2 = std::f32::consts::FRAC_2_PI * (n + 1.5) + 0.087_586_43 / (n + 1.961_956);
        Exact { h, p: (f2 - 1.0) * (1.0 + q) - h, q }
    }

    /// f(c) = c (1 + 2 Lambda(c)). Domain: 0..1. Gives: 1 at c = 1, growing to about sqrt(2 n / pi) at c = 0.
    #[inline(always)]
    pub fn f(&self, cos: f32) -> f32 {
        let u = (1.0 - cos) * (1.0 + cos);
        (1.0 + u * (self.h + self.p * u) / (1.0 + self.q * u)).max(1.0).sqrt()
    }

    /// Lambda. Domain: (0, 1]. Gives: 0 at c = 1, growing as 1/c; finite (clamped) at c = 0.
    /// The difference of squares keeps all digits near c = 1.
    #[inline(always)]
    pub fn lambda(&self, cos: f32) -> f32 {
        let c = cos.max(1e-30);
        let u = ((1.0 - c) * (1.0 + c)).max(0.0);
        let rise = (self.h + self.p * u) / (1.0 + self.q * u);
        let f = (1.0 + u * rise).max(1.0).sqrt();
        (u * (1.0 + rise)).max(0.0) / (2.0 * c * (f + c))
    }
}

/// The exact term for one roughness as a Chebyshev series, once the roughness is known.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    h: f32,
    q: f32,
    c: [f32; SERIES],
}

impl Series {
    /// What takes the place of a series that is not needed.
    pub const NONE: Series = Series { h: 0.0, q: 0.0, c: [0.0; SERIES] };

    /// Source: own interpolation of (f² - 1) / (u n / 2), u = 1 - c², at Chebyshev nodes of v = u (1 + q) / (1 + q u) and log n.
    /// Domain: n = 1/r in 1..100. Error: 2.3e-6 of f² - c² in exact arithmetic, 4e-6 of Lambda in single floats.
    /// q moves the nodes to where f bends: near c = 1 for large n, near c = 0 for n = 1, where f has a term c^4 log c.
    #[inline(always)]
    pub fn new(n: f32) -> Self {
        let s = log2(n) * (2.0 / LOG2_MOST) - 1.0;
        let mut c = [0.0; SERIES];
        for i in 0..SERIES {
            c[i] = chebyshev::<SERIES_COLUMNS>(&SHADOWING_SERIES[i], s);
        }
        Series { h: 0.5 * n, q: 0.25 * (n - 3.5), c }
    }

    /// (f² - 1) / u.
    #[inline(always)]
    fn rise(&self, u: f32) -> f32 {
        let v = u * (1.0 + self.q) / (1.0 + self.q * u);
        self.h * chebyshev::<SERIES>(&self.c, 2.0 * v - 1.0)
    }

    /// f(c) = c (1 + 2 Lambda(c)), as [`Exact::f`].
    #[inline(always)]
    pub fn f(&self, cos: f32) -> f32 {
        let u = (1.0 - cos) * (1.0 + cos);
        (1.0 + u * self.rise(u)).max(1.0).sqrt()
    }

    /// Lambda, as [`Exact::lambda`].
    #[inline(always)]
    pub fn lambda(&self, cos: f32) -> f32 {
        let c = cos.max(1e-30);
        let u = ((1.0 - c) * (1.0 + c)).max(0.0);
        let rise = self.rise(u);
        let f = (1.0 + u * rise).max(1.0).sqrt();
        (u * (1.0 + rise)).max(0.0) / (2.0 * c * (f + c))
    }
}

/// Constants of the published fit for one roughness.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
    twice_middle: f32,
}

impl Published {
    /// What takes the place of a fit that is not needed.
    pub const NONE: Published = Published { a: 0.0, b: 0.0, c: 0.0, d: 0.0, e: 0.0, twice_middle: 0.0 };

    /// Source: Estevez and Kulla 2017, Table 1 and its interpolation in (1 - r)². Domain: r 0.01..1.
    #[inline(always)]
    pub fn new(r: f32) -> Self {
        let t = (1.0 - r) * (1.0 - r);
        let mix = |p0: f32, p1: f32| t * p0 + (1.0 - t) * p1;
        let mut fit = Published {
            a: mix(25.3245, 21.5473),
            b: mix(3.32435, 3.82987),
            c: mix(0.16801, 0.19823),
            d: mix(-1.27393, -1.97760),
            e: mix(-4.85967, -4.32054),
            twice_middle: 0.0,
        };
        fit.twice_middle = 2.0 * fit.l(0.5);
        fit
    }

    #[inline(always)]
    fn l(&self, x: f32) -> f32 {
        let power = select(x > 0.0, power(x.max(f32::MIN_POSITIVE), self.c), 0.0);
        self.a / (1.0 + self.b * power) + self.d * x + self.e
    }

    /// Lambda of eq. 3. Domain: 0..1. Gives: about 1e-8 at c = 1, finite (3e7 at r = 1) at c = 0 where the truth is
    /// infinite: below c = 1e-5 this fit gains energy at every roughness.
    #[inline(always)]
    pub fn lambda(&self, cos: f32) -> f32 {
        let c = cos.clamp(0.0, 1.0);
        let low = c < 0.5;
        let l = self.l(select(low, c, 1.0 - c));
        exp(select(low, l, self.twice_middle - l))
    }
}

/// The light-side Lambda with a softer terminator.
///
/// Source: Estevez and Kulla 2017, eq. 4: Lambda^(1 + 2 (1 - cos)^8). Domain: Lambda >= 0, cos 0..1.
/// Gives: >= 0, at most 1e38. Degenerate cases: Lambda 0 stays 0.
#[inline(always)]
pub fn soften(lambda: f32, cos: f32) -> f32 {
    let x = 1.0 - cos;
    let x2 = x * x;
    let x4 = x2 * x2;
    select(lambda > 1e-37, power(lambda.max(1e-37), 1.0 + 2.0 * x4 * x4), 0.0)
}
