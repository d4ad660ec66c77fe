//! Sorting: hits by material, so that each material's are shaded in full batches.

use crate::render::accel::NOTHING;
use crate::render::emission::found_on_surface;
use crate::render::wave::{Batch, Wave};
use crate::render::world::World;
use glam::Vec3;

/// Sorts the hits by material, stably, so that the order of paths is kept, and cuts them into batches.
///
/// Emission that is one constant is added here, since no shader has to be run for it; what ends at such a hit is left out.
pub fn sort(world: &World, wave: &mut Wave, bounce: u32) {
    let Wave { paths, crossings, facings, active, sorted, dropped, .. } = wave;
    sorted.starts.clear();
    sorted.starts.resize(world.scene.materials.len() + 1, 0);
    sorted.unsorted.clear();
    sorted.materials.clear();
    for &i in active.iter() {
        let path = &mut paths[i as usize];
        let primitive = path.segment.hit.primitive;
        if primitive == NOTHING {
            continue;
        }
        let material = world.material_of(primitive);
        if path.clear {
            path.alpha = 1.0;
        }
        if let Some(emission) = world.emission_of(primitive).filter(|_| world.settings.show_globals == 0) {
            let crossing = crossings.get(i as usize);
            let last = crossing.map_or(bounce, |c| c.bounces) >= world.settings.max_bounces;
            // Most surfaces shine nowhere.
            if emission != Vec3::ZERO {
                found_on_surface(world, path, crossing, facings.get(i as usize), emission, material, dropped);
            }
            let plan = &world.plan.materials[material];
            if (last && !plan.clear || !plan.scatters) && !(plan.holds_out && path.clear) {
                continue;
            }
        }
        sorted.starts[material + 1] += 1;
        sorted.unsorted.push(i);
        sorted.materials.push(material as u32);
    }
    for m in 1..sorted.starts.len() {
        sorted.starts[m] += sorted.starts[m - 1];
    }
    sorted.paths.resize(sorted.unsorted.len(), 0);
    for (&i, &material) in sorted.unsorted.iter().zip(&sorted.materials) {
        let slot = &mut sorted.starts[material as usize];
        sorted.paths[*slot as usize] = i;
        *slot += 1;
    }
    // Each start has moved to its end, which is the next one's start.
    sorted.batches.clear();
    let mut start = 0;
    for (material, &end) in sorted.starts.iter().take(world.scene.materials.len()).enumerate() {
        let lanes = world.settings.lanes();
        let batches = (start..end as usize).step_by(lanes);
        sorted.batches.extend(batches.map(|from| Batch { material, lanes: from..(end as usize).min(from + lanes) }));
        start = end as usize;
    }
}
