//! Gabor noise: waves of one frequency under Gaussian bells, scattered over space.
//!
//! Source: Lagae, Lefebvre, Drettakis and Dutré 2009, "Procedural noise using sparse Gabor convolution", eqs. 2, 5 and 13; bells of weight 1
//! whose waves begin anywhere, sliced and filtered, as in Lagae and Drettakis 2011, "Filtering solid Gabor noise", eqs. 6 and 10.
//!
//! Decision (2026-11-29): random numbers, scale and frequency are those of OSL 1.16, so that a shader shows the same bells in both;
//! instead of our own, which had the same statistics at twice the spread. Two things differ: a fourth coordinate counts (OSL leaves it
//! out, and says that this is broken), and periods are of the coordinates (OSL wraps cells by them, so its noise does not repeat).

use super::Jet;
use super::lookup3::hash4;
use crate::math::elementary::{exp, ln, pow, sincos};
use glam::{Mat2, Mat3, Vec2, Vec3};

/// How the waves lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gabor {
    /// Their direction; where they all have it, its length is their frequency.
    pub direction: [f32; 3],
    /// Width of the spectrum in octaves, 0.01..100.
    pub bandwidth: f32,
    /// Mean number of bells that reach a point, 1..32.
    pub impulses: f32,
    /// 0: waves of any direction; 1: of this one; else: of any in the plane of x and y.
    pub anisotropic: i32,
    /// Period of each coordinate, 0 for none.
    pub period: [f32; 3],
    /// How the point changes along x and y of the picture, over which the noise is then filtered.
    pub pixel: Option<[[f32; 3]; 2]>,
}

/// Where a bell counts as ended: at 2 % of its height.
const CUT: f32 = 0.02;

/// The frequency that the width of bells is derived from.
const FREQUENCY: f32 = 2.0;

const TAU: f32 = std::f32::consts::TAU;
const PI: f32 = std::f32::consts::PI;

/// Random numbers of a cell: the multiplicative generator of Borosh and Niederreiter 1983.
struct Dice(u32);

impl Dice {
    fn of_cell(cell: [i32; 3], seed: u32) -> Self {
        Dice(hash4(cell[0] as u32, cell[1] as u32, cell[2] as u32, seed).max(1))
    }

    /// The next number in [0, 1].
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(3_039_177_861);
        self.0 as f32 / u32::MAX as f32
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

/// What the bells of a noise have in common.
struct Bells {
    /// The width of the bell.
    a: f32,
    /// How far it counts.
    radius: f32,
    /// How many a cell has on average.
    mean: f32,
    filter: Option<Filter>,
}

/// The surface that is seen, and what a pixel covers of it.
struct Filter {
    /// Rows: two directions in the surface and its normal.
    local: Mat3,
    /// The covariance of a pixel's Gaussian in the surface.
    covariance: Mat2,
}

impl Filter {
    /// Of how the point changes along x and y; nothing where a pixel covers next to nothing.
    fn new([dx, dy]: [[f32; 3]; 2]) -> Option<Self> {
        let (dx, dy) = (Vec3::from(dx), Vec3::from(dy));
        let normal = dx.cross(dy);
        // Covers less than a thousandth: bells are much wider.
        if !(normal.length_squared() >= 1e-6 && normal.is_finite()) {
            return None;
        }
        let normal = normal.normalize();
        let across = if normal.x.abs() < 0.9 {
            Vec3::new(0.0, normal.z, -normal.y)
        } else {
            Vec3::new(-normal.z, 0.0, normal.x)
        };
        let across = across.normalize();
        let along = normal.cross(across);
        let local = Mat3::from_cols(across, along, normal).transpose();
        let pixel = Mat2::from_cols((local * dx).truncate(), (local * dy).truncate());
        // A pixel's Gaussian has half a pixel for its deviation.
        let covariance = 0.25 * (pixel * pixel.transpose());
        (covariance.determinant() >= 1e-18).then_some(Filter { local, covariance })
    }
}

impl Gabor {
    fn bells(&self) -> Bells {
        let octaves = pow(2.0, self.bandwidth.clamp(0.01, 100.0));
        // Eq. 5: the width of the bell whose spectrum is so wide.
        let width = (octaves - 1.0) / (octaves + 1.0) * (PI / std::f32::consts::LN_2).sqrt();
        // All octaves there are: a float has no more of them.
        let a = FREQUENCY * if width.is_finite() { width } else { (PI / std::f32::consts::LN_2).sqrt() };
        let radius = (-ln(CUT) / PI).sqrt() / a;
        // Over the volume of a sphere with OSL's digits.
        let mean = self.impulses.clamp(1.0, 32.0) / (1.33333 * std::f64::consts::PI) as f32;
        Bells { a, radius, mean, filter: self.pixel.and_then(Filter::new) }
    }

