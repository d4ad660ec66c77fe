//! Area lights: which primitives emit, how one is chosen, and how a point on it is.

use super::block::{Row, Row3, WIDTH, get, load, set, store};
use super::form::Form;
use super::segment::Segment;
use crate::lanes;
use crate::math::columns::Column3;
use crate::math::elementary::sincos;
use crate::scene::{Geometry, Shape};
use glam::Vec3;
use std::f32::consts::PI;

/// Directions toward lights, one a lane.
#[derive(Clone, Debug, Default)]
pub struct LightLanes {
    /// The unit direction.
    pub direction: Column3,
    /// The distance to the light.
    pub distance: Vec<f32>,
    /// Density of the direction over solid angle, the choice of the light included; 0 when there is no sample.
    pub pdf_solid_angle: Vec<f32>,
    /// The light's primitive.
    pub primitive: Vec<u32>,
    /// Surface coordinates, as `accel::Hit` has them.
    pub u: Vec<f32>,
    /// Surface coordinates, as `accel::Hit` has them.
    pub v: Vec<f32>,
}

impl LightLanes {
    /// Makes room for `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.direction.resize(len);
        self.primitive.resize(len, 0);
        for column in [&mut self.distance, &mut self.pdf_solid_angle, &mut self.u, &mut self.v] {
            column.resize(len, 0.0);
        }
    }
}

/// One direction toward a light.
#[derive(Clone, Copy, Debug)]
struct LightSample {
    direction: Vec3,
    distance: f32,
    pdf_solid_angle: f32,
}

/// A light as samplers see it.
#[derive(Clone, Copy, Debug)]
struct LightForm {
    form: Form,
    /// Normal of a flat light, as long as its area; nothing for a sphere.
    area: Vec3,
    triangle: bool,
}

/// The lights of a scene and the probability of each.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    primitives: Vec<u32>,
    /// Running sums of the probabilities; the last one is 1.
    cumulative: Vec<f32>,
    /// Probability of each primitive of the scene; empty when there is no light.
    chance: Vec<f32>,
    /// The shapes, beside `primitives`.
    forms: Vec<LightForm>,
    /// Any of them is a sphere.
    any_round: bool,
}

impl Lights {
    /// Lights from primitives and an estimate of the power of each.
    ///
    /// The estimate comes from a few points of a shader that may vary, so it may be too low; a tenth of the mean is
    /// added to each so that no light is starved.
    pub fn new(geometry: &Geometry, powers: &[(u32, f32)]) -> Self {
        if powers.is_empty() {
            return Self::default();
        }
        let count = powers.len() as f64;
        let clean = |p: f32| if p.is_finite() && p > 0.0 { f64::from(p) } else { 0.0 };
        let total: f64 = powers.iter().map(|(_, p)| clean(*p)).sum();
        let floor = if total > 0.0 { 0.1 * total / count } else { 1.0 };
        let sum = total + floor * count;
        let mut lights = Lights { chance: vec![0.0; geometry.primitives.len()], ..Self::default() };
        let (mut running, mut before) = (0.0f64, 0.0f32);
        for &(primitive, power) in powers {
            running += (clean(power) + floor) / sum;
            lights.primitives.push(primitive);
            let form = LightForm::new(&geometry.primitives[primitive as usize].shape);
            lights.any_round |= form.form.round;
            lights.forms.push(form);
            // Random numbers are multiples of 2^-23. With sums that are too, a light's chance, which is their difference,
            // is exactly how often the search gives it; one of less than that may never be chosen, and has none.
            let rounded = (running * 8_388_608.0).round() / 8_388_608.0;
            lights.cumulative.push(rounded as f32);
            lights.chance[primitive as usize] = rounded as f32 - before;
            before = rounded as f32;
        }
        if let Some(last) = lights.cumulative.last_mut() {
            *last = 1.0;
        }
        lights
    }

    /// True when there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.primitives.len()
    }

    /// Chooses a light a lane and a point on it as seen from `p`; a lane of `from` is the primitive that its `p` lies
    /// on. The first two numbers of a lane choose the point, the third the light.
    pub fn sample(&self, p: &Column3, from: &[u32], numbers: &[Vec<f32>; 4], out: &mut LightLanes) {
        out.resize(from.len());
        let mut block = LightBlock::new();
        let one = self.primitives.len() == 1;
        // A light that is alone is the same for all blocks.
        (0..WIDTH)
            .filter(|_| one)
            .for_each(|k| block.load(k, &self.forms[0], self.chance[self.primitives[0] as usize]));
        for start in (0..from.len()).step_by(WIDTH) {
            let len = WIDTH.min(from.len() - start);
            let mut chosen = [0; WIDTH];
            for k in 0..len {
                let lane = start + k;
                if !one {
                    let index = self.cumulative.partition_point(|c| *c <= numbers[2][lane]);
                    chosen[k] = index.min(self.primitives.len() - 1);
                    block.load(k, &self.forms[chosen[k]], self.chance[self.primitives[chosen[k]] as usize]);
                }
                let primitive = self.primitives[chosen[k]];
                out.primitive[lane] = primitive;
                block.usable[k] = u32::from(primitive != from[lane]);
            }
            block.look(p, [&numbers[0], &numbers[1]], start, len);
            flat_block(&mut block);
            for k in (0..len).filter(|_| self.any_round) {
                let light = &self.forms[chosen[k]];
                block.round(k, light, out.primitive[start + k] == from[start + k]);
            }
            block.store(start, len, out);
        }
    }

    /// Density with which `sample` would have chosen the hit that a ray has made; 0 for what is no light.
    #[inline]
    pub fn pdf(&self, geometry: &Geometry, segment: &Segment, from: u32) -> f32 {
        let Segment { origin, direction, hit, .. } = *segment;
        let chance = match self.chance.get(hit.primitive as usize) {
            Some(chance) if *chance > 0.0 => *chance,
            _ => return 0.0,
        };
        let flat = |normal: Vec3, scale: f32| {
            let cos_area = normal.dot(direction).abs() * scale;
            if cos_area > 0.0 { hit.t * hit.t / cos_area } else { 0.0 }
        };
        chance
            * match geometry.primitives[hit.primitive as usize].shape {
                Shape::Sphere { center, radius } => {
                    let to_center = center - origin;
                    if hit.primitive == from || to_center.length_squared() < radius * radius {
                        let n = (origin + hit.t * direction - center).normalize_or_zero();
                        flat(n, 4.0 * PI * radius * radius)
                    } else {
                        cone_pdf(radius * radius / to_center.length_squared())
                    }
                }
                Shape::Quad { edge_x, edge_y, .. } => flat(edge_x.cross(edge_y), 1.0),
                Shape::Triangle { a, b, c } => flat((b - a).cross(c - a), 0.5),
            }
    }
}

