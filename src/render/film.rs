//! The film: every sample counts for the pixels around it, by a tent as wide as two pixels.
//!
//! Decision (2026-11-22): a sample is drawn evenly in its own pixel and weighed by the tent into the two by two pixels
//! whose centres are near, instead of being drawn by the tent for one pixel, because the picture is the same and each
//! pixel hears 2.25 times as many samples: the mean square error of `shaders/scenes/figure1.xml` (320 x 128, 64
//! samples, half the mean square difference of three seeds) falls from 1.32e-5 to 6.9e-6. Neighbours then share noise, as in every renderer that splats.
//!
//! A thread keeps its tile's sums apart by source pixel and by the pixel they count for, and adds them up in one fixed
//! order. Tiles overlap by a rim of one pixel; the rims are added in the order of the tiles when all is done. So neither
//! threads nor waves show, and the size of a tile shows only where a sum of doubles rounds to another single.

use super::settings::Settings;
use super::tile::Tile;

/// Red, green, blue, alpha and weight.
const PARTS: usize = 5;

/// Independent halves that an error can be estimated from.
pub const HALVES: usize = 2;

/// The sums of one pixel's samples for the pixels around it, row by row; the fifth is the pixel itself.
type Around = [[f64; PARTS]; 9];

/// One thread's sums of one tile.
#[derive(Default)]
pub struct Sums {
    around: [Vec<Around>; HALVES],
}

impl Sums {
    /// Empty sums for `count` pixels in each of `halves`.
    pub fn clear(&mut self, count: usize, halves: usize) {
        for half in &mut self.around[..halves] {
            half.clear();
            half.resize(count, [[0.0; PARTS]; 9]);
        }
    }

    /// Adds a sample of `pixel` that lies at (`x`, `y`) in it, both in [0, 1].
    #[inline]
    pub fn add(&mut self, half: usize, pixel: usize, [x, y]: [f32; 2], light: [f32; 3], alpha: f32) {
        let around = &mut self.around[half][pixel];
        let light = [light[0], light[1], light[2], alpha, 1.0].map(f64::from);
        let ((column, across), (row, down)) = (taps(x), taps(y));
        for (j, wy) in down.into_iter().enumerate() {
            for (i, wx) in across.into_iter().enumerate() {
                let sum = &mut around[(row + j) * 3 + column + i];
                (0..PARTS).for_each(|k| sum[k] += wx * wy * light[k]);
            }
        }
    }

    /// What the tile adds to pixel (`x`, `y`), counted from one left of and above its corner.
    fn total(&self, half: usize, tile: &Tile, x: usize, y: usize) -> [f64; PARTS] {
        let (width, height) = (tile.width as usize, tile.height as usize);
        let mut total = [0.0; PARTS];
        // A source at column x - 1 + i - 1 counts for this pixel through its tap 2 - i.
        for j in 0..3 {
            for i in 0..3 {
                let (Some(sx), Some(sy)) = ((x + i).checked_sub(2), (y + j).checked_sub(2)) else { continue };
                if sx < width && sy < height {
                    let part = &self.around[half][sy * width + sx][(2 - j) * 3 + 2 - i];
                    (0..PARTS).for_each(|k| total[k] += part[k]);
                }
            }
        }
        total
    }
}

/// The first of two neighbouring pixels (0 before, 1 the own) that a place in a pixel counts for, and both weights.
#[inline]
fn taps(x: f32) -> (usize, [f64; 2]) {
    let x = f64::from(x);
    if x < 0.5 { (0, [0.5 - x, 0.5 + x]) } else { (1, [1.5 - x, x - 0.5]) }
}

