//! The two distributions of microfacets, their Smith terms, and the visible normals of GGX.

use crate::math::elementary::exp;
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::PI;

/// Widths of a distribution along the local x and y axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widths {
    /// GGX width along x.
    pub x: f32,
    /// GGX width along y.
    pub y: f32,
}

/// D of GGX, anisotropic.
///
/// Source: Trowbridge and Reitz 1975; Burley 2012. Domain: unit m, widths > 0. Gives: 1/sr, 0 below the horizon.
/// Degenerate cases: none; the form in slopes keeps its digits near the normal.
#[inline(always)]
pub fn ggx_d(m: Vec3, w: Widths) -> f32 {
    let (x, y) = (m.x / w.x, m.y / w.y);
    let e = (x * x + y * y + m.z * m.z).max(1e-15);
    let d = 1.0 / (PI * w.x * w.y * e * e);
    if m.z > 0.0 { d } else { 0.0 }
}

/// Smith's Lambda of GGX. Source: Heitz 2014, eq. 72 and 86. Domain: any direction, its side is ignored. Gives: >= 0.
#[inline(always)]
pub fn ggx_lambda(v: Vec3, w: Widths) -> f32 {
    let (x, y) = (w.x * v.x, w.y * v.y);
    let t2 = (x * x + y * y) / (v.z * v.z).max(1e-30);
    // (sqrt(1 + t²) - 1) / 2 loses digits at small t², this form does not.
    0.5 * t2 / ((1.0 + t2).sqrt() + 1.0)
}

/// D of Beckmann, anisotropic.
///
/// Source: Beckmann and Spizzichino 1963; Walter et al. 2007, eq. 25. Domain: unit m, widths > 0.
/// Gives: 1/sr, 0 at and below the horizon.
#[inline(always)]
pub fn beckmann_d(m: Vec3, w: Widths) -> f32 {
    let (x, y) = (m.x / w.x, m.y / w.y);
    let z2 = (m.z * m.z).max(1e-15);
    let d = exp(-(x * x + y * y) / z2) / (PI * w.x * w.y * z2 * z2);
    if m.z > 0.0 { d } else { 0.0 }
}

/// Smith's Lambda of Beckmann.
///
/// Source: Heitz 2014, eq. 68: with a = cot(theta)/alpha, (erf a - 1)/2 + exp(-a²)/(2 a sqrt pi), written as
/// exp(-a²) k(a) / (2 sqrt(pi) a (1 + 2 a²)) with a fitted k between 0.5 and 1, because the two terms cancel.
/// Domain: any direction, its side is ignored. Gives: >= 0. Constants: fitted on a 0..10, relative error 1.1e-6; beyond, exp(-a²) is 0.
#[inline(always)]
pub fn beckmann_lambda(v: Vec3, w: Widths) -> f32 {
    const K: [f32; 11] = [
        0.703_153_1,
        -0.198_582_09,
        0.390_397_64,
        0.222_628_46,
        -0.135_579_87,
        -0.002_856_928,
        0.038_634_453,
        -0.022_443_807,
        0.001_117_311_9,
        0.006_007_035_7,
        -0.002_475_452_6,
    ];
    let (x, y) = (w.x * v.x, w.y * v.y);
    let a = (v.z.abs() / (x * x + y * y).max(1e-30).sqrt()).clamp(1e-6, 10.0);
    let t = (1.0 / (1.0 + a) - 0.09) * (2.0 / 0.91) - 1.0;
    let mut k = K[10];
    for i in (0..10).rev() {
        k = k * t + K[i];
    }
    const INVERSE_ROOT_PI_HALF: f32 = 0.282_094_8;
    exp(-a * a) * k * INVERSE_ROOT_PI_HALF / (a * (1.0 + 2.0 * a * a))
}

/// A visible micronormal of GGX.
///
/// Source: Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3 and 4.
/// Domain: wo.z >= 0, numbers in [0, 1). Gives: unit m, m.z >= 0, density G1(wo) max(0, wo . m) D(m) / wo.z.
/// Degenerate cases: grazing wo is fine, the cap is then a hemisphere.
#[inline(always)]
pub fn sample_visible(wo: Vec3, w: Widths, u: f32, v: f32) -> Vec3 {
    let stretched = Vec3::new(wo.x * w.x, wo.y * w.y, wo.z);
    let view = stretched * (1.0 / stretched.dot(stretched).max(1e-30).sqrt());
    let (cos, sin) = turn(v);
    let z = (1.0 - u) * (1.0 + view.z) - view.z;
    let s = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let h = Vec3::new(s * cos + view.x, s * sin + view.y, z + view.z);
    let m = Vec3::new(h.x * w.x, h.y * w.y, h.z.max(0.0));
    m * (1.0 / m.dot(m).max(1e-30).sqrt())
}
