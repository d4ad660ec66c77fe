//! The sphere of directions unrolled to the unit square: equal areas stay equal, and there are no poles.
//!
//! The upper hemisphere (z > 0) is the diamond in the middle, the lower one is folded out into the corners.
//!
//! Source: P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", 2008.

use crate::math::elementary::{atan2, sincos};
use glam::Vec3;
use std::f32::consts::{FRAC_2_PI, FRAC_PI_4};

/// The unit direction of a point of the square, both coordinates in [0, 1].
#[inline]
pub fn direction(x: f32, y: f32) -> Vec3 {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let (au, av) = (u.abs(), v.abs());
    let above = 1.0 - (au + av);
    let r = 1.0 - above.abs();
    let turn = if r > 0.0 { (av - au) / r + 1.0 } else { 1.0 };
    let (sin, cos) = sincos(turn * FRAC_PI_4);
    let ring = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new((ring * cos).copysign(u), (ring * sin).copysign(v), (1.0 - r * r).copysign(above))
}

/// The point of the square of a unit direction, both coordinates in [0, 1].
#[inline]
pub fn place(direction: Vec3) -> [f32; 2] {
    let Vec3 { x, y, z } = direction.abs();
    // 1 - |z| without cancellation.
    let r = ((x * x + y * y) / (1.0 + z)).sqrt();
    let v = r * (atan2(y, x) * FRAC_2_PI);
    let u = r - v;
    let (u, v) = if direction.z < 0.0 { (1.0 - v, 1.0 - u) } else { (u, v) };
    let unit = |a: f32, sign: f32| (0.5 + 0.5 * a.copysign(sign)).clamp(0.0, 1.0);
    [unit(u, direction.x), unit(v, direction.y)]
}

/// The cell that lies where a step out of a grid of `side` cells a side leads; cells inside are their own.
#[inline]
pub fn wrapped(side: usize, x: isize, y: isize) -> [usize; 2] {
    let last = side as isize - 1;
    // Each side of the square is folded onto itself about its middle.
    let (x, y) = if x < 0 || x > last { (x.clamp(0, last), last - y) } else { (x, y) };
    let (x, y) = if y < 0 || y > last { (last - x, y.clamp(0, last)) } else { (x, y) };
    [x as usize, y as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: u32) -> impl Iterator<Item = [f32; 2]> {
        (0..count).map(|i| {
            let r = crate::render::random::sample(3, i, 0);
            [r[0], r[1]]
        })
    }

    #[test]
    fn a_point_goes_to_a_direction_and_back() {
        for [x, y] in points(100_000) {
            let d = direction(x, y);
            assert!((d.length() - 1.0).abs() < 1e-6);
            let [a, b] = place(d);
            assert!((a - x).abs().max((b - y).abs()) < 3e-6, "{x} {y}: {a} {b}");
        }
        for d in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            let [a, b] = place(d);
            assert!((direction(a, b) - d).length() < 1e-6, "{d}: {a} {b}");
        }
    }

    /// The mean of z and of products of coordinates over uniform directions: 0 and a third of the identity.
    #[test]
    fn areas_are_kept() {
        const SIDE: usize = 512;
        let (mut mean, mut squares) = (glam::DVec3::ZERO, glam::DVec3::ZERO);
        for i in 0..SIDE * SIDE {
            let d = direction((i % SIDE) as f32 / SIDE as f32, (i / SIDE) as f32 / SIDE as f32);
            let d = d.as_dvec3() / (SIDE * SIDE) as f64;
            mean += d;
            squares += d * d * (SIDE * SIDE) as f64;
        }
        assert!(mean.abs().max_element() < 3e-3, "{mean}");
        assert!((squares - 1.0 / 3.0).abs().max_element() < 3e-3, "{squares}");
    }

    /// Whatever is half a degree wide holds the centre of a cell, wherever it stands.
    #[test]
    fn a_cell_is_smaller_than_a_sun() {
        const SIDE: usize = crate::render::sky::LEAST_SIDE as usize;
        let mut farthest = 0.0f32;
        for [x, y] in points(100_000) {
            let d = direction(x, y);
            let cell = [x, y].map(|a| (a * SIDE as f32) as isize);
            let around = (0..9).map(|k| wrapped(SIDE, cell[0] + k % 3 - 1, cell[1] + k / 3 - 1));
            let centres =
                around.map(|[x, y]| direction((x as f32 + 0.5) / SIDE as f32, (y as f32 + 0.5) / SIDE as f32));
            farthest = farthest.max(centres.map(|c| (c - d).length()).fold(f32::INFINITY, f32::min));
        }
        assert!(2.0 * farthest.to_degrees() < 0.4, "{}", 2.0 * farthest.to_degrees());
    }

    #[test]
    fn a_step_over_the_edge_is_a_small_one() {
        const SIDE: usize = 64;
        let centre = |[x, y]: [usize; 2]| direction((x as f32 + 0.5) / SIDE as f32, (y as f32 + 0.5) / SIDE as f32);
        for k in 0..SIDE as isize {
            for (inside, outside) in [((0, k), (-1, k)), ((63, k), (64, k)), ((k, 0), (k, -1)), ((k, 63), (k, 64))] {
                let step = centre(wrapped(SIDE, inside.0, inside.1)) - centre(wrapped(SIDE, outside.0, outside.1));
                assert!(step.length() < 0.1, "{inside:?}: {step}");
            }
        }
    }
}
