//! The chart of speed against accuracy: every method that competes with another, measured on the machine at hand.
//!
//! A file a figure. Each times its methods in turns ([`race`]), finds their errors against integrals in f64 that are computed
//! then and there, and gives a [`Figure`]; [`draw`] and [`table`] turn figures into files.
//!
//! Decision (2026-11-22): truths are integrated anew in every run (a few seconds), because a stored one would go on to agree with
//! whatever made it, instead of read from a file. Costs are medians with quartiles, because a mean follows every hiccup of
//! a shared machine; turns are shorter than the slices of time that a system gives out, so that most are undisturbed. Costs that differ by less than their quartiles may change places on the front from run to run.

mod albedo;
mod axis;
mod closures;
pub mod draw;
pub mod figure;
mod labels;
mod lambda;
mod lanes;
mod layering;
mod precision;
pub mod race;
mod sampling;
mod scene;
pub mod table;
mod tables;
pub mod truth;
mod visibility;
mod widths;

pub use scene::{Budget, scene_figure};

use figure::{Figure, Point};
use race::{Cost, Laps};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// How costs are timed.
    pub laps: Laps,
    /// How many cosines errors are looked for at.
    pub cosines: usize,
    /// Steps of quadratures, as in [`crate::bsdf::sheen::reference::albedo`].
    pub steps: usize,
    /// Cells of the finest table of albedos: a power of two, at least 8.
    pub cells: usize,
}

impl Effort {
    /// Next to nothing, for tests: costs mean little, errors are those of the quick chart at fewer places.
    pub fn tiny() -> Self {
        Effort { laps: Laps { rounds: 3, turn: 1e-5 }, cosines: 13, steps: 24, cells: 8 }
    }

    /// Some seconds.
    pub fn quick() -> Self {
        Effort { laps: Laps { rounds: 81, turn: 2e-4 }, cosines: 25, steps: 24, cells: 64 }
    }

    /// A minute or two.
    pub fn full() -> Self {
        Effort { laps: Laps { rounds: 401, turn: 3e-4 }, cosines: 61, steps: 32, cells: 128 }
    }
}

/// A point that may lie on the front.
fn point(group: &str, method: &str, cost: Cost, error: f64) -> Point {
    let Cost { median, spread } = cost;
    Point { group: group.to_owned(), method: method.to_owned(), cost: median, spread, error, front: false }
}

/// What a cost is in figures whose methods are timed in turns.
const MEDIANS: &str = "Cost: the median of interleaved rounds, with its quartiles.";

/// What measures a figure.
type Measure = fn(&Effort) -> Result<Figure, String>;

/// Measures all figures that need no scene; tells how many of how many are done.
pub fn figures(effort: &Effort, progress: &dyn Fn(usize, usize)) -> Result<Vec<Figure>, String> {
    let all: [Measure; 7] = [
        lambda::figure,
        visibility::figure,
        albedo::figure,
        sampling::figure,
        layering::figure,
        widths::figure,
        precision::figure,
    ];
    let mut out = Vec::new();
    for (done, measure) in all.iter().enumerate() {
        progress(done, all.len());
        out.push(measure(effort)?);
    }
    progress(all.len(), all.len());
    Ok(out)
}
