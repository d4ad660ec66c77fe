//! Shadows: the rays that a bounce has queued are traced together, and the lights that they reach shaded in batches.

use crate::render::accel::{NOTHING, Questions, Ray};
use crate::render::path::ShadowRay;
use crate::render::points::{fill, fill_sky};
use crate::render::segment::ray_type;
use crate::render::sky::Sky;
use crate::render::through::trace_through;
use crate::render::wave::{ShadowQueue, Wave};
use crate::render::world::World;

/// The rays of a queue, of which the clear ones are listed.
struct Shadows<'a> {
    rays: &'a [ShadowRay],
    clear: &'a mut Vec<u32>,
}

impl Questions<bool> for Shadows<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.rays.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self.rays[number].ray
    }

    #[inline(always)]
    fn answer(&mut self, number: usize, blocked: bool) {
        if !blocked {
            self.clear.push(number as u32);
        }
    }
}

/// Traces all queued shadow rays and adds what they bring.
pub fn trace_shadows(world: &World, wave: &mut Wave) {
    let mut lights = std::mem::take(&mut wave.light_shadows);
    trace_queue(world, wave, &mut lights);
    shade_reached_lights(world, wave, &mut lights);
    lights.rays.clear();
    wave.light_shadows = lights;
    let mut sky = std::mem::take(&mut wave.sky_shadows);
    trace_queue(world, wave, &mut sky);
    shade_reached_sky(world, wave, &sky);
    sky.rays.clear();
    wave.sky_shadows = sky;
}

/// Adds what the rays that get through bring, where that is known; the others are listed as `reached`.
fn trace_queue(world: &World, wave: &mut Wave, queue: &mut ShadowQueue) {
    queue.clear.clear();
    if world.plan.clear {
        trace_through(world, wave, queue);
    } else {
        wave.traced += queue.rays.len() as u64;
        world.accel.answer_any(&mut Shadows { rays: &queue.rays, clear: &mut queue.clear });
    }
    let Wave { paths, dropped, .. } = wave;
    let ShadowQueue { rays, clear, reached, .. } = queue;
    reached.clear();
    for &i in clear.iter() {
        let shadow = &rays[i as usize];
        let material = match (&world.sky, shadow.ray.target) {
            (Sky::Shader { material, .. }, NOTHING) => *material,
            (Sky::Constant(_), NOTHING) => continue,
            (Sky::Shader { .. } | Sky::Constant(_), light) => world.material_of(light),
        };
        if shadow.known {
            paths[shadow.path as usize].gather(shadow.contribution, material, dropped);
        } else {
            reached.push((material as u32, i));
        }
    }
    reached.sort_unstable();
}

/// Shades the points of lights that shadow rays have reached, material by material.
fn shade_reached_lights(world: &World, wave: &mut Wave, queue: &mut ShadowQueue) {
    let ShadowQueue { rays, reached, segments, .. } = queue;
    for run in reached.chunk_by(|a, b| a.0 == b.0) {
        let plan = &world.plan.materials[run[0].0 as usize];
        for batch in run.chunks(world.settings.lanes()) {
            segments.clear();
            segments.extend(batch.iter().map(|&(_, i)| rays[i as usize].segment()));
            wave.shading.resize(batch.len());
            fill(&mut wave.shading.points, &world.scene.geometry, segments.iter(), &plan.needs);
            add_reached(world, wave, rays, batch);
        }
    }
}

/// Shades the background where shadow rays have reached it.
fn shade_reached_sky(world: &World, wave: &mut Wave, queue: &ShadowQueue) {
    for batch in queue.reached.chunks(world.settings.lanes()) {
        wave.shading.resize(batch.len());
        for (lane, &(_, i)) in batch.iter().enumerate() {
            fill_sky(&mut wave.shading.points, lane, queue.rays[i as usize].ray.direction, ray_type::SHADOW);
        }
        add_reached(world, wave, &queue.rays, batch);
    }
}

/// Shades the filled points and adds what the rays of `batch` bring from there.
fn add_reached(world: &World, wave: &mut Wave, rays: &[ShadowRay], batch: &[(u32, u32)]) {
    let Wave { paths, shading, dropped, .. } = wave;
    let material = batch[0].0 as usize;
    shading.shade(world.material(material).0);
    for (lane, &(_, i)) in batch.iter().enumerate() {
        let shadow = &rays[i as usize];
        let radiance = shading.emission().get(lane);
        paths[shadow.path as usize].gather(shadow.contribution * radiance, material, dropped);
    }
}
