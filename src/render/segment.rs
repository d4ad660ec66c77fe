//! A part of a path between two surfaces: a ray, what it hits, and what shaders are told of it.

use super::accel::Hit;
use glam::Vec3;

/// A ray with its hit, its cone and its kind.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where it starts.
    pub origin: Vec3,
    /// Its unit direction.
    pub direction: Vec3,
    /// What it hits.
    pub hit: Hit,
    /// Width of its cone at the origin.
    pub width: f32,
    /// Growth of that width with distance.
    pub spread: f32,
    /// One of the bits of `ray_type`.
    pub ray_type: i32,
}

/// What `raytype()` tells rays apart by, a bit each.
pub mod ray_type {
    /// From the camera.
    pub const CAMERA: i32 = 1;
    /// Toward a light.
    pub const SHADOW: i32 = 2;
    /// After a diffuse bounce.
    pub const DIFFUSE: i32 = 4;
    /// After a glossy bounce.
    pub const GLOSSY: i32 = 8;
    /// After a mirror.
    pub const REFLECTION: i32 = 16;
    /// After a clear refraction.
    pub const REFRACTION: i32 = 32;
    /// No ray: a corner that displacement looks at.
    pub const DISPLACEMENT: i32 = 64;
}
