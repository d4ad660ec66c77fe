//! Meshes: from the file that an element names to triangles with materials.

use super::error::{MeshFlaw, Place};
use super::geometry::{Geometry, Object, Primitive, Shape};
use super::obj::{self, Corner, Note, ObjFlaw, ObjMesh};
use super::placement::Placement;
use crate::limits::{CUTTING_STEPS, LIBRARY_BYTES, MESH_BYTES};
use glam::Vec3;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::path::Path;
use velour_grammar::files::{Access, ReadError};

/// A mesh file, read.
#[derive(Debug)]
pub struct MeshFile {
    mesh: ObjMesh,
    /// What is odd in it and in its MTL files, as warnings.
    pub warnings: Vec<String>,
}

impl MeshFile {
    /// Reads an OBJ file, and looks for what is odd in the MTL files that it names.
    ///
    /// # Errors
    /// It cannot be opened, is too large, or is no OBJ.
    pub fn read(path: &Path, access: &Access) -> Result<Self, MeshFlaw> {
        let text = access.read(path, MESH_BYTES).map_err(unopened)?;
        let mesh = obj::read(&text).map_err(|flaw| match flaw {
            ObjFlaw::NotText => MeshFlaw::NotText,
            ObjFlaw::Line { line, flaw } => MeshFlaw::Line { line, flaw },
        })?;
        if mesh.ends.is_empty() {
            return Err(MeshFlaw::NoFaces);
        }
        let mut warnings: Vec<String> = mesh.notes.warnings(&path.display().to_string()).collect();
        for library in &mesh.libraries {
            check_library(path, library, access, &mut warnings);
        }
        Ok(MeshFile { mesh, warnings })
    }

    /// How many triangles its faces make at most.
    pub fn triangles(&self) -> u64 {
        self.mesh.triangles()
    }
}

fn unopened(error: ReadError) -> MeshFlaw {
    match error {
        ReadError::TooLarge { most } => MeshFlaw::TooLarge { most },
        other => MeshFlaw::Unopened { reason: other.to_string() },
    }
}

/// Warns of what is odd in an MTL file, and of one that is not there: material names are matched all the same.
fn check_library(mesh: &Path, library: &Note, access: &Access, warnings: &mut Vec<String>) {
    let folder = mesh.parent().unwrap_or(Path::new(""));
    let whole = folder.join(&library.text);
    // One name with spaces in it, or several names.
    let files = match access.is_file(&whole) {
        true => vec![whole],
        false => library.text.split_whitespace().map(|name| folder.join(name)).collect(),
    };
    for file in files {
        let shown = file.display().to_string();
        match access.read(&file, LIBRARY_BYTES).map_err(unopened) {
            Ok(text) => warnings.extend(obj::check_library(&text).warnings(&shown)),
            Err(flaw) => {
                let place = format!("{}:{}", mesh.display(), library.line);
                warnings.push(format!("{place}: warning: `{shown}`: {flaw}; materials are matched by name without it"));
            }
        }
    }
}

/// How an OBJ's names find their shader groups.
pub struct MaterialNames<'a> {
    /// Named groups of the scene so far.
    pub by_name: &'a HashMap<String, u32>,
    /// The last group, for whatever has no name of its own.
    pub last: u32,
}

impl MaterialNames<'_> {
    /// The group of a name, or of the first of several that has one.
    fn find(&self, name: &str) -> Option<u32> {
        let whole = self.by_name.get(name);
        whole.or_else(|| name.split_whitespace().find_map(|word| self.by_name.get(word))).copied()
    }
}

/// What has become of the faces of a mesh.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Added {
    /// Triangles with an area.
    pub kept: usize,
    /// Triangles without one, which are left out.
    pub degenerate: usize,
    /// Some polygons were cut anyhow, as all together have too many corners.
    pub hurried: bool,
    /// Material names without a shader group, where others have one.
    pub unmatched: Vec<String>,
}

/// Adds a mesh to `geometry`.
///
/// As in testrender, shapes are matched by their own name only when no material name matches. Differs from testrender:
/// the names are those of `usemtl`, whether an MTL file has them or not.
///
/// # Errors
/// The placement puts a vertex beyond what a single can hold.
pub fn add_mesh(
    geometry: &mut Geometry,
    file: &MeshFile,
    placement: Option<&Placement>,
    names: &MaterialNames,
    place: &Place,
) -> Result<Added, MeshFlaw> {
    let mesh = &file.mesh;
    let mut adder = Adder::new(geometry, mesh, placement)?;
    let used: BTreeSet<u32> = mesh.parts.iter().map(|part| part.material).filter(|&name| name != 0).collect();
    let named = |name: u32| names.find(&mesh.names[name as usize]);
    let by_material = used.iter().any(|&name| named(name).is_some());
    for shape in mesh.parts.chunk_by(|a, b| a.shape == b.shape) {
        let first = adder.geometry.objects.len();
        for part in shape {
            let name = if by_material { part.material } else { part.shape_name };
            let material = Some(name).filter(|&name| name != 0).and_then(named).unwrap_or(names.last);
            adder.add(part.faces.clone(), material, first, place);
        }
        share_area(adder.geometry, first);
    }
    let mut added = adder.added;
    added.hurried = adder.steps == 0;
    if by_material {
        added.unmatched = used
            .into_iter()
            .filter(|&name| named(name).is_none())
            .map(|name| mesh.names[name as usize].clone())
            .collect();
    }
    Ok(added)
}

