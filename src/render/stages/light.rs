//! Light: each path of the batch looks toward a light, and toward the background where that is sampled.

use crate::render::accel::{NOTHING, Ray};
use crate::render::emission::weigh_sampled;
use crate::render::light::Lookers;
use crate::render::path::ShadowRay;
use crate::render::random::{Use, dimension_set};
use crate::render::settings::LightStrategy;
use crate::render::shading::Shading;
use crate::render::sky::{Sky, SkyTable};
use crate::render::wave::Wave;
use crate::render::world::World;
use glam::Vec3;

/// Samples lights and background for the batch; the shadow rays are queued.
pub fn sample_light(world: &World, wave: &mut Wave) {
    if !wave.shading.takes_light_samples() {
        return;
    }
    if !world.lights.is_empty() {
        sample_lights(world, wave);
    }
    if let Sky::Shader { table: Some(table), .. } = &world.sky {
        sample_sky(world, wave, table);
    }
}

fn sample_lights(world: &World, wave: &mut Wave) {
    let Wave { lanes, shading, lit, .. } = wave;
    lanes.draws.draw(dimension_set(lanes.bounce, Use::Light), world.lights.numbers());
    if world.lights.reads_normals() {
        shading.facing(&mut lanes.facing);
    }
    let lookers = Lookers { p: &shading.points.p, normal: &lanes.facing, from: &lanes.primitives };
    world.lights.sample(lookers, &lanes.draws.numbers, lit);
    wave.shading.toward.clone_from(&wave.lit.direction);
    weigh(world, wave);
    if wave.shading.smooth.moves_any() { queue_lights::<true>(world, wave) } else { queue_lights::<false>(world, wave) }
}

/// Queues the shadow rays to the lights that the batch has sampled; `MOVES` where some start elsewhere than on their facets.
fn queue_lights<const MOVES: bool>(world: &World, wave: &mut Wave) {
    for lane in 0..wave.lanes.paths.len() {
        let weight = wave.weights.get(lane);
        // Most lanes that bring nothing face away from the light.
        if weight == Vec3::ZERO {
            continue;
        }
        let target = wave.lit.primitive[lane];
        let emission = world.emission_of(target);
        let contribution = weight * emission.unwrap_or(Vec3::ONE);
        if !contribution.is_finite() {
            wave.dropped.add(wave.lanes.material);
        } else if contribution != Vec3::ZERO {
            let ray = shadow_ray::<MOVES>(world, wave, lane, wave.lit.distance[lane], target);
            let (path, u, v) = (wave.lanes.paths[lane], wave.lit.u[lane], wave.lit.v[lane]);
            wave.light_shadows.rays.push(ShadowRay { ray, contribution, known: emission.is_some(), path, u, v });
        }
    }
}

fn sample_sky(world: &World, wave: &mut Wave, table: &SkyTable) {
    wave.lanes.draws.draw(dimension_set(wave.lanes.bounce, Use::Sky), 2);
    let len = wave.lanes.paths.len();
    wave.lit.resize(len);
    for lane in 0..len {
        let [x, y] = [0, 1].map(|k| wave.lanes.draws.numbers[k][lane]);
        let (direction, pdf) = table.sample(x, y);
        wave.shading.toward.set(lane, direction);
        wave.lit.pdf_solid_angle[lane] = pdf;
    }
    weigh(world, wave);
    for lane in 0..len {
        let contribution = wave.weights.get(lane);
        if !contribution.is_finite() {
            wave.dropped.add(wave.lanes.material);
        } else if contribution != Vec3::ZERO {
            let ray = shadow_ray::<true>(world, wave, lane, f32::INFINITY, NOTHING);
            let path = wave.lanes.paths[lane];
            wave.sky_shadows.rays.push(ShadowRay { ray, contribution, known: false, path, u: 0.0, v: 0.0 });
        }
    }
}

/// The ray from a lane's point toward its sampled light.
#[inline]
fn shadow_ray<const MOVES: bool>(world: &World, wave: &Wave, lane: usize, reach: f32, target: u32) -> Ray {
    let Shading { points, smooth, toward, .. } = &wave.shading;
    let direction = toward.get(lane);
    let (origin, skip) = smooth.leave::<MOVES>(points, &world.accel, lane, direction, wave.lanes.primitives[lane]);
    let ray = Ray { origin, direction, reach, skip, target };
    if MOVES && smooth.moves(lane) && reach.is_finite() {
        aimed(ray, points.p.get(lane) + direction * reach)
    } else {
        ray
    }
}

/// A ray to a point that was seen from elsewhere than where the ray starts.
fn aimed(ray: Ray, to: Vec3) -> Ray {
    let way = to - ray.origin;
    let reach = way.length();
    if reach > 0.0 { Ray { direction: way / reach, reach, ..ray } } else { ray }
}

/// Evaluates the lobes toward the sampled lights; what a unit of radiance there adds goes to `weights`.
fn weigh(world: &World, wave: &mut Wave) {
    let Wave { lanes, shading, lit, weights, .. } = wave;
    shading.evaluate();
    let combined = world.settings.lights == LightStrategy::Combined;
    weights.resize(lanes.paths.len());
    let out = [&mut weights.x, &mut weights.y, &mut weights.z].map(Vec::as_mut_slice);
    let evaluation = &shading.evaluation;
    weigh_sampled(&lit.pdf_solid_angle, &evaluation.pdf, &evaluation.f_cos, &lanes.throughput, combined, out);
}
