//! Simplex noise in one to four dimensions.
//!
//! Source: Gustavson 2005, "Simplex noise demystified", and his `sdnoise` for the gradient, with the hash, gradient tables and
//! scale factors of Open Shading Language. Domain: |x| < 2^30. Gives: signed noise in about
//! [-1, 1], and its gradient when `D` is the dimension (`D` = 0 gives none). Degenerate cases: NaN in, NaN out.
//! Departs from source: corners out of reach are multiplied by zero in place of being skipped, and the order of the
//! coordinates in four dimensions comes from counting comparisons in place of a table, so that there is no branch.
//!
//! The vector variants are the scalar noise with seeds 0, 1 and 2.

use super::Jet;
use super::lookup3::finish;
use crate::math::elementary::floor_and_rest;

/// Scale factors that bring the noise of each dimension to about [-1, 1], as OSL has them (found by experiment there).
const SCALE: [f32; 4] = [0.36, 64.0, 68.0, 54.0];

#[inline(always)]
fn cell_of(x: f32) -> i32 {
    floor_and_rest(x).0 as i32
}

#[inline(always)]
fn scramble(a: u32, b: u32, c: u32) -> u32 {
    finish(a, b, c ^ 0xdead_beef)
}

/// 1 or -1 when `index` is set in the first or second mask, else 0: a table of unit steps without a gather.
#[inline(always)]
fn step(index: u32, plus: u32, minus: u32) -> f32 {
    ((plus >> index) & 1) as f32 - ((minus >> index) & 1) as f32
}

/// Eight directions in the plane.
#[inline(always)]
fn gradient2(h: u32) -> [f32; 2] {
    let h = h & 7;
    [step(h, 0x8a, 0x15), step(h, 0x58, 0xa1)]
}

/// The twelve edges of the cube, four of them twice.
#[inline(always)]
fn gradient3(h: u32) -> [f32; 3] {
    let h = h & 15;
    [step(h, 0x1311, 0x2c44), step(h, 0x4622, 0x8988), step(h, 0x300f, 0xc0f0)]
}

/// The thirty-two edges of the hypercube.
#[inline(always)]
fn gradient4(h: u32) -> [f32; 4] {
    let h = h & 31;
    [
        step(h, 0x0f0f_0f00, 0xf0f0_f000),
        step(h, 0x3333_000f, 0xcccc_00f0),
        step(h, 0x5500_3333, 0xaa00_cccc),
        step(h, 0x0055_5555, 0x00aa_aaaa),
    ]
}

/// The contribution of one corner: (reach - r^2)^4 times the gradient ramp, and its derivative.
#[inline(always)]
fn corner<const N: usize, const D: usize>(reach: f32, offset: [f32; N], slope: [f32; N]) -> Jet<D> {
    let mut t = reach;
    for axis in 0..N {
        t -= offset[axis] * offset[axis];
    }
    let t = if t < 0.0 { 0.0 } else { t };
    let mut ramp = slope[0] * offset[0];
    for axis in 1..N {
        ramp += slope[axis] * offset[axis];
    }
    let square = t * t;
    let fourth = square * square;
    let fall = -8.0 * (square * t * ramp);
    let mut gradient = [0.0; D];
    for axis in 0..D {
        if axis < N {
            gradient[axis] = fall * offset[axis] + fourth * slope[axis];
        }
    }
    Jet { value: fourth * ramp, gradient }
}

#[inline(always)]
fn sum<const D: usize>(mut total: Jet<D>, more: Jet<D>) -> Jet<D> {
    total.value += more.value;
    for axis in 0..D {
        total.gradient[axis] += more.slope(axis);
    }
    total
}

/// A skewed cell and the point in it. The corners are methods and not closures, as only functions can be told to be inlined
/// always, without which a loop over lanes does not become SIMD.
struct Cell<const N: usize> {
    seed: u32,
    /// The point seen from the first corner.
    origin: [f32; N],
    index: [i32; N],
}

