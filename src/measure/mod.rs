//! Measurements: what `verify` and `chart` run on, and what the tests hold.

pub mod furnace;
pub mod statistics;