/// The parts of one shape that differ only in material are one surface to `surfacearea()`.
fn share_area(geometry: &mut Geometry, start: usize) {
    let total: f32 = geometry.objects[start..].iter().map(|o| o.surface_area).sum();
    geometry.objects[start..].iter_mut().for_each(|o| o.surface_area = total);
}

/// Turns faces into triangles.
struct Adder<'a> {
    geometry: &'a mut Geometry,
    mesh: &'a ObjMesh,
    positions: Cow<'a, [Vec3]>,
    normals: Cow<'a, [Vec3]>,
    mirrors: bool,
    added: Added,
    /// Corners of a polygon, and its triangles.
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Steps that are left for cutting polygons.
    steps: u64,
}

impl<'a> Adder<'a> {
    fn new(geometry: &'a mut Geometry, mesh: &'a ObjMesh, placement: Option<&Placement>) -> Result<Self, MeshFlaw> {
        let (positions, normals) = match placement {
            None => (Cow::from(&mesh.positions), Cow::from(&mesh.normals)),
            Some(placement) => {
                let positions: Vec<Vec3> = mesh.positions.iter().map(|p| placement.point(*p)).collect();
                (
                    Cow::from(positions),
                    Cow::from(mesh.normals.iter().copied().map(placement.normals()).collect::<Vec<_>>()),
                )
            }
        };
        if !positions.iter().all(|p| p.is_finite()) {
            return Err(MeshFlaw::NotFinite);
        }
        let triangles = mesh.corners.len() - 2 * mesh.ends.len();
        geometry.primitives.reserve(triangles);
        geometry.normals.reserve(if mesh.normals.is_empty() { 0 } else { triangles });
        geometry.uvs.reserve(if mesh.uvs.is_empty() { 0 } else { triangles });
        let mirrors = placement.is_some_and(Placement::mirrors);
        let (added, points, triangles) = (Added::default(), Vec::new(), Vec::new());
        Ok(Adder { geometry, mesh, positions, normals, mirrors, added, points, triangles, steps: CUTTING_STEPS })
    }

    /// Adds faces of one material to the object of it, of those from `first` on, or to a new one.
    fn add(&mut self, faces: Range<usize>, material: u32, first: usize, place: &Place) {
        let known = self.geometry.objects[first..].iter().position(|object| object.material == material);
        let object = known.map_or(self.geometry.objects.len(), |at| first + at);
        let before = self.geometry.primitives.len();
        let area: f64 = faces.map(|face| self.face(face, object as u32)).sum();
        if known.is_some() {
            self.geometry.objects[object].surface_area += area as f32;
        } else {
            self.geometry.add_object(Object { material, surface_area: area as f32, place: place.clone() }, before);
        }
    }

    /// Adds a face; gives its area.
    #[inline]
    fn face(&mut self, number: usize, object: u32) -> f64 {
        let mesh = self.mesh;
        let corners = mesh.face(number);
        if let &[a, b, c] = corners {
            return self.triangle([a, b, c], object);
        }
        self.points.clear();
        self.points.extend(corners.iter().map(|corner| self.positions[corner.position as usize]));
        let mut triangles = std::mem::take(&mut self.triangles);
        triangles.clear();
        obj::triangulate(&self.points, &mut self.steps, &mut triangles);
        let area = triangles.iter().map(|t| self.triangle(t.map(|i| corners[i as usize]), object)).sum();
        self.triangles = triangles;
        area
    }

    /// Adds a triangle unless it has no area; gives its area.
    #[inline]
    fn triangle(&mut self, [first, mut second, mut third]: [Corner; 3], object: u32) -> f64 {
        if self.mirrors {
            std::mem::swap(&mut second, &mut third);
        }
        let corners = [first, second, third];
        let [a, b, c] = corners.map(|corner| self.positions[corner.position as usize]);
        let shape = Shape::Triangle { a, b, c };
        let area = shape.area();
        // Not a number where the edges are too long for a single.
        if area <= 0.0 || area.is_nan() {
            self.added.degenerate += 1;
            return 0.0;
        }
        self.added.kept += 1;
        let normals = all(corners.map(|corner| self.normals.get(corner.normal as usize).copied()));
        let uvs = all(corners.map(|corner| self.mesh.uvs.get(corner.uv as usize).copied()));
        let normals = push(&mut self.geometry.normals, normals.filter(|n| n.iter().all(is_direction)));
        let uvs = push(&mut self.geometry.uvs, uvs);
        self.geometry.primitives.push(Primitive { shape, object, normals, uvs });
        f64::from(area)
    }
}

fn is_direction(n: &Vec3) -> bool {
    n.length_squared() > 0.0
}

#[inline]
fn all<T: Copy>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

#[inline]
fn push<T>(list: &mut Vec<T>, value: Option<T>) -> u32 {
    match value {
        Some(value) => {
            list.push(value);
            list.len() as u32 - 1
        }
        None => Primitive::NONE,
    }
}
