//! Furnaces: how much of a white sky a batch of lobes sends to its viewer, by quadrature and by sampling.

use crate::closure::{Evaluation, Lobes, Samples};
use crate::math::columns::Column3;
use crate::math::quadrature::gauss_legendre;
use glam::Vec3;

/// Directions over the hemisphere of z with the weights of their solid angles.
///
/// Source: Gauss-Legendre in the cube root of the cosine, which follows sheens to the horizon, split at `split`; equal
/// steps in azimuth. The sum of the weights is 2 pi.
pub fn hemisphere(rings: usize, azimuths: usize, split: f64) -> Vec<(Vec3, f64)> {
    let mut out = Vec::with_capacity(2 * rings * azimuths);
    let middle = split.clamp(1e-3, 0.999).cbrt();
    for (a, b) in [(0.0, middle), (middle, 1.0)] {
        for ring in gauss_legendre(rings, a, b) {
            let cos = ring.x.powi(3);
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
            let weight = ring.weight * 3.0 * ring.x * ring.x * std::f64::consts::TAU / azimuths as f64;
            for k in 0..azimuths {
                let angle = (k as f64 + 0.5) * std::f64::consts::TAU / azimuths as f64;
                let w = Vec3::new((sin * angle.cos()) as f32, (sin * angle.sin()) as f32, cos as f32);
                out.push((w, weight));
            }
        }
    }
    out
}

/// The integral of f |cos| over the given directions, a triple a lane. Lobes of one direction are not in it.
pub fn integrate(lobes: &mut Lobes, lanes: usize, directions: &[(Vec3, f64)]) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; lanes];
    let mut out = Evaluation::default();
    for &(w, weight) in directions {
        lobes.evaluate(&Column3::splat(w, lanes), &mut out);
        for (lane, sum) in sums.iter_mut().enumerate() {
            let f = out.f_cos.get(lane);
            for (s, v) in sum.iter_mut().zip(f.to_array()) {
                *s += weight * f64::from(v);
            }
        }
    }
    sums
}

/// The mean weight of `count` samples in every lane: the same number by Monte Carlo, lobes of one direction included.
pub fn sample_mean(lobes: &mut Lobes, lanes: usize, count: u32, mut next: impl FnMut() -> f32) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; lanes];
    let (mut xi, mut out) = (Column3::zeros(lanes), Samples::default());
    for _ in 0..count {
        for lane in 0..lanes {
            xi.set(lane, Vec3::new(next(), next(), next()));
        }
        lobes.sample(&xi, &mut out);
        for (lane, sum) in sums.iter_mut().enumerate() {
            for (s, v) in sum.iter_mut().zip(out.weight.get(lane).to_array()) {
                *s += f64::from(v) / f64::from(count);
            }
        }
    }
    sums
}
