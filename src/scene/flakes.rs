//! Small triangles scattered in a box and turned at random: sequins, snow, or a thousand little lamps.

use super::error::{Place, SceneError, SceneProblem};
use super::geometry::{Geometry, Object, Primitive, Shape};
use super::xml::Element;
use crate::limits::MADE_TRIANGLES;
use crate::math::elementary::sincos;
use crate::math::noise::lookup3::hash2;
use glam::Vec3;
use std::f32::consts::TAU;

/// What a `<Flakes>` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flakes {
    low: Vec3,
    high: Vec3,
    count: u32,
    size: f32,
    seed: u32,
}

impl Flakes {
    /// The attributes it knows.
    pub const ATTRIBUTES: [&str; 5] = ["low", "high", "count", "size", "seed"];

    /// Reads an element.
    ///
    /// # Errors
    /// An attribute is missing or out of range.
    pub fn read(e: &Element) -> Result<Self, SceneError> {
        e.required("size")?;
        let flakes = Flakes {
            low: e.required_vector("low")?,
            high: e.required_vector("high")?,
            count: e.whole("count", 1000, 1..=MADE_TRIANGLES as u32)?,
            size: e.real("size", 0.0, f32::MIN_POSITIVE..=1e6)?,
            seed: e.whole("seed", 1, 0..=u32::MAX)?,
        };
        if flakes.low.cmpgt(flakes.high).any() {
            return Err(SceneError::at(e.place(), SceneProblem::InsideOut { tag: e.tag().to_owned() })
                .with_help("`low` has the least x, y and z of the box, `high` the greatest"));
        }
        Ok(flakes)
    }

    /// How many triangles they are.
    pub fn triangles(&self) -> u64 {
        u64::from(self.count)
    }

    /// Adds equilateral triangles, as one object.
    pub fn add(&self, geometry: &mut Geometry, material: u32, place: &Place) {
        let object = geometry.objects.len() as u32;
        let (mut area, before) = (0.0, geometry.primitives.len());
        for i in 0..self.count {
            // The sequence ends after 2^16 points. Hashed, the next block's seed is not that of another element.
            let seed = hash2(self.seed, i >> 16);
            let [r, q] = [0, 1].map(|set| sobol_burley::sample_4d(i % (1 << 16), set, seed));
            let center = self.low + (self.high - self.low) * Vec3::new(r[0], r[1], r[2]);
            let z = 1.0 - 2.0 * q[0];
            let (sin, cos) = sincos(TAU * q[1]);
            let flat = (1.0 - z * z).max(0.0).sqrt();
            let (x, y) = Vec3::new(flat * cos, flat * sin, z).any_orthonormal_pair();
            let corner = |third: f32| {
                let (sin, cos) = sincos(TAU * (q[2] + third / 3.0));
                // The side of the triangle is `size`.
                center + (x * cos + y * sin) * (self.size / 3f32.sqrt())
            };
            let shape = Shape::Triangle { a: corner(0.0), b: corner(1.0), c: corner(2.0) };
            // Lost to rounding: far away and small.
            if shape.area() > 0.0 {
                area += f64::from(shape.area());
                geometry.primitives.push(Primitive { shape, object, normals: Primitive::NONE, uvs: Primitive::NONE });
            }
        }
        geometry.add_object(Object { material, surface_area: area as f32, place: place.clone() }, before);
    }
}
