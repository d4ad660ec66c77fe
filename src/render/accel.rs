//! Rays against geometry: one hierarchy over all primitives, closest hit and any hit.
//!
//! **No self-hits, no leaks.** A hit point is rebuilt from its primitive (corner and edges, vertices and weights, or
//! centre and radius), never as origin + t * direction, so its error is a few roundings of the primitive's largest
//! coordinate M. A new ray starts 2^-20 M off the surface (16 roundings), on the side it goes to, which clears its own
//! neighbourhood; and it skips the very primitive it starts on, which a ray from a flat primitive cannot meet again. A
//! ray that starts on a sphere can meet it on the far side: there the root t = 0 is divided out of the quadratic, so
//! no tolerance is needed. Triangles are tested by the signs of three edge functions, computed so that two triangles
//! compute the same number for the edge they share, of opposite sign: no ray slips between them.

use crate::scene::{Geometry, Primitive, Shape};
use glam::{Vec3, Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use std::time::Duration;

/// Stands for no primitive.
pub const NOTHING: u32 = u32::MAX;

const SPHERE: u32 = 0;
const QUAD: u32 = 1;
const TRIANGLE: u32 = 2;

/// A primitive as rays see it, three quarters of a cache line: the fourth lanes hold kind, identity and M.
#[derive(Clone, Copy, Debug)]
struct Packed {
    a: Vec4,
    b: Vec4,
    c: Vec4,
}

impl Packed {
    fn new(shape: &Shape, id: u32) -> Self {
        let (kind, a, b, c, magnitude) = match *shape {
            Shape::Sphere { center, radius } => {
                (SPHERE, center, Vec3::splat(radius), Vec3::ZERO, center.abs().max_element() + radius)
            }
            Shape::Quad { corner, edge_x, edge_y } => {
                let reach = corner.abs() + edge_x.abs() + edge_y.abs();
                (QUAD, corner, edge_x, edge_y, reach.max_element())
            }
            Shape::Triangle { a, b, c } => (TRIANGLE, a, b, c, a.abs().max(b.abs()).max(c.abs()).max_element()),
        };
        Packed { a: a.extend(f32::from_bits(kind)), b: b.extend(f32::from_bits(id)), c: c.extend(magnitude) }
    }

    #[inline(always)]
    fn id(&self) -> u32 {
        self.b.w.to_bits()
    }

    fn bounds(&self) -> Aabb {
        let (a, b, c) = (Vec3A::from_vec4(self.a), Vec3A::from_vec4(self.b), Vec3A::from_vec4(self.c));
        let bounds = match self.a.w.to_bits() {
            SPHERE => Aabb::new(a - b, a + b),
            QUAD => Aabb::from_points(&[a, a + b, a + c, a + b + c]),
            _ => Aabb::from_points(&[a, b, c]),
        };
        // A flat box has a slab of no thickness, which rounding could miss.
        let pad = Vec3A::splat(OFFSET * self.c.w);
        Aabb::new(bounds.min - pad, bounds.max + pad)
    }

    /// Distance and surface coordinates of the nearest hit in front of the ray, or infinity.
    #[inline(always)]
    fn intersect(&self, origin: Vec3A, direction: Vec3A, skip: u32) -> (f32, f32, f32) {
        let a = Vec3A::from_vec4(self.a);
        match self.a.w.to_bits() {
            SPHERE => (sphere(origin - a, direction, self.b.x, self.id() == skip), 0.0, 0.0),
            _ if self.id() == skip => MISS,
            QUAD => quad(origin - a, direction, Vec3A::from_vec4(self.b), Vec3A::from_vec4(self.c)),
            _ => triangle(a - origin, Vec3A::from_vec4(self.b) - origin, Vec3A::from_vec4(self.c) - origin, direction),
        }
    }
}

const MISS: (f32, f32, f32) = (f32::INFINITY, 0.0, 0.0);

/// The start of a ray is this much of M off its surface: 2^-20, exact.
const OFFSET: f32 = 9.536_743e-7;

/// `from` is the ray's origin seen from the centre; `on` says that the ray starts on this sphere.
#[inline(always)]
fn sphere(from: Vec3A, direction: Vec3A, radius: f32, on: bool) -> f32 {
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
fn quad(from: Vec3A, direction: Vec3A, edge_x: Vec3A, edge_y: Vec3A) -> (f32, f32, f32) {
    let p = direction.cross(edge_y);
    let determinant = edge_x.dot(p);
    let inverse = 1.0 / determinant;
    let u = from.dot(p) * inverse;
    let q = from.cross(edge_x);
    let v = direction.dot(q) * inverse;
    let t = edge_y.dot(q) * inverse;
    // A ray in the plane gives infinities or NaN, which fail every comparison.
    if u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0 && t > 0.0 { (t, u, v) } else { MISS }
}

/// Vertices seen from the ray's origin. Source: Plücker's test, in the symmetric form that Embree made known.
#[inline(always)]
fn triangle(a: Vec3A, b: Vec3A, c: Vec3A, direction: Vec3A) -> (f32, f32, f32) {
    let (e0, e1, e2) = (c - a, a - b, b - c);
    let u = e0.cross(c + a).dot(direction);
    let v = e1.cross(a + b).dot(direction);
    let w = e2.cross(b + c).dot(direction);
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let sum = u + v + w;
    if !inside || sum == 0.0 {
        return MISS;
    }
    let normal = e1.cross(e0);
    let t = a.dot(normal) / direction.dot(normal);
    let inverse = 1.0 / sum;
    if t > 0.0 { (t, u * inverse, v * inverse) } else { MISS }
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

/// Geometry, prepared for rays.
pub struct Accel {
    shapes: Vec<Packed>,
    hierarchy: CwBvh,
    magnitude: Vec<f32>,
}

impl Accel {
    /// Prepares `geometry`.
    pub fn new(geometry: &Geometry) -> Self {
        let pack = |(id, p): (usize, &Primitive)| Packed::new(&p.shape, id as u32);
        let shapes: Vec<Packed> = geometry.primitives.iter().enumerate().map(pack).collect();
        let magnitude = shapes.iter().map(|s| s.c.w).collect();
        let bounds: Vec<Aabb> = shapes.iter().map(Packed::bounds).collect();
        // Pre-splitting would name a primitive twice, which the reordering below does not mind.
        let quality =
            if shapes.len() > 200_000 { BvhBuildParams::medium_build() } else { BvhBuildParams::slow_build() };
        let quality = BvhBuildParams { pre_split: false, ..quality };
        let hierarchy = build_cwbvh(&bounds, quality, &mut Duration::default());
        // In leaf order, so that the primitives of a leaf lie side by side.
        let shapes = hierarchy.primitive_indices.iter().map(|&i| shapes[i as usize]).collect();
        Accel { shapes, hierarchy, magnitude }
    }

    /// The closest hit, not counting `skip`, the primitive that the ray starts on.
    #[inline]
    pub fn closest(&self, origin: Vec3, direction: Vec3, skip: u32) -> Hit {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, f32::INFINITY);
        let mut found = RayHit::none();
        let (mut u, mut v) = (0.0, 0.0);
        self.hierarchy.ray_traverse(ray, &mut found, |ray, index| {
            let hit = self.shapes[index].intersect(ray.origin, ray.direction, skip);
            if hit.0 < ray.tmax {
                (u, v) = (hit.1, hit.2);
            }
            hit.0
        });
        match self.shapes.get(found.primitive_id as usize) {
            Some(shape) => Hit { t: found.t, primitive: shape.id(), u, v },
            None => Hit { t: f32::INFINITY, primitive: NOTHING, u, v },
        }
    }

    /// True when anything but `skip` and `target` is hit nearer than `distance`.
    #[inline]
    pub fn occluded(&self, origin: Vec3, direction: Vec3, distance: f32, skip: u32, target: u32) -> bool {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, distance);
        !self.hierarchy.ray_traverse_miss(ray, |ray, index| {
            let shape = &self.shapes[index];
            if shape.id() == target { f32::INFINITY } else { shape.intersect(ray.origin, ray.direction, skip).0 }
        })
    }

    /// Where a ray toward `direction` starts that leaves `point` of `primitive`.
    #[inline]
    pub fn leave(&self, point: Vec3, ng: Vec3, direction: Vec3, primitive: u32) -> Vec3 {
        let distance = OFFSET * self.magnitude[primitive as usize];
        point + ng * distance.copysign(ng.dot(direction))
    }
}
