//! Scenes of a few spheres and quads: no hierarchy, every primitive against blocks of sixteen rays at once.
//!
//! On the scene of figure 1 (seven primitives) a hierarchy is one node, whose boxes cost about as much to test as what
//! is in them. Rays are the lanes, so that the nearest hit is a select, not a search. The formulas are those of
//! `shape.rs`, term by term, so that both methods give the same answers.

use super::ray::{Hit, NOTHING, Ray};
use crate::lanes;
use crate::render::block::{Row, WIDTH};
use crate::scene::{Geometry, Shape};
use glam::Vec3;

/// All primitives of a small scene.
#[derive(Clone, Debug)]
pub struct Few {
    shapes: Vec<Shape>,
}

impl Few {
    /// The shapes of `geometry`, unless it has triangles or more than `most` primitives.
    pub fn new(geometry: &Geometry, most: usize) -> Option<Few> {
        let shapes: Vec<Shape> = geometry.primitives.iter().take(most.saturating_add(1)).map(|p| p.shape).collect();
        let flat = shapes.iter().all(|s| !matches!(s, Shape::Triangle { .. }));
        (flat && shapes.len() <= most).then_some(Few { shapes })
    }
}

/// Sixteen rays, and the nearest hit of each so far.
#[derive(Clone, Copy)]
struct Block {
    ox: Row,
    oy: Row,
    oz: Row,
    dx: Row,
    dy: Row,
    dz: Row,
    t: Row,
    u: Row,
    v: Row,
    skip: [u32; WIDTH],
    target: [u32; WIDTH],
    id: [u32; WIDTH],
}

impl Block {
    #[inline(always)]
    fn empty() -> Self {
        let zero = [0.0; WIDTH];
        let none = [NOTHING; WIDTH];
        Block {
            ox: zero,
            oy: zero,
            oz: zero,
            dx: zero,
            dy: zero,
            dz: zero,
            t: zero,
            u: zero,
            v: zero,
            skip: none,
            target: none,
            id: none,
        }
    }

    /// Takes `rays` into the first lanes, each to meet what is nearer than its reach, or as near if `at_reach` says so.
    #[inline(always)]
    fn load(&mut self, rays: &[Ray], at_reach: bool) {
        for (k, ray) in rays.iter().enumerate() {
            (self.ox[k], self.oy[k], self.oz[k]) = (ray.origin.x, ray.origin.y, ray.origin.z);
            (self.dx[k], self.dy[k], self.dz[k]) = (ray.direction.x, ray.direction.y, ray.direction.z);
            self.t[k] = if at_reach { ray.reach.next_up() } else { ray.reach };
            (self.skip[k], self.target[k], self.id[k]) = (ray.skip, ray.target, NOTHING);
        }
    }

    /// What the ray of a lane has met. A lane keeps the surface coordinates of a quad behind a nearer sphere.
    #[inline(always)]
    fn hit(&self, few: &Few, k: usize) -> Hit {
        let (t, primitive) = (self.t[k], self.id[k]);
        match few.shapes.get(primitive as usize) {
            None => Hit::NONE,
            Some(Shape::Sphere { .. }) => Hit { t, primitive, u: 0.0, v: 0.0 },
            Some(_) => Hit { t, primitive, u: self.u[k], v: self.v[k] },
        }
    }

    #[inline(always)]
    fn meet_all(&mut self, few: &Few) {
        for (id, shape) in few.shapes.iter().enumerate() {
            match *shape {
                Shape::Sphere { center, radius } => self.sphere(center, radius, id as u32),
                Shape::Quad { corner, edge_x, edge_y } => self.quad(corner, edge_x, edge_y, id as u32),
                // There are none: `Few::new` refuses them.
                Shape::Triangle { .. } => {}
            }
        }
    }

