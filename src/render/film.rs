//! The film: every sample counts for the pixels around it, by a tent as wide as two pixels.
//!
//! Decision (2026-11-22): a sample is drawn evenly in its own pixel and weighed by the tent into the two by two pixels
//! whose centres are near, instead of being drawn by the tent for one pixel, because the picture is the same and each
//! pixel hears 2.25 times as many samples: the mean square error of `shaders/scenes/spheres.xml` (320 x 128, 64
//! samples, half the mean square difference of three seeds) falls from 1.32e-5 to 6.9e-6. Neighbours then share noise, as in every renderer that splats.
//!
//! A tile's sums are taken by the thread that renders it and given back. They are exact (see `exact`), so that neither threads nor
//! waves, rounds, tiles or the order of samples show. Tiles overlap by a rim of one pixel, which is added when a picture is made.
//!
//! Decision (2026-11-29): a tile's sums (13 kB at 16 x 16 pixels) are kept together, because they stay in the nearest cache, where
//! sums kept apart by source pixel did not.

use super::exact::{self, ALPHA, PARTS, Sums, WEIGHT};
use super::settings::{HALVES, Settings};
use super::tile::Tile;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// What a tile has gathered in each half: sums over its pixels and a rim of one.
#[derive(Clone, Debug, Default)]
pub struct TileSums {
    halves: [HalfSums; HALVES],
    /// Sums in a row, the rim's included.
    across: usize,
}

/// The sums of one half, row by row, and how many samples each pixel has had.
#[derive(Clone, Debug, Default)]
struct HalfSums {
    sums: Sums,
    samples: u32,
}

impl TileSums {
    /// Makes room for `tile`, in the first `halves`; what is there stays.
    pub fn open(&mut self, tile: &Tile, halves: usize) {
        let (across, down) = (tile.width as usize + 2, tile.height as usize + 2);
        self.across = across;
        self.halves[..halves].iter_mut().for_each(|half| half.sums.open(across * down));
    }

    /// Adds a sample of the tile's pixel (`x`, `y`) that lies at `position` in it, both coordinates in [0, 1].
    #[inline]
    pub fn add(&mut self, half: usize, [x, y]: [u32; 2], position: [f32; 2], light: [f32; 3], alpha: f32) {
        let ((column, columns), (row, rows)) = (taps(position[0]), taps(position[1]));
        // Pixel (0, 0) is at (1, 1) of the sums, and tap 1 is the pixel itself.
        let first = (y as usize + row) * self.across + x as usize + column;
        self.halves[half].sums.splat(first, self.across, columns, rows, light, alpha);
    }

    /// Puts all there is into the first half, so that the second is empty.
    pub fn join(&mut self) {
        let [first, second] = &mut self.halves;
        first.sums.drain(&mut second.sums);
        first.samples += std::mem::take(&mut second.samples);
        first.sums.settle();
    }

    /// Notes that each pixel has had one sample more.
    pub fn count(&mut self, half: usize) {
        let half = &mut self.halves[half];
        half.samples += 1;
        if half.samples.is_multiple_of(exact::SETTLE) {
            half.sums.settle();
        }
    }
}

/// The first of two neighbouring pixels (0 before, 1 the own) that a place in a pixel counts for, and both weights. The middle counts for the
/// own pixel alone.
#[inline]
fn taps(x: f32) -> (usize, [f64; 2]) {
    let x = f64::from(x);
    if x < 0.5 { (0, [0.5 - x, 0.5 + x]) } else { (1, [1.5 - x, x - 0.5]) }
}

