//! The sheen in f64, straight from its formulas: what the fast evaluators are measured against.

use crate::math::quadrature::{gauss_legendre, tanh_sinh};
use std::f64::consts::{PI, TAU};

/// A shadowing term of the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Smith's term by the hypergeometric series.
    Exact,
    /// Smith's term by the fit that the fast evaluator uses.
    ExactFit,
    /// The published fit.
    Published,
    /// The visibility of Ashikhmin and Premoze.
    Ashikhmin,
}

/// f(c) = c (1 + 2 Lambda) = 2F1(-1/2, -n/2; 1; 1 - c²) by its series.
///
/// Source: own derivation from the projected-area normalisation of D. Domain: c 0..1, n >= 1.
/// Gives: relative error below 1e-9. The series converges for all u <= 1 because 1 + 1/2 + n/2 > 0.
/// Beyond n = 12 its terms cancel, so Gauss's contiguous relation climbs from small n instead.
pub fn exact_f(cos: f64, n: f64) -> f64 {
    let u = 1.0 - cos * cos;
    if n <= 12.0 {
        return series(u, n);
    }
    let half = 0.5 * n;
    let mut m = half - half.floor() + 1.0;
    let (mut before, mut here) = (series(u, 2.0 * m - 2.0), series(u, 2.0 * m));
    while m < half - 0.5 {
        (before, here) = (here, ((2.0 * m + 1.0 - (m - 0.5) * u) * here - m * (1.0 - u) * before) / (m + 1.0));
        m += 1.0;
    }
    here
}

/// 2F1(-1/2, -n/2; 1; u), n up to 12. Near u = 1 the series takes thousands of terms and an integral takes its place.
fn series(u: f64, n: f64) -> f64 {
    if u > 0.95 {
        return around_the_circle(u, n);
    }
    let (mut term, mut sum) = (1.0f64, 1.0f64);
    for k in 0..400_000 {
        let k = f64::from(k);
        term *= (k - 0.5) * (k - 0.5 * n) / ((k + 1.0) * (k + 1.0)) * u;
        sum += term;
        // The tail of an algebraic series is about k/2 times its term.
        if term.abs() * (1.0 + 0.5 * k) < 1e-13 * sum.abs() && k > n {
            break;
        }
    }
    sum
}

/// 2F1(-1/2, -n/2; 1; u) as the constant term of (1 - sqrt(u) z)^(1/2) (1 - sqrt(u) / z)^(n/2) on the unit circle.
///
/// Source: the product of two binomial series. Domain: u 0..1, n 1..12; beyond it the integrand cancels.
/// Gives: relative error below 1e-10.
fn around_the_circle(u: f64, n: f64) -> f64 {
    let x = u.sqrt();
    let (rest, m) = ((1.0 - u) / (1.0 + x), 0.5 * n);
    let mut sum = 0.0;
    for node in tanh_sinh(45, 0.0, PI) {
        let s = (0.5 * node.x).sin();
        let (re, im) = (rest + 2.0 * x * s * s, x * node.x.sin());
        sum += node.weight * re.hypot(im).powf(m + 0.5) * ((m - 0.5) * im.atan2(re)).cos();
    }
    sum / PI
}

/// Lambda by the integral that defines it, without any closed form: cos (1 + Lambda) is the area that micronormals of
/// density D project toward the viewer.
///
/// Source: Smith 1967; the azimuth is integrated by hand, the elevation on both sides of the horizon of the viewer.
/// Domain: cos above 0 and below 1, r 0.01..1. Gives: error below 1e-11 / cos.
pub fn lambda_by_area(cos: f64, r: f64) -> f64 {
    let (sin, horizon) = (((1.0 - cos) * (1.0 + cos)).sqrt(), 0.5 * PI - cos.acos());
    let mut area = 0.0;
    for (a, b) in [(0.0, horizon), (horizon, 0.5 * PI)] {
        for node in tanh_sinh(48, a, b) {
            let (up, across) = (cos * node.x.cos(), sin * node.x.sin());
            let ring = if up >= across {
                PI * up
            } else {
                let edge = (-up / across).acos();
                up * edge + across * edge.sin()
            };
            let s = node.x.sin();
            area += node.weight * 2.0 * ring * s * distribution(s * s, r);
        }
    }
    area / cos - 1.0
}

/// f(c) by the fit with one root and one division.
pub fn fitted_f(cos: f64, n: f64) -> f64 {
    let (h, u) = (0.5 * n, 1.0 - cos * cos);
    let q = (n - 2.0) * (0.3083493155320879 + 0.030894748163257907 * n) / (1.0 + 0.10737898325540718 * n);
    let f2 = 2.0 / PI * (n + 1.5) + 0.08758643323763687 / (n + 1.9619560726578413);
    let p = (f2 - 1.0) * (1.0 + q) - h;
    (1.0 + u * (h + p * u) / (1.0 + q * u)).sqrt()
}

