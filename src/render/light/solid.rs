//! Points of flat lights by the solid angle that they fill, instead of by their area.
//!
//! All corners are relative to the point that looks, so that this is the origin.
//!
//! Decision (2026-11-29): solid angles come from the tangents of half triangles, and places from sines and cosines of the
//! angles between planes, never from the angles themselves, in `f64`; instead of the sums of four arc cosines less a turn
//! that the sources have, which in `f32` put one point in ten at a wrong place where a light is thin or seen edge-on.

use crate::math::elementary::{atan2, sincos};
use glam::DVec3;

/// What fills less than this, in steradian, is sampled by area: it is seen edge-on, and may have no extent at all.
pub const LEAST: f32 = 3e-4;

/// A flat light as it is seen: a corner and two edges.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The corner.
    pub a: DVec3,
    /// An edge.
    pub b: DVec3,
    /// The other edge.
    pub c: DVec3,
}

impl Seen {
    /// The solid angle of the triangle.
    #[inline(always)]
    pub fn triangle(&self) -> f32 {
        let Seen { a, b, c } = *self;
        angle(a, a + b, a + c, a.dot(b.cross(c)).abs())
    }

    /// The solid angles of the halves of the parallelogram, cut between the ends of its edges: the near half and the far one.
    #[inline(always)]
    pub fn halves(&self) -> [f32; 2] {
        let Seen { a, b, c } = *self;
        let volume = a.dot(b.cross(c)).abs();
        [angle(a, a + b, a + c, volume), angle(a + b + c, a + b, a + c, volume)]
    }

    /// The far half as a triangle of its own: its edges run backward.
    pub fn far_half(&self) -> Seen {
        Seen { a: self.a + self.b + self.c, b: -self.b, c: -self.c }
    }

    /// A point of a rectangle of that solid angle, in parts of its edges.
    ///
    /// Source: C. Urena, M. Fajardo and A. King, "An Area-Preserving Parametrization for Spherical Rectangles", 2013.
    #[inline(always)]
    pub fn in_rectangle(&self, angle: f32, x: f32, y: f32) -> (f32, f32) {
        let Seen { a, b, c } = *self;
        let (lb, lc) = (b.length(), c.length());
        let (x0, y0) = (a.dot(b) / lb, a.dot(c) / lc);
        let (x1, y1) = (x0 + lb, y0 + lc);
        let depth = a.dot(b.cross(c)).abs() / (lb * lc);
        let across = |s: f64| s / (s * s + depth * depth).sqrt();
        // The heights of the normals of the planes through the edges, and the angles between those of the far side.
        let (n0, n1, n2) = (-across(y0), across(y1), -across(x0));
        let (cos_2, cos_3) = (-n1 * n2, -n2 * n0);
        let (sin_2, sin_3) = (sine(cos_2), sine(cos_3));
        // The turn less both of them is where the sample's angle begins.
        let (sin_k, cos_k) = (-(sin_2 * cos_3 + cos_2 * sin_3), cos_2 * cos_3 - sin_2 * sin_3);
        let (sin_part, cos_part) = turn(x * angle);
        let sin = sin_k * cos_part + cos_k * sin_part;
        let slope = ((cos_k * cos_part - sin_k * sin_part) * n0 - n1) / sin;
        let rest = (slope * slope + n0 * n0 - 1.0).max(1e-30);
        // Not `clamp`, whose check of its bounds keeps a loop from becoming SIMD: 47 ns a lane instead of 149.
        let at_x = (depth / rest.sqrt()).copysign(slope).max(x0).min(x1);
        let d2 = at_x * at_x + depth * depth;
        let (h0, h1) = (y0 / (d2 + y0 * y0).sqrt(), y1 / (d2 + y1 * y1).sqrt());
        let h = h0 + f64::from(y) * (h1 - h0);
        let at_y = (h * (d2 / (1.0 - h * h).max(1e-30)).sqrt()).max(y0).min(y1);
        (((at_x - x0) / lb) as f32, ((at_y - y0) / lc) as f32)
    }

