//! The scatterer of a subject that scatters nothing, or that could not be made.

use super::subject::Scatterer;
use crate::closure::{Evaluation, Samples, event};
use crate::math::columns::Column3;

/// Scatters nothing, and says why if something is wrong with that.
#[derive(Default)]
pub(super) struct Nothing {
    lanes: usize,
    why: Option<String>,
}

impl Nothing {
    /// Nothing, for this reason.
    pub fn because(why: &str) -> Self {
        Nothing { lanes: 0, why: Some(why.to_owned()) }
    }
}

impl Scatterer for Nothing {
    fn look(&mut self, wo: &Column3) {
        self.lanes = wo.len();
    }

    fn evaluate(&mut self, _wi: &Column3, out: &mut Evaluation) {
        *out = Evaluation { f_cos: Column3::zeros(self.lanes), pdf: vec![0.0; self.lanes] };
    }

    fn sample(&mut self, _xi: &Column3, out: &mut Samples) {
        let none = || Column3::zeros(self.lanes);
        let (pdf, event) = (vec![0.0; self.lanes], vec![event::NONE; self.lanes]);
        *out = Samples { wi: none(), weight: none(), pdf, event };
    }

    fn stated_albedo(&self, _lane: usize) -> f64 {
        0.0
    }

    fn complaint(&self) -> Option<String> {
        self.why.clone()
    }
}
