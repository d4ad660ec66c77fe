//! A picture as a page shows it: bytes for a canvas.

use crate::render::{Image, Screen};

/// Eight bits a channel, red, green, blue and 255, row by row from the upper left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `4 * width * height` of them.
    pub bytes: Vec<u8>,
}

impl Frame {
    /// The frame of a picture.
    ///
    /// Decision (2026-11-30): plain bytes instead of a PNG: they are .7 MB for 640 x 256 pixels, which the loopback device takes
    /// sooner than an encoder.
    pub fn of(image: &Image, screen: Screen) -> Frame {
        let bytes = screen.bytes(image).chunks_exact(image.channels).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
        Frame { width: image.width, height: image.height, bytes }
    }
}