    /// As `sphere` of `shape.rs`, with selects for its branches.
    #[inline(always)]
    fn sphere(&mut self, center: Vec3, r: f32, id: u32) {
        let (mut along, mut left) = ([0.0; WIDTH], [0.0; WIDTH]);
        let mut any = 0;
        for k in 0..WIDTH {
            let (x, y, z) = (self.ox[k] - center.x, self.oy[k] - center.y, self.oz[k] - center.z);
            let (dx, dy, dz) = (self.dx[k], self.dy[k], self.dz[k]);
            let b = x * dx + y * dy + z * dz;
            let (fx, fy, fz) = (x - b * dx, y - b * dy, z - b * dz);
            let h = r * r - (fx * fx + fy * fy + fz * fz);
            any |= i32::from(h >= 0.0) | i32::from(self.skip[k] == id);
            (along[k], left[k]) = (b, h);
        }
        // Rays of one pixel mostly miss a sphere together.
        if any == 0 {
            return;
        }
        for k in 0..WIDTH {
            let (b, h) = (along[k], left[k]);
            let root = h.max(0.0).sqrt();
            let (near, far) = (-b - root, root - b);
            let apart = if near > 0.0 { near } else { far };
            let on = self.skip[k] == id;
            let t = if on { -2.0 * b } else { apart };
            let least = if on { 1e-6 * r } else { 0.0 };
            let hit = (t > least) & (on | (h >= 0.0)) & (t < self.t[k]) & (self.target[k] != id);
            self.t[k] = if hit { t } else { self.t[k] };
            self.id[k] = if hit { id } else { self.id[k] };
        }
    }

    /// As `quad` of `shape.rs`, with selects for its branches.
    #[inline(always)]
    // `contains` asks one question after the other, which lanes cannot.
    #[allow(clippy::manual_range_contains)]
    fn quad(&mut self, corner: Vec3, ex: Vec3, ey: Vec3, id: u32) {
        for k in 0..WIDTH {
            let (x, y, z) = (self.ox[k] - corner.x, self.oy[k] - corner.y, self.oz[k] - corner.z);
            let (dx, dy, dz) = (self.dx[k], self.dy[k], self.dz[k]);
            let (px, py, pz) = (dy * ey.z - dz * ey.y, dz * ey.x - dx * ey.z, dx * ey.y - dy * ey.x);
            let inverse = 1.0 / (ex.x * px + ex.y * py + ex.z * pz);
            let u = (x * px + y * py + z * pz) * inverse;
            let (qx, qy, qz) = (y * ex.z - z * ex.y, z * ex.x - x * ex.z, x * ex.y - y * ex.x);
            let v = (dx * qx + dy * qy + dz * qz) * inverse;
            let t = (ey.x * qx + ey.y * qy + ey.z * qz) * inverse;
            let inside = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0);
            let hit = inside & (t > 0.0) & (t < self.t[k]) & (self.skip[k] != id) & (self.target[k] != id);
            self.t[k] = if hit { t } else { self.t[k] };
            self.u[k] = if hit { u } else { self.u[k] };
            self.v[k] = if hit { v } else { self.v[k] };
            self.id[k] = if hit { id } else { self.id[k] };
        }
    }
}

lanes! {
    /// Gives `hits` the closest hit of each ray.
    pub fn closest(few: &Few, rays: &[Ray], hits: &mut [Hit]) {
        let mut block = Block::empty();
        for (rays, hits) in rays.chunks(WIDTH).zip(hits.chunks_mut(WIDTH)) {
            block.load(rays, true);
            block.meet_all(few);
            for (k, hit) in hits.iter_mut().enumerate() {
                *hit = block.hit(few, k);
            }
        }
    }
}

lanes! {
    /// Gives `blocked` whether anything is in the way of each ray.
    pub fn any(few: &Few, rays: &[Ray], blocked: &mut [bool]) {
        let mut block = Block::empty();
        for (rays, blocked) in rays.chunks(WIDTH).zip(blocked.chunks_mut(WIDTH)) {
            block.load(rays, false);
            block.meet_all(few);
            for (k, blocked) in blocked.iter_mut().enumerate() {
                *blocked = block.id[k] != NOTHING;
            }
        }
    }
}
