//! What an OBJ file says, as data.

use super::flaw::Attribute;
use super::notes::{Note, Notes};
use glam::{Vec2, Vec3};
use std::ops::Range;

/// A corner of a face: indices from 0, or [`Corner::NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Its position.
    pub position: u32,
    /// Its texture coordinates.
    pub uv: u32,
    /// Its normal.
    pub normal: u32,
}

impl Corner {
    /// Stands for no texture coordinates or no normal.
    pub const NONE: u32 = u32::MAX;
}

/// Faces in a row that share their shape and their material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of the shape; an `o` or `g` of another name begins one.
    pub shape: u32,
    /// Index of the name of the last `o` or `g`.
    pub shape_name: u32,
    /// Index of the name of the last `usemtl`.
    pub material: u32,
    /// The faces.
    pub faces: Range<usize>,
}

/// What an OBJ file says. Every index that a corner has is in range, unless there are no texture coordinates or normals at all.
#[derive(Clone, Debug, Default)]
pub struct ObjMesh {
    /// The positions, all finite.
    pub positions: Vec<Vec3>,
    /// Texture coordinates, all finite.
    pub uvs: Vec<Vec2>,
    /// Normals, all finite, of any length.
    pub normals: Vec<Vec3>,
    /// The corners of all faces, one face after another.
    pub corners: Vec<Corner>,
    /// Where each face ends in `corners`.
    pub ends: Vec<u32>,
    /// The faces by shape and material, in the order of the file; none is empty.
    pub parts: Vec<Part>,
    /// Names of shapes and materials; the first one is empty and stands for none.
    pub names: Vec<String>,
    /// The MTL files that it names.
    pub libraries: Vec<Note>,
    /// What is odd.
    pub notes: Notes,
}

impl ObjMesh {
    /// The corners of a face.
    #[inline]
    pub fn face(&self, number: usize) -> &[Corner] {
        let start = if number == 0 { 0 } else { self.ends[number - 1] as usize };
        &self.corners[start..self.ends[number] as usize]
    }

    /// How many triangles the faces make at most: two fewer than corners each.
    pub fn triangles(&self) -> u64 {
        (self.corners.len() as u64).saturating_sub(2 * self.ends.len() as u64)
    }

    /// How many vertices of a kind there are.
    #[inline]
    pub fn count(&self, attribute: Attribute) -> usize {
        match attribute {
            Attribute::Position => self.positions.len(),
            Attribute::Uv => self.uvs.len(),
            Attribute::Normal => self.normals.len(),
        }
    }
}
