//! Geometry prepared for rays: by which method, and where a ray starts that leaves a surface.

use super::few::{self, Few};
use super::ray::{Hit, Ray};
use super::tree::Tree;
use super::walk;
use crate::scene::{Geometry, Shape};
use glam::Vec3;

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

/// Up to this many primitives, all of them are tested. Measured at seven only; the bound is a guess from the cost of
/// one test.
const MOST: usize = 24;

/// How rays find what they hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every primitive against sixteen rays at a time, no hierarchy; only for a few spheres and quads.
    Few,
    /// A hierarchy of eight children a node.
    Wide,
}

#[derive(Debug)]
enum Structure {
    Few(Few),
    Wide(Tree),
}

/// Geometry, prepared for rays.
#[derive(Debug)]
pub struct Accel {
    structure: Structure,
    /// How far off each primitive a ray starts that leaves it.
    margin: Vec<f32>,
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
        let margin: Vec<f32> = geometry.primitives.iter().map(|p| OFFSET * magnitude(&p.shape)).collect();
        let few = match method {
            Method::Few => Few::new(geometry, usize::MAX),
            Method::Wide => None,
        };
        let structure = match few {
            Some(few) => Structure::Few(few),
            None => Structure::Wide(Tree::new(geometry, &margin)),
        };
        Accel { structure, margin }
    }

    /// Bytes of the hierarchy, nodes and leaves.
    pub fn bytes(&self) -> usize {
        match &self.structure {
            Structure::Few(_) => 0,
            Structure::Wide(tree) => tree.bytes(),
        }
    }

    /// Gives `hits` the closest hit of each ray, up to its reach and not counting what it skips or goes to.
    pub fn closest(&self, rays: &[Ray], hits: &mut Vec<Hit>) {
        hits.clear();
        hits.resize(rays.len(), Hit::NONE);
        match &self.structure {
            Structure::Few(few) => few::closest(few, rays, hits),
            Structure::Wide(tree) => walk::closest(tree, rays, hits),
        }
    }

    /// Gives `blocked` whether anything but what it skips or goes to is in the way of each ray, short of its reach.
    pub fn any(&self, rays: &[Ray], blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        match &self.structure {
            Structure::Few(few) => few::any(few, rays, blocked),
            Structure::Wide(tree) => walk::any(tree, rays, blocked),
        }
    }

    /// Where a ray toward `direction` starts that leaves `point` of `primitive`.
    #[inline]
    pub fn leave(&self, point: Vec3, ng: Vec3, direction: Vec3, primitive: u32) -> Vec3 {
        let distance = self.margin[primitive as usize];
        point + ng * distance.copysign(ng.dot(direction))
    }
}
