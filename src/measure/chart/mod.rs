//! The chart of speed against accuracy: every method that competes with another, measured on the machine at hand.
//!
//! A file a figure. Each times its methods in turns ([`race`]), finds their errors against integrals in f64 that are computed
//! then and there, and gives a [`figure::Figure`]; [`draw`] and [`table`] turn figures into files.
//!
//! Decision (2026-11-22): truths are integrated anew in every run (a few seconds), because a stored one would go on to agree with
//! whatever made it, instead of read from a file. Costs are medians with quartiles, because a mean follows every hiccup of
//! a shared machine; turns are shorter than the slices of time that a system gives out, so that most are undisturbed. Costs that differ by less than their quartiles may change places on the front from run to run.

mod albedo;
mod axis;
mod closures;
mod density;
pub mod draw;
mod effort;
pub mod figure;
mod figures;
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
mod terminator;
pub mod truth;
mod visibility;
mod widths;

pub use density::density;
pub use effort::Effort;
pub use figures::figures;
pub use scene::{Budget, scene_figure};
