//! Numbers without a language: columns, elementary functions, frames, warps, noise.

pub mod columns;
pub mod elementary;
pub mod frame;
pub mod instruction_set;
pub mod noise;
pub mod polynomial;
pub mod quadrature;
pub mod warp;
