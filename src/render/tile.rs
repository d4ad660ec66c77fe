//! Tiles: which part of the image a thread takes next, and how its samples become pixels.

use super::settings::Settings;
use super::wave::Wave;
use super::world::World;

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

    /// Renders the tile into `pixels`, `channels` numbers a pixel.
    ///
    /// Each pixel adds its samples in their own order and in double precision, so neither the size of the tile nor
    /// that of the wave shows.
    pub fn render(&self, world: &World, wave: &mut Wave, sums: &mut Vec<[f64; 4]>) {
        let count = self.width * self.height;
        let samples = world.settings.samples;
        let wave_size = world.settings.wave_size.max(1) as u32;
        sums.clear();
        sums.resize(count as usize, [0.0; 4]);
        // Whole pixels at a time when few samples make a wave, else as many samples of all pixels as fill it.
        let per_pixel = (wave_size / count).clamp(1, samples);
        let pixels_at_once = (wave_size / per_pixel).clamp(1, count);
        for first_sample in (0..samples).step_by(per_pixel as usize) {
            let range = first_sample..samples.min(first_sample + per_pixel);
            for first in (0..count).step_by(pixels_at_once as usize) {
                let end = count.min(first + pixels_at_once);
                wave.clear();
                for pixel in first..end {
                    wave.start(world, self.x + pixel % self.width, self.y + pixel / self.width, range.clone());
                }
                wave.run(world);
                for (pixel, paths) in (first..end).zip(wave.paths.chunks_exact(range.len())) {
                    let sum = &mut sums[pixel as usize];
                    for path in paths {
                        let r = path.radiance.to_array();
                        (0..3).for_each(|c| sum[c] += f64::from(r[c]));
                        sum[3] += f64::from(path.alpha);
                    }
                }
            }
        }
    }
}
