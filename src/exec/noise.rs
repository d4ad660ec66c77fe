//! Noise over lanes.

use super::machine::Run;
use crate::ir::op::{Noise, NoiseKind};
use crate::ir::program::Reg;
use crate::math::noise::cell::*;
use crate::math::noise::perlin::*;
use crate::math::noise::simplex::*;
use crate::math::noise::{Endless, Jet, Periodic, unsigned};
use multiversion::multiversion;

/// A float column that may stand for all lanes.
#[derive(Clone, Copy)]
struct Column<'a>(&'a [f32]);

impl Column<'_> {
    #[inline(always)]
    fn at(&self, lane: usize) -> f32 {
        if self.0.len() == 1 { self.0[0] } else { self.0[lane] }
    }
}

/// Writes the jets of all lanes: values first, then gradients.
#[inline(always)]
fn write<const D: usize, const O: usize>(out: &mut [Vec<f32>], bias: bool, jet: impl Fn(usize) -> [Jet<D>; O]) {
    let lanes = out[0].len();
    for lane in 0..lanes {
        let jets = jet(lane);
        for o in 0..O {
            let jet = if bias { unsigned(jets[o]) } else { jets[o] };
            out[o][lane] = jet.value;
            for d in 0..D {
                out[O + o * D + d][lane] = jet.gradient[d];
            }
        }
    }
}

/// One noise function by its number of dimensions, for one or three results.
macro_rules! by_dims {
    ($noise:ident, $out:ident, $x:ident, $bias:expr, $lane:ident,
     $($dims:literal => $scalar:expr, $vector:expr);+) => {
        match ($noise.dims, $noise.outputs, $noise.gradient) {
            $(($dims, 1, false) => write::<0, 1>($out, $bias, |$lane| [$scalar]),
              ($dims, 1, true) => write::<$dims, 1>($out, $bias, |$lane| [$scalar]),
              ($dims, _, false) => write::<0, 3>($out, $bias, |$lane| $vector),
              ($dims, _, true) => write::<$dims, 3>($out, $bias, |$lane| $vector),)+
            _ => {}
        }
    };
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
fn perlin(noise: Noise, out: &mut [Vec<f32>], x: &[Column], bias: bool) {
    by_dims!(noise, out, x, bias, l,
        1 => perlin1(Endless, x[0].at(l)), perlin1_vector(Endless, x[0].at(l));
        2 => perlin2(Endless, x[0].at(l), x[1].at(l)), perlin2_vector(Endless, x[0].at(l), x[1].at(l));
        3 => perlin3(Endless, x[0].at(l), x[1].at(l), x[2].at(l)),
             perlin3_vector(Endless, x[0].at(l), x[1].at(l), x[2].at(l));
        4 => perlin4(Endless, x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)),
             perlin4_vector(Endless, x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)));
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
fn perlin_periodic(noise: Noise, out: &mut [Vec<f32>], x: &[Column], bias: bool) {
    let p1 = |l: usize| Periodic::new([x[1].at(l)]);
    let p2 = |l: usize| Periodic::new([x[2].at(l), x[3].at(l)]);
    let p3 = |l: usize| Periodic::new([x[3].at(l), x[4].at(l), x[5].at(l)]);
    let p4 = |l: usize| Periodic::new([x[4].at(l), x[5].at(l), x[6].at(l), x[7].at(l)]);
    by_dims!(noise, out, x, bias, l,
        1 => perlin1(p1(l), x[0].at(l)), perlin1_vector(p1(l), x[0].at(l));
        2 => perlin2(p2(l), x[0].at(l), x[1].at(l)), perlin2_vector(p2(l), x[0].at(l), x[1].at(l));
        3 => perlin3(p3(l), x[0].at(l), x[1].at(l), x[2].at(l)),
             perlin3_vector(p3(l), x[0].at(l), x[1].at(l), x[2].at(l));
        4 => perlin4(p4(l), x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)),
             perlin4_vector(p4(l), x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)));
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
fn simplex(noise: Noise, out: &mut [Vec<f32>], x: &[Column], bias: bool) {
    by_dims!(noise, out, x, bias, l,
        1 => simplex1(0, x[0].at(l)), simplex1_vector(x[0].at(l));
        2 => simplex2(0, x[0].at(l), x[1].at(l)), simplex2_vector(x[0].at(l), x[1].at(l));
        3 => simplex3(0, x[0].at(l), x[1].at(l), x[2].at(l)), simplex3_vector(x[0].at(l), x[1].at(l), x[2].at(l));
        4 => simplex4(0, x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)),
             simplex4_vector(x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)));
}

