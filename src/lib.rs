//! velour: an OSL-style closure interpreter and renderer.

pub mod bsdf;
pub mod check;
pub mod cli;
pub mod closure;
pub mod compile;
pub mod exec;
pub mod ir;
pub mod lang;
pub mod math;
pub mod measure;
pub mod ops;
pub mod optimize;
pub mod render;
pub mod scene;
