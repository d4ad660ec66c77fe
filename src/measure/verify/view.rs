//! One view of a variant: its cells, its integrals, and what its samples add up to.

pub use super::direction::View;
use super::draws::{Draw, Kind, draw};
use super::effort::Effort;
use super::subject::Scatterer;
use crate::closure::Evaluation;
use crate::math::columns::Column3;
use crate::measure::patch::Chart;
use crate::measure::sphere::{Cells, Integrals, LANES};
use crate::measure::statistics::Random;
use glam::Vec3;

/// Directions drawn to lay the cells out by.
const SCOUTS: usize = 4096;
/// Draws that measure lobes of one direction.
const SINGLES: usize = 8192;

/// Sums over many draws of one view.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// How many were drawn.
    pub count: f64,
    /// How many had a density.
    pub spread: f64,
    /// How many fell into each cell.
    pub cells: Vec<f64>,
    /// The sum of weights with a density, largest component last.
    pub sum: [f64; 3],
    /// The sum of their squares.
    pub squares: [f64; 3],
    /// The worst mismatch of a weight, with its direction.
    pub mismatch: (f64, Vec3),
}

/// What one view of a variant showed.
#[derive(Clone, Debug)]
pub struct Seen {
    /// From where.
    pub view: View,
    /// The integrals of the density and of f |cos| over every cell.
    pub integrals: Integrals,
    /// What lobes of one direction reflect, with the error of that.
    pub single: ([f64; 3], f64),
    /// The albedo that the evaluators state.
    pub stated: f64,
    /// The samples, where the view was sampled.
    pub tally: Option<Tally>,
}

impl Seen {
    /// The directional albedo of each component: reflected, transmitted, and by lobes of one direction.
    pub fn albedo(&self) -> [f64; 3] {
        let total = self.integrals.total();
        std::array::from_fn(|k| total[k + 1] + self.single.0[k])
    }

    /// The largest component of the albedo, and how far it may be off.
    pub fn largest(&self) -> (f64, f64) {
        let albedo = self.albedo();
        let error = self.integrals.error[1..].iter().copied().fold(0.0, f64::max) + self.single.1;
        if albedo.iter().any(|a| a.is_nan()) {
            return (f64::NAN, error);
        }
        (albedo.into_iter().fold(f64::MIN, f64::max), error)
    }
}

/// Looks at a variant from one direction; draws samples as well when told to.
pub fn look(scatterer: &mut dyn Scatterer, view: View, sampled: bool, effort: &Effort, random: &mut Random) -> Seen {
    let wo = view.wo();
    scatterer.look(&Column3::splat(wo, LANES));
    let stated = scatterer.stated_albedo(0);
    let (mut scouts, mut single) = (Vec::with_capacity(SCOUTS), false);
    draw(scatterer, SCOUTS, false, random, |draw| match draw.kind {
        Kind::Spread if draw.wi.is_finite() => scouts.push((draw.wi, draw.pdf)),
        Kind::Single => single = true,
        _ => {}
    });
    let count = if sampled { effort.cells } else { effort.cells / 2 };
    let cells = Cells::new(Chart::new(wo), scouts.into_iter(), count, random);
    // Errors of many patches along an edge add up, so each may be a two-hundredth of the noise of a cell's count.
    let density = if sampled { 0.005 / (effort.samples as f64 * count as f64).sqrt() } else { 1e-4 };
    let mut evaluation = Evaluation::default();
    let integrals = cells.integrate(
        [density, effort.tolerance, effort.tolerance, effort.tolerance],
        effort.directions,
        |wi, out| {
            scatterer.evaluate(wi, &mut evaluation);
            for (lane, out) in out.iter_mut().enumerate() {
                let f_cos = evaluation.f_cos.get(lane).as_dvec3();
                *out = [f64::from(evaluation.pdf[lane]), f_cos.x, f_cos.y, f_cos.z];
            }
        },
    );
    let single = if single { singles(scatterer, random) } else { ([0.0; 3], 0.0) };
    let tally = sampled.then(|| tally(scatterer, &cells, effort.samples, random));
    Seen { view, integrals, single, stated, tally }
}

/// The mean weight of lobes of one direction. Evenly spread picks hit each lobe's share to within one or two draws.
fn singles(scatterer: &mut dyn Scatterer, random: &mut Random) -> ([f64; 3], f64) {
    let (mut sum, mut most) = ([0.0; 3], 0.0f64);
    draw(scatterer, SINGLES, true, random, |draw| {
        if draw.kind == Kind::Single {
            for (s, w) in sum.iter_mut().zip(draw.weight.as_dvec3().to_array()) {
                *s += w / SINGLES as f64;
                most = most.max(w);
            }
        }
    });
    let whole = sum.iter().all(|s| (s - most).abs() < 1e-6 * most);
    (sum, if whole { 1e-6 } else { 4.0 * most / SINGLES as f64 })
}

fn tally(scatterer: &mut dyn Scatterer, cells: &Cells, count: usize, random: &mut Random) -> Tally {
    let mut out = Tally { cells: vec![0.0; cells.len()], ..Tally::default() };
    draw(scatterer, count, false, random, |Draw { wi, weight, kind, mismatch, .. }| {
        out.count += 1.0;
        if kind != Kind::Spread {
            return;
        }
        out.spread += 1.0;
        out.cells[cells.find(wi)] += 1.0;
        for (k, w) in weight.as_dvec3().to_array().into_iter().enumerate() {
            out.sum[k] += w;
            out.squares[k] += w * w;
        }
        if mismatch > out.mismatch.0 {
            out.mismatch = (mismatch, wi);
        }
    });
    out
}
