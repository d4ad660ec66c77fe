//! The camera: where paths start.

use crate::render::camera::directions;
use crate::render::path::Path;
use crate::render::random;
use crate::render::settings::HALVES;
use crate::render::wave::Wave;
use crate::render::world::World;
use std::ops::Range;

/// Starts a path for each of `samples` of the pixel at (`x`, `y`).
pub fn start(world: &World, wave: &mut Wave, x: u32, y: u32, samples: Range<u32>) {
    let settings = &world.settings;
    let halves = settings.halves() as u32;
    let seeds: [u32; HALVES] = std::array::from_fn(|half| random::pixel_seed(settings.seed, x, y, half as u32));
    let lanes = &mut wave.camera;
    lanes.draws.resize(samples.len());
    lanes.directions.resize(samples.len());
    for (lane, sample) in samples.enumerate() {
        lanes.draws.seeds[lane] = seeds[(sample % halves) as usize];
        lanes.draws.indices[lane] = sample / halves;
    }
    match settings.jitter {
        true => lanes.draws.draw(random::CAMERA, 2),
        false => lanes.draws.numbers.iter_mut().for_each(|column| column.fill(0.5)),
    }
    let [across, down] = [0, 1].map(|k| lanes.draws.numbers[k].as_slice());
    directions(&world.camera, x as f32, y as f32, [across, down], &mut lanes.directions);
    for lane in 0..lanes.draws.seeds.len() {
        let direction = lanes.directions.get(lane);
        let spread = if world.plan.cones { world.camera.spread(direction) } else { 0.0 };
        let (seed, index) = (lanes.draws.seeds[lane], lanes.draws.indices[lane]);
        wave.positions.push([across[lane], down[lane]]);
        wave.active.push(wave.paths.len() as u32);
        wave.paths.push(Path::new(world.camera.eye(), direction, spread, seed, index));
    }
}
