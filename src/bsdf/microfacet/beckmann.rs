//! Facets of Beckmann and Spizzichino.

use super::distribution::{Distribution, Widths, normal_of_slope};
use super::geometry::Facets;
use crate::bsdf::power;
use crate::math::elementary::exp;
use crate::math::warp::turn;
use glam::Vec3;
use std::f32::consts::PI;

/// Polynomial of k(a), fitted on a 0..10.
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

/// Beckmann's distribution of slopes, anisotropic.
#[derive(Clone, Copy, Debug)]
pub struct Beckmann(pub Widths);

impl Distribution for Beckmann {
    const FACETS: Facets = Facets::Beckmann;

    #[inline(always)]
    fn new(widths: Widths) -> Self {
        Beckmann(widths)
    }

    #[inline(always)]
    fn widths(&self) -> Widths {
        self.0
    }

    /// Source: Beckmann and Spizzichino 1963; Walter et al. 2007, eq. 25. Domain: unit m, widths > 0.
    /// Gives: 1/sr, 0 at and below the horizon.
    #[inline(always)]
    fn d(&self, m: Vec3) -> f32 {
        let w = self.0;
        let (x, y) = (m.x / w.x, m.y / w.y);
        let z2 = (m.z * m.z).max(1e-15);
        let d = exp(-(x * x + y * y) / z2) / (PI * w.x * w.y * z2 * z2);
        if m.z > 0.0 { d } else { 0.0 }
    }

    /// Source: Heitz 2014, eq. 68: with a = cot(theta)/alpha, (erf a - 1)/2 + exp(-a²)/(2 a sqrt pi), written as
    /// exp(-a²) k(a) / (2 sqrt(pi) a (1 + 2 a²)) with a fitted k between 0.5 and 1, because the two terms cancel.
    /// Domain: any direction, its side is ignored. Gives: >= 0. Constants: relative error 1.1e-6; beyond 10, exp(-a²) is 0.
    #[inline(always)]
    fn lambda(&self, v: Vec3) -> f32 {
        const INVERSE_ROOT_PI_HALF: f32 = 0.282_094_8;
        let (x, y) = (self.0.x * v.x, self.0.y * v.y);
        let a = (v.z.abs() / (x * x + y * y).max(1e-30).sqrt()).clamp(1e-6, 10.0);
        let t = (1.0 / (1.0 + a) - 0.09) * (2.0 / 0.91) - 1.0;
        let mut k = K[10];
        for i in (0..10).rev() {
            k = k * t + K[i];
        }
        exp(-a * a) * k * INVERSE_ROOT_PI_HALF / (a * (1.0 + 2.0 * a * a))
    }

    /// Source: Walter et al. 2007, eq. 28, stretched to two widths.
    #[inline(always)]
    fn sample_normal(&self, u: f32, v: f32) -> Vec3 {
        let ln = power::log2((1.0 - u).max(1e-8)) * std::f32::consts::LN_2;
        normal_of_slope(self.0, -ln, turn(v))
    }
}