/// A sum as a finite single.
fn limited(x: f64) -> f32 {
    x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

/// The first `channels` numbers of a pixel of these sums, 3 or 4.
fn means(sum: [f64; PARTS], channels: usize) -> impl Iterator<Item = f32> {
    let mean = move |k: usize| match if sum[WEIGHT] > 0.0 { limited(sum[k] / sum[WEIGHT]) } else { 0.0 } {
        // A clear surface that amplifies makes a sample's share negative.
        alpha if k == ALPHA => alpha.clamp(0.0, 1.0),
        light => light,
    };
    (0..channels).map(mean)
}

/// Adds the sums of a tile and its rim to those of some rows of a picture of a width, from row `first` on.
fn add_tile(tile: &Tile, from: &[[i64; PARTS]], rows: &mut [[i64; PARTS]], [width, first]: [usize; 2]) {
    let (x, y) = (tile.x as usize, tile.y as usize);
    let (across, down) = (tile.width as usize + 2, tile.height as usize + 2);
    // The rim may lie outside the picture; nobody looks there.
    let columns = usize::from(x == 0)..across.min(width + 1 - x);
    let (start, end) = ((first + 1).saturating_sub(y), (first + rows.len() / width + 1 - y).min(down));
    for row in start..end {
        let to = (y + row - 1 - first) * width + x + columns.start - 1;
        let from = &from[row * across + columns.start..row * across + columns.end];
        rows[to..].iter_mut().zip(from).for_each(|(sum, more)| exact::plus(sum, more));
    }
}

/// The picture of sums, `channels` numbers a pixel, 3 or 4.
pub fn picture_of(sums: &Sums, channels: usize) -> Vec<f32> {
    const PIECE: usize = 1 << 12;
    let mut pixels = vec![0.0; channels * sums.len()];
    pixels.par_chunks_mut(channels * PIECE).enumerate().for_each(|(piece, pixels)| {
        for (i, pixel) in pixels.chunks_exact_mut(channels).enumerate() {
            let mean = means(sums.value(piece * PIECE + i), channels);
            pixel.iter_mut().zip(mean).for_each(|(channel, mean)| *channel = mean);
        }
    });
    pixels
}

/// What all tiles have gathered: some 50 bytes a pixel, twice that when there are halves, and as much again while a
/// picture is made of it.
#[derive(Debug)]
pub struct Film {
    tiles: Vec<TileSums>,
    /// Sums over the pixels of samples that were made elsewhere.
    kept: Option<Sums>,
}

impl Film {
    /// An empty film.
    pub fn new(settings: &Settings) -> Self {
        Film { tiles: vec![TileSums::default(); Tile::count(settings)], kept: None }
    }

    /// Adds to all pictures what was made elsewhere, in place of what this was told before.
    pub fn keep(&mut self, sums: Sums) {
        self.kept = Some(sums);
    }

    /// Hands out the sums of tile `number`, to be given back with more in them.
    pub fn take(&mut self, number: usize) -> TileSums {
        std::mem::take(&mut self.tiles[number])
    }

    /// Takes back the sums of tile `number`.
    pub fn give(&mut self, number: usize, sums: TileSums) {
        self.tiles[number] = sums;
    }

    /// The picture of the samples of `halves`, `channels` numbers a pixel; black where there are none.
    pub fn picture(&self, settings: &Settings, halves: std::ops::Range<usize>, channels: usize) -> Vec<f32> {
        let samples = |tile: &TileSums| tile.halves[halves.clone()].iter().map(|half| half.samples).sum::<u32>();
        let first = self.tiles.first().map_or(0, samples);
        if self.kept.is_some() || self.tiles.iter().all(|tile| samples(tile) == first) {
            picture_of(&self.sums(settings, halves), channels)
        } else {
            self.shares(settings, halves).into_iter().flat_map(|sum| means(sum, channels)).collect()
        }
    }

    /// The exact sums of `halves` over the pixels of the picture.
    pub fn sums(&self, settings: &Settings, halves: std::ops::Range<usize>) -> Sums {
        let (width, height) = (settings.width as usize, settings.height as usize);
        let across = settings.width.div_ceil(settings.tile_size) as usize;
        let row = settings.tile_size as usize * width;
        let mut sums = self.kept.clone().unwrap_or_default();
        let numbers: BTreeSet<i32> = self
            .tiles
            .iter()
            .flat_map(|tile| tile.halves[halves.clone()].iter().flat_map(|half| half.sums.numbers()))
            .collect();
        // A row of tiles gets what is its own, and the rims of the rows above and below.
        sums.gather(width * height, row, numbers.into_iter(), |number, place, out| {
            let tiles = across * place.saturating_sub(1)..(across * (place + 2)).min(self.tiles.len());
            for (tile, tile_sums) in tiles.clone().zip(&self.tiles[tiles]) {
                let first = place * settings.tile_size as usize;
                for half in &tile_sums.halves[halves.clone()] {
                    if let Some(sums) = half.sums.of_tier(number) {
                        add_tile(&Tile::number(settings, tile), sums, out, [width, first]);
                    }
                }
            }
        });
        sums
    }

    /// The same where tiles have had unlike numbers of samples: a tile's sums count by its samples a pixel, so that where two meet
    /// each still gives a pixel the share that the tent gives to its side.
    fn shares(&self, settings: &Settings, halves: std::ops::Range<usize>) -> Vec<[f64; PARTS]> {
        let (width, height) = (settings.width as usize, settings.height as usize);
        let mut sums = vec![[0.0f64; PARTS]; width * height];
        for (number, tile_sums) in self.tiles.iter().enumerate() {
            let tile = Tile::number(settings, number);
            let rim = tile.width as usize + 2;
            let halves = &tile_sums.halves[halves.clone()];
            let samples: f64 = halves.iter().map(|half| f64::from(half.samples)).sum();
            let share = 1.0 / samples.max(1.0);
            for (half, i) in halves.iter().flat_map(|half| (0..half.sums.len()).map(move |i| (half, i))) {
                let (x, y) = (tile.x as usize + i % rim, tile.y as usize + i / rim);
                if (1..=width).contains(&x) && (1..=height).contains(&y) {
                    let pixel = &mut sums[(y - 1) * width + x - 1];
                    half.sums.value(i).iter().zip(pixel).for_each(|(sum, pixel)| *pixel += share * sum);
                }
            }
        }
        sums
    }

    /// The mean square error of each tile's pixels, from the difference of the two halves: a quarter of its square where they have
    /// as many samples.
    ///
    /// Gives: mean over pixels and colors, in squared units of radiance. The halves are one sequence cut at its last power of two, of
    /// which the second fills the gaps of the first, so that the true error is rather smaller: on Figure 1 by a factor between 1 and 2.2.
    /// Infinite where a half has no sample.
    ///
    /// Decision (2026-11-29): halves of one sequence, because the picture is then that of a plain render, instead of one sequence
    /// for each, of which the estimate has no bias and the picture 1.5 times the squared error.
    pub fn errors(&self, settings: &Settings) -> Vec<f64> {
        let [a, b] = [0..1, 1..2].map(|half| self.picture(settings, half, 3));
        let error = |number: usize| {
            let [first, second] = self.tiles[number].halves.each_ref().map(|half| f64::from(half.samples));
            if first * second == 0.0 {
                return f64::INFINITY;
            }
            let shares = first * second / ((first + second) * (first + second));
            let tile = Tile::number(settings, number);
            let mut sum = 0.0;
            for y in tile.y..tile.y + tile.height {
                let start = (y as usize * settings.width as usize + tile.x as usize) * 3;
                let row = start..start + 3 * tile.width as usize;
                sum += a[row.clone()].iter().zip(&b[row]).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
            }
            shares * sum / (3.0 * f64::from(tile.pixels()))
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
        for number in 0..Tile::count(settings) {
            let tile = Tile::number(settings, number);
            let mut sums = film.take(number);
            sums.open(&tile, 1);
            let side = side(number);
            for i in 0..side * side {
                let at = [i % side, i / side].map(|k| (k as f32 + 0.5) / side as f32);
                for pixel in 0..tile.pixels() {
                    let [x, y] = [pixel % tile.width, pixel / tile.width];
                    let light = [(tile.x + x) as f32 + at[0], (tile.y + y) as f32 + at[1], 1.0];
                    sums.add(0, [x, y], at, light, 0.5);
                }
                sums.count(0);
            }
            film.give(number, sums);
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
