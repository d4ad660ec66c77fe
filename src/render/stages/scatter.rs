//! Scattering: where each path of the batch goes on, if it does.

use crate::closure::event;
use crate::render::path::Path;
use crate::render::random::{Use, dimension_set};
use crate::render::segment::ray_type;
use crate::render::wave::Wave;
use crate::render::world::World;
use glam::Vec3;

/// A cone that bounces off a diffuse surface grows as fast as this, off a glossy one as the other: guesses on the
/// wide side, for they only choose how much a texture is blurred.
const DIFFUSE_SPREAD: f32 = 1.0;
const GLOSSY_SPREAD: f32 = 0.25;

/// Beyond this bounce roulette ends even paths that lose nothing, or a white closed room would never be done.
const DEEP: u32 = 64;

/// Samples a direction for each path and sends on those that still carry something.
pub fn scatter(world: &World, wave: &mut Wave) {
    let Wave { paths, facings, next, lanes, shading, dropped, .. } = wave;
    let (bounce, material) = (lanes.bounce, lanes.material);
    let roulette = bounce >= world.settings.rr_depth;
    lanes.draws.draw(dimension_set(bounce, Use::Scatter), if roulette { 4 } else { 3 });
    let random = &mut shading.random;
    for (column, numbers) in [&mut random.x, &mut random.y, &mut random.z].into_iter().zip(&lanes.draws.numbers) {
        column.copy_from_slice(numbers);
    }
    shading.sample();
    for (lane, &i) in lanes.paths.iter().enumerate() {
        let samples = &shading.samples;
        let (event, pdf) = (samples.event[lane], samples.pdf[lane]);
        if event == event::NONE || pdf <= 0.0 {
            continue;
        }
        let path = &mut paths[i as usize];
        let mut throughput = path.throughput * samples.weight.get(lane);
        let wi = samples.wi.get(lane);
        if !(throughput.is_finite() && wi.is_finite() && !pdf.is_nan()) {
            dropped.add(material);
            continue;
        }
        let carried = throughput.max_element();
        if carried <= 0.0 {
            continue;
        }
        if event == event::STRAIGHT && path.clear {
            // Before roulette, which would only add noise to it.
            path.alpha = 1.0 - throughput.element_sum() / 3.0;
        } else {
            path.clear = false;
        }
        if roulette {
            let survival = carried.min(if bounce > DEEP { 0.95 } else { 1.0 });
            if lanes.draws.numbers[3][lane] >= survival {
                continue;
            }
            throughput /= survival;
        }
        path.throughput = throughput;
        let (p, ng) = (shading.points.p.get(lane), shading.points.ng.get(lane));
        let origin = world.accel.leave(p, ng, wi, path.segment.hit.primitive);
        if let Some(facing) = facings.get_mut(i as usize).filter(|_| matches!(event, event::DIFFUSE | event::GLOSSY)) {
            *facing = lanes.facing.get(lane);
        }
        turn(path, origin, wi, event, pdf);
        next.push(i);
    }
}

/// Sends a path on from `origin` toward `wi`, after an event of density `pdf`.
#[inline(always)]
fn turn(path: &mut Path, origin: Vec3, wi: Vec3, event: u8, pdf: f32) {
    let segment = &mut path.segment;
    path.from = segment.hit.primitive;
    segment.origin = origin;
    segment.direction = wi;
    segment.width += segment.spread * segment.hit.t;
    let delta = !matches!(event, event::DIFFUSE | event::GLOSSY);
    path.pdf_solid_angle = if delta { f32::INFINITY } else { pdf };
    match event {
        event::DIFFUSE => (segment.ray_type, segment.spread) = (ray_type::DIFFUSE, segment.spread.max(DIFFUSE_SPREAD)),
        event::GLOSSY => (segment.ray_type, segment.spread) = (ray_type::GLOSSY, segment.spread.max(GLOSSY_SPREAD)),
        event::DELTA_REFLECT => segment.ray_type = ray_type::REFLECTION,
        event::DELTA_REFRACT => segment.ray_type = ray_type::REFRACTION,
        // Straight through: still the same ray to whoever asks.
        _ => {}
    }
}