/// Lambda of the published fit, eq. 3 and Table 1.
pub fn published_lambda(cos: f64, r: f64) -> f64 {
    let t = (1.0 - r) * (1.0 - r);
    let mix = |a: f64, b: f64| t * a + (1.0 - t) * b;
    let (a, b, c) = (mix(25.3245, 21.5473), mix(3.32435, 3.82987), mix(0.16801, 0.19823));
    let (d, e) = (mix(-1.27393, -1.97760), mix(-4.85967, -4.32054));
    let l = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 { l(cos).exp() } else { (2.0 * l(0.5) - l(1.0 - cos)).exp() }
}

/// Lambda of a model; infinite at cos 0 where the truth is.
pub fn lambda(model: Model, cos: f64, r: f64) -> f64 {
    let n = 1.0 / r;
    match model {
        Model::Exact => ((exact_f(cos, n) / cos - 1.0) * 0.5).max(0.0),
        Model::ExactFit => ((fitted_f(cos, n) / cos - 1.0) * 0.5).max(0.0),
        Model::Published => published_lambda(cos, r),
        Model::Ashikhmin => 0.0,
    }
}

/// Eq. 4.
pub fn soften(lambda: f64, cos: f64) -> f64 {
    lambda.powf(1.0 + 2.0 * (1.0 - cos).powi(8))
}

/// G divided by 4 cos_i cos_o, for a viewer of this cosine and Lambda.
fn visibility(model: Model, soft: bool, ci: f64, (co, viewer): (f64, f64), r: f64) -> f64 {
    if model == Model::Ashikhmin {
        return 0.25 / (ci + co - ci * co);
    }
    let light = lambda(model, ci, r);
    let light = if soft { soften(light, ci) } else { light };
    1.0 / (4.0 * ci * co * (1.0 + light + viewer))
}

/// D of a squared sine.
pub fn distribution(sin2: f64, r: f64) -> f64 {
    (2.0 + 1.0 / r) / TAU * sin2.powf(0.5 / r)
}

/// f of two local unit directions, 1/sr; 0 below the horizon.
pub fn f(model: Model, soft: bool, wo: [f64; 3], wi: [f64; 3], r: f64) -> f64 {
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return 0.0;
    }
    let h: [f64; 3] = std::array::from_fn(|k| wo[k] + wi[k]);
    let across = h[0] * h[0] + h[1] * h[1];
    distribution(across / (across + h[2] * h[2]), r)
        * visibility(model, soft, wi[2], (wo[2], lambda(model, wo[2], r)), r)
}

/// Directional albedo by quadrature over light directions, view fixed.
///
/// Source: double-exponential rules in the cosine, split at the view's, and in the azimuth.
/// Gives: error below 1e-6 for 40 steps, 1e-5 for 32 and 1e-4 for 24, cosines from 1e-4 and r from 0.01.
pub fn albedo(model: Model, soft: bool, co: f64, r: f64, steps: usize) -> f64 {
    let so = ((1.0 - co) * (1.0 + co)).sqrt();
    let viewer = (co, lambda(model, co, r));
    let azimuths = tanh_sinh(steps + steps / 2, 0.0, 0.5 * PI);
    let mut sum = 0.0;
    let mut parts = vec![0.0, 0.5, 1.0];
    if co < 1.0 && co != 0.5 {
        parts.push(co);
        parts.sort_by(f64::total_cmp);
    }
    for part in parts.windows(2) {
        for node in tanh_sinh(steps, part[0], part[1]) {
            let ci = node.x;
            if ci <= 0.0 || ci >= 1.0 {
                continue;
            }
            let si = ((1.0 - ci) * (1.0 + ci)).sqrt();
            let difference = (ci - co) * (ci + co) / (so + si);
            let mut ring = 0.0;
            for azimuth in &azimuths {
                let s = azimuth.x.sin();
                let across = difference * difference + 4.0 * so * si * s * s;
                ring += azimuth.weight * distribution(across / (across + (co + ci) * (co + ci)), r);
            }
            sum += node.weight * 4.0 * ring * ci * visibility(model, soft, ci, viewer, r);
        }
    }
    sum
}

/// Mean of an albedo over the hemisphere: 2 times the integral of albedo times cosine, in the cube root of the cosine.
pub fn average(albedo: impl Fn(f64) -> f64) -> f64 {
    gauss_legendre(24, 0.0, 1.0).iter().map(|n| n.weight * 6.0 * n.x.powi(5) * albedo(n.x.powi(3))).sum()
}
