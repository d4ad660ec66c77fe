//! One light: how a point on it is chosen as seen from a point, and with which density.

use super::bounds::Bounds;
use super::solid::{self, Seen};
use crate::lanes;
use crate::math::columns::Column3;
use crate::math::elementary::sincos;
use crate::render::block::{Row, Row3, WIDTH, get, load, set};
use crate::render::form::Form;
use crate::render::settings::LightPoints;
use crate::scene::Shape;
use glam::Vec3;
use std::f32::consts::PI;

/// A flat light is sampled by solid angle where its area is this many times the square of the distance of its middle.
///
/// Decision (2026-11-29): 1, because what is farther looks nearly the same from one end to the other, and stratified samples
/// are as good by area: with every light of more than 3e-4 sr sampled by solid angle, the squared error of Figure 1 fell by 5
/// % and its time rose by 79 %, while near a window the error fell to a fifth.
const WIDE: f32 = 1.0;

/// One direction toward a light.
#[derive(Clone, Copy, Debug)]
struct LightSample {
    direction: Vec3,
    distance: f32,
    pdf_solid_angle: f32,
}

/// What a light is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Outline {
    /// A ball.
    Sphere,
    /// A quadrilateral with right angles.
    Rectangle,
    /// Another quadrilateral.
    Parallelogram,
    /// A triangle.
    Triangle,
}

/// A light as samplers see it.
#[derive(Clone, Copy, Debug)]
pub struct LightForm {
    form: Form,
    /// Normal of a flat light, as long as its area; nothing for a sphere.
    area: Vec3,
    outline: Outline,
}

impl LightForm {
    /// The light of a shape.
    pub fn new(shape: &Shape) -> Self {
        let form = Form::new(shape);
        let outline = match shape {
            Shape::Sphere { .. } => Outline::Sphere,
            Shape::Triangle { .. } => Outline::Triangle,
            Shape::Quad { edge_x, edge_y, .. } => {
                let right = edge_x.dot(*edge_y).abs() <= 1e-6 * edge_x.length() * edge_y.length();
                if right { Outline::Rectangle } else { Outline::Parallelogram }
            }
        };
        let part = if outline == Outline::Triangle { 0.5 } else { 1.0 };
        LightForm { form, area: form.b.cross(form.c) * part, outline }
    }

    /// What it is made of.
    pub fn outline(&self) -> Outline {
        self.outline
    }

    /// Box, cone of normals and power.
    pub fn bounds(&self, power: f32) -> Bounds {
        let Form { a, b, c, .. } = self.form;
        let corners = match self.outline {
            Outline::Sphere => [a - b, a + b, a, a],
            Outline::Triangle => [a, a + b, a + c, a],
            Outline::Rectangle | Outline::Parallelogram => [a, a + b, a + c, a + b + c],
        };
        let low = corners.into_iter().fold(Vec3::INFINITY, Vec3::min);
        let high = corners.into_iter().fold(Vec3::NEG_INFINITY, Vec3::max);
        let axis = self.area.normalize_or_zero();
        // A ball, and what has no area, shines all around.
        let cos_cone = if axis == Vec3::ZERO { 0.0 } else { 1.0 };
        Bounds { low, high, axis: if axis == Vec3::ZERO { Vec3::Y } else { axis }, cos_cone, power }
    }

    /// The density with which a point is chosen that lies at `distance` in `direction` from `p`; `on` says that `p` lies on the
    /// light.
    pub fn pdf(&self, points: LightPoints, p: Vec3, direction: Vec3, distance: f32, on: bool) -> f32 {
        if self.outline == Outline::Sphere {
            let (center, radius) = (self.form.a, self.form.b.x);
            let to_center = center - p;
            if on || to_center.length_squared() < radius * radius {
                let n = (distance * direction - to_center).normalize_or_zero();
                return flat_pdf(n * (4.0 * PI * radius * radius), direction, distance);
            }
            return cone_pdf(radius * radius / to_center.length_squared());
        }
        match self.solid_angle(points, p) {
            Some(angle) => 1.0 / angle,
            None => flat_pdf(self.area, direction, distance),
        }
    }

