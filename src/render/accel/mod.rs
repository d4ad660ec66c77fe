//! Rays against geometry: one hierarchy over all primitives, closest hit and any hit.
//!
//! **No self-hits, no leaks.** A hit point is rebuilt from its primitive (corner and edges, vertices and weights, or
//! centre and radius), never as origin + t * direction, so its error is a few roundings of the primitive's largest
//! coordinate M. A new ray starts 2^-20 M off the surface (16 roundings), on the side it goes to, which clears its own
//! neighbourhood; and it skips the very primitive it starts on, which a ray from a flat primitive cannot meet again. A
//! ray that starts on a sphere can meet it on the far side: there the root t = 0 is divided out of the quadratic, so
//! no tolerance is needed. Triangles are tested by the signs of three edge functions; two triangles compute the same
//! number for the edge they share, up to its sign, and no rounding turns a sign around: no ray slips between them.
//!
//! Decision (2026-11-22): the tree of `obvhs` is put together to our own nodes of eight boxes in full precision and blocks
//! of four triangles, and walked by our own kernels, instead of by the stock walk of `obvhs` over its compressed
//! eight-wide nodes, because that answers more rays. One run of `cargo bench --bench rays`, one thread of a quiet 2-core
//! AMD EPYC, woven cloth of 1,051,392 triangles, million rays a second:
//!
//! | rays | closest hit | stock walk | any hit |
//! |---|---|---|---|
//! | camera | 3.27 | 1.54 | 4.24 |
//! | bounce | 2.92 | 1.34 | 3.13 |
//! | random | 2.17 | 0.98 | 2.49 |
//!
//! At 15,552 triangles the closest hits are 5.39, 4.68 and 3.57; a doubling of triangles adds 4 to 65 ns a ray. The
//! price is the build: 3.2 s for the million, where the stock tree takes 1.0 s.
//!
//! What each part brings, on woven cloth of 1.03 million triangles and a bumpy ball of 1.04 million:
//!
//! - Boxes in search distance 24 of the Morton curve and a tenth of the nodes reinserted, where 14 (with 1 in the first
//!   three rounds) and a twentieth were: a bounce visits 10.8 nodes and 3.3 blocks of the cloth, not 12.5 and 4.4.
//!   Twice as many reinsertions would make it 10.1 and 3.1, and take more than twice the time.
//! - Large pages and asking ahead (see `pages` and `prefetch`): random rays in the ball 1.15 to 1.3 million a second
//!   before asking ahead, 1.6 after it; large pages before that, a quarter on random rays in the cloth.
//! - The walk is compiled for AVX2 and for the baseline from the same source. Nothing is contracted and no order depends
//!   on the width, so both give the same bits.
//!
//! **One answer.** The closest hit does not depend on the instruction set or on what else is in a batch of rays; of
//! hits at the same distance the primitive that comes first in the scene is taken.

mod pages;
mod prefetch;
mod shape;
mod tree;
mod walk;

use super::few::{self, Few};
use super::shadow::ShadowRay;
use super::wave::Path;
use crate::scene::{Geometry, Shape};
use glam::Vec3;
use tree::Tree;

/// Stands for no primitive.
pub const NOTHING: u32 = u32::MAX;

/// The start of a ray is this much of M off its surface: 2^-20, exact.
const OFFSET: f32 = 9.536_743e-7;

/// The largest coordinate of a shape, M.
fn magnitude(shape: &Shape) -> f32 {
    match *shape {
        Shape::Sphere { center, radius } => center.abs().max_element() + radius,
        Shape::Quad { corner, edge_x, edge_y } => (corner.abs() + edge_x.abs() + edge_y.abs()).max_element(),
        Shape::Triangle { a, b, c } => a.abs().max(b.abs()).max(c.abs()).max_element(),
    }
}

/// A ray, and what it does not meet.
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

/// Up to this many primitives, all of them are tested. Measured at seven only; the bound is a guess from the cost of
/// one test.
const MOST: usize = 24;

/// Rays that are handed to a kernel at once.
const PACK: usize = 256;

