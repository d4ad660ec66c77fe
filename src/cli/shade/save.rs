//! Outputs of a grid as image files: EXR, TIFF, PNG and HDR, of any number of channels where the format has them.

use crate::files::{Destination, Sink};
use crate::render::srgb;
use exr::prelude as exr;
use image::{ExtendedColorType, ImageEncoder};
use std::io::Write;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};

/// How numbers are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// A byte, 0 to 1 spread over it.
    Bytes,
    /// Two bytes, IEEE half.
    Halves,
    /// Four bytes, IEEE single.
    Floats,
    /// Four bytes, whole numbers; only TIFFs have them.
    Ints,
}

impl Numbers {
    /// The numbers of a name that `-d` may have.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "uint8" => Numbers::Bytes,
            "half" => Numbers::Halves,
            "float" => Numbers::Floats,
            _ => return None,
        })
    }
}

/// A grid of values, row by row.
#[derive(Debug)]
pub struct Grid {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Numbers a value has.
    pub channels: usize,
    /// True where they are whole, which bytes then keep as they are.
    pub ints: bool,
    /// All of them.
    pub values: Vec<f32>,
}

/// Writes a grid to a file of the kind that its name ends with.
pub fn save(grid: &Grid, path: &Path, numbers: Option<Numbers>) -> Result<(), String> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !["exr", "tif", "tiff", "tx", "png", "hdr"].contains(&extension.as_str()) {
        return Err("its name ends with none of .exr, .tif, .png and .hdr".to_owned());
    }
    let written = Destination::at(path)
        .and_then(|file| file.write(|sink| encode(grid, sink, &extension, numbers).map_err(std::io::Error::other)));
    written.map_err(|error| error.to_string())
}

fn encode(grid: &Grid, sink: &mut Sink, extension: &str, numbers: Option<Numbers>) -> Result<(), String> {
    match extension {
        "exr" => save_exr(grid, sink, numbers),
        "png" => save_png(grid, sink),
        "hdr" => save_hdr(grid, sink),
        _ => save_tiff(grid, sink, numbers),
    }
}

/// The names that viewers know; those of further channels are made of their numbers.
fn channel_name(at: usize, of: usize) -> String {
    match of {
        1 => "Y".to_owned(),
        3 | 4 => ["R", "G", "B", "A"][at].to_owned(),
        _ => format!("channel{at}"),
    }
}

fn save_exr(grid: &Grid, mut writer: &mut Sink, numbers: Option<Numbers>) -> Result<(), String> {
    use exr::WritableImage;
    let column = |channel: usize| grid.values.iter().skip(channel).step_by(grid.channels).copied();
    let channel = |at: usize| {
        let samples = match numbers {
            Some(Numbers::Halves) => exr::FlatSamples::F16(column(at).map(exr::f16::from_f32).collect()),
            _ => exr::FlatSamples::F32(column(at).collect()),
        };
        exr::AnyChannel::new(exr::Text::from(channel_name(at, grid.channels).as_str()), samples)
    };
    let channels = exr::AnyChannels::sort((0..grid.channels).map(channel).collect());
    let size = exr::Vec2(grid.size[0] as usize, grid.size[1] as usize);
    let layer = exr::Layer::new(size, exr::LayerAttributes::default(), exr::Encoding::FAST_LOSSLESS, channels);
    exr::Image::from_layer(layer).write().to_buffered(&mut writer).map_err(|error| error.to_string())?;
    writer.flush().map_err(|error| error.to_string())
}

fn byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn save_tiff(grid: &Grid, writer: &mut Sink, numbers: Option<Numbers>) -> Result<(), String> {
    let [width, height] = grid.size;
    let mut encoder = TiffEncoder::new(writer).map_err(|error| error.to_string())?;
    let kept = |x: f32| if grid.ints { x.clamp(0.0, 255.0) as u8 } else { byte(x) };
    let bytes = || grid.values.iter().map(|&x| kept(x)).collect::<Vec<u8>>();
    if (grid.channels, numbers) == (1, Some(Numbers::Ints)) {
        let ints: Vec<i32> = grid.values.iter().map(|&x| x as i32).collect();
        let written = encoder.write_image::<colortype::GrayI32>(width, height, &ints);
        return written.map_err(|error| error.to_string());
    }
    match (grid.channels, numbers == Some(Numbers::Bytes)) {
        (1, true) => encoder.write_image::<colortype::Gray8>(width, height, &bytes()),
        (3, true) => encoder.write_image::<colortype::RGB8>(width, height, &bytes()),
        (4, true) => encoder.write_image::<colortype::RGBA8>(width, height, &bytes()),
        (1, false) => encoder.write_image::<colortype::Gray32Float>(width, height, &grid.values),
        (3, false) => encoder.write_image::<colortype::RGB32Float>(width, height, &grid.values),
        (4, false) => encoder.write_image::<colortype::RGBA32Float>(width, height, &grid.values),
        (channels, _) => return Err(format!("a TIFF of {channels} channels cannot be written; an EXR can")),
    }
    .map_err(|error| error.to_string())
}

/// One or three channels; a picture that people look at is in sRGB, as testshade saves it.
fn save_png(grid: &Grid, writer: &mut Sink) -> Result<(), String> {
    let [width, height] = grid.size;
    let bytes: Vec<u8> = grid.values.iter().map(|&x| byte(srgb(x))).collect();
    let kind = match grid.channels {
        1 => ExtendedColorType::L8,
        3 => ExtendedColorType::Rgb8,
        channels => return Err(format!("a PNG of {channels} channels cannot be written; an EXR can")),
    };
    let encoder = image::codecs::png::PngEncoder::new(writer);
    encoder.write_image(&bytes, width, height, kind).map_err(|error| error.to_string())
}

fn save_hdr(grid: &Grid, writer: &mut Sink) -> Result<(), String> {
    if grid.channels != 3 {
        return Err(format!("an HDR has three channels, not {}", grid.channels));
    }
    let pixels: Vec<image::Rgb<f32>> = grid.values.chunks_exact(3).map(|p| image::Rgb([p[0], p[1], p[2]])).collect();
    let encoder = image::codecs::hdr::HdrEncoder::new(writer);
    encoder.encode(&pixels, grid.size[0] as usize, grid.size[1] as usize).map_err(|error| error.to_string())
}
