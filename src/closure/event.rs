//! What can happen to light in a lane.

/// Absorbed.
pub const NONE: u8 = 0;
/// Scattered by a diffuse or sheen lobe.
pub const DIFFUSE: u8 = 1;
/// Scattered by a rough boundary.
pub const GLOSSY: u8 = 2;
/// Reflected by a mirror.
pub const DELTA_REFLECT: u8 = 3;
/// Refracted by a smooth boundary.
pub const DELTA_REFRACT: u8 = 4;
/// Passed straight on.
pub const STRAIGHT: u8 = 5;
