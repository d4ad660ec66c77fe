//! Noise over lanes.

use super::run::Run;
use crate::ir::op::{Noise, NoiseKind};
use crate::ir::program::Reg;
use crate::lanes;
use crate::math::columns::copy_block;
use crate::math::noise::cell::*;
use crate::math::noise::gabor::Gabor;
use crate::math::noise::perlin::*;
use crate::math::noise::simplex::*;
use crate::math::noise::{Endless, Jet, Periodic, unsigned};

/// How many lanes are computed at a time: a few vectors of the widest kind.
const BLOCK: usize = 16;

/// Coordinates, and periods behind them, of the lanes of one block.
type Block = [[f32; BLOCK]; 8];

/// Writes the jets of all lanes: values first, then gradients.
///
/// Coordinates and results pass through arrays of a fixed length, because only then does the compiler turn the many
/// steps of a noise into SIMD.
#[inline(always)]
fn write<const D: usize, const O: usize>(
    out: &mut [Vec<f32>],
    columns: &[&[f32]],
    bias: bool,
    jet: impl Fn(&Block, usize) -> [Jet<D>; O],
) {
    let lanes = out[0].len();
    let mut x = [[0.0; BLOCK]; 8];
    let mut values = [[0.0; BLOCK]; O];
    let mut gradients = [[[0.0; BLOCK]; D]; O];
    for first in (0..lanes).step_by(BLOCK) {
        let count = BLOCK.min(lanes - first);
        for (slot, column) in x.iter_mut().zip(columns) {
            match column.len() {
                1 => *slot = [column[0]; BLOCK],
                _ => copy_block::<BLOCK>(&mut slot[..count], &column[first..first + count]),
            }
        }
        // Lanes beyond the last one are computed as well: a loop of a known length is worth more than they cost.
        for l in 0..BLOCK {
            let jets = jet(&x, l);
            for o in 0..O {
                let jet = if bias { unsigned(jets[o]) } else { jets[o] };
                values[o][l] = jet.value;
                for d in 0..D {
                    gradients[o][d][l] = jet.gradient[d];
                }
            }
        }
        for o in 0..O {
            copy_block::<BLOCK>(&mut out[o][first..first + count], &values[o][..count]);
            for d in 0..D {
                copy_block::<BLOCK>(&mut out[O + o * D + d][first..first + count], &gradients[o][d][..count]);
            }
        }
    }
}

/// One noise function by its number of dimensions, for one or three results.
macro_rules! by_dims {
    ($noise:ident, $out:ident, $columns:ident, $bias:expr, |$x:ident, $lane:ident|
     $($dims:literal => $scalar:expr, $vector:expr);+) => {
        match ($noise.dims, $noise.outputs, $noise.gradient) {
            $(($dims, 1, false) => write::<0, 1>($out, $columns, $bias, |$x: &Block, $lane| [$scalar]),
              ($dims, 1, true) => write::<$dims, 1>($out, $columns, $bias, |$x: &Block, $lane| [$scalar]),
              ($dims, _, false) => write::<0, 3>($out, $columns, $bias, |$x: &Block, $lane| $vector),
              ($dims, _, true) => write::<$dims, 3>($out, $columns, $bias, |$x: &Block, $lane| $vector),)+
            _ => {}
        }
    };
}

lanes! {
    fn perlin(noise: Noise, out: &mut [Vec<f32>], columns: &[&[f32]], bias: bool) {
        by_dims!(noise, out, columns, bias, |x, l|
            1 => perlin1(Endless, x[0][l]), perlin1_vector(Endless, x[0][l]);
            2 => perlin2(Endless, x[0][l], x[1][l]), perlin2_vector(Endless, x[0][l], x[1][l]);
            3 => perlin3(Endless, x[0][l], x[1][l], x[2][l]),
                 perlin3_vector(Endless, x[0][l], x[1][l], x[2][l]);
            4 => perlin4(Endless, x[0][l], x[1][l], x[2][l], x[3][l]),
                 perlin4_vector(Endless, x[0][l], x[1][l], x[2][l], x[3][l]));
    }
}