    /// The solid angle of a flat light that is sampled by it as seen from `p`; none when it is sampled by area.
    #[inline]
    fn solid_angle(&self, points: LightPoints, p: Vec3) -> Option<f32> {
        let Form { a, b, c, .. } = self.form;
        let a = a - p;
        if points == LightPoints::Area || !is_wide(a, b, c, self.area, self.outline) {
            return None;
        }
        let angle = match self.outline {
            Outline::Sphere => return None,
            Outline::Triangle => seen(a, b, c).triangle(),
            Outline::Rectangle | Outline::Parallelogram => {
                let [near, far] = seen(a, b, c).halves();
                near + far
            }
        };
        (angle >= solid::LEAST).then_some(angle)
    }
}

/// True when a light is so close for its size that it is sampled by solid angle.
#[inline(always)]
fn is_wide(a: Vec3, b: Vec3, c: Vec3, area: Vec3, outline: Outline) -> bool {
    let middle = a + if outline == Outline::Triangle { (b + c) / 3.0 } else { 0.5 * (b + c) };
    let distance2 = middle.length_squared();
    area.length_squared() >= WIDE * WIDE * distance2 * distance2
}

#[inline(always)]
fn seen(a: Vec3, b: Vec3, c: Vec3) -> Seen {
    Seen { a: a.as_dvec3(), b: b.as_dvec3(), c: c.as_dvec3() }
}

/// Density over solid angle of a uniform point of a flat light; `area` is its normal, as long as its area.
#[inline]
fn flat_pdf(area: Vec3, direction: Vec3, distance: f32) -> f32 {
    let cos_area = area.dot(direction).abs();
    if cos_area > 0.0 { distance * distance / cos_area } else { 0.0 }
}

/// The lights of a few lanes.
pub struct LightBlock {
    p: Row3,
    a: Row3,
    b: Row3,
    c: Row3,
    area: Row3,
    x: Row,
    y: Row,
    chance: Row,
    outline: [u32; WIDTH],
    usable: [u32; WIDTH],
    /// The solid angle of a light that is sampled by it, whose place is in `x` and `y` already; else 0.
    angle: Row,
    direction: Row3,
    distance: Row,
    pdf: Row,
}

impl LightBlock {
    /// No lights.
    pub fn new() -> Self {
        let (row, zero) = ([0.0; WIDTH], [[0.0; WIDTH]; 3]);
        LightBlock {
            p: zero,
            a: zero,
            b: zero,
            c: zero,
            area: zero,
            x: row,
            y: row,
            chance: row,
            outline: [0; WIDTH],
            usable: [0; WIDTH],
            angle: row,
            direction: zero,
            distance: row,
            pdf: row,
        }
    }

    /// The points that look.
    pub fn points(&self) -> &Row3 {
        &self.p
    }

    /// Takes the light of lane `k`.
    #[inline(always)]
    pub fn load(&mut self, k: usize, light: &LightForm, chance: f32) {
        set(&mut self.a, k, light.form.a);
        set(&mut self.b, k, light.form.b);
        set(&mut self.c, k, light.form.c);
        set(&mut self.area, k, light.area);
        self.outline[k] = light.outline as u32;
        self.chance[k] = chance;
    }

    /// Says whether lane `k` may use its light.
    #[inline(always)]
    pub fn allow(&mut self, k: usize, usable: bool) {
        self.usable[k] = u32::from(usable);
    }

    /// Takes the points that look at the lights, and the places on those.
    #[inline(always)]
    pub fn look(&mut self, p: &Column3, [x, y]: [&[f32]; 2], start: usize, len: usize) {
        let lanes = start..start + len;
        load(&mut self.p, start, len, p);
        self.x[..len].copy_from_slice(&x[lanes.clone()]);
        self.y[..len].copy_from_slice(&y[lanes]);
    }

