//! A picture as a page shows it: bytes for a canvas.

use crate::math::elementary::exp2;
use crate::render::Image;
use crate::render::srgb;
use std::sync::LazyLock;

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

/// Steps of the curve, which goes over roots: there neighbours differ by less than a byte.
const STEPS: usize = 4096;

/// The transfer curve of sRGB over the root of the light.
static CURVE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let byte = |k: usize| {
        let root = k as f32 / (STEPS - 1) as f32;
        (srgb(root * root) * 255.0 + 0.5) as u8
    };
    (0..STEPS).map(byte).collect()
});

impl Frame {
    /// The frame of a picture, made brighter by so many stops.
    ///
    /// Decision (2026-11-30): plain bytes instead of a PNG: 640 x 256 pixels take 1 ms to make and .7 MB over the loopback device, where
    /// encoding takes longer than the device.
    pub fn of(image: &Image, stops: f32) -> Frame {
        let scale = exp2(stops.clamp(-20.0, 20.0));
        let byte = |light: f32| CURVE[((light * scale).clamp(0.0, 1.0).sqrt() * (STEPS - 1) as f32 + 0.5) as usize];
        let mut bytes = Vec::with_capacity(4 * image.width as usize * image.height as usize);
        for pixel in image.pixels.chunks_exact(image.channels) {
            bytes.extend_from_slice(&[byte(pixel[0]), byte(pixel[1]), byte(pixel[2]), 255]);
        }
        Frame { width: image.width, height: image.height, bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::About;

    #[test]
    fn bytes_follow_the_curve_within_one() {
        let lights: Vec<f32> = (0..3000).map(|k| k as f32 / 2400.0).collect();
        let image = Image { width: 1000, height: 1, channels: 3, pixels: lights.clone(), about: About::default() };
        for stops in [0.0, 1.0, -2.0] {
            let frame = Frame::of(&image, stops);
            for (k, light) in lights.iter().enumerate() {
                let expected = (srgb(light * stops.exp2()) * 255.0 + 0.5) as i32;
                let byte = i32::from(frame.bytes[4 * (k / 3) + k % 3]);
                assert!((byte - expected).abs() <= 1, "{light} at {stops}: {byte} for {expected}");
            }
        }
    }
}
