//! The background: what paths see that hit nothing.

use crate::render::emission::found_in_sky;
use crate::render::points::fill_sky;
use crate::render::sky::Sky;
use crate::render::wave::Wave;
use crate::render::world::World;

/// Adds the background to the paths that hit nothing.
pub fn background(world: &World, wave: &mut Wave) {
    let Wave { paths, missed, shading, dropped, .. } = wave;
    let (material, table) = match &world.sky {
        Sky::Constant(radiance) => {
            // There is a background, and thus a material, where there is light.
            let material = world.scene.background.map_or(0, |b| b.material as usize);
            for &i in missed.iter() {
                let path = &mut paths[i as usize];
                path.gather(path.throughput * *radiance, material, dropped);
            }
            return;
        }
        Sky::Shader { material, table } => (*material, table.as_ref()),
    };
    for batch in missed.chunks(world.settings.lanes()) {
        shading.resize(batch.len());
        for (lane, &i) in batch.iter().enumerate() {
            let segment = &paths[i as usize].segment;
            fill_sky(&mut shading.points, lane, segment.direction, segment.ray_type);
        }
        shading.shade(&world.scene.materials[material].surface);
        for (lane, &i) in batch.iter().enumerate() {
            let radiance = shading.emission().get(lane);
            found_in_sky(world, table, &mut paths[i as usize], radiance, material, dropped);
        }
    }
}
