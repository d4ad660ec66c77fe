//! One batch at one bounce: shade, add emission, sample the lights, choose where each path goes on.

use super::light::power_heuristic;
use super::random::{self, Use, dimension_set};
use super::settings::LightStrategy;
use super::shading::{event, ray_type};
use super::shadow::ShadowRay;
use super::surface::fill;
use super::wave::{Path, Wave, emission_weight, gather};
use super::world::{Sky, World};
use glam::Vec3;

/// A cone that bounces off a diffuse surface grows as fast as this, off a glossy one as the other: guesses on the
/// wide side, for they only choose how much a texture is blurred.
const DIFFUSE_SPREAD: f32 = 1.0;
const GLOSSY_SPREAD: f32 = 0.25;

/// Beyond this bounce roulette ends even paths that lose nothing, or a white closed room would never be done.
const DEEP: u32 = 64;

impl Wave {
    /// Shades the paths `batch`, all of which hit `material`.
    pub fn shade_batch(&mut self, world: &World, material: usize, batch: &[u32], bounce: u32) {
        let (group, plan) = world.material(material);
        if world.settings.show_globals != 0 {
            return self.show_globals(world, batch);
        }
        self.shading.resize(batch.len());
        for (lane, &i) in batch.iter().enumerate() {
            fill(&mut self.shading.points, lane, &world.scene.geometry, &self.paths[i as usize].hit, &plan.needs);
        }
        self.shading.shade(group);
        self.add_emission(world, material, batch);
        if bounce >= world.settings.max_bounces || !plan.scatters {
            return;
        }
        if self.shading.takes_light_samples() {
            self.sample_lights(world, batch, bounce, material);
            self.sample_sky(world, batch, bounce, material);
        }
        self.scatter(world, batch, bounce, material);
    }

    fn add_emission(&mut self, world: &World, material: usize, batch: &[u32]) {
        for (lane, &i) in batch.iter().enumerate() {
            let path = &mut self.paths[i as usize];
            if path.clear {
                // Of what clear surfaces have let through, the hole lets the background show.
                path.alpha = 1.0 - through(path) * self.shading.holdout()[lane].clamp(0.0, 1.0);
            }
            // Constant emission was added when the hits were sorted.
            if !world.plan.materials[material].emits || world.emission_of(path.hit.primitive).is_some() {
                continue;
            }
            let emission = self.shading.emission().get(lane);
            if emission != Vec3::ZERO {
                let weight = emission_weight(world, path);
                gather(path, path.throughput * emission * weight, material, &mut self.dropped);
            }
        }
    }

    fn sample_lights(&mut self, world: &World, batch: &[u32], bounce: u32, material: usize) {
        if world.lights.is_empty() {
            return;
        }
        let start = self.shadows.rays.len();
        for (lane, &i) in batch.iter().enumerate() {
            let path = &self.paths[i as usize];
            let r = random::sample(path.seed, path.index, dimension_set(bounce, Use::Light));
            let p = self.shading.points.p.get(lane);
            let s = world.lights.sample(&world.scene.geometry, p, path.hit.primitive, r);
            let emission = world.emission_of(s.primitive);
            let usable = s.pdf_solid_angle > 0.0;
            self.shading.toward.set(lane, s.direction);
            self.shadows.rays.push(ShadowRay {
                origin: p,
                direction: s.direction,
                distance: s.distance,
                // The density rides along until the lobes are evaluated.
                contribution: if usable { emission.unwrap_or(Vec3::ONE) / s.pdf_solid_angle } else { Vec3::ZERO },
                known: emission.is_some(),
                path: i,
                from: path.hit.primitive,
                target: s.primitive,
                u: s.u,
                v: s.v,
            });
            self.densities[lane] = s.pdf_solid_angle;
        }
        self.keep_useful(world, start, material, false);
    }

    fn sample_sky(&mut self, world: &World, batch: &[u32], bounce: u32, material: usize) {
        let Sky::Shader { table: Some(table), .. } = &world.sky else { return };
        let start = self.sky_shadows.rays.len();
        for (lane, &i) in batch.iter().enumerate() {
            let path = &self.paths[i as usize];
            let r = random::sample(path.seed, path.index, dimension_set(bounce, Use::Sky));
            let (direction, pdf) = table.sample(r[0], r[1]);
            self.shading.toward.set(lane, direction);
            self.sky_shadows.rays.push(ShadowRay {
                origin: self.shading.points.p.get(lane),
                direction,
                distance: f32::INFINITY,
                contribution: if pdf > 0.0 { Vec3::splat(1.0 / pdf) } else { Vec3::ZERO },
                known: false,
                path: i,
                from: path.hit.primitive,
                target: super::accel::NOTHING,
                u: 0.0,
                v: 0.0,
            });
            self.densities[lane] = pdf;
        }
        self.keep_useful(world, start, material, true);
    }