lanes! {
    fn perlin_periodic(noise: Noise, out: &mut [Vec<f32>], columns: &[&[f32]], bias: bool) {
        let p1 = |x: &Block, l: usize| Periodic::new([x[1][l]]);
        let p2 = |x: &Block, l: usize| Periodic::new([x[2][l], x[3][l]]);
        let p3 = |x: &Block, l: usize| Periodic::new([x[3][l], x[4][l], x[5][l]]);
        let p4 = |x: &Block, l: usize| Periodic::new([x[4][l], x[5][l], x[6][l], x[7][l]]);
        by_dims!(noise, out, columns, bias, |x, l|
            1 => perlin1(p1(x, l), x[0][l]), perlin1_vector(p1(x, l), x[0][l]);
            2 => perlin2(p2(x, l), x[0][l], x[1][l]), perlin2_vector(p2(x, l), x[0][l], x[1][l]);
            3 => perlin3(p3(x, l), x[0][l], x[1][l], x[2][l]),
                 perlin3_vector(p3(x, l), x[0][l], x[1][l], x[2][l]);
            4 => perlin4(p4(x, l), x[0][l], x[1][l], x[2][l], x[3][l]),
                 perlin4_vector(p4(x, l), x[0][l], x[1][l], x[2][l], x[3][l]));
    }
}

lanes! {
    fn simplex(noise: Noise, out: &mut [Vec<f32>], columns: &[&[f32]], bias: bool) {
        by_dims!(noise, out, columns, bias, |x, l|
            1 => simplex1(0, x[0][l]), simplex1_vector(x[0][l]);
            2 => simplex2(0, x[0][l], x[1][l]), simplex2_vector(x[0][l], x[1][l]);
            3 => simplex3(0, x[0][l], x[1][l], x[2][l]), simplex3_vector(x[0][l], x[1][l], x[2][l]);
            4 => simplex4(0, x[0][l], x[1][l], x[2][l], x[3][l]),
                 simplex4_vector(x[0][l], x[1][l], x[2][l], x[3][l]));
    }
}

/// A jet without gradient.
#[inline(always)]
fn flat(value: f32) -> Jet<0> {
    Jet { value, gradient: [] }
}

/// Cell and hash noise have no gradient, so one arm a shape is enough.
macro_rules! flat_by_dims {
    ($noise:ident, $out:ident, $columns:ident, |$x:ident, $lane:ident| $($dims:literal => $scalar:expr, $vector:expr);+) => {
        match ($noise.dims, $noise.outputs) {
            $(($dims, 1) => write::<0, 1>($out, $columns, false, |$x: &Block, $lane| [flat($scalar)]),
              ($dims, _) => write::<0, 3>($out, $columns, false, |$x: &Block, $lane| $vector.map(flat)),)+
            _ => {}
        }
    };
}

lanes! {
    fn cell(noise: Noise, out: &mut [Vec<f32>], columns: &[&[f32]]) {
        flat_by_dims!(noise, out, columns, |x, l|
            1 => cell1(x[0][l]), cell1_vector(x[0][l]);
            2 => cell2(x[0][l], x[1][l]), cell2_vector(x[0][l], x[1][l]);
            3 => cell3(x[0][l], x[1][l], x[2][l]), cell3_vector(x[0][l], x[1][l], x[2][l]);
            4 => cell4(x[0][l], x[1][l], x[2][l], x[3][l]),
                 cell4_vector(x[0][l], x[1][l], x[2][l], x[3][l]));
    }
}

lanes! {
    fn hash(noise: Noise, out: &mut [Vec<f32>], columns: &[&[f32]]) {
        flat_by_dims!(noise, out, columns, |x, l|
            1 => hash1_noise(x[0][l]), hash1_vector(x[0][l]);
            2 => hash2_noise(x[0][l], x[1][l]), hash2_vector(x[0][l], x[1][l]);
            3 => hash3_noise(x[0][l], x[1][l], x[2][l]), hash3_vector(x[0][l], x[1][l], x[2][l]);
            4 => hash4_noise(x[0][l], x[1][l], x[2][l], x[3][l]),
                 hash4_vector(x[0][l], x[1][l], x[2][l], x[3][l]));
    }
}

