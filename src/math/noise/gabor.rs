//! Gabor noise: waves of one frequency under Gaussian bells, scattered over space.
//!
//! Source: Lagae, Lefebvre, Drettakis and Dutré 2009, "Procedural noise using sparse Gabor convolution", eqs. 2, 5 and 13 (bells of weight 1
//! whose waves begin anywhere, as in Lagae et al. 2011). Departs from OSL: other random numbers, so other bells in the same places of
//! the statistics; `do_filter` is not done.

use super::Jet;
use super::lookup3::hash4;
use crate::math::elementary::{exp, ln, pow, sincos};

/// How the waves lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gabor {
    /// Their direction; its length is the frequency.
    pub direction: [f32; 3],
    /// Width of the spectrum in octaves, 0.01..100.
    pub bandwidth: f32,
    /// Mean number of bells that reach a point, 1..32.
    pub impulses: f32,
    /// 0: waves of any direction; 1: of this one; 2: of any at a right angle to this one.
    pub anisotropic: i32,
    /// Period of each coordinate, 0 for none.
    pub period: [f32; 3],
}

/// Where a bell counts as ended: at 2 % of its height.
const CUT: f32 = 0.02;

/// A wave's direction, its first phase and where its bell is, of random numbers.
struct Dice([u32; 4]);

impl Dice {
    /// The next number in [0, 1).
    fn roll(&mut self) -> f32 {
        self.0[3] = self.0[3].wrapping_add(1);
        (hash4(self.0[0], self.0[1], self.0[2], self.0[3]) >> 8) as f32 / (1 << 24) as f32
    }

    /// How many of rare events there are where `mean` are expected: Poisson's distribution, by Knuth's product.
    fn count(&mut self, mean: f32) -> u32 {
        let (limit, mut product, mut count) = (exp(-mean), self.roll(), 0);
        while product > limit && count < 64 {
            product *= self.roll();
            count += 1;
        }
        count
    }
}

impl Gabor {
    /// The noise at a point, of mean 0 and nearly always in -1..1, and its gradient. Different seeds give independent noises.
    pub fn at(&self, p: [f32; 3], seed: u32) -> Jet<3> {
        let bandwidth = self.bandwidth.clamp(0.01, 100.0);
        let octaves = pow(2.0, bandwidth);
        let ln2 = std::f32::consts::LN_2;
        let frequency = self.frequency();
        // Eq. 5: the width of the bell whose spectrum is so wide.
        let a = (frequency * (octaves - 1.0) / (octaves + 1.0) * (std::f32::consts::PI / ln2).sqrt()).max(1e-4);
        let radius = (-ln(CUT) / std::f32::consts::PI).sqrt() / a;
        let mean = self.impulses.clamp(1.0, 32.0) * 3.0 / (4.0 * std::f32::consts::PI);
        let grid = p.map(|x| x / radius);
        let mut sum = Jet { value: 0.0, gradient: [0.0; 3] };
        if !grid.iter().all(|x| x.abs() < 1e9) {
            return sum;
        }
        let cell = grid.map(f32::floor);
        for neighbor in 0..27i32 {
            let offset = [neighbor % 3 - 1, neighbor / 3 % 3 - 1, neighbor / 9 - 1];
            let at: [f32; 3] = std::array::from_fn(|c| cell[c] + offset[c] as f32);
            self.add_cell(at, grid, (mean, radius, a), seed, &mut sum);
        }
        // The variance of the sum is the density of bells times the integral of a squared one, half of that of the squared bell.
        let density = mean / (radius * radius * radius);
        let variance = density * 0.5 / (2.0f32.sqrt() * a * 2.0 * a * a);
        let scale = 1.0 / (3.0 * variance.sqrt());
        Jet { value: sum.value * scale, gradient: sum.gradient.map(|g| g * scale) }
    }

    fn frequency(&self) -> f32 {
        let [x, y, z] = self.direction;
        let length = (x * x + y * y + z * z).sqrt();
        if length.is_finite() && length > 1e-6 { length.min(1e4) } else { 1.0 }
    }

    /// The cell that stands for one: the same a period on. A period is a whole number of cells only nearly.
    fn wrapped(&self, cell: f32, axis: usize, radius: f32) -> i32 {
        let cells = (self.period[axis] / radius).round();
        let cell = if cells >= 1.0 { cell - cells * (cell / cells).floor() } else { cell };
        cell as i32
    }