    /// The noise at a point, of mean 0 and nearly always in -1..1 (its deviation is 1/6), and its gradient. Different seeds give independent
    /// noises.
    pub fn at(&self, p: [f32; 3], seed: u32) -> Jet<3> {
        let bells = self.bells();
        let inverse = 1.0 / bells.radius;
        let grid = p.map(|x| x * inverse);
        let mut sum = Jet { value: 0.0, gradient: [0.0; 3] };
        if !grid.iter().all(|x| x.abs() < 1e9) {
            return sum;
        }
        let cell = grid.map(f32::floor);
        for neighbor in 0..27i32 {
            let offset = [neighbor % 3 - 1, neighbor / 3 % 3 - 1, neighbor / 9 - 1];
            let at: [i32; 3] = std::array::from_fn(|c| self.wrapped(cell[c] + offset[c] as f32, c, bells.radius));
            let from = std::array::from_fn(|c| (grid[c] - cell[c]) - offset[c] as f32);
            self.add_cell(&bells, Dice::of_cell(at, seed), from, &mut sum);
        }
        // The variance of the sum is the density of bells times the integral of a squared one, half of that of the squared bell; what it is
        // brought to is half of a third.
        let density = bells.mean / (bells.radius * bells.radius * bells.radius);
        let variance = 1.0 / (4.0 * std::f32::consts::SQRT_2 * bells.a * bells.a * bells.a);
        let scale = 0.5 / (3.0 * variance.sqrt() * density.sqrt());
        Jet { value: sum.value * scale, gradient: sum.gradient.map(|g| g * scale) }
    }

    /// The cell that stands for one: the same a period on. A period is a whole number of cells only nearly.
    fn wrapped(&self, cell: f32, axis: usize, radius: f32) -> i32 {
        let cells = (self.period[axis] / radius).round();
        let cell = if cells >= 1.0 { cell - cells * (cell / cells).floor() } else { cell };
        cell as i32
    }

    /// Adds the bells of a cell at a place from its corner, in cells.
    fn add_cell(&self, bells: &Bells, mut dice: Dice, from: [f32; 3], sum: &mut Jet<3>) {
        let Bells { a, radius, .. } = *bells;
        for _ in 0..dice.count(bells.mean) {
            let [z, y, x] = [dice.roll(), dice.roll(), dice.roll()];
            let d = Vec3::new(from[0] - x, from[1] - y, from[2] - z) * radius;
            let wave = self.wave(&mut dice);
            let phase = dice.roll() * TAU;
            if d.length_squared() >= radius * radius {
                continue;
            }
            let filtered = bells.filter.as_ref().and_then(|filter| filtered(filter, a, wave, phase, d));
            let jet = filtered.unwrap_or_else(|| {
                let bell = exp(-PI * (a * a) * d.length_squared());
                let (sin, cos) = sincos(TAU * wave.dot(d) + phase);
                Jet { value: bell * cos, gradient: (-bell * TAU * (a * a * cos * d + sin * wave)).to_array() }
            });
            sum.value += jet.value;
            (0..3).for_each(|c| sum.gradient[c] += jet.gradient[c]);
        }
    }

