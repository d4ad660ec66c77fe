//! How much a chart measures.

use super::race::Laps;

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
