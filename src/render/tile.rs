//! Tiles: which part of the image a thread takes next, and how its samples become pixels.

use super::film::Sums;
use super::settings::Settings;
use super::wave::Wave;
use super::world::World;
use std::ops::Range;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Width.
    pub width: u32,
    /// Height.
    pub height: u32,
}

impl Tile {
    /// How many tiles an image has.
    pub fn count(settings: &Settings) -> usize {
        let across = |n: u32| n.div_ceil(settings.tile_size) as usize;
        across(settings.width) * across(settings.height)
    }

    /// The tile of a number, row by row.
    pub fn number(settings: &Settings, number: usize) -> Tile {
        let across = settings.width.div_ceil(settings.tile_size) as usize;
        let x = (number % across) as u32 * settings.tile_size;
        let y = (number / across) as u32 * settings.tile_size;
        let width = settings.tile_size.min(settings.width - x);
        Tile { x, y, width, height: settings.tile_size.min(settings.height - y) }
    }

    /// Renders samples `first..end` of the tile's pixels into `sums`.
    ///
    /// Each pixel adds its samples in their own order and in double precision, so neither the batches nor the waves
    /// show.
    pub fn render(&self, world: &World, wave: &mut Wave, samples: Range<u32>, sums: &mut Sums) {
        let count = self.width * self.height;
        let (halves, wave_size) = (world.settings.halves(), world.settings.wave_size.max(1) as u32);
        sums.clear(count as usize, halves);
        // Whole pixels at a time when few samples make a wave, else as many samples of all pixels as fill it.
        let per_pixel = (wave_size / count).clamp(1, samples.len().max(1) as u32);
        let pixels_at_once = (wave_size / per_pixel).clamp(1, count);
        for first_sample in samples.clone().step_by(per_pixel as usize) {
            let range = first_sample..samples.end.min(first_sample + per_pixel);
            for first in (0..count).step_by(pixels_at_once as usize) {
                let end = count.min(first + pixels_at_once);
                wave.clear();
                for pixel in first..end {
                    wave.start(world, self.x + pixel % self.width, self.y + pixel / self.width, range.clone());
                }
                wave.run(world);
                for (number, (path, place)) in wave.paths.iter().zip(&wave.places).enumerate() {
                    let pixel = first as usize + number / range.len();
                    let half = (range.start as usize + number % range.len()) % halves;
                    sums.add(half, pixel, *place, path.radiance.to_array(), path.alpha);
                }
            }
        }
    }
}
