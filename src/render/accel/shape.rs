//! Spheres and quads against one ray.

use crate::scene::Shape;
use glam::Vec3;

/// A sphere or a quad, as a leaf holds it.
#[derive(Clone, Copy, Debug)]
pub struct Analytic {
    /// Its form; a triangle is never met.
    pub shape: Shape,
    /// Its primitive.
    pub id: u32,
}

/// No hit.
pub const MISS: (f32, f32, f32) = (f32::INFINITY, 0.0, 0.0);

impl Analytic {
    /// Distance and surface coordinates of the nearest hit in front of the ray, or infinity.
    #[inline(always)]
    pub fn intersect(&self, origin: Vec3, direction: Vec3, skip: u32) -> (f32, f32, f32) {
        match self.shape {
            Shape::Sphere { center, radius } => (sphere(origin - center, direction, radius, self.id == skip), 0.0, 0.0),
            Shape::Quad { corner, edge_x, edge_y } if self.id != skip => {
                quad(origin - corner, direction, edge_x, edge_y)
            }
            Shape::Quad { .. } | Shape::Triangle { .. } => MISS,
        }
    }
}

/// `from` is the ray's origin seen from the centre; `on` says that the ray starts on this sphere.
#[inline(always)]
fn sphere(from: Vec3, direction: Vec3, radius: f32, on: bool) -> f32 {
    let b = from.dot(direction);
    if on {
        let t = -2.0 * b;
        // Rays that leave the sphere have t below zero, tangent ones a t of rounding size.
        return if t > 1e-6 * radius { t } else { f32::INFINITY };
    }
    // The distance from the centre to the ray, squared, without the cancellation of b^2 - c.
    let foot = from - b * direction;
    let h = radius * radius - foot.dot(foot);
    if h < 0.0 {
        return f32::INFINITY;
    }
    let root = h.sqrt();
    let near = -b - root;
    let far = root - b;
    if near > 0.0 {
        near
    } else if far > 0.0 {
        far
    } else {
        f32::INFINITY
    }
}

#[inline(always)]
fn quad(from: Vec3, direction: Vec3, edge_x: Vec3, edge_y: Vec3) -> (f32, f32, f32) {
    let p = direction.cross(edge_y);
    let determinant = edge_x.dot(p);
    let inverse = 1.0 / determinant;
    let u = from.dot(p) * inverse;
    let q = from.cross(edge_x);
    let v = direction.dot(q) * inverse;
    let t = edge_y.dot(q) * inverse;
    // A ray in the plane gives infinities or NaN, which fail every comparison.
    let unit = 0.0..=1.0;
    if unit.contains(&u) && unit.contains(&v) && t > 0.0 { (t, u, v) } else { MISS }
}
