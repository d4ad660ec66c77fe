//! Reads OBJ meshes, with the material names of their MTL files.

use super::error::{MeshFlaw, Place, SceneError, SceneProblem};
use super::geometry::{Geometry, Object, Primitive, Shape};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::path::Path;

/// How an OBJ's names find their shader groups.
pub struct MaterialNames<'a> {
    /// Named groups of the scene so far.
    pub by_name: &'a HashMap<String, u32>,
    /// The last group, for whatever has no name of its own.
    pub last: u32,
}

impl MaterialNames<'_> {
    fn find(&self, name: &str) -> u32 {
        self.by_name.get(name).copied().unwrap_or(self.last)
    }
}

/// Adds the mesh of `path` to `geometry`; gives the number of triangles without area, which are left out.
pub fn add_mesh(
    geometry: &mut Geometry,
    path: &Path,
    names: &MaterialNames,
    place: &Place,
) -> Result<usize, SceneError> {
    let fail = |flaw| SceneError::at(place.clone(), SceneProblem::Mesh { file: path.display().to_string(), flaw });
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, materials) = tobj::load_obj(path, &options).map_err(|e| fail(complaint(&e)))?;
    // A missing MTL is no mistake: OBJ files are often passed on without theirs.
    let materials = materials.unwrap_or_default();
    // As in testrender, shapes are matched by their own name only when no material name matches.
    let by_material = materials.iter().any(|m| names.by_name.contains_key(&m.name));
    let mut degenerate = 0;
    let mut shape_start = geometry.objects.len();
    let mut previous: Option<&str> = None;
    for model in &models {
        if previous != Some(model.name.as_str()) {
            share_area(geometry, shape_start);
            shape_start = geometry.objects.len();
            previous = Some(&model.name);
        }
        let material = match model.mesh.material_id.and_then(|id| materials.get(id)) {
            Some(m) if by_material => names.find(&m.name),
            _ if by_material => names.last,
            _ => names.find(&model.name),
        };
        degenerate += add_shape(geometry, &model.mesh, material, place).map_err(fail)?;
    }
    share_area(geometry, shape_start);
    if models.iter().all(|m| m.mesh.indices.is_empty()) {
        return Err(fail(MeshFlaw::NoFaces));
    }
    Ok(degenerate)
}

/// What is wrong with a mesh file, for people.
fn complaint(error: &tobj::LoadError) -> MeshFlaw {
    match error {
        tobj::LoadError::ReadError => MeshFlaw::NotText,
        tobj::LoadError::OpenFileFailed => MeshFlaw::Unopened,
        other => MeshFlaw::NotObj { reason: other.to_string() },
    }
}

/// The parts of one shape that differ only in material are one surface to `surfacearea()`.
fn share_area(geometry: &mut Geometry, start: usize) {
    let total: f32 = geometry.objects[start..].iter().map(|o| o.surface_area).sum();
    geometry.objects[start..].iter_mut().for_each(|o| o.surface_area = total);
}

fn add_shape(geometry: &mut Geometry, mesh: &tobj::Mesh, material: u32, place: &Place) -> Result<usize, MeshFlaw> {
    if mesh.positions.iter().any(|x| !x.is_finite()) {
        return Err(MeshFlaw::NotFinite);
    }
    let position = |i: u32| mesh.positions.get(3 * i as usize..3 * i as usize + 3).map(Vec3::from_slice);
    let normal = |i: u32| mesh.normals.get(3 * i as usize..3 * i as usize + 3).map(Vec3::from_slice);
    let uv = |i: u32| mesh.texcoords.get(2 * i as usize..2 * i as usize + 2).map(Vec2::from_slice);
    let object = geometry.objects.len() as u32;
    let (mut area, mut degenerate) = (0.0f64, 0);
    for (face, corners) in mesh.indices.chunks_exact(3).enumerate() {
        let Some([a, b, c]) = three(corners, position) else {
            return Err(MeshFlaw::NoSuchVertex);
        };
        let shape = Shape::Triangle { a, b, c };
        if shape.area() <= 0.0 {
            degenerate += 1;
            continue;
        }
        area += f64::from(shape.area());
        let own = |indices: &'_ [u32]| indices.get(3 * face..3 * face + 3).map(|s| [s[0], s[1], s[2]]);
        let normals = own(&mesh.normal_indices).and_then(|i| three(&i, normal)).filter(|n| n.iter().all(is_direction));
        let uvs = own(&mesh.texcoord_indices).and_then(|i| three(&i, uv)).filter(|t| t.iter().all(|t| t.is_finite()));
        geometry.primitives.push(Primitive {
            shape,
            object,
            normals: push(&mut geometry.normals, normals),
            uvs: push(&mut geometry.uvs, uvs),
        });
    }
    geometry.objects.push(Object { material, surface_area: area as f32, place: place.clone() });
    Ok(degenerate)
}

fn is_direction(n: &Vec3) -> bool {
    n.is_finite() && n.length_squared() > 0.0
}

fn three<T: Copy>(indices: &[u32], get: impl Fn(u32) -> Option<T>) -> Option<[T; 3]> {
    Some([get(indices[0])?, get(indices[1])?, get(indices[2])?])
}

fn push<T>(list: &mut Vec<T>, value: Option<T>) -> u32 {
    match value {
        Some(value) => {
            list.push(value);
            list.len() as u32 - 1
        }
        None => Primitive::NONE,
    }
}
