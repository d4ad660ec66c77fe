//! Scattering: where each path of the batch goes on, if it does.

use crate::closure::event;
use crate::limits::ROULETTE;
use crate::render::accel::Hit;
use crate::render::crossing::{Crossing, MOST_PASSED};
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

/// Samples a direction for each path and sends on those that still carry something.
pub fn scatter(world: &World, wave: &mut Wave) {
    draw(world, wave);
    if wave.crossings.is_empty() && wave.facings.is_empty() && !wave.shading.smooth.moves_any() {
        send::<false>(world, wave);
    } else {
        send::<true>(world, wave);
    }
}

/// Sends the paths of the batch on; `REMEMBERS` where they keep more than a path does, or start elsewhere than on their facets, which
/// most scenes have no use for.
fn send<const REMEMBERS: bool>(world: &World, wave: &mut Wave) {
    let Wave { paths, crossings, facings, next, lanes, shading, dropped, .. } = wave;
    let material = lanes.material;
    let clear = REMEMBERS && world.plan.materials[material].clear;
    let mut endless = false;
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
        // Straight through a surface that shadow rays pass as well is no bounce.
        let passes = clear && event == event::STRAIGHT;
        let mut bounces = lanes.bounce;
        if let Some(crossing) = crossings.get_mut(i as usize).filter(|_| REMEMBERS) {
            bounces = crossing.bounces;
            endless |= passes && crossing.passed >= MOST_PASSED;
            if if passes { crossing.passed >= MOST_PASSED } else { bounces >= world.settings.max_bounces } {
                continue;
            }
            *crossing = crossed(crossing, passes, &path.segment.hit);
        }
        path.clear &= event == event::STRAIGHT;
        if path.clear {
            path.alpha = 1.0 - (throughput.element_sum() / 3.0).min(1.0);
        }
        if bounces >= world.settings.rr_depth.min(ROULETTE) && !passes {
            // A path that loses a factor a bounce survives with it, so its weight stays.
            let survival = carried.min(if bounces > ROULETTE { 0.95 } else { 1.0 });
            if lanes.draws.numbers[3][lane] >= survival {
                continue;
            }
            throughput /= survival;
        }
        path.throughput = throughput;
        let primitive = path.segment.hit.primitive;
        let (origin, from) = shading.smooth.leave::<REMEMBERS>(&shading.points, &world.accel, lane, wi, primitive);
        let chosen = matches!(event, event::DIFFUSE | event::GLOSSY);
        if let Some(facing) = facings.get_mut(i as usize).filter(|_| REMEMBERS && chosen) {
            *facing = lanes.facing.get(lane);
        }
        if !passes {
            path.pdf_solid_angle = if chosen { pdf } else { f32::INFINITY };
        }
        path.from = from;
        turn(path, origin, wi, event);
        next.push(i);
    }
    if endless {
        shading.warn(format!("a path that has passed {MOST_PASSED} clear surfaces ends there"));
    }
}

/// Samples the lobes of the batch.
fn draw(world: &World, wave: &mut Wave) {
    let Wave { lanes, shading, .. } = wave;
    // A path of a scene with clear surfaces may have fewer bounces behind it than the wave, never more.
    let roulette = lanes.bounce >= world.settings.rr_depth.min(ROULETTE);
    lanes.draws.draw(dimension_set(lanes.bounce, Use::Scatter), if roulette { 4 } else { 3 });
    let random = &mut shading.random;
    for (column, numbers) in [&mut random.x, &mut random.y, &mut random.z].into_iter().zip(&lanes.draws.numbers) {
        column.copy_from_slice(numbers);
    }
    shading.sample();
}

/// What a path remembers behind a surface that it passes, or that scatters it.
fn crossed(before: &Crossing, passes: bool, hit: &Hit) -> Crossing {
    match passes {
        true => Crossing { passed: before.passed + 1, since: before.since + hit.t, ..*before },
        false => Crossing { bounces: before.bounces + 1, last: hit.primitive, since: 0.0, ..*before },
    }
}

/// Turns a path at `origin` toward `wi`.
#[inline(always)]
fn turn(path: &mut Path, origin: Vec3, wi: Vec3, event: u8) {
    let segment = &mut path.segment;
    segment.origin = origin;
    segment.direction = wi;
    segment.width += segment.spread * segment.hit.t;
    match event {
        event::DIFFUSE => (segment.ray_type, segment.spread) = (ray_type::DIFFUSE, segment.spread.max(DIFFUSE_SPREAD)),
        event::GLOSSY => (segment.ray_type, segment.spread) = (ray_type::GLOSSY, segment.spread.max(GLOSSY_SPREAD)),
        event::DELTA_REFLECT => segment.ray_type = ray_type::REFLECTION,
        event::DELTA_REFRACT => segment.ray_type = ray_type::REFRACTION,
        // Straight through: still the same ray to whoever asks.
        _ => {}
    }
}
