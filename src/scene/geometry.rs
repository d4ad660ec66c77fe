//! The geometry of a scene: spheres, parallelograms and triangles, each a part of an object.

use super::error::Place;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The form of a primitive.
///
/// Differs from OSL: testrender tessellates spheres and quads; here they are exact unless a shader moves them, so silhouettes are
/// round and a sphere's area is 4 pi r^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere; its poles are along y, u runs around them and v from +y to -y.
    Sphere {
        /// Its centre.
        center: Vec3,
        /// Its radius, above zero.
        radius: f32,
    },
    /// A parallelogram; u runs along `edge_x`, v along `edge_y`, the normal is `edge_x` x `edge_y`.
    Quad {
        /// The corner where u = v = 0.
        corner: Vec3,
        /// From the corner to where u = 1.
        edge_x: Vec3,
        /// From the corner to where v = 1.
        edge_y: Vec3,
    },
    /// A triangle; the normal is (b - a) x (c - a).
    Triangle {
        /// First vertex.
        a: Vec3,
        /// Second vertex.
        b: Vec3,
        /// Third vertex.
        c: Vec3,
    },
}

impl Shape {
    /// The surface area.
    pub fn area(&self) -> f32 {
        match *self {
            Shape::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Shape::Quad { edge_x, edge_y, .. } => edge_x.cross(edge_y).length(),
            Shape::Triangle { a, b, c } => 0.5 * (b - a).cross(c - a).length(),
        }
    }
}

/// One primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Its form.
    pub shape: Shape,
    /// Which object it belongs to.
    pub object: u32,
    /// Index of its vertex normals, or `NONE`.
    pub normals: u32,
    /// Index of its vertex texture coordinates, or `NONE`.
    pub uvs: u32,
}

impl Primitive {
    /// Stands for no vertex normals or no texture coordinates.
    pub const NONE: u32 = u32::MAX;
}

/// What the primitives of one object share.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Index of the material.
    pub material: u32,
    /// The area of all of it, for `surfacearea()`.
    pub surface_area: f32,
    /// Where the scene names it.
    pub place: Place,
}

/// All geometry of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    /// The primitives in the order of the scene.
    pub primitives: Vec<Primitive>,
    /// The objects.
    pub objects: Vec<Object>,
    /// Vertex normals of the triangles that have them; not all of unit length.
    pub normals: Vec<[Vec3; 3]>,
    /// Texture coordinates of the triangles that have them.
    pub uvs: Vec<[Vec2; 3]>,
    /// Steps along a side, by primitive, of spheres and parallelograms whose elements say it, in their order; read where they are moved.
    pub resolutions: Vec<(u32, u32)>,
}

impl Geometry {
    /// Adds the object of the primitives from `first` on; one without primitives, which no ray could meet, is left out.
    pub(super) fn add_object(&mut self, object: Object, first: usize) {
        if self.primitives.len() > first {
            self.objects.push(object);
        }
    }

    /// Steps along a side that the element of a primitive states.
    pub fn resolution(&self, primitive: u32) -> Option<u32> {
        let at = self.resolutions.binary_search_by_key(&primitive, |(of, _)| *of).ok()?;
        Some(self.resolutions[at].1)
    }

    /// Adds an object of one analytic primitive.
    pub fn add_single(&mut self, shape: Shape, material: u32, place: Place) {
        let object = self.objects.len() as u32;
        self.objects.push(Object { material, surface_area: shape.area(), place });
        self.primitives.push(Primitive { shape, object, normals: Primitive::NONE, uvs: Primitive::NONE });
    }
}