/// A jet without gradient.
#[inline(always)]
fn flat(value: f32) -> Jet<0> {
    Jet { value, gradient: [] }
}

/// Cell and hash noise have no gradient, so one arm a shape is enough.
macro_rules! flat_by_dims {
    ($noise:ident, $out:ident, $lane:ident, $($dims:literal => $scalar:expr, $vector:expr);+) => {
        match ($noise.dims, $noise.outputs) {
            $(($dims, 1) => write::<0, 1>($out, false, |$lane| [flat($scalar)]),
              ($dims, _) => write::<0, 3>($out, false, |$lane| $vector.map(flat)),)+
            _ => {}
        }
    };
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
fn cell(noise: Noise, out: &mut [Vec<f32>], x: &[Column]) {
    flat_by_dims!(noise, out, l,
        1 => cell1(x[0].at(l)), cell1_vector(x[0].at(l));
        2 => cell2(x[0].at(l), x[1].at(l)), cell2_vector(x[0].at(l), x[1].at(l));
        3 => cell3(x[0].at(l), x[1].at(l), x[2].at(l)), cell3_vector(x[0].at(l), x[1].at(l), x[2].at(l));
        4 => cell4(x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)),
             cell4_vector(x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)));
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
fn hash(noise: Noise, out: &mut [Vec<f32>], x: &[Column]) {
    flat_by_dims!(noise, out, l,
        1 => hash1_noise(x[0].at(l)), hash1_vector(x[0].at(l));
        2 => hash2_noise(x[0].at(l), x[1].at(l)), hash2_vector(x[0].at(l), x[1].at(l));
        3 => hash3_noise(x[0].at(l), x[1].at(l), x[2].at(l)), hash3_vector(x[0].at(l), x[1].at(l), x[2].at(l));
        4 => hash4_noise(x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)),
             hash4_vector(x[0].at(l), x[1].at(l), x[2].at(l), x[3].at(l)));
}

impl Run<'_> {
    pub(super) fn noise(&mut self, noise: Noise, dst: &[Reg], src: &[Reg]) {
        let mut out = std::mem::take(&mut self.s.columns);
        out.extend(dst.iter().map(|reg| std::mem::take(&mut self.regs.floats[reg.0 as usize])));
        // Four coordinates and their four periods at most.
        let mut x = [Column(&[]); 8];
        for (slot, &reg) in x.iter_mut().zip(src) {
            *slot = Column(self.regs.f(reg));
        }
        match noise.kind {
            NoiseKind::Perlin | NoiseKind::UPerlin => {
                let bias = noise.kind == NoiseKind::UPerlin;
                let run = if noise.periodic { perlin_periodic } else { perlin };
                run(noise, &mut out, &x, bias);
            }
            NoiseKind::Simplex => simplex(noise, &mut out, &x, false),
            NoiseKind::USimplex => simplex(noise, &mut out, &x, true),
            NoiseKind::Cell => cell(noise, &mut out, &x),
            NoiseKind::Hash => hash(noise, &mut out, &x),
        }
        for (reg, column) in dst.iter().zip(out.drain(..)) {
            self.regs.floats[reg.0 as usize] = column;
        }
        self.s.columns = out;
    }
}