    /// Evaluates the lobes toward the queued directions and keeps the rays that can bring something.
    fn keep_useful(&mut self, world: &World, start: usize, material: usize, sky: bool) {
        self.shading.evaluate();
        let rays = if sky { &mut self.sky_shadows.rays } else { &mut self.shadows.rays };
        let mut kept = start;
        for lane in 0..rays.len() - start {
            let mut ray = rays[start + lane];
            let f_cos = self.shading.evaluation.f_cos.get(lane);
            if ray.contribution == Vec3::ZERO || f_cos == Vec3::ZERO {
                continue;
            }
            let weight = match world.settings.lights {
                LightStrategy::Combined => power_heuristic(self.densities[lane], self.shading.evaluation.pdf[lane]),
                _ => 1.0,
            };
            ray.contribution *= self.paths[ray.path as usize].throughput * f_cos * weight;
            if !ray.contribution.is_finite() {
                self.dropped.add(material);
                continue;
            }
            if ray.contribution == Vec3::ZERO {
                continue;
            }
            let ng = self.shading.points.ng.get(lane);
            let origin = world.accel.leave(ray.origin, ng, ray.direction, ray.from);
            ray.origin = origin;
            rays[kept] = ray;
            kept += 1;
        }
        rays.truncate(kept);
    }

    /// Samples a direction for each path and sends on those that still carry something.
    fn scatter(&mut self, world: &World, batch: &[u32], bounce: u32, material: usize) {
        for (lane, &i) in batch.iter().enumerate() {
            let path = &self.paths[i as usize];
            let r = random::sample(path.seed, path.index, dimension_set(bounce, Use::Scatter));
            self.shading.random.set(lane, Vec3::new(r[0], r[1], r[2]));
            self.densities[lane] = r[3];
        }
        self.shading.sample();
        for (lane, &i) in batch.iter().enumerate() {
            let samples = &self.shading.samples;
            let (kind, pdf) = (samples.event[lane], samples.pdf[lane]);
            if kind == event::NONE || pdf <= 0.0 {
                continue;
            }
            let path = &mut self.paths[i as usize];
            let mut throughput = path.throughput * samples.weight.get(lane);
            let wi = samples.wi.get(lane);
            if !(throughput.is_finite() && wi.is_finite() && !pdf.is_nan()) {
                self.dropped.add(material);
                continue;
            }
            let carried = throughput.max_element();
            if carried <= 0.0 {
                continue;
            }
            if kind == event::STRAIGHT && path.clear {
                // Before roulette, which would only add noise to it.
                path.alpha = 1.0 - throughput.element_sum() / 3.0;
            } else {
                path.clear = false;
            }
            if bounce >= world.settings.rr_depth {
                let survival = carried.min(if bounce > DEEP { 0.95 } else { 1.0 });
                if self.densities[lane] >= survival {
                    continue;
                }
                throughput /= survival;
            }
            path.throughput = throughput;
            let hit = &mut path.hit;
            hit.origin =
                world.accel.leave(self.shading.points.p.get(lane), self.shading.points.ng.get(lane), wi, hit.primitive);
            hit.direction = wi;
            path.from = hit.primitive;
            hit.radius += hit.spread * hit.t;
            let delta = !matches!(kind, event::DIFFUSE | event::GLOSSY);
            path.pdf_solid_angle = if delta { f32::INFINITY } else { pdf };
            match kind {
                event::DIFFUSE => (hit.ray_type, hit.spread) = (ray_type::DIFFUSE, hit.spread.max(DIFFUSE_SPREAD)),
                event::GLOSSY => (hit.ray_type, hit.spread) = (ray_type::GLOSSY, hit.spread.max(GLOSSY_SPREAD)),
                event::DELTA_REFLECT => hit.ray_type = ray_type::REFLECTION,
                event::DELTA_REFRACT => hit.ray_type = ray_type::REFRACTION,
                // Straight through: still the same ray to whoever asks.
                _ => {}
            }
            self.next.push(i);
        }
    }

    /// Paints a shader global in place of light, as testrender's `show_globals` does.
    fn show_globals(&mut self, world: &World, batch: &[u32]) {
        let needs = super::plan::Needs { uv: true, tangents: true, ..Default::default() };
        self.shading.resize(batch.len());
        for (lane, &i) in batch.iter().enumerate() {
            let path = &mut self.paths[i as usize];
            let points = &mut self.shading.points;
            fill(points, lane, &world.scene.geometry, &path.hit, &needs);
            let shown = match world.settings.show_globals {
                1 => points.ng.get(lane),
                2 => points.n.get(lane),
                3 => points.dpdu.get(lane).normalize_or_zero(),
                4 => points.dpdv.get(lane).normalize_or_zero(),
                _ => {
                    path.radiance = Vec3::new(points.u[lane], points.v[lane], 0.0);
                    continue;
                }
            };
            path.radiance = shown * 0.5 + Vec3::splat(0.5);
        }
    }
}

/// The part of the light from behind that clear surfaces have let through, while there is nothing else on the path.
fn through(path: &Path) -> f32 {
    path.throughput.element_sum() / 3.0
}
