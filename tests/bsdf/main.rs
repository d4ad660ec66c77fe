//! Scattering models and layering: golden figures, stress, samplers against densities, furnaces, trees.

mod albedo;
mod between;
mod boundaries;
mod coat;
mod extremes;
mod fits;
mod golden;
mod hair;
mod layering;
mod lossless;
mod microfacet;
mod model_closures;
mod models;
mod samplers;
mod stability;
mod stress;
mod trees;

/// The seed of everything random here.
pub const SEED: u64 = 20_261_122;

/// A direction of the given cosine and azimuth.
pub fn direction(cos: f64, phi: f64) -> [f64; 3] {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    [sin * phi.cos(), sin * phi.sin(), cos]
}

/// The same in single precision.
pub fn narrow(w: [f64; 3]) -> glam::Vec3 {
    glam::Vec3::new(w[0] as f32, w[1] as f32, w[2] as f32)
}