impl LightForm {
    fn new(shape: &Shape) -> Self {
        let form = Form::new(shape);
        let triangle = matches!(shape, Shape::Triangle { .. });
        LightForm { form, area: form.b.cross(form.c) * if triangle { 0.5 } else { 1.0 }, triangle }
    }
}

/// The lights of a few lanes.
struct LightBlock {
    p: Row3,
    a: Row3,
    b: Row3,
    c: Row3,
    area: Row3,
    x: Row,
    y: Row,
    chance: Row,
    triangle: [u32; WIDTH],
    usable: [u32; WIDTH],
    direction: Row3,
    distance: Row,
    pdf: Row,
}

impl LightBlock {
    fn new() -> Self {
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
            triangle: [0; WIDTH],
            usable: [0; WIDTH],
            direction: zero,
            distance: row,
            pdf: row,
        }
    }

    /// Takes the light of lane `k`.
    #[inline(always)]
    fn load(&mut self, k: usize, light: &LightForm, chance: f32) {
        set(&mut self.a, k, light.form.a);
        set(&mut self.b, k, light.form.b);
        set(&mut self.c, k, light.form.c);
        set(&mut self.area, k, light.area);
        self.triangle[k] = u32::from(light.triangle);
        self.chance[k] = chance;
    }

    /// Takes the points that look at the lights, and the places on those.
    #[inline(always)]
    fn look(&mut self, p: &Column3, [x, y]: [&[f32]; 2], start: usize, len: usize) {
        let lanes = start..start + len;
        load(&mut self.p, start, len, p);
        self.x[..len].copy_from_slice(&x[lanes.clone()]);
        self.y[..len].copy_from_slice(&y[lanes]);
    }

    /// Does a sphere's lane over again; `on` says that the lane lies on it.
    fn round(&mut self, k: usize, light: &LightForm, on: bool) {
        if !light.form.round {
            return;
        }
        let sample = sample_sphere(light.form.a, light.form.b.x, get(&self.p, k), on, self.x[k], self.y[k]);
        self.pdf[k] = sample.map_or(0.0, |s| s.pdf_solid_angle * self.chance[k]);
        self.distance[k] = sample.map_or(0.0, |s| s.distance);
        set(&mut self.direction, k, sample.map_or(Vec3::Y, |s| s.direction));
        (self.x[k], self.y[k]) = (0.0, 0.0);
    }

    fn store(&self, start: usize, len: usize, out: &mut LightLanes) {
        let lanes = start..start + len;
        store(&mut out.direction, start, len, &self.direction);
        out.distance[lanes.clone()].copy_from_slice(&self.distance[..len]);
        out.pdf_solid_angle[lanes.clone()].copy_from_slice(&self.pdf[..len]);
        out.u[lanes.clone()].copy_from_slice(&self.x[..len]);
        out.v[lanes].copy_from_slice(&self.y[..len]);
    }
}

lanes! {
    /// Samples all lanes as if their lights were flat.
    fn flat_block(block: &mut LightBlock) {
        for k in 0..WIDTH {
            let (x, y) = (block.x[k], block.y[k]);
            let (tx, ty) = square_to_triangle(x, y);
            let triangle = block.triangle[k] != 0;
            let (u, v) = (if triangle { tx } else { x }, if triangle { ty } else { y });
            let to = get(&block.a, k) + u * get(&block.b, k) + v * get(&block.c, k) - get(&block.p, k);
            let distance = to.length();
            let direction = to / distance;
            let pdf = distance * distance / get(&block.area, k).dot(direction).abs();
            // Neither a point on the light, nor one in its plane, nor a light without extent can be sampled.
            let good = (block.usable[k] != 0) & (distance > 0.0) & (pdf < f32::INFINITY);
            block.pdf[k] = if good { pdf * block.chance[k] } else { 0.0 };
            block.distance[k] = distance;
            set(&mut block.direction, k, if good { direction } else { Vec3::Y });
            (block.x[k], block.y[k]) = (u, v);
        }
    }
}

/// A point of a flat light as seen from the origin; `normal` times `scale` is as long as the light's area.
#[inline]
fn toward(to: Vec3, normal: Vec3, scale: f32) -> Option<LightSample> {
    let distance = to.length();
    let direction = to / distance;
    let cos_area = normal.dot(direction).abs() * scale;
    let pdf_solid_angle = distance * distance / cos_area;
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
        return toward(to_center + radius * n, n, 4.0 * PI * radius * radius);
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
