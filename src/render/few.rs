//! Scenes of a few spheres and quads: no hierarchy, every ray against blocks of eight primitives at once.
//!
//! On the scene of figure 1 (seven primitives) a hierarchy is one node and costs more to walk than the primitives cost
//! to test; see `accel::Method` for the figures.

use super::accel::{Hit, NOTHING};
use super::shadow::ShadowRay;
use super::wave::Path;
use crate::scene::{Geometry, Shape};
use glam::Vec3;
use multiversion::multiversion;

const WIDTH: usize = 8;
type Lanes = [f32; WIDTH];

/// Eight primitives of one kind, one array a component; empty places hold numbers that no ray meets.
#[derive(Clone, Debug)]
struct Block {
    a: [Lanes; 3],
    b: [Lanes; 3],
    c: [Lanes; 3],
    id: [u32; WIDTH],
}

/// All primitives of a small scene.
#[derive(Clone, Debug)]
pub struct Few {
    spheres: Vec<Block>,
    quads: Vec<Block>,
}

impl Few {
    /// The blocks of `geometry`, unless it has triangles or needs more than `most` blocks.
    pub fn new(geometry: &Geometry, most: usize) -> Option<Few> {
        let (mut spheres, mut quads) = (Vec::new(), Vec::new());
        for (id, primitive) in geometry.primitives.iter().enumerate() {
            match primitive.shape {
                Shape::Sphere { center, radius } => spheres.push((id as u32, center, Vec3::splat(radius), Vec3::ZERO)),
                Shape::Quad { corner, edge_x, edge_y } => quads.push((id as u32, corner, edge_x, edge_y)),
                Shape::Triangle { .. } => return None,
            }
            if spheres.len().div_ceil(WIDTH) + quads.len().div_ceil(WIDTH) > most {
                return None;
            }
        }
        Some(Few { spheres: blocks(&spheres), quads: blocks(&quads) })
    }
}

fn blocks(list: &[(u32, Vec3, Vec3, Vec3)]) -> Vec<Block> {
    let block = |part: &[(u32, Vec3, Vec3, Vec3)]| {
        // NaN fails every comparison that a hit must pass.
        let mut block = Block { a: [[0.0; 8]; 3], b: [[f32::NAN; 8]; 3], c: [[0.0; 8]; 3], id: [NOTHING; WIDTH] };
        for (k, (id, a, b, c)) in part.iter().enumerate() {
            block.id[k] = *id;
            for axis in 0..3 {
                (block.a[axis][k], block.b[axis][k], block.c[axis][k]) = (a[axis], b[axis], c[axis]);
            }
        }
        block
    };
    list.chunks(WIDTH).map(block).collect()
}

/// Distances to eight spheres; the formulas are those of `accel::sphere`.
#[inline(always)]
fn spheres(s: &Block, o: Vec3, d: Vec3, skip: u32) -> Lanes {
    let mut out = [f32::INFINITY; WIDTH];
    for k in 0..WIDTH {
        let (x, y, z, r) = (o.x - s.a[0][k], o.y - s.a[1][k], o.z - s.a[2][k], s.b[0][k]);
        let b = x * d.x + y * d.y + z * d.z;
        let (fx, fy, fz) = (x - b * d.x, y - b * d.y, z - b * d.z);
        let h = r * r - (fx * fx + fy * fy + fz * fz);
        let root = h.max(0.0).sqrt();
        let (near, far) = (-b - root, root - b);
        let t = if near > 0.0 { near } else { far };
        let apart = if (h >= 0.0) & (t > 0.0) { t } else { f32::INFINITY };
        let leaving = if -2.0 * b > 1e-6 * r { -2.0 * b } else { f32::INFINITY };
        out[k] = if s.id[k] == skip { leaving } else { apart };
    }
    out
}

/// Distances to eight quads and where on them; the formulas are those of `accel::quad`.
#[inline(always)]
fn quads(q: &Block, o: Vec3, d: Vec3, skip: u32) -> (Lanes, Lanes, Lanes) {
    let (mut ts, mut us, mut vs) = ([f32::INFINITY; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
    for k in 0..WIDTH {
        let (x, y, z) = (o.x - q.a[0][k], o.y - q.a[1][k], o.z - q.a[2][k]);
        let (ax, ay, az) = (q.b[0][k], q.b[1][k], q.b[2][k]);
        let (bx, by, bz) = (q.c[0][k], q.c[1][k], q.c[2][k]);
        let (px, py, pz) = (d.y * bz - d.z * by, d.z * bx - d.x * bz, d.x * by - d.y * bx);
        let inverse = 1.0 / (ax * px + ay * py + az * pz);
        let u = (x * px + y * py + z * pz) * inverse;
        let (wx, wy, wz) = (y * az - z * ay, z * ax - x * az, x * ay - y * ax);
        let v = (d.x * wx + d.y * wy + d.z * wz) * inverse;
        let t = (bx * wx + by * wy + bz * wz) * inverse;
        let inside = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0) & (t > 0.0) & (q.id[k] != skip);
        (ts[k], us[k], vs[k]) = (if inside { t } else { f32::INFINITY }, u, v);
    }
    (ts, us, vs)
}

#[inline(always)]
fn closest(few: &Few, o: Vec3, d: Vec3, skip: u32) -> Hit {
    let mut hit = Hit { t: f32::INFINITY, primitive: NOTHING, u: 0.0, v: 0.0 };
    for block in &few.spheres {
        let ts = spheres(block, o, d, skip);
        for k in 0..WIDTH {
            if ts[k] < hit.t {
                (hit.t, hit.primitive) = (ts[k], block.id[k]);
            }
        }
    }
    for block in &few.quads {
        let (ts, us, vs) = quads(block, o, d, skip);
        for k in 0..WIDTH {
            if ts[k] < hit.t {
                hit = Hit { t: ts[k], primitive: block.id[k], u: us[k], v: vs[k] };
            }
        }
    }
    hit
}

/// Stores the closest hit of each active path.
#[multiversion(targets("x86_64+avx2", "x86_64+avx512f+avx512vl"))]
pub fn intersect(few: &Few, paths: &mut [Path], active: &[u32]) {
    for &i in active {
        let path = &mut paths[i as usize];
        let hit = closest(few, path.hit.origin, path.hit.direction, path.from);
        (path.hit.t, path.hit.primitive, path.hit.u, path.hit.v) = (hit.t, hit.primitive, hit.u, hit.v);
    }
}

/// Keeps in `clear` the numbers of the rays that nothing stops.
#[multiversion(targets("x86_64+avx2", "x86_64+avx512f+avx512vl"))]
pub fn unoccluded(few: &Few, rays: &[ShadowRay], clear: &mut Vec<u32>) {
    for (i, ray) in rays.iter().enumerate() {
        let mut nearest = f32::INFINITY;
        let mut meet = |ts: Lanes, ids: &[u32; WIDTH]| {
            for k in 0..WIDTH {
                nearest = nearest.min(if ids[k] == ray.target { f32::INFINITY } else { ts[k] });
            }
        };
        few.spheres.iter().for_each(|b| meet(spheres(b, ray.origin, ray.direction, ray.from), &b.id));
        few.quads.iter().for_each(|b| meet(quads(b, ray.origin, ray.direction, ray.from).0, &b.id));
        // An infinite distance must not stop a ray that nothing stands in the way of.
        if nearest >= ray.distance {
            clear.push(i as u32);
        }
    }
}
