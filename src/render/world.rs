//! A scene made ready: hierarchy, lights with their powers, background with its table, and the plan.

use super::accel::Accel;
use super::camera::RayCamera;
use super::light::Lights;
use super::plan::{MaterialPlan, Plan, same_all_over};
use super::settings::Settings;
use super::shading::{Shading, ray_type};
use super::sky::SkyTable;
use super::surface::{RayHitPoint, fill};
use crate::exec::{Group, Host, MAX_LANES, Report};
use crate::scene::{Scene, Shape};
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use std::sync::Arc;

/// What rays see that hit nothing.
pub enum Sky {
    /// One radiance for all directions; zero when there is no background.
    Constant(Vec3),
    /// A shader, and a table when it is to be sampled.
    Shader {
        /// Index of the material.
        material: usize,
        /// The table.
        table: Option<SkyTable>,
    },
}

/// Everything that tiles share.
pub struct World<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// The settings.
    pub settings: &'s Settings,
    /// What is needed.
    pub plan: Plan,
    /// The camera.
    pub camera: RayCamera,
    /// The hierarchy.
    pub accel: Accel,
    /// The lights.
    pub lights: Lights,
    /// What shaders may ask.
    pub host: Arc<dyn Host>,
    /// The background.
    pub sky: Sky,
    /// The radiance of each object, where it is one constant; zero for objects that do not emit.
    pub object_emission: Vec<Option<Vec3>>,
    /// What shaders said while lights were prepared.
    pub reports: Vec<Report>,
}

impl<'s> World<'s> {
    /// Prepares `scene`; runs shaders where emission has to be known beforehand.
    pub fn new(scene: &'s Scene, settings: &'s Settings) -> Self {
        let plan = Plan::new(scene, settings);
        let host: Arc<dyn Host> = Arc::new(super::host::host(&scene.camera, settings));
        let mut shading = Shading::new(settings.closure, host.clone());
        let first_of_object = first_primitives(scene);
        let emission = |(object, first): (usize, &u32)| constant_emission(scene, &plan, &mut shading, object, *first);
        let object_emission: Vec<Option<Vec3>> = first_of_object.iter().enumerate().map(emission).collect();
        let powers = light_powers(scene, &plan, &mut shading, &object_emission);
        let sky = sky(scene, &plan, settings, &mut shading, &host);
        World {
            camera: RayCamera::new(&scene.camera, settings.width, settings.height),
            accel: Accel::new(&scene.geometry),
            lights: Lights::new(&scene.geometry, &powers),
            host,
            sky,
            object_emission,
            reports: shading.take_reports(),
            plan,
            scene,
            settings,
        }
    }

    /// The material of a primitive.
    #[inline(always)]
    pub fn material_of(&self, primitive: u32) -> usize {
        let object = self.scene.geometry.primitives[primitive as usize].object;
        self.scene.geometry.objects[object as usize].material as usize
    }

    /// The constant radiance of a primitive, if it has one.
    #[inline(always)]
    pub fn emission_of(&self, primitive: u32) -> Option<Vec3> {
        self.object_emission[self.scene.geometry.primitives[primitive as usize].object as usize]
    }

    /// The group and the plan of a material.
    #[inline(always)]
    pub fn material(&self, index: usize) -> (&'s Group, &MaterialPlan) {
        (&self.scene.materials[index].surface, &self.plan.materials[index])
    }
}

/// The first primitive of every object; objects without one keep 0 and are never met.
fn first_primitives(scene: &Scene) -> Vec<u32> {
    let mut first = vec![0; scene.geometry.objects.len()];
    for (id, primitive) in scene.geometry.primitives.iter().enumerate().rev() {
        first[primitive.object as usize] = id as u32;
    }
    first
}

/// A hit at surface coordinates `x`, `y` in [0, 1), from straight above.
pub fn probe(scene: &Scene, primitive: u32, x: f32, y: f32) -> RayHitPoint {
    let mut hit = RayHitPoint {
        origin: Vec3::ZERO,
        direction: Vec3::NEG_Y,
        t: 1.0,
        primitive,
        u: x,
        v: y,
        radius: 0.0,
        spread: 0.0,
        ray_type: ray_type::SHADOW,
    };
    if let Shape::Triangle { .. } = scene.geometry.primitives[primitive as usize].shape {
        (hit.u, hit.v) = (x * (1.0 - y), y);
    }
    let (mut p, mut n) = super::surface::place(&scene.geometry, &hit);
    if let Shape::Sphere { center, radius } = scene.geometry.primitives[primitive as usize].shape {
        n = SkyTable::direction(1, x, y);
        p = center + radius * n;
    }
    hit.origin = p + n;
    hit.direction = -n;
    hit
}

