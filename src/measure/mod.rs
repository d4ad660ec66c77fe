//! Measurements: what `verify` and `chart` run on, and what the tests hold.

pub mod chart;
pub mod choose;
pub mod furnace;
pub mod patch;
pub mod sphere;
pub mod statistics;
pub mod verify;
