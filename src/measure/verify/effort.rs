//! How much work goes into a verification.

/// How much work goes into a verification.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Samples a sampled view.
    pub samples: usize,
    /// Cells that they are counted in.
    pub cells: usize,
    /// Directions that the integrals of a view may take.
    pub directions: usize,
    /// What a refinement may still change in a patch's part of the albedo.
    pub tolerance: f64,
    /// Cosines of the views that are sampled and integrated.
    pub sampled: Vec<f64>,
    /// Cosines of the views that are only integrated.
    pub integrated: Vec<f64>,
    /// Places and views of a shader that are surveyed for a closer look; an eighth of it for each further value of a parameter.
    pub places: usize,
    /// Values that each range of a shader's parameters is surveyed at.
    pub steps: usize,
    /// Batches of pairs whose directions are exchanged.
    pub pairs: usize,
    /// Chosen by the user, to try other random numbers.
    pub seed: u64,
}

impl Effort {
    /// All there is.
    pub fn full() -> Self {
        Effort {
            samples: 100_000,
            cells: 128,
            directions: 600_000,
            tolerance: 1e-6,
            sampled: vec![0.05, 0.25, 0.5, 0.75, 0.999],
            integrated: vec![1e-4, 1e-3, 0.01, 0.1, 0.9, 1.0],
            places: 1 << 16,
            steps: 24,
            pairs: 16,
            seed: 0,
        }
    }

    /// A second look at what a first one finds wrong.
    pub(super) fn closer(&self) -> Self {
        Effort {
            samples: 2 * self.samples,
            cells: 4 * self.cells,
            directions: 40 * self.directions,
            tolerance: 0.1 * self.tolerance,
            seed: self.seed.wrapping_add(1),
            ..self.clone()
        }
    }

    /// Enough to see a density 5 % wrong and a lobe 2 % too bright.
    pub fn quick() -> Self {
        Effort {
            samples: 30_000,
            cells: 64,
            directions: 100_000,
            tolerance: 2e-6,
            integrated: vec![1e-4, 0.01],
            places: 1 << 13,
            steps: 8,
            pairs: 4,
            ..Effort::full()
        }
    }
}
