//! From a segment to a shading point: position, normals, texture coordinates and derivatives, as far as they are read.

use super::accel::Hit;
use super::block::{Row3, WIDTH, get, set, store};
use super::form::Form;
use super::plan::Needs;
use super::segment::Segment;
use crate::exec::Points;
use crate::lanes;
use crate::math::elementary::{acos, atan2};
use crate::scene::{Geometry, Primitive, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// The hits of a few rays.
struct Hits {
    origin: Row3,
    direction: Row3,
    /// Distance and surface coordinates.
    met: Row3,
    form: [Row3; 3],
    round: [u32; WIDTH],
    p: Row3,
    outward: Row3,
    facing: Row3,
    behind: [i32; WIDTH],
}

impl Hits {
    fn new() -> Self {
        let zero = [[0.0; WIDTH]; 3];
        Hits {
            origin: zero,
            direction: zero,
            met: zero,
            form: [zero; 3],
            round: [0; WIDTH],
            p: zero,
            outward: zero,
            facing: zero,
            behind: [0; WIDTH],
        }
    }

    #[inline(always)]
    fn load(&mut self, lane: usize, segment: &Segment, shape: &Shape) {
        let form = Form::new(shape);
        let Segment { origin, direction, hit, .. } = *segment;
        set(&mut self.origin, lane, origin);
        set(&mut self.direction, lane, direction);
        set(&mut self.met, lane, Vec3::new(hit.t, hit.u, hit.v));
        set(&mut self.form[0], lane, form.a);
        set(&mut self.form[1], lane, form.b);
        set(&mut self.form[2], lane, form.c);
        self.round[lane] = u32::from(form.round);
    }
}

lanes! {
    /// Finds all hits' positions and normals and turns the normals to the rays.
    fn meet_block(hits: &mut Hits) {
        for i in 0..WIDTH {
            let [a, b, c] = [0, 1, 2].map(|k| get(&hits.form[k], i));
            let form = Form { a, b, c, round: hits.round[i] != 0 };
            let direction = get(&hits.direction, i);
            let (p, n) = form.meet(get(&hits.origin, i), direction, hits.met.map(|row| row[i]));
            let behind = n.dot(direction) > 0.0;
            set(&mut hits.p, i, p);
            set(&mut hits.outward, i, n);
            set(&mut hits.facing, i, if behind { -n } else { n });
            hits.behind[i] = i32::from(behind);
        }
    }
}

/// Fills `points` with what the rays of `segments` have met, turned to the rays as testrender turns it.
pub fn fill<'s>(
    points: &mut Points,
    geometry: &Geometry,
    mut segments: impl Iterator<Item = &'s Segment>,
    needs: &Needs,
) {
    let mut block = Hits::new();
    let more = needs.uv || needs.tangents || needs.any_derivative() || !geometry.normals.is_empty();
    for start in (0..points.len).step_by(WIDTH) {
        let len = WIDTH.min(points.len - start);
        let mut taken: [Option<&Segment>; WIDTH] = [None; WIDTH];
        for (k, segment) in segments.by_ref().take(len).enumerate() {
            let primitive = &geometry.primitives[segment.hit.primitive as usize];
            block.load(k, segment, &primitive.shape);
            points.ray_type[start + k] = segment.ray_type;
            points.surface_area[start + k] = geometry.objects[primitive.object as usize].surface_area;
            taken[k] = Some(segment);
        }
        meet_block(&mut block);
        store(&mut points.i, start, len, &block.direction);
        store(&mut points.p, start, len, &block.p);
        store(&mut points.n, start, len, &block.facing);
        store(&mut points.ng, start, len, &block.facing);
        points.backfacing[start..start + len].copy_from_slice(&block.behind[..len]);
        if more {
            for (k, segment) in taken.iter().flatten().enumerate() {
                follow(points, start + k, geometry, segment, needs, get(&block.outward, k));
            }
        }
    }
}

/// Fills one lane with what a background shader sees along `direction`.
pub fn fill_sky(points: &mut Points, lane: usize, direction: Vec3, ray_type: i32) {
    points.p.set(lane, Vec3::ZERO);
    points.i.set(lane, direction);
    points.n.set(lane, -direction);
    points.ng.set(lane, -direction);
    points.u[lane] = 0.0;
    points.v[lane] = 0.0;
    points.surface_area[lane] = 4.0 * PI;
    points.backfacing[lane] = 0;
    points.ray_type[lane] = ray_type;
    for column in
        [&mut points.dpdu, &mut points.dpdv, &mut points.dpdx, &mut points.dpdy, &mut points.didx, &mut points.didy]
    {
        column.set(lane, Vec3::ZERO);
    }
}

/// Smooth normals, texture coordinates, tangents and derivatives of one lane, as far as they are read.
fn follow(points: &mut Points, lane: usize, geometry: &Geometry, segment: &Segment, needs: &Needs, outward: Vec3) {
    let hit = &segment.hit;
    let primitive = &geometry.primitives[hit.primitive as usize];
    if let Some([na, nb, nc]) = geometry.normals.get(primitive.normals as usize) {
        let smooth = ((1.0 - hit.u - hit.v) * *na + hit.u * *nb + hit.v * *nc).normalize_or(outward);
        points.n.set(lane, if points.backfacing[lane] != 0 { -smooth } else { smooth });
    }
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
        footprint(points, lane, segment, points.n.get(lane));
    }
}

fn texture_coordinates(geometry: &Geometry, primitive: &Primitive, hit: &Hit, n: Vec3) -> Vec2 {
    match primitive.shape {
        Shape::Sphere { .. } => {
            let around = atan2(-n.x, -n.z) * (0.5 * FRAC_1_PI);
            Vec2::new(if around < 0.0 { around + 1.0 } else { around }, acos(n.y.clamp(-1.0, 1.0)) * FRAC_1_PI)
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
/// The camera's cone is one pixel wide. A bounce keeps the width it has and widens its growth (see `stages/scatter`), which is
/// cheap and errs toward blur. Source: the way testrender carries radius and spread.
fn footprint(points: &mut Points, lane: usize, segment: &Segment, n: Vec3) {
    let i = segment.direction;
    let x = if i.x.abs() > 0.01 { Vec3::new(i.z, 0.0, -i.x) } else { Vec3::new(0.0, -i.z, i.y) }.normalize_or_zero();
    // In this order the cross product of the two derivatives of P faces the viewer, as `calculatenormal` wants it.
    let y = x.cross(i);
    let width = segment.width + segment.spread * segment.hit.t;
    let cos = -i.dot(n);
    let project = |d: Vec3| if cos.abs() > 1e-3 { d + i * (d.dot(n) / cos) } else { d };
    let (dpdx, dpdy) = (project(x * width), project(y * width));
    points.dpdx.set(lane, dpdx);
    points.dpdy.set(lane, dpdy);
    points.didx.set(lane, x * segment.spread);
    points.didy.set(lane, y * segment.spread);
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