/// How rays find what they hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every primitive against sixteen rays at a time, no hierarchy; only for a few spheres and quads.
    Few,
    /// A hierarchy of eight children a node.
    Wide,
}

enum Hierarchy {
    Few(Few),
    Wide(Tree),
}

/// Geometry, prepared for rays.
pub struct Accel {
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
        let magnitude: Vec<f32> = geometry.primitives.iter().map(|p| magnitude(&p.shape)).collect();
        let few = if method == Method::Few { Few::new(geometry, usize::MAX) } else { None };
        let hierarchy = match few {
            Some(few) => Hierarchy::Few(few),
            None => Hierarchy::Wide(Tree::new(geometry, &magnitude)),
        };
        Accel { hierarchy, magnitude }
    }

    /// Bytes of the hierarchy, nodes and leaves.
    pub fn bytes(&self) -> usize {
        match &self.hierarchy {
            Hierarchy::Few(_) => 0,
            Hierarchy::Wide(tree) => tree.bytes(),
        }
    }

    /// Stores the closest hit of each active path.
    pub fn intersect(&self, paths: &mut [Path], active: &[u32]) {
        let tree = match &self.hierarchy {
            Hierarchy::Few(few) => return few::intersect(few, paths, active),
            Hierarchy::Wide(tree) => tree,
        };
        let mut rays = Vec::with_capacity(PACK);
        let mut hits = [Hit::NONE; PACK];
        for part in active.chunks(PACK) {
            rays.clear();
            rays.extend(part.iter().map(|&i| {
                let path = &paths[i as usize];
                Ray { skip: path.from, ..Ray::new(path.hit.origin, path.hit.direction) }
            }));
            walk::closest(tree, &rays, &mut hits);
            for (&i, found) in part.iter().zip(&hits) {
                let hit = &mut paths[i as usize].hit;
                (hit.t, hit.primitive, hit.u, hit.v) = (found.t, found.primitive, found.u, found.v);
            }
        }
    }

    /// Keeps in `clear` the numbers of the rays that nothing stops short of their target.
    pub fn unoccluded(&self, shadows: &[ShadowRay], clear: &mut Vec<u32>) {
        clear.clear();
        let tree = match &self.hierarchy {
            Hierarchy::Few(few) => return few::unoccluded(few, shadows, clear),
            Hierarchy::Wide(tree) => tree,
        };
        let mut rays = Vec::with_capacity(PACK);
        let mut blocked = [false; PACK];
        for (number, part) in shadows.chunks(PACK).enumerate() {
            rays.clear();
            rays.extend(part.iter().map(|s| Ray {
                origin: s.origin,
                direction: s.direction,
                reach: s.distance,
                skip: s.from,
                target: s.target,
            }));
            walk::any(tree, &rays, &mut blocked);
            clear.extend((0..part.len()).filter(|&k| !blocked[k]).map(|k| (number * PACK + k) as u32));
        }
    }

    /// Gives `hits` the closest hit of each ray, up to its reach and not counting what it skips or goes to.
    pub fn closest(&self, rays: &[Ray], hits: &mut Vec<Hit>) {
        hits.clear();
        hits.resize(rays.len(), Hit::NONE);
        match &self.hierarchy {
            Hierarchy::Few(few) => few::closest(few, rays, hits),
            Hierarchy::Wide(tree) => walk::closest(tree, rays, hits),
        }
    }

    /// Gives `blocked` whether anything but what it skips or goes to is in the way of each ray, short of its reach.
    pub fn any(&self, rays: &[Ray], blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        match &self.hierarchy {
            Hierarchy::Few(few) => few::any(few, rays, blocked),
            Hierarchy::Wide(tree) => walk::any(tree, rays, blocked),
        }
    }

    /// Where a ray toward `direction` starts that leaves `point` of `primitive`.
    #[inline]
    pub fn leave(&self, point: Vec3, ng: Vec3, direction: Vec3, primitive: u32) -> Vec3 {
        let distance = OFFSET * self.magnitude[primitive as usize];
        point + ng * distance.copysign(ng.dot(direction))
    }
}
