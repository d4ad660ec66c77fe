//! Points of a primitive to be looked at before any ray is traced.

use super::accel::Hit;
use super::form::Form;
use super::segment::{Segment, ray_type};
use super::sky;
use crate::scene::{Geometry, Shape};
use glam::Vec3;

/// A segment that hits `primitive` at surface coordinates `x`, `y` in [0, 1), from straight above.
pub fn probe(geometry: &Geometry, primitive: u32, x: f32, y: f32) -> Segment {
    let shape = &geometry.primitives[primitive as usize].shape;
    let (u, v) = match shape {
        Shape::Triangle { .. } => (x * (1.0 - y), y),
        Shape::Sphere { .. } | Shape::Quad { .. } => (x, y),
    };
    let (mut p, mut n) = Form::new(shape).meet(Vec3::ZERO, Vec3::NEG_Y, [1.0, u, v]);
    if let Shape::Sphere { center, radius } = *shape {
        n = sky::direction(x, y);
        p = center + radius * n;
    }
    let hit = Hit { t: 1.0, primitive, u, v };
    Segment { origin: p + n, direction: -n, hit, width: 0.0, spread: 0.0, ray_type: ray_type::SHADOW }
}