    /// A point of a triangle of that solid angle, in parts of its edges.
    ///
    /// Source: J. Arvo, "Stratified Sampling of Spherical Triangles", 1995.
    #[inline]
    pub fn in_triangle(&self, angle: f32, x: f32, y: f32) -> (f32, f32) {
        let Seen { a, b, c } = *self;
        let [u, v, w] = [a, a + b, a + c].map(DVec3::normalize_or_zero);
        // From corner to corner without the rounding of u x v where both are close.
        let uv = a.cross(b).normalize_or_zero();
        let wu = c.cross(a).normalize_or_zero();
        let (cos_a, sin_a) = (-uv.dot(wu), uv.cross(wu).length());
        let (sin_part, cos_part) = turn(x * angle);
        // Half a turn and the part that the sample cuts off, less the angle at the first corner.
        let sin = cos_part * sin_a - sin_part * cos_a;
        let cos = -(cos_part * cos_a + sin_part * sin_a);
        let k1 = cos + cos_a;
        let k2 = sin - sin_a * u.dot(v);
        let q = (k2 + (k2 * cos - k1 * sin) * cos_a) / ((k2 * sin + k1 * cos) * sin_a);
        let q = if q.is_finite() { q.clamp(-1.0, 1.0) } else { 1.0 };
        let upright = |s: DVec3, of: DVec3| (s - of * s.dot(of)).normalize_or_zero();
        let cut = q * u + sine(q) * upright(w, u);
        let height = 1.0 - f64::from(y) * (1.0 - cut.dot(v));
        let direction = height * v + sine(height) * upright(cut, v);
        // Where the ray in that direction meets the triangle.
        let s = direction.cross(c);
        let below = s.dot(b);
        let inverse = if below != 0.0 { 1.0 / below } else { 0.0 };
        // What is no number becomes 0.
        let p = (-a.dot(s) * inverse).clamp(0.0, 1.0).max(0.0);
        let r = (direction.dot(b.cross(a)) * inverse).max(0.0).min(1.0 - p);
        (p as f32, r as f32)
    }
}

/// The solid angle of a triangle with corners `a`, `b`, `c`; `volume` is |a . (b x c)|.
///
/// Source: A. van Oosterom and J. Strackee, "The Solid Angle of a Plane Triangle", 1983, eq. 8.
#[inline(always)]
fn angle(a: DVec3, b: DVec3, c: DVec3, volume: f64) -> f32 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    // Of both only the ratio counts; it is brought to where f32 has its digits.
    let scale = 1.0 / (volume + below.abs()).max(f64::MIN_POSITIVE);
    2.0 * atan2((volume * scale) as f32, (below * scale) as f32)
}

/// Sine and cosine of an angle in [0, 2 pi], as good as the angle: a cosine near 1 has lost it in `f32`.
#[inline(always)]
fn turn(angle: f32) -> (f64, f64) {
    let (sin, cos) = sincos(0.25 * angle);
    let (sin, cos) = (f64::from(sin), f64::from(cos));
    let small = sin < cos;
    let (sin, cos) = (if small { sin } else { sine(cos) }, if small { sine(sin) } else { cos });
    let (sin, cos) = (2.0 * sin * cos, (cos - sin) * (cos + sin));
    (2.0 * sin * cos, (cos - sin) * (cos + sin))
}

