//! Triangles that stand for the surfaces that are moved.

use crate::math::elementary::sincos;
use crate::scene::{Geometry, Primitive, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Steps along a side of what has no triangles of its own, where its element does not say: testrender's.
const RESOLUTION: u32 = 64;

/// Steps around or along and down or across that a primitive without triangles of its own is cut into.
fn steps(of: &Geometry, number: usize) -> [u32; 2] {
    let steps = of.resolution(number as u32).unwrap_or(RESOLUTION).max(1);
    match of.primitives[number].shape {
        Shape::Sphere { .. } => [steps.max(2).saturating_mul(2), steps.max(2)],
        Shape::Quad { .. } | Shape::Triangle { .. } => [steps; 2],
    }
}

/// How many triangles a primitive becomes, or a few more.
pub fn facets_of(of: &Geometry, number: usize) -> u64 {
    let [columns, rows] = steps(of, number).map(u64::from);
    match of.primitives[number].shape {
        Shape::Sphere { .. } | Shape::Quad { .. } => columns.saturating_mul(rows).saturating_mul(2),
        Shape::Triangle { .. } => 1,
    }
}

/// Adds the triangles of a primitive of `from` to `to`; a sphere's and a parallelogram's have normals and texture coordinates, by
/// which the moved surface is smooth again.
pub fn add_facets(from: &Geometry, number: usize, to: &mut Geometry) {
    let primitive = from.primitives[number];
    let [around, down] = steps(from, number);
    match primitive.shape {
        Shape::Triangle { .. } => add_as_it_is(from, number, to),
        Shape::Quad { corner, edge_x, edge_y } => {
            let normal = edge_x.cross(edge_y).normalize_or(Vec3::Y);
            let at = |u: u32, v: u32| {
                let uv = Vec2::new(u as f32 / around as f32, v as f32 / down as f32);
                Corner { p: corner + uv.x * edge_x + uv.y * edge_y, n: normal, uv }
            };
            add_grid(to, primitive.object, [around, down], at);
        }
        Shape::Sphere { center, radius } => {
            let at = |u: u32, v: u32| {
                // The last column lies on the first, and every corner of a pole is the pole.
                let (sin_u, cos_u) = sincos(2.0 * PI * (u % around) as f32 / around as f32);
                let (sin_v, cos_v) = sincos(PI * v as f32 / down as f32);
                let n = match v {
                    0 => Vec3::Y,
                    v if v == down => Vec3::NEG_Y,
                    _ => Vec3::new(-sin_u * sin_v, cos_v, -cos_u * sin_v),
                };
                let uv = Vec2::new(u as f32 / around as f32, v as f32 / down as f32);
                Corner { p: center + radius * n, n, uv }
            };
            add_grid(to, primitive.object, [around, down], at);
        }
    }
}

/// Adds a primitive as it is.
pub fn add_as_it_is(from: &Geometry, number: usize, to: &mut Geometry) {
    let primitive = from.primitives[number];
    let normals = kept(&from.normals, primitive.normals, &mut to.normals);
    let uvs = kept(&from.uvs, primitive.uvs, &mut to.uvs);
    to.primitives.push(Primitive { normals, uvs, ..primitive });
}

struct Corner {
    p: Vec3,
    n: Vec3,
    uv: Vec2,
}

fn kept<T: Copy>(from: &[T], index: u32, to: &mut Vec<T>) -> u32 {
    match from.get(index as usize) {
        Some(value) => {
            to.push(*value);
            to.len() as u32 - 1
        }
        None => Primitive::NONE,
    }
}

/// Adds two triangles for each cell of a grid, turned to the side of their normals, but for those that have no area.
fn add_grid(to: &mut Geometry, object: u32, [columns, rows]: [u32; 2], at: impl Fn(u32, u32) -> Corner) {
    for v in 0..rows {
        for u in 0..columns {
            for corners in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
                let mut corners = corners.map(|(x, y)| at(u + x, v + y));
                let normal = |c: &[Corner; 3]| (c[1].p - c[0].p).cross(c[2].p - c[0].p);
                let side = normal(&corners).dot(corners[0].n + corners[1].n + corners[2].n);
                if side < 0.0 {
                    corners.swap(1, 2);
                }
                if side == 0.0 || side.is_nan() {
                    continue;
                }
                let [a, b, c] = [0, 1, 2].map(|k| corners[k].p);
                to.normals.push([0, 1, 2].map(|k| corners[k].n));
                to.uvs.push([0, 1, 2].map(|k| corners[k].uv));
                let (normals, uvs) = (to.normals.len() as u32 - 1, to.uvs.len() as u32 - 1);
                to.primitives.push(Primitive { shape: Shape::Triangle { a, b, c }, object, normals, uvs });
            }
        }
    }
}
