//! The chart of speed against accuracy: every method that competes with another, measured on the machine at hand.
//!
//! A file a figure. Each times its methods in turns ([`race`]), finds their errors against integrals in f64 that are computed
//! then and there, and gives a [`Figure`]; [`draw`] and [`table`] turn figures into files.

mod axis;
pub mod draw;
pub mod figure;
mod labels;
mod lambda;
mod lanes;
pub mod race;
pub mod table;

use figure::{Figure, Point};
use race::{Cost, Laps};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// How costs are timed.
    pub laps: Laps,
    /// How many cosines errors are looked for at.
    pub cosines: usize,
}

impl Effort {
    /// Less than a minute.
    pub fn quick() -> Self {
        Effort { laps: Laps { rounds: 15, turn: 1e-3 }, cosines: 25 }
    }

    /// Some minutes.
    pub fn full() -> Self {
        Effort { laps: Laps { rounds: 41, turn: 4e-3 }, cosines: 97 }
    }
}

/// A point that may lie on the front.
fn point(group: &str, method: &str, cost: Cost, error: f64) -> Point {
    let Cost { median, spread } = cost;
    Point { group: group.to_owned(), method: method.to_owned(), cost: median, spread, error, front: false }
}

/// Measures all figures; tells how many of how many are done.
pub fn figures(effort: &Effort, progress: &dyn Fn(usize, usize)) -> Vec<Figure> {
    let all: [fn(&Effort) -> Figure; 1] = [lambda::figure];
    let mut out = Vec::new();
    for (done, measure) in all.iter().enumerate() {
        progress(done, all.len());
        out.push(measure(effort));
    }
    progress(all.len(), all.len());
    out
}