/// Gabor noise lane by lane; a lane costs hundreds of steps, so there is nothing to gain by columns. A fourth coordinate moves the seed
/// from one whole number to the next, with the values of both joined.
fn gabor<'r>(noise: Noise, out: &mut [Vec<f32>], src: &[Reg], column: impl Fn(Reg) -> &'r [f32]) {
    let (dims, outputs) = (noise.dims as usize, noise.outputs as usize);
    let options = dims * if noise.periodic { 2 } else { 1 };
    for lane in 0..out[0].len() {
        let at = |i: usize| {
            let column = column(src[i]);
            if column.len() == 1 { column[0] } else { column[lane] }
        };
        let coordinate = |i: usize| if i < dims { at(i) } else { 0.0 };
        let period = |i: usize| if noise.periodic && i < dims { at(dims + i) } else { 0.0 };
        let kind = Gabor {
            direction: std::array::from_fn(|c| at(options + c)),
            bandwidth: at(options + 3),
            impulses: at(options + 4),
            anisotropic: at(options + 5) as i32,
            period: std::array::from_fn(period),
            pixel: noise.filtered.then(|| {
                let flat = dims.min(3);
                let change = |axis: usize, c: usize| if c < flat { at(options + 6 + axis * flat + c) } else { 0.0 };
                [0, 1].map(|axis| std::array::from_fn(|c| change(axis, c)))
            }),
        };
        let p = std::array::from_fn(coordinate);
        let time = coordinate(3);
        for o in 0..outputs {
            let whole = time.floor();
            let seed = |step: f32| (o as u32).wrapping_add(((whole + step) as i32 as u32).wrapping_mul(0x85eb_ca6b));
            let (mut jet, part) = (kind.at(p, seed(0.0)), time - whole);
            let mut along_time = 0.0;
            if dims == 4 && part.is_finite() {
                let next = kind.at(p, seed(1.0));
                along_time = next.value - jet.value;
                jet.value += part * along_time;
                (0..3).for_each(|c| jet.gradient[c] += part * (next.gradient[c] - jet.gradient[c]));
            }
            out[o][lane] = jet.value;
            if noise.gradient {
                for d in 0..dims {
                    out[outputs + o * dims + d][lane] = if d < 3 { jet.gradient[d] } else { along_time };
                }
            }
        }
    }
}

impl Run<'_> {
    pub(super) fn noise(&mut self, noise: Noise, dst: &[Reg], src: &[Reg]) {
        let mut out = std::mem::take(&mut self.s.columns);
        out.extend(dst.iter().map(|reg| std::mem::take(&mut self.regs.floats[reg.0 as usize])));
        // Four coordinates and their four periods at most.
        let mut x: [&[f32]; 8] = [&[]; 8];
        for (slot, &reg) in x.iter_mut().zip(src) {
            *slot = self.regs.f(reg);
        }
        let x = &x[..src.len().min(8)];
        match noise.kind {
            NoiseKind::Perlin | NoiseKind::UPerlin => {
                let bias = noise.kind == NoiseKind::UPerlin;
                let run = if noise.periodic { perlin_periodic } else { perlin };
                run(noise, &mut out, x, bias);
            }
            NoiseKind::Simplex => simplex(noise, &mut out, x, false),
            NoiseKind::USimplex => simplex(noise, &mut out, x, true),
            NoiseKind::Cell => cell(noise, &mut out, x),
            NoiseKind::Hash => hash(noise, &mut out, x),
            NoiseKind::Gabor => gabor(noise, &mut out, src, |reg| self.regs.f(reg)),
        }
        for (reg, column) in dst.iter().zip(out.drain(..)) {
            self.regs.floats[reg.0 as usize] = column;
        }
        self.s.columns = out;
    }
}
