//! Emission that paths find and light that they sample: what each counts for, so that together they count once.

use super::crossing::Crossing;
use super::path::{Dropped, Path};
use super::settings::LightStrategy;
use super::sky::SkyTable;
use super::world::World;
use crate::lanes;
use crate::math::columns::Column3;
use glam::Vec3;

/// Adds to a path the radiance of the surface that its ray has hit; `crossing` is what it remembers of clear surfaces.
#[inline]
pub fn found_on_surface(
    world: &World,
    path: &mut Path,
    crossing: Option<&Crossing>,
    radiance: Vec3,
    material: usize,
    dropped: &mut Dropped,
) {
    if radiance == Vec3::ZERO {
        return;
    }
    let other = match crossing {
        None => world.lights.pdf(&world.scene.geometry, &path.segment, path.from),
        Some(crossing) => {
            let (segment, from) = crossing.whole(path);
            world.lights.pdf(&world.scene.geometry, &segment, from)
        }
    };
    let weight = weight_of_found(world.settings.lights, path.pdf_solid_angle, other);
    path.gather(path.throughput * radiance * weight, material, dropped);
}

/// Adds to a path the radiance of the background where its ray goes; `table` is what it may be sampled by.
#[inline]
pub fn found_in_sky(
    world: &World,
    table: Option<&SkyTable>,
    path: &mut Path,
    radiance: Vec3,
    material: usize,
    dropped: &mut Dropped,
) {
    let other = table.map_or(0.0, |t| t.pdf(path.segment.direction));
    let weight = weight_of_found(world.settings.lights, path.pdf_solid_angle, other);
    path.gather(path.throughput * radiance * weight, material, dropped);
}

/// The weight of emission that a scattered ray has found, where a light sample would have had density `other`.
#[inline]
fn weight_of_found(strategy: LightStrategy, own: f32, other: f32) -> f32 {
    if other <= 0.0 || own == f32::INFINITY {
        return 1.0;
    }
    match strategy {
        LightStrategy::Combined => power_heuristic(own, other),
        LightStrategy::ScatteringOnly => 1.0,
        LightStrategy::LightsOnly => 0.0,
    }
}

lanes! {
    /// What a unit of a sampled light's radiance adds to each lane's path: throughput times f |cos| / density, times the
    /// weight against scattering when the two are combined.
    pub fn weigh_sampled(own: &[f32], other: &[f32], f_cos: &Column3, throughput: &Column3, combined: bool, out: [&mut [f32]; 3]) {
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

/// The power heuristic: the weight of a sample of density `own` against a method that would give it `other`.
#[inline(always)]
fn power_heuristic(own: f32, other: f32) -> f32 {
    // The ratio keeps infinite densities (one possible direction) and huge ones from overflowing.
    if own > other {
        let r = other / own;
        1.0 / (1.0 + r * r)
    } else if other > 0.0 {
        let r = own / other;
        r * r / (1.0 + r * r)
    } else {
        0.0
    }
}
