//! Image files: EXR, PNG and HDR, written under a temporary name and then renamed, so that no half file is ever seen.

use super::error::OutputError;
use super::image::Image;
use crate::math::elementary::pow;
use exr::prelude as exr;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// The kinds of files that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// OpenEXR, linear, 32-bit floats.
    Exr,
    /// PNG, 8 bits, sRGB.
    Png,
    /// Radiance HDR, linear, shared exponent.
    Hdr,
}

/// Says, before anything is rendered, whether a file of this name can be written.
pub fn check(path: &Path) -> Result<Format, OutputError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let format = match extension.as_str() {
        "exr" => Format::Exr,
        "png" => Format::Png,
        "hdr" => Format::Hdr,
        _ => return Err(OutputError::UnknownFormat { path: path.to_owned() }),
    };
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(OutputError::NoFolder { folder: folder.to_owned() });
    }
    if path.is_dir() {
        return Err(OutputError::IsFolder { path: path.to_owned() });
    }
    // Permissions, full disks and odd file systems are best found out by trying.
    let temporary = temporary_name(path);
    let tried = File::create(&temporary).map_err(|e| unwritable(path, e.to_string()));
    if tried.is_ok() {
        // What cannot be removed now is written over, and then renamed, by the image.
        let _ = std::fs::remove_file(&temporary);
    }
    tried.map(|_| format)
}

/// Writes `image` to `path` in the format of its extension.
pub fn write(image: &Image, path: &Path) -> Result<(), OutputError> {
    let format = check(path)?;
    let temporary = temporary_name(path);
    let written =
        write_to(image, format, &temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(|e| e.to_string()));
    written.map_err(|e| {
        // A failure to remove is not worth hiding the first failure for.
        let _ = std::fs::remove_file(&temporary);
        unwritable(path, e)
    })
}

fn unwritable(path: &Path, reason: String) -> OutputError {
    OutputError::Unwritable { path: path.to_owned(), reason }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// A name beside the file's own, so that the renaming stays on one disk; with the process, so that two renders of one
/// name do not meet.
fn temporary_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    folder_of(path).join(format!(".{name}.{}.part", std::process::id()))
}

fn write_to(image: &Image, format: Format, path: &Path) -> Result<(), String> {
    let file = File::create(path).map_err(|e| e.to_string())?;
    let mut writer = BufWriter::new(file);
    match format {
        Format::Exr => write_exr(image, &mut writer)?,
        Format::Png => write_png(image, &mut writer)?,
        Format::Hdr => write_hdr(image, &mut writer)?,
    }
    writer.flush().map_err(|e| e.to_string())
}

fn write_exr(image: &Image, writer: &mut (impl Write + std::io::Seek)) -> Result<(), String> {
    use exr::WritableImage;
    let size = exr::Vec2(image.width as usize, image.height as usize);
    let at = |p: exr::Vec2<usize>| image.pixel(p.0 as u32, p.1 as u32);
    let attributes = exr::LayerAttributes {
        software_name: Some(exr::Text::from(format!("velour {}", env!("CARGO_PKG_VERSION")).as_str())),
        comments: Some(exr::Text::from(note(image).as_str())),
        ..exr::LayerAttributes::default()
    };
    let encoding = exr::Encoding::FAST_LOSSLESS;
    if image.channels == 4 {
        let channels = exr::SpecificChannels::rgba(|p| {
            let c = at(p);
            (c[0], c[1], c[2], c[3])
        });
        let layer = exr::Layer::new(size, attributes, encoding, channels);
        exr::Image::from_layer(layer).write().to_buffered(writer)
    } else {
        let channels = exr::SpecificChannels::rgb(|p| {
            let c = at(p);
            (c[0], c[1], c[2])
        });
        let layer = exr::Layer::new(size, attributes, encoding, channels);
        exr::Image::from_layer(layer).write().to_buffered(writer)
    }
    .map_err(|e| e.to_string())
}

/// What the header says of the picture.
fn note(image: &Image) -> String {
    let about = &image.about;
    let version = env!("CARGO_PKG_VERSION");
    let [fewest, most] = about.taken;
    let samples = if fewest == most { most.to_string() } else { format!("{fewest}-{most}") };
    let noise = about.noise.map_or(String::new(), |noise| format!(" noise={noise:.2e}"));
    format!("scene={} samples={samples}{noise} seed={} velour={version}", about.scene, about.seed)
}

fn write_png(image: &Image, writer: &mut impl Write) -> Result<(), String> {
    use ::image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
    let color = |c: f32| (srgb(c) * 255.0 + 0.5) as u8;
    let encode = |pixel: &[f32]| -> [u8; 4] {
        let alpha = pixel.get(3).map_or(1.0, |a| a.clamp(0.0, 1.0));
        // PNG keeps colour apart from alpha; the render has them multiplied.
        let scale = if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
        [color(pixel[0] * scale), color(pixel[1] * scale), color(pixel[2] * scale), (alpha * 255.0 + 0.5) as u8]
    };
    let channels = image.channels;
    let bytes: Vec<u8> =
        image.pixels.chunks_exact(channels).flat_map(|p| encode(p).into_iter().take(channels)).collect();
    let kind = if channels == 4 { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    PngEncoder::new(writer).write_image(&bytes, image.width, image.height, kind).map_err(|e| e.to_string())
}

/// The transfer curve of IEC 61966-2-1, clipped to [0, 1].
pub(crate) fn srgb(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * pow(x, 1.0 / 2.4) - 0.055 }
}

fn write_hdr(image: &Image, writer: &mut impl Write) -> Result<(), String> {
    use ::image::{Rgb, codecs::hdr::HdrEncoder};
    let pixels: Vec<Rgb<f32>> =
        image.pixels.chunks_exact(image.channels).map(|p| Rgb([p[0].max(0.0), p[1].max(0.0), p[2].max(0.0)])).collect();
    HdrEncoder::new(writer).encode(&pixels, image.width as usize, image.height as usize).map_err(|e| e.to_string())
}
