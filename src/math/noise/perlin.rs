//! Perlin's gradient noise in one to four dimensions.
//!
//! Source: Perlin 2002, "Improving Noise", with the hash, gradients and scale factors of Open Shading Language.
//! Domain: |x| < 2^38; cells repeat after 2^32. Gives: signed noise in about [-1, 1], zero at
//! every lattice point, and its gradient when `D` is the dimension (`D` = 0 gives none). Degenerate cases: NaN in, NaN out.
//! Departs from source: the order of interpolation (z, x, y, w) is OSL's on machines with SIMD; another order would differ in
//! the last bit. OSL's derivatives go through dual numbers; these are the analytic gradient, and equal up to rounding.
//!
//! The vector variants need one hash a corner: each component uses another byte of it.

use super::lookup3::{hash1, hash2, hash3, hash4};
use super::{Jet, Lattice};
use crate::math::elementary::floor_and_rest;

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
        let (cell, t) = floor_and_rest(x);
        let weight = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let slope = 30.0 * t * t * (t * (t - 2.0) + 1.0);
        Axis { cell: cell as i32, fraction: t, weight, slope }
    }

    /// The coordinate seen from the near (0) or far (1) side of the cell.
    #[inline(always)]
    fn offset(&self, side: usize) -> f32 {
        if side == 0 { self.fraction } else { self.fraction - 1.0 }
    }

    #[inline(always)]
    fn cell(&self, side: usize) -> i32 {
        self.cell.wrapping_add(side as i32)
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

// From here on corners are numbered i + 2j + 4k + 8l. These are functions and not closures because only functions can be told to
// be inlined always, and one call that is not inlined keeps the whole loop over lanes from becoming SIMD.

#[inline(always)]
fn blend1<const D: usize>(x: &Axis, h: &[u32; 2], byte: u32) -> Jet<D> {
    let near = gradient1(h[0] >> byte, x.offset(0));
    let far = gradient1(h[1] >> byte, x.offset(1));
    x.between(0, near, far).scaled(SCALE[0])
}

#[inline(always)]
fn row2<const D: usize>(x: &Axis, y: &Axis, h: &[u32; 4], byte: u32, j: usize) -> Jet<D> {
    let near = gradient2(h[2 * j] >> byte, x.offset(0), y.offset(j));
    let far = gradient2(h[2 * j + 1] >> byte, x.offset(1), y.offset(j));
    x.between(0, near, far)
}

#[inline(always)]
fn blend2<const D: usize>(x: &Axis, y: &Axis, h: &[u32; 4], byte: u32) -> Jet<D> {
    y.between(1, row2(x, y, h, byte, 0), row2(x, y, h, byte, 1)).scaled(SCALE[1])
}

#[inline(always)]
fn column3<const D: usize>([x, y, z]: &[Axis; 3], h: &[u32; 8], byte: u32, i: usize, j: usize) -> Jet<D> {
    let corner = i + 2 * j;
    let near = gradient3(h[corner] >> byte, x.offset(i), y.offset(j), z.offset(0));
    let far = gradient3(h[corner + 4] >> byte, x.offset(i), y.offset(j), z.offset(1));
    z.between(2, near, far)
}

#[inline(always)]
fn row3<const D: usize>(axes: &[Axis; 3], h: &[u32; 8], byte: u32, j: usize) -> Jet<D> {
    axes[0].between(0, column3(axes, h, byte, 0, j), column3(axes, h, byte, 1, j))
}

#[inline(always)]
fn blend3<const D: usize>(axes: &[Axis; 3], h: &[u32; 8], byte: u32) -> Jet<D> {
    axes[1].between(1, row3(axes, h, byte, 0), row3(axes, h, byte, 1)).scaled(SCALE[2])
}

#[inline(always)]
fn column4<const D: usize>(axes: &[Axis; 4], h: &[u32; 8], byte: u32, i: usize, j: usize, l: usize) -> Jet<D> {
    let [x, y, z, w] = axes;
    let corner = i + 2 * j;
    let near = gradient4(h[corner] >> byte, x.offset(i), y.offset(j), z.offset(0), w.offset(l));
    let far = gradient4(h[corner + 4] >> byte, x.offset(i), y.offset(j), z.offset(1), w.offset(l));
    z.between(2, near, far)
}

#[inline(always)]
fn row4<const D: usize>(axes: &[Axis; 4], h: &[u32; 8], byte: u32, j: usize, l: usize) -> Jet<D> {
    axes[0].between(0, column4(axes, h, byte, 0, j, l), column4(axes, h, byte, 1, j, l))
}

#[inline(always)]
fn cube4<const D: usize>(axes: &[Axis; 4], h: &[u32; 8], byte: u32, l: usize) -> Jet<D> {
    axes[1].between(1, row4(axes, h, byte, 0, l), row4(axes, h, byte, 1, l))
}

#[inline(always)]
fn blend4<const D: usize>(axes: &[Axis; 4], h: &[[u32; 8]; 2], byte: u32) -> Jet<D> {
    axes[3].between(3, cube4(axes, &h[0], byte, 0), cube4(axes, &h[1], byte, 1)).scaled(SCALE[3])
}

#[inline(always)]
fn corner1(lattice: impl Lattice<1>, x: &Axis, i: usize) -> u32 {
    let [x] = lattice.cell([x.cell(i)]);
    hash1(x)
}

#[inline(always)]
fn corners1(lattice: impl Lattice<1>, x: &Axis) -> [u32; 2] {
    [corner1(lattice, x, 0), corner1(lattice, x, 1)]
}

#[inline(always)]
fn corner2(lattice: impl Lattice<2>, x: &Axis, y: &Axis, i: usize, j: usize) -> u32 {
    let [x, y] = lattice.cell([x.cell(i), y.cell(j)]);
    hash2(x, y)
}

#[inline(always)]
fn corners2(lattice: impl Lattice<2>, x: &Axis, y: &Axis) -> [u32; 4] {
    [
        corner2(lattice, x, y, 0, 0),
        corner2(lattice, x, y, 1, 0),
        corner2(lattice, x, y, 0, 1),
        corner2(lattice, x, y, 1, 1),
    ]
}

#[inline(always)]
fn corner3(lattice: impl Lattice<3>, axes: &[Axis; 3], i: usize, j: usize, k: usize) -> u32 {
    let [x, y, z] = lattice.cell([axes[0].cell(i), axes[1].cell(j), axes[2].cell(k)]);
    hash3(x, y, z)
}

#[inline(always)]
fn corners3(lattice: impl Lattice<3>, axes: &[Axis; 3]) -> [u32; 8] {
    [
        corner3(lattice, axes, 0, 0, 0),
        corner3(lattice, axes, 1, 0, 0),
        corner3(lattice, axes, 0, 1, 0),
        corner3(lattice, axes, 1, 1, 0),
        corner3(lattice, axes, 0, 0, 1),
        corner3(lattice, axes, 1, 0, 1),
        corner3(lattice, axes, 0, 1, 1),
        corner3(lattice, axes, 1, 1, 1),
    ]
}

#[inline(always)]
fn corner4(lattice: impl Lattice<4>, axes: &[Axis; 4], i: usize, j: usize, k: usize, l: usize) -> u32 {
    let [x, y, z, w] = lattice.cell([axes[0].cell(i), axes[1].cell(j), axes[2].cell(k), axes[3].cell(l)]);
    hash4(x, y, z, w)
}

#[inline(always)]
fn corners4(lattice: impl Lattice<4>, axes: &[Axis; 4], l: usize) -> [u32; 8] {
    [
        corner4(lattice, axes, 0, 0, 0, l),
        corner4(lattice, axes, 1, 0, 0, l),
        corner4(lattice, axes, 0, 1, 0, l),
        corner4(lattice, axes, 1, 1, 0, l),
        corner4(lattice, axes, 0, 0, 1, l),
        corner4(lattice, axes, 1, 0, 1, l),
        corner4(lattice, axes, 0, 1, 1, l),
        corner4(lattice, axes, 1, 1, 1, l),
    ]
}

/// Signed Perlin noise of one coordinate.
#[inline(always)]
pub fn perlin1<const D: usize>(lattice: impl Lattice<1>, x: f32) -> Jet<D> {
    let x = Axis::new(x);
    blend1(&x, &corners1(lattice, &x), 0)
}

/// Signed Perlin noise of two coordinates.
#[inline(always)]
pub fn perlin2<const D: usize>(lattice: impl Lattice<2>, x: f32, y: f32) -> Jet<D> {
    let (x, y) = (Axis::new(x), Axis::new(y));
    blend2(&x, &y, &corners2(lattice, &x, &y), 0)
}

/// Signed Perlin noise of three coordinates.
#[inline(always)]
pub fn perlin3<const D: usize>(lattice: impl Lattice<3>, x: f32, y: f32, z: f32) -> Jet<D> {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z)];
    blend3(&axes, &corners3(lattice, &axes), 0)
}

