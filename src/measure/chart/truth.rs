//! What errors are measured against: albedos by quadrature in f64, and directions to integrate any lobe over.

use crate::bsdf::sheen::reference::{self, Model};
use crate::math::quadrature::tanh_sinh;
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Roughnesses at which errors are looked for, from 0.06 to 1, away from the nodes of tables.
pub const ROUGHNESSES: [f64; 9] = [0.06, 0.083, 0.11, 0.15, 0.23, 0.37, 0.56, 0.79, 1.0];

/// Cosines from 1e-4 to 1, even in the cube root.
pub fn cosines(count: usize) -> Vec<f64> {
    let least = 1e-4f64.cbrt();
    (0..count).map(|k| (least + (1.0 - least) * k as f64 / (count - 1) as f64).powi(3)).collect()
}

/// Albedos of a model, a row a roughness, a column a cosine; `steps` as in [`reference::albedo`].
pub fn albedos(model: Model, soft: bool, rs: &[f64], cosines: &[f64], steps: usize) -> Vec<Vec<f64>> {
    let all: Vec<(f64, f64)> = rs.iter().flat_map(|r| cosines.iter().map(move |c| (*r, *c))).collect();
    let values: Vec<f64> = all.par_iter().map(|(r, c)| reference::albedo(model, soft, *c, *r, steps)).collect();
    values.chunks(cosines.len()).map(<[f64]>::to_vec).collect()
}

/// A viewer of this cosine in the plane of x and z.
pub fn viewer(cos: f64) -> Vec3 {
    Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt() as f32, 0.0, cos as f32)
}

/// Light directions of the half space of positive y with the solid angles that they and their mirror images stand for.
///
/// Source: the rules of [`reference::albedo`]. Gives: integrals of lobes that are even in y, to 1e-6 for 32 steps.
pub fn directions(viewer_cos: f64, steps: usize) -> Vec<(Vec3, f64)> {
    let mut parts = vec![0.0, 0.5, 1.0];
    if viewer_cos < 1.0 && viewer_cos != 0.5 {
        parts.push(viewer_cos);
        parts.sort_by(f64::total_cmp);
    }
    let halves = tanh_sinh(steps + steps / 2, 0.0, 0.5 * PI);
    let mut out = Vec::new();
    for part in parts.windows(2) {
        for node in tanh_sinh(steps, part[0], part[1]).iter().filter(|node| node.x > 0.0 && node.x < 1.0) {
            let sin = ((1.0 - node.x) * (1.0 + node.x)).sqrt();
            for half in &halves {
                let angle = PI - 2.0 * half.x;
                let w = Vec3::new((sin * angle.cos()) as f32, (sin * angle.sin()) as f32, node.x as f32);
                out.push((w, 4.0 * half.weight * node.weight));
            }
        }
    }
    out
}
