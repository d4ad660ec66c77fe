//! Shading: the batch's shaders are run, and what they emit is added.

use crate::render::emission::found_on_surface;
use crate::render::points::fill;
use crate::render::wave::Wave;
use crate::render::world::World;

/// Shades the batch and adds the emission that was not known before.
pub fn shade(world: &World, wave: &mut Wave) {
    let Wave { paths, crossings, facings, lanes, shading, dropped, .. } = wave;
    let (group, plan) = world.material(lanes.material);
    shading.resize(lanes.paths.len());
    let segments = lanes.paths.iter().map(|&i| &paths[i as usize].segment);
    fill(&mut shading.points, &world.scene.geometry, segments, &plan.needs);
    if plan.smooth {
        let segments = lanes.paths.iter().map(|&i| &paths[i as usize].segment);
        shading.smooth.find(world.settings.terminator, &shading.points, &world.scene.geometry, segments);
    }
    shading.shade(group);
    for (lane, &i) in lanes.paths.iter().enumerate() {
        let path = &mut paths[i as usize];
        if path.clear {
            // Of what clear surfaces have let through, the hole lets the background show.
            path.alpha = 1.0 - path.through().min(1.0) * shading.holdout()[lane].clamp(0.0, 1.0);
        }
        // Constant emission was added when the hits were sorted.
        if plan.emits && world.emission_of(path.segment.hit.primitive).is_none() {
            let (crossing, facing) = (crossings.get(i as usize), facings.get(i as usize));
            let radiance = shading.emission().get(lane);
            found_on_surface(world, path, crossing, facing, radiance, lanes.material, dropped);
        }
    }
}
