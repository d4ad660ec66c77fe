//! The renderer against answers known exactly, against itself, and against bad input.

mod determinism;
mod exact;
mod materials;
mod speed;