impl<const N: usize> Cell<N> {
    /// The point seen from the corner that is `step` cells away, and that corner's cell.
    #[inline(always)]
    fn seen(&self, back: f32, step: [i32; N]) -> ([f32; N], [u32; N]) {
        let (mut offset, mut cell) = ([0.0; N], [0; N]);
        for axis in 0..N {
            offset[axis] = self.origin[axis] - step[axis] as f32 + back;
            cell[axis] = self.index[axis].wrapping_add(step[axis]) as u32;
        }
        (offset, cell)
    }
}

impl Cell<2> {
    #[inline(always)]
    fn corner2<const D: usize>(&self, back: f32, a: i32, b: i32) -> Jet<D> {
        let (offset, [i, j]) = self.seen(back, [a, b]);
        corner(0.5, offset, gradient2(scramble(i, j, self.seed)))
    }
}

impl Cell<3> {
    /// The corner that steps along the axes whose rank is at least `least`.
    #[inline(always)]
    fn corner3<const D: usize>(&self, rank: [i32; 3], back: f32, least: i32) -> Jet<D> {
        let step = [(rank[0] >= least) as i32, (rank[1] >= least) as i32, (rank[2] >= least) as i32];
        let (offset, [i, j, k]) = self.seen(back, step);
        corner(0.5, offset, gradient3(scramble(i, j, scramble(k, self.seed, 0))))
    }
}

impl Cell<4> {
    /// The corner that steps along the axes whose rank is at least `least`.
    #[inline(always)]
    fn corner4<const D: usize>(&self, rank: [i32; 4], back: f32, least: i32) -> Jet<D> {
        let step = [
            (rank[0] >= least) as i32,
            (rank[1] >= least) as i32,
            (rank[2] >= least) as i32,
            (rank[3] >= least) as i32,
        ];
        let (offset, [i, j, k, l]) = self.seen(back, step);
        corner(0.5, offset, gradient4(scramble(i, j, scramble(k, l, self.seed))))
    }
}

/// Signed simplex noise of one coordinate.
#[inline(always)]
pub fn simplex1<const D: usize>(seed: u32, x: f32) -> Jet<D> {
    let i = cell_of(x);
    let x0 = x - i as f32;
    let slope = |i: i32| {
        let h = scramble(i as u32, seed, 0);
        let g = 1.0 + (h & 7) as f32;
        [if h & 8 != 0 { -g } else { g }]
    };
    let near = corner(1.0, [x0], slope(i));
    let far = corner(1.0, [x0 - 1.0], slope(i.wrapping_add(1)));
    sum(near, far).scaled(SCALE[0])
}

/// Signed simplex noise of two coordinates.
#[inline(always)]
pub fn simplex2<const D: usize>(seed: u32, x: f32, y: f32) -> Jet<D> {
    // (sqrt 3 - 1) / 2 skews triangles to squares, (3 - sqrt 3) / 6 takes it back.
    const SKEW: f32 = 0.366_025_4;
    const BACK: f32 = 0.211_324_87;
    let s = (x + y) * SKEW;
    let (i, j) = (cell_of(x + s), cell_of(y + s));
    let t = i.wrapping_add(j) as f32 * BACK;
    let x0 = x - (i as f32 - t);
    let y0 = y - (j as f32 - t);
    let lower = (x0 > y0) as i32;
    let cell = Cell { seed, origin: [x0, y0], index: [i, j] };
    let total = sum(cell.corner2(0.0, 0, 0), cell.corner2(BACK, lower, 1 - lower));
    sum(total, cell.corner2(2.0 * BACK, 1, 1)).scaled(SCALE[1])
}