#[inline(always)]
fn sine(cos: f64) -> f64 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{counts, random};

    /// Numbers that follow each other.
    struct Numbers(u32);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 += 1;
            f64::from(random::sample(random::pixel_seed(11, self.0, 0), 0, 0)[0])
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
        }
    }

    /// Lights near and far, wide and thin, from above and edge-on, with right angles or not.
    fn views(right: bool) -> impl Iterator<Item = Seen> {
        let mut numbers = Numbers(u32::from(right) * 1_000_000);
        (0..150).map(move |_| {
            let b = numbers.vector();
            let c = numbers.vector();
            let c = if right { c - b * (c.dot(b) / b.length_squared()) } else { c };
            let c = c * 10f64.powf(3.0 * numbers.next() - 1.5);
            let height = 10f64.powf(4.0 * numbers.next() - 3.0);
            let beside = b * (3.0 * numbers.next() - 1.0) + c * (3.0 * numbers.next() - 1.0);
            Seen { a: b.cross(c).normalize() * height - beside, b, c }
        })
    }

    /// A part of a light: `size` of each edge, from `x`, `y` on.
    fn part(seen: &Seen, x: f64, y: f64, size: f64) -> Seen {
        Seen { a: seen.a + x * seen.b + y * seen.c, b: size * seen.b, c: size * seen.c }
    }

    const CELLS: usize = 4;

    /// Counts points in 4 x 4 cells of the edges, and finds the solid angles of those.
    fn check(right: bool, lie: f64) -> (usize, usize) {
        const SAMPLES: u32 = 2000;
        let (mut wrong, mut all) = (0, 0);
        for seen in views(right) {
            let whole = if right { seen.halves().iter().sum() } else { seen.triangle() };
            if whole < LEAST {
                continue;
            }
            let (mut observed, mut expected) = ([0.0; CELLS * CELLS], [0.0; CELLS * CELLS]);
            for i in 0..SAMPLES {
                let [x, y, _, _] = random::sample(random::pixel_seed(5, i, 1), 0, 0);
                let (u, v) = if right { seen.in_rectangle(whole, x, y) } else { seen.in_triangle(whole, x, y) };
                let cell = [u, v].map(|a| ((a * CELLS as f32) as usize).min(CELLS - 1));
                observed[cell[1] * CELLS + cell[0]] += 1.0;
            }
            for (k, expected) in expected.iter_mut().enumerate() {
                let (x, y, size) = (k % CELLS, k / CELLS, 1.0 / CELLS as f64);
                let [near, far] = part(&seen, x as f64 * size, y as f64 * size, size).halves();
                // A cell at the long side of a triangle has its near half in it alone, one beyond has none.
                let near = if right || x + y < CELLS { near } else { 0.0 };
                let far = if right || x + y + 1 < CELLS { far } else { 0.0 };
                let lie = if x < CELLS / 2 { lie } else { 1.0 };
                *expected = lie * f64::from(near + far) / f64::from(whole) * f64::from(SAMPLES);
            }
            all += 1;
            wrong += usize::from(counts::deviation(&observed, &expected) > 4.5);
        }
        (wrong, all)
    }

    #[test]
    fn points_come_as_often_as_their_solid_angle_says() {
        for right in [true, false] {
            let (wrong, all) = check(right, 1.0);
            assert!(wrong == 0 && all > 70, "{wrong} of {all}");
            let (wrong, all) = check(right, 1.3);
            assert!(5 * wrong > all, "a density that is wrong must be found: {wrong} of {all}");
        }
    }

    #[test]
    fn solid_angles_are_those_of_formulas() {
        let octant = Seen { a: DVec3::X, b: DVec3::Y - DVec3::X, c: DVec3::Z - DVec3::X };
        assert!((octant.triangle() - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        // A face of a cube around the point is a sixth of all, and so it stays if it is cut askew.
        let face = Seen { a: DVec3::new(-1.0, -1.0, 1.0), b: DVec3::X * 2.0, c: DVec3::Y * 2.0 };
        assert!((face.halves().iter().sum::<f32>() - 2.0 / 3.0 * std::f32::consts::PI).abs() < 1e-6);
        // Far away it is area over distance squared, to the last digit.
        let far = Seen { a: DVec3::new(0.0, 0.0, 1e4), b: DVec3::X, c: DVec3::Y };
        assert!((far.halves().iter().sum::<f32>() / 1e-8 - 1.0).abs() < 1e-6);
    }
}
