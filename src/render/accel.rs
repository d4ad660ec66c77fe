//! Rays against geometry: one hierarchy over all primitives, closest hit and any hit.
//!
//! **No self-hits, no leaks.** A hit point is rebuilt from its primitive (corner and edges, vertices and weights, or
//! centre and radius), never as origin + t * direction, so its error is a few roundings of the primitive's largest
//! coordinate M. A new ray starts 2^-20 M off the surface (16 roundings), on the side it goes to, which clears its own
//! neighbourhood; and it skips the very primitive it starts on, which a ray from a flat primitive cannot meet again. A
//! ray that starts on a sphere can meet it on the far side: there the root t = 0 is divided out of the quadratic, so
//! no tolerance is needed. Triangles are tested by the signs of three edge functions, computed so that two triangles
//! compute the same number for the edge they share, of opposite sign: no ray slips between them.

use super::few::{self, Few};
use super::shadow::ShadowRay;
use super::wave::Path;
use crate::scene::{Geometry, Primitive, Shape};
use glam::{Vec3, Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
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
    let unit = 0.0..=1.0;
    if unit.contains(&u) && unit.contains(&v) && t > 0.0 { (t, u, v) } else { MISS }
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

/// Up to this many primitives, all of them are tested. Measured at seven only; the bound is a guess from the cost of
/// one test.
const MOST: usize = 24;

/// How rays find what they hit.
///
/// Measured on one thread of a shared machine, baseline x86-64 build, million closest hits a second, range of four
/// runs a method on two occasions: figure 1 (7 primitives) `Wide` 9.0 to 10.8, `Binary` 8.3 to 11.9, no clear winner; a
/// bumpy ball of 204,480 triangles, rays from all around, `Wide` 0.51 to 0.57, `Binary` 0.36 to 0.49. Hence `Wide` for
/// meshes, though it takes about twice as long to build (0.2 s against 0.1 s). `Few` was measured inside a whole render
/// of figure 1 alone: all ray tests together took 32 % of the time with `Wide` and 17 % with `Few`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every primitive against sixteen rays at a time, no hierarchy; only for a few spheres and quads.
    Few,
    /// A hierarchy of eight compressed children a node.
    Wide,
    /// A hierarchy of two children a node.
    Binary,
}

enum Hierarchy {
    Few(Few),
    Wide(CwBvh),
    Binary(Bvh2),
}

/// Geometry, prepared for rays.
pub struct Accel {
    shapes: Vec<Packed>,
    hierarchy: Hierarchy,
    magnitude: Vec<f32>,
}

impl Accel {
    /// Prepares `geometry` by the method that measured best for its size.
    pub fn new(geometry: &Geometry) -> Self {
        match Few::new(geometry, MOST) {
            Some(_) => Self::with(geometry, Method::Few),
            None => Self::with(geometry, Method::Wide),
        }
    }

    /// Prepares `geometry` by a given method; `Few` falls back to `Wide` where it does not apply.
    pub fn with(geometry: &Geometry, method: Method) -> Self {
        let pack = |(id, p): (usize, &Primitive)| Packed::new(&p.shape, id as u32);
        let shapes: Vec<Packed> = geometry.primitives.iter().enumerate().map(pack).collect();
        let magnitude = shapes.iter().map(|s| s.c.w).collect();
        let few = if method == Method::Few { Few::new(geometry, usize::MAX) } else { None };
        if let Some(few) = few {
            return Accel { shapes, hierarchy: Hierarchy::Few(few), magnitude };
        }
        let bounds: Vec<Aabb> = shapes.iter().map(Packed::bounds).collect();
        let large = shapes.len() > 200_000;
        let quality = if large { BvhBuildParams::medium_build() } else { BvhBuildParams::slow_build() };
        // Bounds alone cannot be split.
        let quality = BvhBuildParams { pre_split: false, ..quality };
        let (hierarchy, order) = if method == Method::Binary {
            let mut bvh = build_bvh2(&bounds, quality, &mut Duration::default());
            let order = std::mem::take(&mut bvh.primitive_indices);
            (Hierarchy::Binary(bvh), order)
        } else {
            let mut bvh = build_cwbvh(&bounds, quality, &mut Duration::default());
            let order = std::mem::take(&mut bvh.primitive_indices);
            (Hierarchy::Wide(bvh), order)
        };
        // In leaf order, so that the primitives of a leaf lie side by side.
        let shapes = order.iter().map(|&i| shapes[i as usize]).collect();
        Accel { shapes, hierarchy, magnitude }
    }

    /// Stores the closest hit of each active path.
    pub fn intersect(&self, paths: &mut [Path], active: &[u32]) {
        if let Hierarchy::Few(few) = &self.hierarchy {
            return few::intersect(few, paths, active);
        }
        for &i in active {
            let path = &mut paths[i as usize];
            let hit = self.closest(path.hit.origin, path.hit.direction, path.from);
            (path.hit.t, path.hit.primitive, path.hit.u, path.hit.v) = (hit.t, hit.primitive, hit.u, hit.v);
        }
    }

    /// Keeps in `clear` the numbers of the rays that nothing stops short of their target.
    pub fn unoccluded(&self, rays: &[ShadowRay], clear: &mut Vec<u32>) {
        clear.clear();
        if let Hierarchy::Few(few) = &self.hierarchy {
            return few::unoccluded(few, rays, clear);
        }
        clear.extend((0..rays.len() as u32).filter(|&i| !self.occluded(&rays[i as usize])));
    }

    /// The closest hit, not counting `skip`, the primitive that the ray starts on. The few have their own way.
    #[inline]
    pub fn closest(&self, origin: Vec3, direction: Vec3, skip: u32) -> Hit {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, f32::INFINITY);
        let mut found = RayHit::none();
        let (mut u, mut v) = (0.0, 0.0);
        let test = |ray: &Ray, index: usize| {
            let hit = self.shapes[index].intersect(ray.origin, ray.direction, skip);
            if hit.0 < ray.tmax {
                (u, v) = (hit.1, hit.2);
            }
            hit.0
        };
        match &self.hierarchy {
            Hierarchy::Wide(bvh) => bvh.ray_traverse(ray, &mut found, test),
            Hierarchy::Binary(bvh) => bvh.ray_traverse(ray, &mut found, test),
            Hierarchy::Few(_) => false,
        };
        match self.shapes.get(found.primitive_id as usize) {
            Some(shape) => Hit { t: found.t, primitive: shape.id(), u, v },
            None => Hit { t: f32::INFINITY, primitive: NOTHING, u, v },
        }
    }

    /// True when anything but where it starts and where it goes is in the way.
    #[inline]
    fn occluded(&self, shadow: &ShadowRay) -> bool {
        let ray = Ray::new(shadow.origin.into(), shadow.direction.into(), 0.0, shadow.distance);
        let test = |ray: &Ray, index: usize| match &self.shapes[index] {
            shape if shape.id() == shadow.target => f32::INFINITY,
            shape => shape.intersect(ray.origin, ray.direction, shadow.from).0,
        };
        match &self.hierarchy {
            Hierarchy::Wide(bvh) => !bvh.ray_traverse_miss(ray, test),
            Hierarchy::Binary(bvh) => !bvh.ray_traverse_miss(ray, test),
            Hierarchy::Few(_) => false,
        }
    }

    /// Where a ray toward `direction` starts that leaves `point` of `primitive`.
    #[inline]
    pub fn leave(&self, point: Vec3, ng: Vec3, direction: Vec3, primitive: u32) -> Vec3 {
        let distance = OFFSET * self.magnitude[primitive as usize];
        point + ng * distance.copysign(ng.dot(direction))
    }
}
