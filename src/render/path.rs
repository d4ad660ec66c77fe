//! A path on its way, the shadow rays it sends to lights, and what had to be dropped of either.

use super::accel::{Hit, NOTHING, Ray};
use super::segment::{Segment, ray_type};
use glam::Vec3;

/// One path: its last segment, what it carries, and what it has gathered.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// The ray it is on, and that ray's hit.
    pub segment: Segment,
    /// The primitive that the ray starts on.
    pub from: u32,
    /// What a unit of radiance met now adds to the sample.
    pub throughput: Vec3,
    /// Density of the ray's direction; infinite when there was no choice.
    pub pdf_solid_angle: f32,
    /// The sample so far.
    pub radiance: Vec3,
    /// The part of the sample that is not background, 0..1.
    pub alpha: f32,
    /// True while nothing but clear surfaces has been met.
    pub clear: bool,
    /// The pixel's scramble.
    pub seed: u32,
    /// The sample's number.
    pub index: u32,
}

impl Path {
    /// A path that leaves the camera; `spread` is the growth of its pixel's cone.
    #[inline]
    pub fn new(eye: Vec3, direction: Vec3, spread: f32, seed: u32, index: u32) -> Self {
        let ray_type = ray_type::CAMERA;
        Path {
            segment: Segment { origin: eye, direction, hit: Hit::NONE, width: 0.0, spread, ray_type },
            from: NOTHING,
            throughput: Vec3::ONE,
            pdf_solid_angle: f32::INFINITY,
            radiance: Vec3::ZERO,
            alpha: 0.0,
            clear: true,
            seed,
            index,
        }
    }

    /// The ray it is on.
    #[inline(always)]
    pub fn ray(&self) -> Ray {
        Ray { skip: self.from, ..Ray::new(self.segment.origin, self.segment.direction) }
    }

    /// The part of the light from behind that clear surfaces have let through, while there is nothing else on the path.
    pub fn through(&self) -> f32 {
        self.throughput.element_sum() / 3.0
    }

    /// Adds what leaves the sample finite; what does not is dropped and counted for `material`.
    #[inline]
    pub fn gather(&mut self, contribution: Vec3, material: usize, dropped: &mut Dropped) {
        let sum = self.radiance + contribution;
        if sum.is_finite() {
            self.radiance = sum;
        } else {
            dropped.add(material);
        }
    }
}

/// A ray toward a light, and what it brings when nothing is in its way.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// The ray; it goes to the light's primitive, or to `NOTHING` for the background.
    pub ray: Ray,
    /// What it adds, to be multiplied by the light's radiance unless `known`.
    pub contribution: Vec3,
    /// The light's radiance is in `contribution` already.
    pub known: bool,
    /// The path it belongs to.
    pub path: u32,
    /// Surface coordinates on the light.
    pub u: f32,
    /// Surface coordinates on the light.
    pub v: f32,
}

impl ShadowRay {
    /// The segment that ends on the light.
    pub fn segment(&self) -> Segment {
        let Ray { origin, direction, reach, target, .. } = self.ray;
        let hit = Hit { t: reach, primitive: target, u: self.u, v: self.v };
        Segment { origin, direction, hit, width: 0.0, spread: 0.0, ray_type: ray_type::SHADOW }
    }
}

/// Contributions that were not finite and therefore dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// How many.
    pub count: u64,
    /// The lowest material index that one came from, plus one; 0 when there is none.
    pub material: usize,
}

impl Dropped {
    /// Counts one more.
    pub fn add(&mut self, material: usize) {
        self.merge(&Dropped { count: 1, material: material + 1 });
    }

    /// Takes in another count. The lowest material is kept, so that the result does not depend on the order.
    pub fn merge(&mut self, other: &Dropped) {
        self.count += other.count;
        self.material = match (self.material, other.material) {
            (0, m) | (m, 0) => m,
            (a, b) => a.min(b),
        };
    }
}
