//! What the shaders of one pixel say and make, in the order in which they say it.

use super::accel::{Hit, NOTHING, Ray};
use super::host::host;
use super::plan::Needs;
use super::points::{fill, fill_sky};
use super::renderer::Renderer;
use super::segment::{Segment, ray_type};
use crate::exec::{Machine, Points, Report};
use std::sync::Arc;

impl Renderer {
    /// Runs the shaders of what the center of a pixel shows, once, and gives what they say, layer by layer; nothing where the pixel
    /// shows nothing. No light is followed on from there.
    pub fn pixel_reports(&self, x: u32, y: u32) -> Vec<Report> {
        let (material, points) = self.point_of(x, y);
        let mut machine = self.machine_of_one();
        if let Some(material) = material {
            machine.shade(&self.world().scene.materials[material].surface, &points);
        }
        machine.take_reports()
    }

    /// A machine for one point, which is soon done, also of a render that was stopped.
    pub(super) fn machine_of_one(&self) -> Machine {
        let world = self.world();
        let host = host(&world.scene.camera, &world.settings, &world.scene.textures, Some(world.accel.clone()));
        Machine::with_host(Arc::new(host))
    }

    /// The material that the center of a pixel shows, that of the background included, and the point that is shaded.
    pub(super) fn point_of(&self, x: u32, y: u32) -> (Option<usize>, Points) {
        let world = self.world();
        let direction = world.camera.direction(x as f32 + 0.5, y as f32 + 0.5);
        let (eye, spread) = (world.camera.eye(), world.camera.spread(direction));
        let mut hits: Vec<Hit> = Vec::new();
        world.accel.closest(&[Ray::new(eye, direction)], &mut hits);
        let mut points = Points::new(1);
        let Some(hit) = hits.first().copied().filter(|hit| hit.primitive != NOTHING) else {
            fill_sky(&mut points, 0, direction, ray_type::CAMERA);
            return (world.scene.background.map(|background| background.material as usize), points);
        };
        let material = world.material_of(hit.primitive);
        let segment = Segment { origin: eye, direction, hit, width: 0.0, spread, ray_type: ray_type::CAMERA };
        // Whoever looks at a pixel wants to know where it is, also where its shader does not.
        let needs = Needs { uv: true, ..world.material(material).1.needs };
        fill(&mut points, &world.scene.geometry, [&segment].into_iter(), &needs);
        (Some(material), points)
    }
}
