//! What can be verified: anything that scatters light toward viewers, in one or more variants.

use super::direction::View;
use crate::closure::{Evaluation, Samples};
use crate::math::columns::Column3;

/// What a subject says about one of the laws.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Promise {
    /// It is kept: breaking it fails.
    #[default]
    Kept,
    /// It is not made, for this reason: what is measured is listed.
    Waived(&'static str),
    /// Nothing is promised: what is measured is told.
    Open,
}

/// The laws that a variant of a subject promises to keep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Promises {
    /// It reflects no more than arrives.
    pub energy: Promise,
    /// f stays the same when directions are exchanged.
    pub reciprocity: Promise,
    /// It lays one closure over another by albedos that are estimates, which may let a little more light pass.
    pub layered: bool,
    /// Its albedo is 1.
    pub lossless: bool,
}

/// Something that scatters, seen by a batch of viewers.
///
/// Directions are unit, away from the surface at the origin, whose geometric normal is z.
pub trait Scatterer {
    /// Turns to new viewers, one a lane; at most [`crate::measure::sphere::LANES`].
    fn look(&mut self, wo: &Column3);
    /// f |cos| and density of one direction a lane, as [`crate::closure::Lobes::evaluate`] gives them.
    fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation);
    /// One direction a lane, as [`crate::closure::Lobes::sample`] gives it.
    fn sample(&mut self, xi: &Column3, out: &mut Samples);
    /// The albedo that its own evaluators state for the viewer of a lane, its largest component.
    fn stated_albedo(&self, lane: usize) -> f64;
    /// The first thing that went wrong while it was made ready, if anything did.
    fn complaint(&self) -> Option<String>;
}

/// Something to verify.
pub trait Subject: Sync {
    /// Its name in the table.
    fn name(&self) -> &str;
    /// How many variants it has: one a choice of parameters.
    fn variants(&self) -> usize;
    /// The parameters of a variant.
    fn label(&self, variant: usize) -> String;
    /// What a variant promises.
    fn promises(&self, variant: usize) -> Promises;
    /// Directions of view that a variant is looked at from beside the usual ones.
    fn views(&self, _variant: usize) -> Vec<View> {
        Vec::new()
    }
    /// A variant, ready to be looked at.
    fn scatterer(&self, variant: usize) -> Box<dyn Scatterer + '_>;
}