    /// The direction of a wave, as long as its frequency.
    fn wave(&self, dice: &mut Dice) -> Vec3 {
        let direction = Vec3::from(self.direction);
        if self.anisotropic == 1 {
            return if direction.is_finite() { direction } else { Vec3::X };
        }
        let (sin, cos) = sincos(dice.roll() * TAU);
        if self.anisotropic != 0 {
            let frequency = direction.length();
            return Vec3::new(cos, sin, 0.0) * if frequency.is_finite() { frequency } else { 1.0 };
        }
        let z = 2.0 * dice.roll() - 1.0;
        let across = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(across * cos, across * sin, z).normalize_or_zero()
    }
}

/// A bell cut by the surface that is seen, and convolved with a pixel's Gaussian in it; nothing where numbers fail.
fn filtered(filter: &Filter, a: f32, wave: Vec3, phase: f32, d: Vec3) -> Option<Jet<3>> {
    let (wave, d) = (filter.local * wave, filter.local * d);
    let (height, flat, wave_flat) = (d.z, d.truncate(), wave.truncate());
    // Eq. 6: the bell in a plane at a height below its middle, whose wave has gone on.
    let slice = exp(-PI * (a * a) * (height * height));
    let phase = phase + TAU * height * wave.z;
    // Eq. 10: Gaussians of spectra multiply. The bell's, the pixel's, and of both together.
    let own = a * a / TAU;
    let spectrum = filter.covariance.inverse() * (1.0 / (TAU * TAU));
    let both = spectrum + Mat2::from_diagonal(Vec2::splat(own));
    let loss = (both.inverse() * wave_flat).dot(wave_flat);
    let strength = 1.0 / (TAU * filter.covariance.determinant().sqrt() * TAU * both.determinant().sqrt());
    let joint = (spectrum.inverse() + Mat2::from_diagonal(Vec2::splat(1.0 / own))).inverse();
    let (weight, wave_flat) = (slice * strength * exp(-0.5 * loss), joint * wave_flat * (1.0 / own));
    // Of the elongated bell the round one of the same area.
    let width = TAU * joint.determinant().sqrt();
    let bell = weight * exp(-PI * width * flat.length_squared());
    let (sin, cos) = sincos(TAU * wave_flat.dot(flat) + phase);
    let value = bell * cos;
    let along = -bell * TAU * (width * cos * flat + sin * wave_flat);
    let up = -bell * TAU * (a * a * height * cos + sin * wave.z);
    let gradient = filter.local.transpose() * along.extend(up);
    (value.is_finite() && gradient.is_finite()).then(|| Jet { value, gradient: gradient.to_array() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Gabor = Gabor {
        direction: [1.0, 0.0, 0.0],
        bandwidth: 1.0,
        impulses: 16.0,
        anisotropic: 0,
        period: [0.0; 3],
        pixel: None,
    };

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
            assert!((spread - 1.0 / 6.0).abs() < 0.015, "{gabor:?}: spread {spread}");
        }
    }

    #[test]
    fn gradients_are_those_of_differences() {
        let pixel = Some([[0.2, 0.05, 0.1], [-0.1, 0.3, 0.0]]);
        for gabor in [PLAIN, Gabor { anisotropic: 1, direction: [0.5, 1.0, -0.3], ..PLAIN }, Gabor { pixel, ..PLAIN }] {
            // At the edge of a bell, which one of some sixteen steps crosses, the value jumps by what is cut off.
            let (mut jumps, mut control) = (0, 0);
            for p in points().take(100) {
                let (jet, h) = (gabor.at(p, 7), 1e-3);
                for c in 0..3 {
                    let moved = |by: f32| {
                        let mut q = p;
                        q[c] += by;
                        f64::from(gabor.at(q, 7).value)
                    };
                    let slope = (moved(h) - moved(-h)) / f64::from(2.0 * h);
                    jumps += usize::from((slope - f64::from(jet.gradient[c])).abs() > 0.02);
                    control += usize::from((slope - 1.3 * f64::from(jet.gradient[c])).abs() > 0.02);
                }
            }
            assert!(jumps <= 40 && control > 150, "{gabor:?}: {jumps} and {control} of 300");
        }
    }

    #[test]
    fn waves_of_one_direction_change_along_it() {
        let gabor = Gabor { anisotropic: 1, bandwidth: 0.5, ..PLAIN };
        let square = |c: usize| points().map(|p| f64::from(gabor.at(p, 0).gradient[c]).powi(2)).sum::<f64>();
        assert!(square(0) > 20.0 * square(1), "{} {}", square(0), square(1));
    }

    /// The root of the mean square of the difference between filtered noise and the mean of the unfiltered one over pixels, by a sum over
    /// five deviations each way.
    fn filter_error(seen: [[f32; 3]; 2], told: Option<[[f32; 3]; 2]>) -> f64 {
        let gabor = Gabor { pixel: told, ..PLAIN };
        let [dx, dy] = seen.map(Vec3::from);
        let mut sum = 0.0;
        for p in points().take(60) {
            let (mut mean, mut all) = (0.0f64, 0.0f64);
            for (i, j) in (-25..=25).flat_map(|i| (-25..=25).map(move |j| (i, j))) {
                // In deviations, which are half a pixel.
                let (x, y) = (i as f32 * 0.1, j as f32 * 0.1);
                let weight = f64::from(exp(-0.5 * (x * x + y * y)));
                let q = Vec3::from(p) + 0.5 * (x * dx + y * dy);
                mean += weight * f64::from(PLAIN.at(q.to_array(), 0).value);
                all += weight;
            }
            sum += (f64::from(gabor.at(p, 0).value) - mean / all).powi(2);
        }
        (sum / 60.0).sqrt()
    }

    #[test]
    fn filtered_noise_is_the_mean_over_a_pixel() {
        let seen = [[0.5, 0.1, 0.0], [0.4, 0.3, 0.2]];
        let transposed = [[0.5, 0.4, 0.0], [0.1, 0.3, 0.2]];
        let (right, none, wrong) =
            (filter_error(seen, Some(seen)), filter_error(seen, None), filter_error(seen, Some(transposed)));
        // What is left is the elongated bell that a round one stands for.
        assert!(right < 0.025 && none > 4.0 * right && wrong > 1.4 * right, "{right} {none} {wrong}");
        // What is far wider than its waves is nothing, what is far narrower is unfiltered.
        let wide = Gabor { pixel: Some([[9.0, 0.0, 0.0], [0.0, 9.0, 0.0]]), ..PLAIN };
        let fine = Gabor { pixel: Some([[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0]]), ..PLAIN };
        for p in points().take(100) {
            assert!(wide.at(p, 0).value.abs() < 0.01);
            assert_eq!(fine.at(p, 0), PLAIN.at(p, 0));
        }
    }

    #[test]
    fn what_is_no_number_gives_numbers() {
        let bad = f32::NAN;
        for pixel in [None, Some([[bad; 3]; 2]), Some([[1e30; 3], [-1e30, 0.0, 1.0]])] {
            for direction in [[bad; 3], [0.0; 3], [1e30; 3]] {
                for anisotropic in [0, 1, 2] {
                    let gabor = Gabor { direction, anisotropic, pixel, bandwidth: 100.0, ..PLAIN };
                    assert!(gabor.at([0.5, 1.5, 2.5], 0).value.is_finite(), "{gabor:?}");
                }
            }
        }
    }
}