/// A sum as a finite single.
fn limited(x: f64) -> f32 {
    x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

/// What a tile has gathered in one half: sums over the tile and its rim, and how many samples each pixel has had.
#[derive(Clone, Default)]
struct Kept {
    sums: Vec<[f64; PARTS]>,
    samples: f64,
}

/// What all tiles have gathered: some 50 bytes a pixel, twice that when there are halves, and as much again while a
/// picture is made of it.
pub struct Film {
    tiles: Vec<[Kept; HALVES]>,
}

impl Film {
    /// An empty film.
    pub fn new(settings: &Settings) -> Self {
        Film { tiles: vec![<[Kept; HALVES]>::default(); Tile::count(settings)] }
    }

    /// Adds what a thread has gathered of tile `number` in `samples` of each pixel, which take the halves in turns.
    pub fn add(&mut self, number: usize, tile: &Tile, sums: &Sums, halves: usize, samples: std::ops::Range<u32>) {
        let (width, height) = (tile.width as usize + 2, tile.height as usize + 2);
        for half in 0..halves {
            let kept = &mut self.tiles[number][half];
            kept.samples += samples.clone().filter(|n| *n as usize % halves == half).count() as f64;
            kept.sums.resize(width * height, [0.0; PARTS]);
            for (i, sum) in kept.sums.iter_mut().enumerate() {
                let new = sums.total(half, tile, i % width, i / width);
                (0..PARTS).for_each(|k| sum[k] += new[k]);
            }
        }
    }

    /// The picture of the samples of `halves`, `channels` numbers a pixel; black where there are none.
    ///
    /// A tile's sums count by its samples a pixel: where two tiles meet that have had unlike numbers of them, each still
    /// gives a pixel the share that the tent gives to its side.
    pub fn picture(&self, settings: &Settings, halves: std::ops::Range<usize>, channels: usize) -> Vec<f32> {
        let (width, height) = (settings.width as usize, settings.height as usize);
        let mut sums = vec![[0.0f64; PARTS]; width * height];
        for (number, kept) in self.tiles.iter().enumerate() {
            let tile = Tile::number(settings, number);
            let rim = tile.width as usize + 2;
            let samples: f64 = kept[halves.clone()].iter().map(|half| half.samples).sum();
            let share = 1.0 / samples.max(1.0);
            for sum in kept[halves.clone()].iter().flat_map(|half| half.sums.iter().enumerate()) {
                let (x, y) = (tile.x as usize + sum.0 % rim, tile.y as usize + sum.0 / rim);
                // The rim may lie outside the picture; nobody looks there.
                if (1..=width).contains(&x) && (1..=height).contains(&y) {
                    let pixel = &mut sums[(y - 1) * width + x - 1];
                    (0..PARTS).for_each(|k| pixel[k] += share * sum.1[k]);
                }
            }
        }
        let mean = |sum: &[f64; PARTS], k: usize| if sum[4] > 0.0 { limited(sum[k] / sum[4]) } else { 0.0 };
        sums.iter().flat_map(|sum| (0..channels).map(move |k| mean(sum, k))).collect()
    }

    /// The mean square error of each tile's pixels, from the difference of the two halves: a quarter of its square.
    ///
    /// Gives: mean over pixels and colors, in squared units of radiance. The halves draw their samples from sequences of
    /// their own, so the estimate is unbiased for any one number of samples. Infinite where a half has no sample.
    pub fn errors(&self, settings: &Settings) -> Vec<f64> {
        let [a, b] = [0..1, 1..2].map(|half| self.picture(settings, half, 3));
        let error = |number: usize| {
            if self.tiles[number].iter().any(|half| half.samples == 0.0) {
                return f64::INFINITY;
            }
            let tile = Tile::number(settings, number);
            let mut sum = 0.0;
            for y in tile.y..tile.y + tile.height {
                let start = (y as usize * settings.width as usize + tile.x as usize) * 3;
                let row = start..start + 3 * tile.width as usize;
                sum += a[row.clone()].iter().zip(&b[row]).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
            }
            sum / (12.0 * f64::from(tile.width * tile.height))
        };
        (0..self.tiles.len()).map(error).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_a_tent_and_add_up_to_one() {
        for i in 0..=100 {
            let x = i as f32 / 100.0;
            let (first, weights) = taps(x);
            assert_eq!(weights[0] + weights[1], 1.0);
            for (k, weight) in weights.into_iter().enumerate() {
                let center = (first + k) as f64 - 0.5;
                assert!((weight - (1.0 - (f64::from(x) - center).abs())).abs() < 1e-7);
            }
        }
    }

    /// A film of nine by seven pixels, whose tile of a number gets `side(number)` squared samples of a ramp a pixel.
    fn ramp(settings: &Settings, side: impl Fn(usize) -> usize) -> Vec<f32> {
        let mut film = Film::new(settings);
        let mut sums = Sums::default();
        for number in 0..Tile::count(settings) {
            let tile = Tile::number(settings, number);
            sums.clear((tile.width * tile.height) as usize, 1);
            let side = side(number);
            for pixel in 0..(tile.width * tile.height) {
                let (px, py) = (tile.x + pixel % tile.width, tile.y + pixel / tile.width);
                for i in 0..side * side {
                    let at = [i % side, i / side].map(|k| (k as f32 + 0.5) / side as f32);
                    sums.add(0, pixel as usize, at, [px as f32 + at[0], py as f32 + at[1], 1.0], 0.5);
                }
            }
            film.add(number, &tile, &sums, 1, 0..(side * side) as u32);
        }
        film.picture(settings, 0..1, 4)
    }

    #[test]
    fn a_ramp_keeps_its_values_across_tiles_of_any_number_of_samples() {
        // A tent filter leaves a linear picture as it is, away from the image's edge.
        let settings = Settings { width: 9, height: 7, tile_size: 4, ..Settings::default() };
        // Unlike grids of samples fit together but for their own error, the square of their spacing; sums that counted by
        // samples alone would be off by a third of a pixel.
        let uneven = ramp(&settings, |number| if number % 2 == 0 { 16 } else { 64 });
        for (picture, error) in [(ramp(&settings, |_| 8), 1e-5), (uneven, 1e-3)] {
            for (i, pixel) in picture.chunks(4).enumerate() {
                let (x, y) = (i % 9, i / 9);
                assert!((pixel[2] - 1.0).abs() < 1e-6 && (pixel[3] - 0.5).abs() < 1e-6);
                if (1..8).contains(&x) && (1..6).contains(&y) {
                    let expected = [x as f32 + 0.5, y as f32 + 0.5];
                    assert!((0..2).all(|k| (pixel[k] - expected[k]).abs() < error), "{x} {y}: {pixel:?}");
                }
            }
        }
    }
}
