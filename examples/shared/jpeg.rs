//! A picture as a JPEG.

use image::codecs::jpeg::JpegEncoder;
use velour::render::{Image, Screen};

/// The bytes of a picture in the default look.
pub fn jpeg(image: &Image, quality: u8) -> Result<Vec<u8>, image::ImageError> {
    let mut out = Vec::new();
    let (bytes, kind) = (Screen::default().bytes(image), image::ExtendedColorType::Rgb8);
    JpegEncoder::new_with_quality(&mut out, quality).encode(&bytes, image.width, image.height, kind)?;
    Ok(out)
}
