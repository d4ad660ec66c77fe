//! Tiles: the rectangles that an image is cut into, one of which a thread takes at a time.

use super::settings::Settings;

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
        Tile::count_of([settings.width, settings.height], settings.tile_size)
    }

    /// How many tiles of a side, above 0, an image of a size has.
    pub fn count_of(size: [u32; 2], side: u32) -> usize {
        size.map(|n| n.div_ceil(side) as usize).into_iter().product()
    }

    /// The tile of a number, row by row.
    pub fn number(settings: &Settings, number: usize) -> Tile {
        let across = settings.width.div_ceil(settings.tile_size) as usize;
        let x = (number % across) as u32 * settings.tile_size;
        let y = (number / across) as u32 * settings.tile_size;
        let width = settings.tile_size.min(settings.width - x);
        Tile { x, y, width, height: settings.tile_size.min(settings.height - y) }
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> u32 {
        self.width * self.height
    }
}