    fn add_cell(
        &self,
        cell: [f32; 3],
        grid: [f32; 3],
        (mean, radius, a): (f32, f32, f32),
        seed: u32,
        sum: &mut Jet<3>,
    ) {
        let of: [u32; 3] = std::array::from_fn(|axis| self.wrapped(cell[axis], axis, radius) as u32);
        let mut dice = Dice([hash4(of[0], of[1], of[2], seed), of[1], of[2], 0]);
        for _ in 0..dice.count(mean) {
            let place = [dice.roll(), dice.roll(), dice.roll()];
            let wave = self.wave(&mut dice);
            let phase = dice.roll() * std::f32::consts::TAU;
            let d: [f32; 3] = std::array::from_fn(|c| (grid[c] - cell[c] - place[c]) * radius);
            let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if square >= radius * radius {
                continue;
            }
            let bell = exp(-std::f32::consts::PI * a * a * square);
            let turns = std::f32::consts::TAU;
            let (sin, cos) = sincos(turns * (wave[0] * d[0] + wave[1] * d[1] + wave[2] * d[2]) + phase);
            sum.value += bell * cos;
            for c in 0..3 {
                sum.gradient[c] -= bell * (turns * a * a * d[c] * cos + turns * wave[c] * sin);
            }
        }
    }

    /// The direction of a wave, as long as its frequency.
    fn wave(&self, dice: &mut Dice) -> [f32; 3] {
        let frequency = self.frequency();
        if self.anisotropic == 1 {
            let known = self.direction.iter().any(|x| x.abs() > 1e-6);
            return if known { self.direction } else { [frequency, 0.0, 0.0] };
        }
        let (sin, cos) = sincos(dice.roll() * std::f32::consts::TAU);
        if self.anisotropic == 2 {
            let axis = glam::Vec3::from(self.direction).normalize_or(glam::Vec3::Z);
            let (x, y) = axis.any_orthonormal_pair();
            return ((x * cos + y * sin) * frequency).to_array();
        }
        let z = 2.0 * dice.roll() - 1.0;
        let across = (1.0 - z * z).max(0.0).sqrt();
        [frequency * across * cos, frequency * across * sin, frequency * z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Gabor =
        Gabor { direction: [1.0, 0.0, 0.0], bandwidth: 1.0, impulses: 16.0, anisotropic: 0, period: [0.0; 3] };

    fn points() -> impl Iterator<Item = [f32; 3]> {
        (0..4000).map(|i| [i as f32 * 0.3719, i as f32 * -0.113 + 5.0, (i % 61) as f32 * 0.77])
    }

    #[test]
    fn values_have_mean_zero_and_the_stated_spread() {
        for gabor in [PLAIN, Gabor { anisotropic: 1, ..PLAIN }, Gabor { anisotropic: 2, bandwidth: 2.0, ..PLAIN }] {
            let values: Vec<f64> = points().map(|p| f64::from(gabor.at(p, 0).value)).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let spread = (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
            assert!(mean.abs() < 0.03, "{gabor:?}: mean {mean}");
            assert!((spread - 1.0 / 3.0).abs() < 0.03, "{gabor:?}: spread {spread}");
        }
    }

    #[test]
    fn gradients_are_those_of_differences() {
        for gabor in [PLAIN, Gabor { anisotropic: 1, direction: [0.5, 1.0, -0.3], ..PLAIN }] {
            for p in points().take(100) {
                let (jet, h) = (gabor.at(p, 7), 1e-3);
                for c in 0..3 {
                    let moved = |by: f32| {
                        let mut q = p;
                        q[c] += by;
                        f64::from(gabor.at(q, 7).value)
                    };
                    let slope = (moved(h) - moved(-h)) / f64::from(2.0 * h);
                    // At the edge of a bell the value jumps by what is cut off.
                    assert!(
                        (slope - f64::from(jet.gradient[c])).abs() < 0.05 || (moved(h) - moved(-h)).abs() > 1e-3,
                        "{p:?} {c}"
                    );
                }
            }
        }
    }

    #[test]
    fn waves_of_one_direction_change_along_it() {
        let gabor = Gabor { anisotropic: 1, bandwidth: 0.5, ..PLAIN };
        let square = |c: usize| points().map(|p| f64::from(gabor.at(p, 0).gradient[c]).powi(2)).sum::<f64>();
        assert!(square(0) > 20.0 * square(1), "{} {}", square(0), square(1));
    }
}
