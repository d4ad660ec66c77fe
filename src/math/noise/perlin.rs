//! Perlin's gradient noise in one to four dimensions.
//!
//! Source: Perlin 2002, "Improving Noise", with the hash, gradients and scale factors of Open Shading Language.
//! Domain: coordinates within the range of `i32`; beyond, cells repeat. Gives: signed noise in about [-1, 1], zero at
//! every lattice point, and its gradient when `D` is the dimension (`D` = 0 gives none). Degenerate cases: NaN in, NaN out.
//! Departs from source: the order of interpolation (z, x, y, w) is OSL's on machines with SIMD; another order would differ in
//! the last bit. OSL's derivatives go through dual numbers; these are the analytic gradient, and equal up to rounding.
//!
//! The vector variants need one hash a corner: each component uses another byte of it.

use super::lookup3::{hash1, hash2, hash3, hash4};
use super::{Jet, Lattice};
use crate::math::elementary::floor_to_int;

/// Scale factors that bring the noise of each dimension to about [-1, 1], as OSL has them (found by experiment there).
const SCALE: [f32; 4] = [0.2500, 0.6616, 0.9820, 0.8344];

/// One coordinate, split: its cell, the fraction in it, the faded weight of the far side and that weight's slope.
#[derive(Clone, Copy)]
struct Axis {
    cell: i32,
    fraction: f32,
    weight: f32,
    slope: f32,
}

impl Axis {
    #[inline(always)]
    fn new(x: f32) -> Axis {
        let cell = floor_to_int(x);
        let t = x - cell as f32;
        let weight = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let slope = 30.0 * t * t * (t * (t - 2.0) + 1.0);
        Axis { cell, fraction: t, weight, slope }
    }

    /// The coordinate seen from the near (0) or far (1) side of the cell.
    #[inline(always)]
    fn offset(&self, side: i32) -> f32 {
        if side == 0 { self.fraction } else { self.fraction - 1.0 }
    }

    #[inline(always)]
    fn cell(&self, side: i32) -> i32 {
        self.cell.wrapping_add(side)
    }

    /// Interpolates between the two sides; `axis` says which partial derivative gains the slope of the weight.
    #[inline(always)]
    fn between<const D: usize>(&self, axis: usize, near: Jet<D>, far: Jet<D>) -> Jet<D> {
        let value = near.value * (1.0 - self.weight) + far.value * self.weight;
        let mut gradient = [0.0; D];
        for k in 0..D {
            gradient[k] = near.gradient[k] * (1.0 - self.weight) + far.gradient[k] * self.weight;
        }
        if axis < D {
            gradient[axis] += (far.value - near.value) * self.slope;
        }
        Jet { value, gradient }
    }
}

/// Flips the sign of `x` when `bit` is set in the hash.
#[inline(always)]
fn signed(x: f32, hash: u32, bit: u32) -> f32 {
    f32::from_bits(x.to_bits() ^ ((hash << (31 - bit)) & 0x8000_0000))
}

/// `components` of a linear function, cut to the directions that are asked for.
#[inline(always)]
fn jet<const N: usize, const D: usize>(value: f32, components: [f32; N]) -> Jet<D> {
    let mut gradient = [0.0; D];
    for k in 0..D {
        if k < N {
            gradient[k] = components[k];
        }
    }
    Jet { value, gradient }
}

/// Slopes +-1 to +-8.
#[inline(always)]
fn gradient1<const D: usize>(hash: u32, x: f32) -> Jet<D> {
    let slope = signed(1.0 + (hash & 7) as f32, hash, 3);
    jet(slope * x, [slope])
}

/// The eight directions (+-1, +-2) and (+-2, +-1).
#[inline(always)]
fn gradient2<const D: usize>(hash: u32, x: f32, y: f32) -> Jet<D> {
    let steep = hash & 4 == 0;
    let (u, v) = if steep { (x, y) } else { (y, x) };
    let (du, dv) = (signed(1.0, hash, 0), signed(2.0, hash, 1));
    let components = if steep { [du, dv] } else { [dv, du] };
    jet(signed(u, hash, 0) + signed(2.0 * v, hash, 1), components)
}

