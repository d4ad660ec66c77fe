//! A shader global in place of light, as testrender's `show_globals` has it.

use crate::render::plan::Needs;
use crate::render::points::fill;
use crate::render::wave::Wave;
use crate::render::world::World;
use glam::Vec3;

/// Paints the batch by the global that the settings ask for.
pub fn show_globals(world: &World, wave: &mut Wave) {
    let Wave { paths, lanes, shading, .. } = wave;
    let needs = Needs { uv: true, tangents: true, ..Needs::default() };
    shading.resize(lanes.paths.len());
    let points = &mut shading.points;
    fill(points, &world.scene.geometry, lanes.paths.iter().map(|&i| &paths[i as usize].segment), &needs);
    for (lane, &i) in lanes.paths.iter().enumerate() {
        let direction = match world.settings.show_globals {
            1 => points.ng.get(lane),
            2 => points.n.get(lane),
            3 => points.dpdu.get(lane).normalize_or_zero(),
            4 => points.dpdv.get(lane).normalize_or_zero(),
            _ => {
                paths[i as usize].radiance = Vec3::new(points.u[lane], points.v[lane], 0.0);
                continue;
            }
        };
        paths[i as usize].radiance = direction * 0.5 + Vec3::splat(0.5);
    }
}