    /// Samples the first `len` lanes. `outlines` says which kinds there may be; a lane of `on` is true where the point lies
    /// on its light.
    pub fn sample(&mut self, len: usize, points: LightPoints, outlines: Outlines, on: &[bool; WIDTH]) {
        if points == LightPoints::Solid {
            self.angle = [0.0; WIDTH];
            if outlines.has(Outline::Rectangle) {
                rectangles(self);
            }
            if outlines.has(Outline::Triangle) || outlines.has(Outline::Parallelogram) {
                (0..len).for_each(|k| self.triangles(k));
            }
        }
        flat_block(self);
        if outlines.has(Outline::Sphere) {
            (0..len).for_each(|k| self.round(k, on[k]));
        }
    }

    /// The place on a triangle or a parallelogram by its solid angle.
    fn triangles(&mut self, k: usize) {
        let outline = self.outline[k];
        let triangle = outline == Outline::Triangle as u32;
        if !triangle && outline != Outline::Parallelogram as u32 {
            return;
        }
        let (a, b, c) = (get(&self.a, k) - get(&self.p, k), get(&self.b, k), get(&self.c, k));
        let kind = if triangle { Outline::Triangle } else { Outline::Parallelogram };
        if !is_wide(a, b, c, get(&self.area, k), kind) {
            return;
        }
        let seen = seen(a, b, c);
        let [near, far] = if triangle { [seen.triangle(), 0.0] } else { seen.halves() };
        let angle = near + far;
        if angle < solid::LEAST {
            return;
        }
        let chosen = self.x[k] * angle;
        let (u, v) = if chosen < near || far <= 0.0 {
            seen.in_triangle(near, (chosen / near).min(ALMOST_ONE), self.y[k])
        } else {
            let (u, v) = seen.far_half().in_triangle(far, ((chosen - near) / far).clamp(0.0, ALMOST_ONE), self.y[k]);
            (1.0 - u, 1.0 - v)
        };
        (self.x[k], self.y[k], self.angle[k]) = (u, v, angle);
    }

    /// Does a sphere's lane over again; `on` says that the lane lies on it.
    fn round(&mut self, k: usize, on: bool) {
        if self.outline[k] != Outline::Sphere as u32 {
            return;
        }
        let (center, radius) = (get(&self.a, k), self.b[0][k]);
        let sample = sample_sphere(center, radius, get(&self.p, k), on, self.x[k], self.y[k]);
        self.pdf[k] = sample.map_or(0.0, |s| s.pdf_solid_angle * self.chance[k]);
        self.distance[k] = sample.map_or(0.0, |s| s.distance);
        set(&mut self.direction, k, sample.map_or(Vec3::Y, |s| s.direction));
        (self.x[k], self.y[k]) = (0.0, 0.0);
    }

    /// Directions, distances, densities, and the places on the lights.
    pub fn results(&self) -> (&Row3, [&Row; 4]) {
        (&self.direction, [&self.distance, &self.pdf, &self.x, &self.y])
    }
}

/// The kinds of outlines that a scene's lights have.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outlines(u32);

impl Outlines {
    /// These and one more.
    pub fn with(self, outline: Outline) -> Self {
        Outlines(self.0 | 1 << outline as u32)
    }

    /// True when a light of that kind is there.
    pub fn has(self, outline: Outline) -> bool {
        self.0 >> outline as u32 & 1 != 0
    }
}

const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

lanes! {
    /// The places on rectangles by their solid angles.
    fn rectangles(block: &mut LightBlock) {
        let (mut wide, mut any) = ([0u32; WIDTH], 0);
        for k in 0..WIDTH {
            let (a, b, c) = (get(&block.a, k) - get(&block.p, k), get(&block.b, k), get(&block.c, k));
            let here = (block.outline[k] == Outline::Rectangle as u32)
                & is_wide(a, b, c, get(&block.area, k), Outline::Rectangle);
            wide[k] = u32::from(here);
            any |= wide[k];
        }
        if any == 0 {
            return;
        }
        for k in 0..WIDTH {
            let (a, b, c) = (get(&block.a, k) - get(&block.p, k), get(&block.b, k), get(&block.c, k));
            let seen = seen(a, b, c);
            let [near, far] = seen.halves();
            let angle = near + far;
            let (u, v) = seen.in_rectangle(angle, block.x[k], block.y[k]);
            let here = (wide[k] != 0) & (angle >= solid::LEAST);
            block.x[k] = if here { u } else { block.x[k] };
            block.y[k] = if here { v } else { block.y[k] };
            block.angle[k] = if here { angle } else { 0.0 };
        }
    }
}

