//! From a hit to a shading point: position, normals, texture coordinates and derivatives, as far as they are read.

use super::plan::Needs;
use crate::exec::Points;
use crate::scene::{Geometry, Primitive, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// A ray and where it hits.
#[derive(Clone, Copy, Debug)]
pub struct RayHitPoint {
    /// The ray's origin.
    pub origin: Vec3,
    /// Its unit direction.
    pub direction: Vec3,
    /// Distance of the hit.
    pub t: f32,
    /// The primitive that is hit.
    pub primitive: u32,
    /// Surface coordinates, as `accel::Hit` has them.
    pub u: f32,
    /// Surface coordinates, as `accel::Hit` has them.
    pub v: f32,
    /// Width of the ray's cone at its origin.
    pub radius: f32,
    /// Growth of that width with distance.
    pub spread: f32,
    /// Bits of the ray's kind.
    pub ray_type: i32,
}

/// Position and geometric normal (unit, outward, not turned) of a hit.
#[inline]
pub fn place(geometry: &Geometry, hit: &RayHitPoint) -> (Vec3, Vec3) {
    match geometry.primitives[hit.primitive as usize].shape {
        Shape::Sphere { center, radius } => {
            let n = (hit.origin + hit.t * hit.direction - center).normalize_or(Vec3::Y);
            (center + radius * n, n)
        }
        Shape::Quad { corner, edge_x, edge_y } => {
            (corner + hit.u * edge_x + hit.v * edge_y, edge_x.cross(edge_y).normalize())
        }
        Shape::Triangle { a, b, c } => {
            ((1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c, (b - a).cross(c - a).normalize())
        }
    }
}

/// Fills one lane of `points`; gives position and geometric normal, turned to the ray as testrender turns it.
#[inline]
pub fn fill(points: &mut Points, lane: usize, geometry: &Geometry, hit: &RayHitPoint, needs: &Needs) -> (Vec3, Vec3) {
    let primitive = &geometry.primitives[hit.primitive as usize];
    let (p, outward) = place(geometry, hit);
    let backfacing = outward.dot(hit.direction) > 0.0;
    let smooth = match primitive.normals {
        Primitive::NONE => outward,
        index => {
            let [na, nb, nc] = geometry.normals[index as usize];
            ((1.0 - hit.u - hit.v) * na + hit.u * nb + hit.v * nc).normalize_or(outward)
        }
    };
    let sign = if backfacing { -1.0 } else { 1.0 };
    let (n, ng) = (smooth * sign, outward * sign);
    points.p.set(lane, p);
    points.i.set(lane, hit.direction);
    points.n.set(lane, n);
    points.ng.set(lane, ng);
    points.backfacing[lane] = i32::from(backfacing);
    points.ray_type[lane] = hit.ray_type;
    points.surface_area[lane] = geometry.objects[primitive.object as usize].surface_area;
    if needs.uv {
        let uv = texture_coordinates(geometry, primitive, hit, outward);
        points.u[lane] = uv.x;
        points.v[lane] = uv.y;
    }
    if needs.tangents || needs.uv_derivatives {
        let (dpdu, dpdv) = tangents(geometry, primitive, outward);
        points.dpdu.set(lane, dpdu);
        points.dpdv.set(lane, dpdv);
    }
    if needs.any_derivative() {
        footprint(points, lane, hit, n);
    }
    (p, ng)
}

fn texture_coordinates(geometry: &Geometry, primitive: &Primitive, hit: &RayHitPoint, n: Vec3) -> Vec2 {
    match primitive.shape {
        Shape::Sphere { .. } => {
            let around = (-n.x).atan2(-n.z) * (0.5 * FRAC_1_PI);
            Vec2::new(if around < 0.0 { around + 1.0 } else { around }, n.y.clamp(-1.0, 1.0).acos() * FRAC_1_PI)
        }
        Shape::Quad { .. } => Vec2::new(hit.u, hit.v),
        Shape::Triangle { .. } => match geometry.uvs.get(primitive.uvs as usize) {
            Some([a, b, c]) => (1.0 - hit.u - hit.v) * *a + hit.u * *b + hit.v * *c,
            None => Vec2::ZERO,
        },
    }
}

fn tangents(geometry: &Geometry, primitive: &Primitive, n: Vec3) -> (Vec3, Vec3) {
    match primitive.shape {
        Shape::Sphere { radius, .. } => {
            let dpdu = 2.0 * PI * radius * Vec3::new(n.z, 0.0, -n.x);
            let sin = (n.x * n.x + n.z * n.z).sqrt();
            // At a pole every direction runs down; testrender's first one is -z.
            let down = if sin > 0.0 { Vec3::new(n.x / sin * n.y, -sin, n.z / sin * n.y) } else { Vec3::NEG_Z * n.y };
            (dpdu, PI * radius * down)
        }
        Shape::Quad { edge_x, edge_y, .. } => (edge_x, edge_y),
        Shape::Triangle { a, b, c } => {
            let Some([ta, tb, tc]) = geometry.uvs.get(primitive.uvs as usize).copied() else {
                return (Vec3::ZERO, Vec3::ZERO);
            };
            let (tac, tbc, pac, pbc) = (ta - tc, tb - tc, a - c, b - c);
            let determinant = tac.x * tbc.y - tac.y * tbc.x;
            if determinant == 0.0 {
                return (Vec3::ZERO, Vec3::ZERO);
            }
            let inverse = 1.0 / determinant;
            ((tbc.y * pac - tac.y * pbc) * inverse, (tac.x * pbc - tbc.x * pac) * inverse)
        }
    }
}

/// Derivatives from the ray's cone: two axes across the ray, as wide as the cone there, projected onto the surface.
///
/// The camera's cone is one pixel wide. A bounce keeps the width it has and widens its growth (see `tile`), which is
/// cheap and errs toward blur. Source: the way testrender carries radius and spread.
fn footprint(points: &mut Points, lane: usize, hit: &RayHitPoint, n: Vec3) {
    let i = hit.direction;
    let x = if i.x.abs() > 0.01 { Vec3::new(i.z, 0.0, -i.x) } else { Vec3::new(0.0, -i.z, i.y) }.normalize_or_zero();
    // In this order the cross product of the two derivatives of P faces the viewer, as `calculatenormal` wants it.
    let y = x.cross(i);
    let width = hit.radius + hit.spread * hit.t;
    let cos = -i.dot(n);
    let project = |d: Vec3| if cos.abs() > 1e-3 { d + i * (d.dot(n) / cos) } else { d };
    let (dpdx, dpdy) = (project(x * width), project(y * width));
    points.dpdx.set(lane, dpdx);
    points.dpdy.set(lane, dpdy);
    points.didx.set(lane, x * hit.spread);
    points.didy.set(lane, y * hit.spread);
    let (dpdu, dpdv) = (points.dpdu.get(lane), points.dpdv.get(lane));
    let uv = |d: Vec3| {
        // Least squares of d = du dPdu + dv dPdv: exact when d lies in the surface.
        let (uu, uv, vv) = (dpdu.dot(dpdu), dpdu.dot(dpdv), dpdv.dot(dpdv));
        let determinant = uu * vv - uv * uv;
        if determinant <= 1e-12 * uu * vv {
            return Vec2::ZERO;
        }
        let (ud, vd) = (dpdu.dot(d), dpdv.dot(d));
        Vec2::new(vv * ud - uv * vd, uu * vd - uv * ud) / determinant
    };
    let (dx, dy) = (uv(dpdx), uv(dpdy));
    (points.dudx[lane], points.dvdx[lane]) = (dx.x, dx.y);
    (points.dudy[lane], points.dvdy[lane]) = (dy.x, dy.y);
}
