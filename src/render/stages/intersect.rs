//! Intersection: what each path's ray hits.

use crate::render::accel::NOTHING;
use crate::render::wave::Wave;
use crate::render::world::World;

/// Rays that the hierarchy is asked for at once: few enough to stay in the nearest cache.
const PACK: usize = 256;

/// Finds the closest hit of every active path, and lists those that hit nothing.
pub fn intersect(world: &World, wave: &mut Wave) {
    let Wave { paths, active, missed, rays, hits, traced, .. } = wave;
    missed.clear();
    *traced += active.len() as u64;
    for pack in active.chunks(PACK) {
        rays.clear();
        rays.extend(pack.iter().map(|&i| paths[i as usize].ray()));
        world.accel.closest(rays, hits);
        for (&i, hit) in pack.iter().zip(hits.iter()) {
            paths[i as usize].segment.hit = *hit;
            if hit.primitive == NOTHING {
                missed.push(i);
            }
        }
    }
}
