//! Measurements: what `verify` and `chart` run on, and what the tests hold.

#[cfg(feature = "chart")]
pub mod chart;
#[cfg(feature = "chart")]
pub mod choose;
pub mod furnace;
pub mod patch;
pub mod sphere;
pub mod statistics;
pub mod verify;
