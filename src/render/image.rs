//! A finished picture, and what is known about how it was made.

use crate::exec::Report;

/// Linear light, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Three channels, or four with alpha, by which the colors are then multiplied.
    pub channels: usize,
    /// `width * height * channels` numbers, all finite.
    pub pixels: Vec<f32>,
    /// How it was made.
    pub about: About,
}

/// How an image was made; the part that its file's header keeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// The name of the scene's file, without its folder.
    pub scene: String,
    /// Samples a pixel that were asked for, the most of them when the render was to stop by itself.
    pub samples: u32,
    /// The fewest and the most samples a pixel that any tile has got.
    pub taken: [u32; 2],
    /// Root of the mean square error of the whole image, in units of radiance, where the render estimated it.
    pub noise: Option<f64>,
    /// The seed.
    pub seed: u32,
    /// Camera samples in all.
    pub paths: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Seconds spent on preparing the scene.
    pub seconds_preparing: f64,
    /// Seconds spent on tracing.
    pub seconds_tracing: f64,
    /// What shaders printed, and one line for whatever had to be dropped.
    pub reports: Vec<Report>,
}

impl Image {
    /// The channels of one pixel.
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        let start = (y as usize * self.width as usize + x as usize) * self.channels;
        &self.pixels[start..start + self.channels]
    }

    /// The mean of red, green and blue over all pixels.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0f64; 3];
        for pixel in self.pixels.chunks_exact(self.channels) {
            (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
        }
        sum.map(|s| s / (f64::from(self.width) * f64::from(self.height)))
    }
}