/// The twelve edges of the cube, four of them twice.
#[inline(always)]
fn gradient3<const D: usize>(hash: u32, x: f32, y: f32, z: f32) -> Jet<D> {
    let h = hash & 15;
    let u_is_x = h < 8;
    let v_is_y = h < 4;
    let v_is_x = (h == 12) | (h == 14);
    let u = if u_is_x { x } else { y };
    let rest = if v_is_x { x } else { z };
    let v = if v_is_y { y } else { rest };
    let (du, dv) = (signed(1.0, hash, 0), signed(1.0, hash, 1));
    let dx = if u_is_x { du } else { 0.0 } + if v_is_x { dv } else { 0.0 };
    let dy = if u_is_x { 0.0 } else { du } + if v_is_y { dv } else { 0.0 };
    let dz = if v_is_y | v_is_x { 0.0 } else { dv };
    jet(signed(u, hash, 0) + signed(v, hash, 1), [dx, dy, dz])
}

/// The thirty-two edges of the hypercube.
#[inline(always)]
fn gradient4<const D: usize>(hash: u32, x: f32, y: f32, z: f32, w: f32) -> Jet<D> {
    let h = hash & 31;
    let (a, b, c) = (h < 24, h < 16, h < 8);
    let u = if a { x } else { y };
    let v = if b { y } else { z };
    let s = if c { z } else { w };
    let (du, dv, ds) = (signed(1.0, hash, 0), signed(1.0, hash, 1), signed(1.0, hash, 2));
    let dx = if a { du } else { 0.0 };
    let dy = if a { 0.0 } else { du } + if b { dv } else { 0.0 };
    let dz = if b { 0.0 } else { dv } + if c { ds } else { 0.0 };
    let dw = if c { 0.0 } else { ds };
    jet(signed(u, hash, 0) + signed(v, hash, 1) + signed(s, hash, 2), [dx, dy, dz, dw])
}

/// The noise of one dimension from the hashes of its two corners.
#[inline(always)]
fn blend1<const D: usize>(x: Axis, hash: impl Fn(i32) -> u32) -> Jet<D> {
    let corner = |i| gradient1(hash(i), x.offset(i));
    x.between(0, corner(0), corner(1)).scaled(SCALE[0])
}

#[inline(always)]
fn blend2<const D: usize>(x: Axis, y: Axis, hash: impl Fn(i32, i32) -> u32) -> Jet<D> {
    let corner = |i, j| gradient2(hash(i, j), x.offset(i), y.offset(j));
    let row = |j| x.between(0, corner(0, j), corner(1, j));
    y.between(1, row(0), row(1)).scaled(SCALE[1])
}

#[inline(always)]
fn blend3<const D: usize>(x: Axis, y: Axis, z: Axis, hash: impl Fn(i32, i32, i32) -> u32) -> Jet<D> {
    let corner = |i, j, k| gradient3(hash(i, j, k), x.offset(i), y.offset(j), z.offset(k));
    let column = |i, j| z.between(2, corner(i, j, 0), corner(i, j, 1));
    let row = |j| x.between(0, column(0, j), column(1, j));
    y.between(1, row(0), row(1)).scaled(SCALE[2])
}

#[inline(always)]
fn blend4<const D: usize>(x: Axis, y: Axis, z: Axis, w: Axis, hash: impl Fn(i32, i32, i32, i32) -> u32) -> Jet<D> {
    let corner = |i, j, k, l| gradient4(hash(i, j, k, l), x.offset(i), y.offset(j), z.offset(k), w.offset(l));
    let column = |i, j, l| z.between(2, corner(i, j, 0, l), corner(i, j, 1, l));
    let row = |j, l| x.between(0, column(0, j, l), column(1, j, l));
    let cube = |l| y.between(1, row(0, l), row(1, l));
    w.between(3, cube(0), cube(1)).scaled(SCALE[3])
}

#[inline(always)]
fn corner1(lattice: impl Lattice<1>, x: &Axis, i: i32) -> u32 {
    let [x] = lattice.cell([x.cell(i)]);
    hash1(x)
}

#[inline(always)]
fn corner2(lattice: impl Lattice<2>, x: &Axis, y: &Axis, i: i32, j: i32) -> u32 {
    let [x, y] = lattice.cell([x.cell(i), y.cell(j)]);
    hash2(x, y)
}

#[inline(always)]
fn corner3(lattice: impl Lattice<3>, x: &Axis, y: &Axis, z: &Axis, i: i32, j: i32, k: i32) -> u32 {
    let [x, y, z] = lattice.cell([x.cell(i), y.cell(j), z.cell(k)]);
    hash3(x, y, z)
}

