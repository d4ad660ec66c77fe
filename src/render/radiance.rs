//! Radiance that is known before a ray is traced: of objects and backgrounds that shine alike all over, and estimates of
//! the others.

use super::plan::{Needs, Plan, same_all_over};
use super::points::{fill, fill_sky};
use super::probe::probe;
use super::segment::{Segment, ray_type};
use super::settings::{LightStrategy, Settings};
use super::shading::Shading;
use super::sky::{Brightness, Sky, SkyTable, direction};
use crate::exec::{Group, Host, MAX_LANES};
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use std::sync::Arc;

/// The radiance of each object, where it is one constant; zero for objects that do not emit.
pub fn constant_emission(scene: &Scene, plan: &Plan, shading: &mut Shading) -> Vec<Option<Vec3>> {
    let first = first_primitives(scene);
    let of_object = |(object, first): (usize, &Option<u32>)| match first {
        Some(first) => emission_of_object(scene, plan, shading, object, *first),
        None => Some(Vec3::ZERO),
    };
    first.iter().enumerate().map(of_object).collect()
}

/// The first primitive of every object; an object without any is never met.
fn first_primitives(scene: &Scene) -> Vec<Option<u32>> {
    let mut first = vec![None; scene.geometry.objects.len()];
    for (id, primitive) in scene.geometry.primitives.iter().enumerate().rev() {
        first[primitive.object as usize] = Some(id as u32);
    }
    first
}

/// The radiance of an object when it is the same from everywhere to everywhere.
fn emission_of_object(scene: &Scene, plan: &Plan, shading: &mut Shading, object: usize, first: u32) -> Option<Vec3> {
    let material = scene.geometry.objects[object].material as usize;
    let group = &scene.materials[material].surface;
    if !plan.materials[material].emits {
        return Some(Vec3::ZERO);
    }
    if !same_all_over(group) {
        return None;
    }
    shading.resize(1);
    let segment = probe(&scene.geometry, first, 0.5, 0.5);
    fill(&mut shading.points, &scene.geometry, std::iter::once(&segment), &plan.materials[material].needs);
    shading.shade(group);
    // What is not finite is left to the paths that meet it, which drop and report it.
    Some(shading.emission().get(0)).filter(|r| r.is_finite())
}

/// The primitives to be sampled as lights, each with an estimate of its power.
pub fn light_powers(scene: &Scene, plan: &Plan, shading: &mut Shading, constant: &[Option<Vec3>]) -> Vec<(u32, f32)> {
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
    let probe = |i| probe(&scene.geometry, primitive, at(i % SIDE), at(i / SIDE));
    let segments: [Segment; SIDE * SIDE] = std::array::from_fn(probe);
    fill(&mut shading.points, &scene.geometry, segments.iter(), &plan.materials[material].needs);
    shading.shade(&scene.materials[material].surface);
    let emission = shading.emission();
    let sum: f32 = (0..SIDE * SIDE).map(|lane| emission.get(lane).element_sum()).filter(|e| e.is_finite()).sum();
    sum / (SIDE * SIDE) as f32
}

/// The background: a constant where it is one, or a shader, with a table when it is to be sampled.
pub fn sky(scene: &Scene, plan: &Plan, settings: &Settings, shading: &mut Shading, host: &Arc<dyn Host>) -> Sky {
    let Some(background) = scene.background else { return Sky::Constant(Vec3::ZERO) };
    let material = background.material as usize;
    let group = &scene.materials[material].surface;
    if plan.constant_background {
        shading.resize(1);
        fill_sky(&mut shading.points, 0, Vec3::Y, ray_type::CAMERA);
        shading.shade(group);
        let radiance = shading.emission().get(0);
        return if radiance.is_finite() { Sky::Constant(radiance) } else { Sky::Shader { material, table: None } };
    }
    let table = match plan.background_table as usize {
        0 => None,
        side => {
            let needs = &plan.materials[material].needs;
            let look = |side: usize, cells: &[[u32; 2]]| brightness(group, needs, side, cells, settings, host);
            SkyTable::new(&Brightness::new(side, &look), settings.lights == LightStrategy::Combined)
        }
    };
    Sky::Shader { material, table }
}

/// The brightest channel of the background in the middle of cells of a grid of `side` cells a side, as shadow rays see it; whatever
/// is filtered there is filtered over the cell.
fn brightness(
    group: &Group,
    needs: &Needs,
    side: usize,
    cells: &[[u32; 2]],
    settings: &Settings,
    host: &Arc<dyn Host>,
) -> Vec<f32> {
    let mut brightness = vec![0.0; cells.len()];
    let width = (4.0 * PI).sqrt() / side as f32;
    let at = |a: u32| (a as f32 + 0.5) / side as f32;
    brightness.par_chunks_mut(MAX_LANES).zip(cells.par_chunks(MAX_LANES)).for_each_init(
        || Shading::new(settings.closure, host.clone()),
        |shading, (brightness, cells)| {
            shading.resize(cells.len());
            for (lane, [x, y]) in cells.iter().enumerate() {
                let direction = direction(at(*x), at(*y));
                fill_sky(&mut shading.points, lane, direction, ray_type::SHADOW);
                if needs.direction_derivatives {
                    let (dx, dy) = direction.any_orthonormal_pair();
                    shading.points.didx.set(lane, dx * width);
                    shading.points.didy.set(lane, dy * width);
                }
            }
            shading.shade(group);
            for (lane, cell) in brightness.iter_mut().enumerate() {
                *cell = shading.emission().get(lane).max_element();
            }
        },
    );
    brightness
}