/// The radiance of an object when it is the same from everywhere to everywhere.
fn constant_emission(scene: &Scene, plan: &Plan, shading: &mut Shading, object: usize, first: u32) -> Option<Vec3> {
    let material = scene.geometry.objects[object].material as usize;
    let group = &scene.materials[material].surface;
    if !plan.materials[material].emits {
        return Some(Vec3::ZERO);
    }
    if !same_all_over(group) {
        return None;
    }
    shading.resize(1);
    let hit = probe(scene, first, 0.5, 0.5);
    fill(&mut shading.points, &scene.geometry, std::iter::once(&hit), &plan.materials[material].needs);
    shading.shade(group);
    // What is not finite is left to the paths that meet it, which drop and report it.
    Some(shading.emission().get(0)).filter(|r| r.is_finite())
}

/// The primitives to be sampled as lights, each with an estimate of its power.
fn light_powers(scene: &Scene, plan: &Plan, shading: &mut Shading, constant: &[Option<Vec3>]) -> Vec<(u32, f32)> {
    if plan.lights == 0 {
        return Vec::new();
    }
    let mut powers = Vec::new();
    for (id, primitive) in scene.geometry.primitives.iter().enumerate() {
        let object = &scene.geometry.objects[primitive.object as usize];
        let material = object.material as usize;
        let asked = plan.materials[material].emits || scene.materials[material].is_light;
        if !asked || constant[primitive.object as usize] == Some(Vec3::ZERO) {
            continue;
        }
        let radiance = match constant[primitive.object as usize] {
            Some(radiance) => radiance.element_sum(),
            None => mean_emission(scene, plan, shading, id as u32, material),
        };
        powers.push((id as u32, radiance * primitive.shape.area()));
    }
    powers
}

/// The mean radiance over a few points of a primitive.
fn mean_emission(scene: &Scene, plan: &Plan, shading: &mut Shading, primitive: u32, material: usize) -> f32 {
    const SIDE: usize = 4;
    shading.resize(SIDE * SIDE);
    let at = |i: usize| (i as f32 + 0.5) / SIDE as f32;
    let hits: [RayHitPoint; SIDE * SIDE] = std::array::from_fn(|i| probe(scene, primitive, at(i % SIDE), at(i / SIDE)));
    fill(&mut shading.points, &scene.geometry, hits.iter(), &plan.materials[material].needs);
    shading.shade(&scene.materials[material].surface);
    let emission = shading.emission();
    let sum: f32 = (0..SIDE * SIDE).map(|lane| emission.get(lane).element_sum()).filter(|e| e.is_finite()).sum();
    sum / (SIDE * SIDE) as f32
}

/// Fills one lane with what a background shader sees along `direction`.
pub fn fill_sky(shading: &mut Shading, lane: usize, direction: Vec3, ray_type: i32) {
    let points = &mut shading.points;
    points.p.set(lane, Vec3::ZERO);
    points.i.set(lane, direction);
    points.n.set(lane, -direction);
    points.ng.set(lane, -direction);
    points.u[lane] = 0.0;
    points.v[lane] = 0.0;
    points.surface_area[lane] = 4.0 * PI;
    points.backfacing[lane] = 0;
    points.ray_type[lane] = ray_type;
    for column in
        [&mut points.dpdu, &mut points.dpdv, &mut points.dpdx, &mut points.dpdy, &mut points.didx, &mut points.didy]
    {
        column.set(lane, Vec3::ZERO);
    }
}

fn sky(scene: &Scene, plan: &Plan, settings: &Settings, shading: &mut Shading, host: &Arc<dyn Host>) -> Sky {
    let Some(background) = scene.background else { return Sky::Constant(Vec3::ZERO) };
    let material = background.material as usize;
    let group = &scene.materials[material].surface;
    if plan.constant_background {
        shading.resize(1);
        fill_sky(shading, 0, Vec3::Y, ray_type::CAMERA);
        shading.shade(group);
        let radiance = shading.emission().get(0);
        return if radiance.is_finite() { Sky::Constant(radiance) } else { Sky::Shader { material, table: None } };
    }
    let side = plan.background_table as usize;
    let table = if side == 0 { None } else { SkyTable::new(side, &sky_brightness(group, side, settings, host)) };
    Sky::Shader { material, table }
}

/// The brightest channel of the background at the centre of each cell of its table.
fn sky_brightness(group: &Group, side: usize, settings: &Settings, host: &Arc<dyn Host>) -> Vec<f32> {
    let mut brightness = vec![0.0; side * side];
    brightness.par_chunks_mut(side).enumerate().for_each_init(
        || Shading::new(settings.closure, host.clone()),
        |shading, (y, row)| {
            for (chunk, cells) in row.chunks_mut(MAX_LANES).enumerate() {
                shading.resize(cells.len());
                for lane in 0..cells.len() {
                    let x = (chunk * MAX_LANES + lane) as f32 + 0.5;
                    fill_sky(shading, lane, SkyTable::direction(side, x, y as f32 + 0.5), 0);
                }
                shading.shade(group);
                for (lane, cell) in cells.iter_mut().enumerate() {
                    *cell = shading.emission().get(lane).max_element();
                }
            }
        },
    );
    brightness
}
