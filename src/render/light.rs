//! Area lights: which primitives emit, how one is chosen, and how a point on it is.

use crate::scene::{Geometry, Shape};
use glam::Vec3;
use std::f32::consts::PI;

/// A direction toward a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The unit direction.
    pub direction: Vec3,
    /// The distance to the light.
    pub distance: f32,
    /// Density of the direction over solid angle, the choice of the light included; 0 when there is no sample.
    pub pdf_solid_angle: f32,
    /// The light's primitive.
    pub primitive: u32,
    /// Surface coordinates, as `accel::Hit` has them.
    pub u: f32,
    /// Surface coordinates, as `accel::Hit` has them.
    pub v: f32,
}

/// The lights of a scene and the probability of each.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    primitives: Vec<u32>,
    /// Running sums of the probabilities; the last one is 1.
    cumulative: Vec<f32>,
    /// Probability of each primitive of the scene; empty when there is no light.
    chance: Vec<f32>,
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
        let mut running = 0.0f64;
        for &(primitive, power) in powers {
            let before = running as f32;
            running += (clean(power) + floor) / sum;
            lights.primitives.push(primitive);
            lights.cumulative.push(running as f32);
            // The chance is the difference of the rounded sums, which is exactly how often the search gives it.
            lights.chance[primitive as usize] = running as f32 - before;
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

    /// Chooses a light and a point on it as seen from `p`; `from` is the primitive that `p` lies on.
    #[inline]
    pub fn sample(&self, geometry: &Geometry, p: Vec3, from: u32, [x, y, z, _]: [f32; 4]) -> LightSample {
        let index = match self.primitives.len() {
            1 => 0,
            n => self.cumulative.partition_point(|c| *c <= z).min(n - 1),
        };
        let primitive = self.primitives[index];
        let chance = self.chance[primitive as usize];
        let mut sample = match geometry.primitives[primitive as usize].shape {
            Shape::Sphere { center, radius } => sample_sphere(center, radius, p, primitive == from, x, y),
            _ if primitive == from => None,
            Shape::Quad { corner, edge_x, edge_y } => {
                let normal = edge_x.cross(edge_y);
                toward(corner + x * edge_x + y * edge_y - p, normal, 1.0).map(|s| LightSample { u: x, v: y, ..s })
            }
            Shape::Triangle { a, b, c } => {
                let (u, v) = square_to_triangle(x, y);
                let point = (1.0 - u - v) * a + u * b + v * c;
                toward(point - p, (b - a).cross(c - a), 0.5).map(|s| LightSample { u, v, ..s })
            }
        }
        .unwrap_or(NO_SAMPLE);
        sample.primitive = primitive;
        sample.pdf_solid_angle *= chance;
        sample
    }

    /// Density with which `sample` would have chosen the hit that a ray has made; 0 for what is no light.
    #[inline]
    pub fn pdf(&self, geometry: &Geometry, hit: &super::surface::RayHitPoint, from: u32) -> f32 {
        let chance = match self.chance.get(hit.primitive as usize) {
            Some(chance) if *chance > 0.0 => *chance,
            _ => return 0.0,
        };
        let flat = |normal: Vec3, scale: f32| {
            let cos_area = normal.dot(hit.direction).abs() * scale;
            if cos_area > 0.0 { hit.t * hit.t / cos_area } else { 0.0 }
        };
        chance
            * match geometry.primitives[hit.primitive as usize].shape {
                Shape::Sphere { center, radius } => {
                    let to_center = center - hit.origin;
                    if hit.primitive == from || to_center.length_squared() < radius * radius {
                        let n = (hit.origin + hit.t * hit.direction - center).normalize_or_zero();
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

const NO_SAMPLE: LightSample =
    LightSample { direction: Vec3::Y, distance: 0.0, pdf_solid_angle: 0.0, primitive: 0, u: 0.0, v: 0.0 };

/// A point of a flat light as seen from the origin; `normal` times `scale` is as long as the light's area.
#[inline]
fn toward(to: Vec3, normal: Vec3, scale: f32) -> Option<LightSample> {
    let distance = to.length();
    let direction = to / distance;
    let cos_area = normal.dot(direction).abs() * scale;
    let pdf_solid_angle = distance * distance / cos_area;
    (distance > 0.0 && pdf_solid_angle.is_finite()).then_some(LightSample {
        direction,
        distance,
        pdf_solid_angle,
        ..NO_SAMPLE
    })
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
    let (sin_phi, cos_phi) = phi.sin_cos();
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
    Some(LightSample { direction, distance: near.max(0.0), pdf_solid_angle, ..NO_SAMPLE })
}

/// Source: E. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
fn square_to_triangle(mut x: f32, mut y: f32) -> (f32, f32) {
    if y > x {
        x *= 0.5;
        y -= x;
    } else {
        y *= 0.5;
        x -= y;
    }
    (x, y)
}

/// The power heuristic: the weight of a sample of density `own` against a method that would give it `other`.
#[inline]
pub fn power_heuristic(own: f32, other: f32) -> f32 {
    // The ratio keeps infinite densities (one possible direction) and huge ones from overflowing.
    if own > other {
        let r = other / own;
        1.0 / (1.0 + r * r)
    } else if other > 0.0 {
        let r = own / other;
        r * r / (1.0 + r * r)
    } else {
        0.0
    }
}
