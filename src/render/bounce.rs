//! One batch at one bounce: shade, add emission, sample the lights, choose where each path goes on.

use super::light::power_heuristic;
use super::random::{Use, dimension_set};
use super::settings::LightStrategy;
use super::shading::{event, ray_type};
use super::shadow::ShadowRay;
use super::surface::fill;
use super::wave::{Path, Wave, emission_weight, gather};
use super::world::{Sky, World};
use crate::lanes;
use crate::math::columns::Column3;
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
        let hits = batch.iter().map(|&i| &self.paths[i as usize].hit);
        fill(&mut self.shading.points, &world.scene.geometry, hits, &plan.needs);
        self.shading.shade(group);
        self.add_emission(world, material, batch);
        if bounce >= world.settings.max_bounces || !plan.scatters {
            return;
        }
        self.lanes.gather(&self.paths, batch);
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
        // The third chooses among lights.
        self.lanes.draw(dimension_set(bounce, Use::Light), if world.lights.len() > 1 { 3 } else { 2 });
        world.lights.sample(&self.shading.points.p, &self.lanes.primitives, &self.lanes.numbers, &mut self.lit);
        self.shading.toward.clone_from(&self.lit.direction);
        self.weigh_lights(world);
        for (lane, &i) in batch.iter().enumerate() {
            let weight = self.weights.get(lane);
            // Most lanes that bring nothing face away from the light.
            if weight == Vec3::ZERO {
                continue;
            }
            let target = self.lit.primitive[lane];
            let emission = world.emission_of(target);
            let contribution = weight * emission.unwrap_or(Vec3::ONE);
            if !contribution.is_finite() {
                self.dropped.add(material);
                continue;
            }
            if contribution == Vec3::ZERO {
                continue;
            }
            let (direction, from) = (self.lit.direction.get(lane), self.lanes.primitives[lane]);
            let (p, ng) = (self.shading.points.p.get(lane), self.shading.points.ng.get(lane));
            self.shadows.rays.push(ShadowRay {
                origin: world.accel.leave(p, ng, direction, from),
                direction,
                distance: self.lit.distance[lane],
                contribution,
                known: emission.is_some(),
                path: i,
                from,
                target,
                u: self.lit.u[lane],
                v: self.lit.v[lane],
            });
        }
    }

    fn sample_sky(&mut self, world: &World, batch: &[u32], bounce: u32, material: usize) {
        let Sky::Shader { table: Some(table), .. } = &world.sky else { return };
        self.lanes.draw(dimension_set(bounce, Use::Sky), 2);
        self.lit.resize(batch.len());
        for lane in 0..batch.len() {
            let (direction, pdf) = table.sample(self.lanes.numbers[0][lane], self.lanes.numbers[1][lane]);
            self.shading.toward.set(lane, direction);
            self.lit.pdf_solid_angle[lane] = pdf;
        }
        self.weigh_lights(world);
        for (lane, &i) in batch.iter().enumerate() {
            let contribution = self.weights.get(lane);
            if !contribution.is_finite() {
                self.dropped.add(material);
            } else if contribution != Vec3::ZERO {
                let (direction, from) = (self.shading.toward.get(lane), self.lanes.primitives[lane]);
                let (p, ng) = (self.shading.points.p.get(lane), self.shading.points.ng.get(lane));
                self.sky_shadows.rays.push(ShadowRay {
                    origin: world.accel.leave(p, ng, direction, from),
                    direction,
                    distance: f32::INFINITY,
                    contribution,
                    known: false,
                    path: i,
                    from,
                    target: super::accel::NOTHING,
                    u: 0.0,
                    v: 0.0,
                });
            }
        }
    }

    /// Evaluates the lobes toward the sampled lights; what a unit of radiance there adds goes to `weights`.
    fn weigh_lights(&mut self, world: &World) {
        self.shading.evaluate();
        let combined = world.settings.lights == LightStrategy::Combined;
        self.weights.resize(self.lanes.seeds.len());
        let (evaluation, throughput) = (&self.shading.evaluation, &self.lanes.throughput);
        let out = [&mut self.weights.x, &mut self.weights.y, &mut self.weights.z].map(Vec::as_mut_slice);
        weigh(&self.lit.pdf_solid_angle, &evaluation.pdf, &evaluation.f_cos, throughput, combined, out);
    }

    /// Samples a direction for each path and sends on those that still carry something.
    fn scatter(&mut self, world: &World, batch: &[u32], bounce: u32, material: usize) {
        let roulette = bounce >= world.settings.rr_depth;
        self.lanes.draw(dimension_set(bounce, Use::Scatter), if roulette { 4 } else { 3 });
        let random = &mut self.shading.random;
        for (column, numbers) in [&mut random.x, &mut random.y, &mut random.z].into_iter().zip(&self.lanes.numbers) {
            column.copy_from_slice(numbers);
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
            if roulette {
                let survival = carried.min(if bounce > DEEP { 0.95 } else { 1.0 });
                if self.lanes.numbers[3][lane] >= survival {
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
        let points = &mut self.shading.points;
        fill(points, &world.scene.geometry, batch.iter().map(|&i| &self.paths[i as usize].hit), &needs);
        for (lane, &i) in batch.iter().enumerate() {
            let path = &mut self.paths[i as usize];
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

lanes! {
    /// What a unit of a light's radiance adds to each lane's path: throughput times f |cos| / density, times the weight
    /// against scattering when the two are combined.
    fn weigh(own: &[f32], other: &[f32], f_cos: &Column3, throughput: &Column3, combined: bool, out: [&mut [f32]; 3]) {
        let n = own.len();
        let other = &other[..n];
        let columns = [(&f_cos.x, &throughput.x), (&f_cos.y, &throughput.y), (&f_cos.z, &throughput.z)];
        for (out, (f_cos, throughput)) in out.into_iter().zip(columns) {
            let (out, f_cos, throughput) = (&mut out[..n], &f_cos[..n], &throughput[..n]);
            for i in 0..n {
                let heuristic = if combined { power_heuristic(own[i], other[i]) } else { 1.0 };
                let scale = if own[i] > 0.0 { heuristic / own[i] } else { 0.0 };
                out[i] = throughput[i] * f_cos[i] * scale;
            }
        }
    }
}

/// The part of the light from behind that clear surfaces have let through, while there is nothing else on the path.
fn through(path: &Path) -> f32 {
    path.throughput.element_sum() / 3.0
}
