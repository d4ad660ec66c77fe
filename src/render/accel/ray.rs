//! Rays and hits, as whoever asks the hierarchy and whatever answers see them.

use glam::Vec3;

/// Stands for no primitive.
pub const NOTHING: u32 = u32::MAX;

/// A ray, and what it does not meet.
///
/// A ray whose origin or direction has a number that is not finite, or whose reach is NaN, meets nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
    /// How far it goes; may be infinite.
    pub reach: f32,
    /// The primitive it starts on, or `NOTHING`.
    pub skip: u32,
    /// The primitive it goes to, which it does not meet, or `NOTHING`.
    pub target: u32,
}

impl Ray {
    /// A ray without end from a point in the open.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Ray { origin, direction, reach: f32::INFINITY, skip: NOTHING, target: NOTHING }
    }
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance; infinite when nothing is hit.
    pub t: f32,
    /// The primitive, or `NOTHING`.
    pub primitive: u32,
    /// Quad: fraction of `edge_x`. Triangle: weight of b. Sphere: 0.
    pub u: f32,
    /// Quad: fraction of `edge_y`. Triangle: weight of c. Sphere: 0.
    pub v: f32,
}

impl Hit {
    /// Nothing is hit.
    pub const NONE: Hit = Hit { t: f32::INFINITY, primitive: NOTHING, u: 0.0, v: 0.0 };
}
