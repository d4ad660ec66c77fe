//! Intersection: what each path's ray hits.

use crate::render::accel::{Hit, NOTHING, Questions, Ray};
use crate::render::path::Path;
use crate::render::wave::Wave;
use crate::render::world::World;

/// The rays of the active paths.
struct Active<'a> {
    paths: &'a mut [Path],
    active: &'a [u32],
    missed: &'a mut Vec<u32>,
}

impl Questions<Hit> for Active<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.active.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self.paths[self.active[number] as usize].ray()
    }

    #[inline(always)]
    fn answer(&mut self, number: usize, hit: Hit) {
        let path = self.active[number];
        self.paths[path as usize].segment.hit = hit;
        if hit.primitive == NOTHING {
            self.missed.push(path);
        }
    }
}

/// Finds the closest hit of every active path, and lists those that hit nothing.
pub fn intersect(world: &World, wave: &mut Wave) {
    let Wave { paths, active, missed, traced, .. } = wave;
    missed.clear();
    *traced += active.len() as u64;
    world.accel.answer_closest(&mut Active { paths, active, missed });
}