#[inline(always)]
fn corner4(lattice: impl Lattice<4>, axes: &[Axis; 4], i: i32, j: i32, k: i32, l: i32) -> u32 {
    let [x, y, z, w] = lattice.cell([axes[0].cell(i), axes[1].cell(j), axes[2].cell(k), axes[3].cell(l)]);
    hash4(x, y, z, w)
}

/// Signed Perlin noise of one coordinate.
#[inline(always)]
pub fn perlin1<const D: usize>(lattice: impl Lattice<1>, x: f32) -> Jet<D> {
    let x = Axis::new(x);
    blend1(x, |i| corner1(lattice, &x, i))
}

/// Signed Perlin noise of two coordinates.
#[inline(always)]
pub fn perlin2<const D: usize>(lattice: impl Lattice<2>, x: f32, y: f32) -> Jet<D> {
    let (x, y) = (Axis::new(x), Axis::new(y));
    blend2(x, y, |i, j| corner2(lattice, &x, &y, i, j))
}

/// Signed Perlin noise of three coordinates.
#[inline(always)]
pub fn perlin3<const D: usize>(lattice: impl Lattice<3>, x: f32, y: f32, z: f32) -> Jet<D> {
    let (x, y, z) = (Axis::new(x), Axis::new(y), Axis::new(z));
    blend3(x, y, z, |i, j, k| corner3(lattice, &x, &y, &z, i, j, k))
}

/// Signed Perlin noise of four coordinates.
#[inline(always)]
pub fn perlin4<const D: usize>(lattice: impl Lattice<4>, x: f32, y: f32, z: f32, w: f32) -> Jet<D> {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z), Axis::new(w)];
    let [x, y, z, w] = axes;
    blend4(x, y, z, w, |i, j, k, l| corner4(lattice, &axes, i, j, k, l))
}

/// Signed vector Perlin noise of one coordinate.
#[inline(always)]
pub fn perlin1_vector<const D: usize>(lattice: impl Lattice<1>, x: f32) -> [Jet<D>; 3] {
    let x = Axis::new(x);
    let h = [corner1(lattice, &x, 0), corner1(lattice, &x, 1)];
    [0, 8, 16].map(|byte| blend1(x, |i| h[i as usize] >> byte))
}

/// Signed vector Perlin noise of two coordinates.
#[inline(always)]
pub fn perlin2_vector<const D: usize>(lattice: impl Lattice<2>, x: f32, y: f32) -> [Jet<D>; 3] {
    let (x, y) = (Axis::new(x), Axis::new(y));
    let at = |i, j| corner2(lattice, &x, &y, i, j);
    let h = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
    [0, 8, 16].map(|byte| blend2(x, y, |i, j| h[(i + 2 * j) as usize] >> byte))
}

/// Signed vector Perlin noise of three coordinates.
#[inline(always)]
pub fn perlin3_vector<const D: usize>(lattice: impl Lattice<3>, x: f32, y: f32, z: f32) -> [Jet<D>; 3] {
    let (x, y, z) = (Axis::new(x), Axis::new(y), Axis::new(z));
    let at = |i, j, k| corner3(lattice, &x, &y, &z, i, j, k);
    let face = |k| [at(0, 0, k), at(1, 0, k), at(0, 1, k), at(1, 1, k)];
    let h = [face(0), face(1)];
    [0, 8, 16].map(|byte| blend3(x, y, z, |i, j, k| h[k as usize][(i + 2 * j) as usize] >> byte))
}

/// Signed vector Perlin noise of four coordinates.
#[inline(always)]
pub fn perlin4_vector<const D: usize>(lattice: impl Lattice<4>, x: f32, y: f32, z: f32, w: f32) -> [Jet<D>; 3] {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z), Axis::new(w)];
    let [x, y, z, w] = axes;
    let at = |i, j, k, l| corner4(lattice, &axes, i, j, k, l);
    let face = |k, l| [at(0, 0, k, l), at(1, 0, k, l), at(0, 1, k, l), at(1, 1, k, l)];
    let h = [face(0, 0), face(1, 0), face(0, 1), face(1, 1)];
    [0, 8, 16].map(|byte| blend4(x, y, z, w, |i, j, k, l| h[(k + 2 * l) as usize][(i + 2 * j) as usize] >> byte))
}
