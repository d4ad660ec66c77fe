//! The renderer against answers known exactly, against itself, and against bad input.

mod determinism;
mod exact;
mod files;
mod materials;
mod speed;
