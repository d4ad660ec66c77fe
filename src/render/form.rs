//! Shapes in one form for all, so that loops over lanes need no branch for them.

use crate::scene::Shape;
use glam::Vec3;

/// A shape as three vectors: centre and radius, or a corner and two edges.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The centre, the corner or the first vertex.
    pub a: Vec3,
    /// The first edge; the radius for a sphere.
    pub b: Vec3,
    /// The second edge.
    pub c: Vec3,
    /// True for a sphere.
    pub round: bool,
}

impl Form {
    /// The form of a shape.
    #[inline(always)]
    pub fn new(shape: &Shape) -> Self {
        match *shape {
            Shape::Sphere { center, radius } => Form { a: center, b: Vec3::splat(radius), c: Vec3::ZERO, round: true },
            Shape::Quad { corner, edge_x, edge_y } => Form { a: corner, b: edge_x, c: edge_y, round: false },
            Shape::Triangle { a, b, c } => Form { a, b: b - a, c: c - a, round: false },
        }
    }

    /// Position and geometric normal (unit, outward, not turned) of the hit of a ray at distance `t` and surface
    /// coordinates `u` and `v`.
    #[inline(always)]
    pub fn meet(&self, origin: Vec3, direction: Vec3, [t, u, v]: [f32; 3]) -> (Vec3, Vec3) {
        let across = self.b.cross(self.c);
        let from = origin + t * direction - self.a;
        let long = if self.round { from } else { across };
        let length = long.length();
        let n = if length > 0.0 { long / length } else { Vec3::Y };
        let p = if self.round { self.a + self.b.x * n } else { self.a + u * self.b + v * self.c };
        (p, n)
    }
}