/// Signed simplex noise of three coordinates.
#[inline(always)]
pub fn simplex3<const D: usize>(seed: u32, x: f32, y: f32, z: f32) -> Jet<D> {
    const SKEW: f32 = 1.0 / 3.0;
    const BACK: f32 = 1.0 / 6.0;
    let s = (x + y + z) * SKEW;
    let (i, j, k) = (cell_of(x + s), cell_of(y + s), cell_of(z + s));
    let t = i.wrapping_add(j).wrapping_add(k) as f32 * BACK;
    let x0 = x - (i as f32 - t);
    let y0 = y - (j as f32 - t);
    let z0 = z - (k as f32 - t);
    // How many of the others each coordinate passes; the corners are walked from the greatest to the least.
    let (xy, yz, xz) = ((x0 >= y0) as i32, (y0 >= z0) as i32, (x0 >= z0) as i32);
    let rank = [xy + xz, 1 - xy + yz, 2 - xz - yz];
    let cell = Cell { seed, origin: [x0, y0, z0], index: [i, j, k] };
    let total = sum(cell.corner3(rank, 0.0, 3), cell.corner3(rank, BACK, 2));
    let total = sum(total, cell.corner3(rank, 2.0 * BACK, 1));
    sum(total, cell.corner3(rank, 3.0 * BACK, 0)).scaled(SCALE[2])
}

/// Signed simplex noise of four coordinates.
#[inline(always)]
pub fn simplex4<const D: usize>(seed: u32, x: f32, y: f32, z: f32, w: f32) -> Jet<D> {
    // (sqrt 5 - 1) / 4 skews, (5 - sqrt 5) / 20 takes it back.
    const SKEW: f32 = 0.309_017;
    const BACK: f32 = 0.138_196_6;
    let s = (x + y + z + w) * SKEW;
    let cell = [cell_of(x + s), cell_of(y + s), cell_of(z + s), cell_of(w + s)];
    let [i, j, k, l] = cell;
    let t = i.wrapping_add(j).wrapping_add(k).wrapping_add(l) as f32 * BACK;
    let [x0, y0, z0, w0] = [x - (i as f32 - t), y - (j as f32 - t), z - (k as f32 - t), w - (l as f32 - t)];
    let (xy, xz, xw) = ((x0 > y0) as i32, (x0 > z0) as i32, (x0 > w0) as i32);
    let (yz, yw, zw) = ((y0 > z0) as i32, (y0 > w0) as i32, (z0 > w0) as i32);
    let rank = [xy + xz + xw, 1 - xy + yz + yw, 2 - xz - yz + zw, 3 - xw - yw - zw];
    let cell = Cell { seed, origin: [x0, y0, z0, w0], index: cell };
    let total = sum(cell.corner4(rank, 0.0, 4), cell.corner4(rank, BACK, 3));
    let total = sum(total, cell.corner4(rank, 2.0 * BACK, 2));
    let total = sum(total, cell.corner4(rank, 3.0 * BACK, 1));
    sum(total, cell.corner4(rank, 4.0 * BACK, 0)).scaled(SCALE[3])
}

/// Signed vector simplex noise of one coordinate.
#[inline(always)]
pub fn simplex1_vector<const D: usize>(x: f32) -> [Jet<D>; 3] {
    [simplex1(0, x), simplex1(1, x), simplex1(2, x)]
}

/// Signed vector simplex noise of two coordinates.
#[inline(always)]
pub fn simplex2_vector<const D: usize>(x: f32, y: f32) -> [Jet<D>; 3] {
    [simplex2(0, x, y), simplex2(1, x, y), simplex2(2, x, y)]
}

/// Signed vector simplex noise of three coordinates.
#[inline(always)]
pub fn simplex3_vector<const D: usize>(x: f32, y: f32, z: f32) -> [Jet<D>; 3] {
    [simplex3(0, x, y, z), simplex3(1, x, y, z), simplex3(2, x, y, z)]
}

/// Signed vector simplex noise of four coordinates.
#[inline(always)]
pub fn simplex4_vector<const D: usize>(x: f32, y: f32, z: f32, w: f32) -> [Jet<D>; 3] {
    [simplex4(0, x, y, z, w), simplex4(1, x, y, z, w), simplex4(2, x, y, z, w)]
}
