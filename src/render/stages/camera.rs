//! The camera: where paths start.

use crate::render::camera::directions;
use crate::render::crossing::Crossing;
use crate::render::path::Path;
use crate::render::random;
use crate::render::settings::Filter;
use crate::render::wave::Wave;
use crate::render::world::World;
use glam::Vec3;
use std::ops::Range;

/// Starts a path for each of `samples` of the pixel at (`x`, `y`).
pub fn start(world: &World, wave: &mut Wave, x: u32, y: u32, samples: Range<u32>) {
    let settings = &world.settings;
    let at = settings.whole_frame().at;
    let (x, y) = (x + at[0], y + at[1]);
    let seed = random::pixel_seed(settings.seed, x, y);
    let lanes = &mut wave.camera;
    lanes.draws.resize(samples.len());
    lanes.directions.resize(samples.len());
    for (lane, sample) in samples.enumerate() {
        lanes.draws.seeds[lane] = seed;
        lanes.draws.indices[lane] = sample;
    }
    match settings.jitter {
        true => lanes.draws.draw(random::CAMERA, 2),
        false => lanes.draws.numbers.iter_mut().for_each(|column| column.fill(0.5)),
    }
    if let Some(window) = &world.window {
        lanes.draws.numbers.iter_mut().take(2).flatten().for_each(|x| *x = window.place(*x));
    }
    let [across, down] = [0, 1].map(|k| lanes.draws.numbers[k].as_slice());
    directions(&world.camera, x as f32, y as f32, [across, down], &mut lanes.directions);
    let len = lanes.draws.seeds.len();
    let first = wave.paths.len() as u32;
    wave.active.extend(first..first + len as u32);
    if world.lights.reads_normals() {
        wave.facings.resize(first as usize + len, Vec3::ZERO);
    }
    if world.plan.clear {
        wave.crossings.resize(first as usize + len, Crossing::START);
    }
    match settings.filter {
        Filter::Tent => wave.positions.extend(across.iter().zip(down).map(|(x, y)| [*x, *y])),
        // To the film, what counts for its own pixel alone lies in the middle of it.
        Filter::Box | Filter::BlackmanHarris => wave.positions.extend(across.iter().map(|_| [0.5, 0.5])),
    }
    wave.paths.extend((0..len).map(|lane| {
        let direction = lanes.directions.get(lane);
        let spread = if world.plan.cones { world.camera.spread(direction) } else { 0.0 };
        Path::new(world.camera.eye(), direction, spread, lanes.draws.seeds[lane], lanes.draws.indices[lane])
    }));
}
