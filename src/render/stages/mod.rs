//! The stages of a bounce, a file each: a function of the world and the wave, which knows no other stage.
//!
//! What a stage leaves for a later one is a field of `Wave`. The order is in `trace`, and nowhere else.

pub mod background;
pub mod camera;
pub mod globals;
pub mod intersect;
pub mod light;
pub mod scatter;
pub mod shade;
pub mod shadow;
pub mod sort;