lanes! {
    /// Samples all lanes as if their lights were flat.
    fn flat_block(block: &mut LightBlock) {
        for k in 0..WIDTH {
            let (x, y) = (block.x[k], block.y[k]);
            let (tx, ty) = square_to_triangle(x, y);
            let placed = block.angle[k] > 0.0;
            let fold = (block.outline[k] == Outline::Triangle as u32) & !placed;
            let (u, v) = (if fold { tx } else { x }, if fold { ty } else { y });
            let to = get(&block.a, k) + u * get(&block.b, k) + v * get(&block.c, k) - get(&block.p, k);
            let distance = to.length();
            let direction = to / distance;
            let by_area = distance * distance / get(&block.area, k).dot(direction).abs();
            let pdf = if placed { 1.0 / block.angle[k] } else { by_area };
            // Neither a point on the light, nor one in its plane, nor a light without extent can be sampled.
            let good = (block.usable[k] != 0) & (distance > 0.0) & (pdf < f32::INFINITY);
            block.pdf[k] = if good { pdf * block.chance[k] } else { 0.0 };
            block.distance[k] = distance;
            set(&mut block.direction, k, if good { direction } else { Vec3::Y });
            (block.x[k], block.y[k]) = (u, v);
        }
    }
}

/// A point of a flat light as seen from the origin; `area` is the light's normal, as long as its area.
#[inline]
fn toward(to: Vec3, area: Vec3) -> Option<LightSample> {
    let distance = to.length();
    let direction = to / distance;
    let pdf_solid_angle = distance * distance / area.dot(direction).abs();
    (distance > 0.0 && pdf_solid_angle.is_finite()).then_some(LightSample { direction, distance, pdf_solid_angle })
}

/// Density of a uniform direction in the cone that a sphere fills, from the square of the cone's sine.
#[inline]
fn cone_pdf(sin2: f32) -> f32 {
    // 1 - cos without cancellation.
    let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt());
    1.0 / (2.0 * PI * one_minus_cos)
}

/// From outside, a uniform direction in the sphere's cone; from inside or on it, a uniform point.
fn sample_sphere(center: Vec3, radius: f32, p: Vec3, on: bool, x: f32, y: f32) -> Option<LightSample> {
    let to_center = center - p;
    let distance2 = to_center.length_squared();
    let phi = 2.0 * PI * x;
    let (sin_phi, cos_phi) = sincos(phi);
    if on || distance2 < radius * radius {
        let height = 1.0 - 2.0 * y;
        let ring = (1.0 - height * height).max(0.0).sqrt();
        let n = Vec3::new(ring * cos_phi, ring * sin_phi, height);
        return toward(to_center + radius * n, n * (4.0 * PI * radius * radius));
    }
    let sin2_max = radius * radius / distance2;
    let one_minus_cos_max = sin2_max / (1.0 + (1.0 - sin2_max).max(0.0).sqrt());
    let one_minus_cos = y * one_minus_cos_max;
    let cos = 1.0 - one_minus_cos;
    // sin^2 = (1 - cos)(1 + cos), which keeps its digits for a distant sphere.
    let sin2 = one_minus_cos * (1.0 + cos);
    let distance = distance2.sqrt();
    let axis = to_center / distance;
    let (t, b) = axis.any_orthonormal_pair();
    let sin = sin2.sqrt();
    let direction = (axis * cos + t * (sin * cos_phi) + b * (sin * sin_phi)).normalize();
    let near = distance * cos - (radius * radius - distance2 * sin2).max(0.0).sqrt();
    let pdf_solid_angle = 1.0 / (2.0 * PI * one_minus_cos_max);
    Some(LightSample { direction, distance: near.max(0.0), pdf_solid_angle })
}

/// Source: E. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
#[inline(always)]
fn square_to_triangle(x: f32, y: f32) -> (f32, f32) {
    let above = y > x;
    let (near, far) = if above { (x, y) } else { (y, x) };
    let (half, rest) = (0.5 * near, far - 0.5 * near);
    if above { (half, rest) } else { (rest, half) }
}
