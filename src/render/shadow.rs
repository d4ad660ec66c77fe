//! Shadow rays: queued while a bounce is shaded, traced together, and the lights that they reach shaded in batches.

use super::accel::NOTHING;
use super::shading::ray_type;
use super::surface::{RayHitPoint, fill};
use super::wave::{Wave, gather};
use super::world::{Sky, World, fill_sky};
use glam::Vec3;

/// A ray toward a light, and what it brings when nothing is in its way.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// How far the light is.
    pub distance: f32,
    /// What it adds, to be multiplied by the light's radiance unless `known`.
    pub contribution: Vec3,
    /// The light's radiance is in `contribution` already.
    pub known: bool,
    /// The path it belongs to.
    pub path: u32,
    /// The primitive it starts on.
    pub from: u32,
    /// The light's primitive, or `NOTHING` for the background.
    pub target: u32,
    /// Surface coordinates on the light.
    pub u: f32,
    /// Surface coordinates on the light.
    pub v: f32,
}

/// Shadow rays waiting to be traced.
#[derive(Clone, Debug, Default)]
pub struct ShadowQueue {
    /// The rays.
    pub rays: Vec<ShadowRay>,
    /// Those that got through.
    clear: Vec<u32>,
    /// Of those, the ones whose light must be shaded, with the light's material.
    reached: Vec<(u32, u32)>,
    /// Of a batch of those, the points.
    hits: Vec<RayHitPoint>,
}

impl Wave {
    /// Traces all queued shadow rays and adds what they bring.
    pub fn trace_shadows(&mut self, world: &World) {
        for sky in [false, true] {
            let mut queue = std::mem::take(if sky { &mut self.sky_shadows } else { &mut self.shadows });
            self.trace_queue(world, &mut queue);
            self.shade_reached(world, &mut queue);
            queue.rays.clear();
            *(if sky { &mut self.sky_shadows } else { &mut self.shadows }) = queue;
        }
    }

    fn trace_queue(&mut self, world: &World, queue: &mut ShadowQueue) {
        queue.reached.clear();
        self.rays += queue.rays.len() as u64;
        world.accel.unoccluded(&queue.rays, &mut queue.clear);
        for &i in &queue.clear {
            let ray = &queue.rays[i as usize];
            let material = match (&world.sky, ray.target) {
                (Sky::Shader { material, .. }, NOTHING) => *material,
                (Sky::Constant(_), NOTHING) => continue,
                _ => world.material_of(ray.target),
            };
            if ray.known {
                gather(&mut self.paths[ray.path as usize], ray.contribution, material, &mut self.dropped);
            } else {
                queue.reached.push((material as u32, i));
            }
        }
    }

    /// Shades the points that shadow rays have reached, material by material.
    fn shade_reached(&mut self, world: &World, queue: &mut ShadowQueue) {
        queue.reached.sort_unstable();
        for run in queue.reached.chunk_by(|a, b| a.0 == b.0) {
            let material = run[0].0 as usize;
            let (group, plan) = world.material(material);
            for batch in run.chunks(world.settings.batch_width.clamp(1, crate::exec::MAX_LANES)) {
                self.shading.resize(batch.len());
                let rays = batch.iter().map(|&(_, i)| &queue.rays[i as usize]);
                // A queue is all lights or all background.
                if queue.rays[batch[0].1 as usize].target == NOTHING {
                    for (lane, ray) in rays.enumerate() {
                        fill_sky(&mut self.shading, lane, ray.direction, ray_type::SHADOW);
                    }
                } else {
                    queue.hits.clear();
                    queue.hits.extend(rays.map(ShadowRay::hit));
                    fill(&mut self.shading.points, &world.scene.geometry, queue.hits.iter(), &plan.needs);
                }
                self.shading.shade(group);
                for (lane, &(_, i)) in batch.iter().enumerate() {
                    let ray = &queue.rays[i as usize];
                    let radiance = self.shading.emission().get(lane);
                    gather(
                        &mut self.paths[ray.path as usize],
                        ray.contribution * radiance,
                        material,
                        &mut self.dropped,
                    );
                }
            }
        }
    }
}

impl ShadowRay {
    fn hit(&self) -> RayHitPoint {
        RayHitPoint {
            origin: self.origin,
            direction: self.direction,
            t: self.distance,
            primitive: self.target,
            u: self.u,
            v: self.v,
            radius: 0.0,
            spread: 0.0,
            ray_type: ray_type::SHADOW,
        }
    }
}