/// Signed Perlin noise of four coordinates.
#[inline(always)]
pub fn perlin4<const D: usize>(lattice: impl Lattice<4>, x: f32, y: f32, z: f32, w: f32) -> Jet<D> {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z), Axis::new(w)];
    blend4(&axes, &[corners4(lattice, &axes, 0), corners4(lattice, &axes, 1)], 0)
}

/// Signed vector Perlin noise of one coordinate.
#[inline(always)]
pub fn perlin1_vector<const D: usize>(lattice: impl Lattice<1>, x: f32) -> [Jet<D>; 3] {
    let x = Axis::new(x);
    let h = corners1(lattice, &x);
    [blend1(&x, &h, 0), blend1(&x, &h, 8), blend1(&x, &h, 16)]
}

/// Signed vector Perlin noise of two coordinates.
#[inline(always)]
pub fn perlin2_vector<const D: usize>(lattice: impl Lattice<2>, x: f32, y: f32) -> [Jet<D>; 3] {
    let (x, y) = (Axis::new(x), Axis::new(y));
    let h = corners2(lattice, &x, &y);
    [blend2(&x, &y, &h, 0), blend2(&x, &y, &h, 8), blend2(&x, &y, &h, 16)]
}

/// Signed vector Perlin noise of three coordinates.
#[inline(always)]
pub fn perlin3_vector<const D: usize>(lattice: impl Lattice<3>, x: f32, y: f32, z: f32) -> [Jet<D>; 3] {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z)];
    let h = corners3(lattice, &axes);
    [blend3(&axes, &h, 0), blend3(&axes, &h, 8), blend3(&axes, &h, 16)]
}

/// Signed vector Perlin noise of four coordinates.
#[inline(always)]
pub fn perlin4_vector<const D: usize>(lattice: impl Lattice<4>, x: f32, y: f32, z: f32, w: f32) -> [Jet<D>; 3] {
    let axes = [Axis::new(x), Axis::new(y), Axis::new(z), Axis::new(w)];
    let h = [corners4(lattice, &axes, 0), corners4(lattice, &axes, 1)];
    [blend4(&axes, &h, 0), blend4(&axes, &h, 8), blend4(&axes, &h, 16)]
}
