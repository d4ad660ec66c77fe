//! Image files: EXR, PNG and HDR.

use super::error::OutputError;
use super::image::Image;
use super::settings::Settings;
use super::view::Screen;
use crate::files::{Destination, Room, Sink};
use exr::prelude as exr;
use std::io::Write;
use std::path::Path;

/// The kinds of files that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// OpenEXR, linear, 32-bit floats.
    Exr,
    /// PNG, 8 bits, by a [`Screen`].
    Png,
    /// Radiance HDR, linear, shared exponent.
    Hdr,
}

/// Says, before anything is rendered, whether a file of this name can be written. `-`, standard output, is an EXR; `png:-` and
/// `hdr:-` say otherwise.
pub fn check(path: &Path) -> Result<Format, OutputError> {
    look(path).map(|(format, _)| format)
}

/// Writes `image` to `path` in the format of its extension; a PNG by the default [`Screen`].
pub fn write(image: &Image, path: &Path) -> Result<(), OutputError> {
    write_as(image, path, &Screen::default())
}

/// The same, for a screen of its own where it is a PNG; the other formats keep linear light as it is.
pub fn write_as(image: &Image, path: &Path, screen: &Screen) -> Result<(), OutputError> {
    write_into(image, path, screen, None)
}

/// The same, into room that is held for it.
pub fn write_into(image: &Image, path: &Path, screen: &Screen, room: Option<Room>) -> Result<(), OutputError> {
    let format = check(path)?;
    write_with(path, room, |sink| match format {
        Format::Exr => write_exr(image, sink),
        Format::Png => write_png(image, screen, sink),
        Format::Hdr => write_hdr(image, sink),
    })
}

/// Holds room for what a render of these settings will write to `path`: the picture, or a `part`. Nothing is held for streams, and where
/// the file system cannot.
///
/// # Errors
/// There is too little room, or the file cannot be written.
pub fn hold(path: &Path, settings: &Settings, part: bool) -> Result<Room, OutputError> {
    let (format, destination) = look(path)?;
    let bytes = most_bytes(format, settings, part);
    destination.hold(bytes).map_err(|_| OutputError::NoRoom { path: path.to_owned(), bytes })
}

/// Bytes that a file takes at the most; a part with light of uncommon range may take more.
fn most_bytes(format: Format, settings: &Settings, part: bool) -> u64 {
    let (pixels, lines) = (u64::from(settings.width) * u64::from(settings.height), u64::from(settings.height));
    let channels = if settings.alpha { 4 } else { 3 };
    let header = 1 << 16;
    header
        + match format {
            // What does not become smaller is kept as it is. A line has an entry in a table and a head. The sums of a channel, and the weight,
            // are numbers in two tiers, as whatever has more than a few samples has.
            Format::Exr if part => 4 * pixels * (channels + 2 * (channels + 1)) + 40 * lines,
            Format::Exr => 4 * pixels * channels + 20 * lines,
            // What does not become smaller grows by a few bytes a block of 32 kB.
            Format::Png => pixels * channels * 1001 / 1000 + lines,
            // Runs of 128 bytes have a head.
            Format::Hdr => 4 * pixels * 129 / 128 + 4 * lines,
        }
}

/// Writes what `encode` makes to `path`.
pub(super) fn write_with(
    path: &Path,
    room: Option<Room>,
    encode: impl FnOnce(&mut Sink) -> Result<(), String>,
) -> Result<(), OutputError> {
    let (_, destination) = look(path)?;
    let encode = |sink: &mut Sink| encode(sink).map_err(std::io::Error::other);
    let written = match room {
        Some(room) => room.write(encode),
        None => destination.write(encode),
    };
    written.map_err(|error| unwritable(path, error.to_string()))
}

/// The format that a name asks for.
///
/// # Errors
/// It is none that can be written.
pub fn format(path: &Path) -> Result<Format, OutputError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let found = standard_format(path).or_else(|| format_named(&extension));
    found.ok_or_else(|| OutputError::UnknownFormat { path: path.to_owned() })
}

/// Does a picture of this name go to standard output?
pub fn is_standard_output(path: &Path) -> bool {
    standard_format(path).is_some()
}

/// The format and the destination of a name.
fn look(path: &Path) -> Result<(Format, Destination), OutputError> {
    let format = format(path)?;
    if is_standard_output(path) {
        return Ok((format, at(Path::new("-"))?));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(OutputError::NoFolder { folder: folder.to_owned() });
    }
    if path.is_dir() {
        return Err(OutputError::IsFolder { path: path.to_owned() });
    }
    Ok((format, at(path)?))
}

fn at(path: &Path) -> Result<Destination, OutputError> {
    Destination::at(path).map_err(|error| unwritable(path, error.to_string()))
}

fn format_named(name: &str) -> Option<Format> {
    match name {
        "exr" => Some(Format::Exr),
        "png" => Some(Format::Png),
        "hdr" => Some(Format::Hdr),
        _ => None,
    }
}

/// The format of a name that means standard output.
fn standard_format(path: &Path) -> Option<Format> {
    match path.to_str()?.strip_suffix('-')? {
        "" => Some(Format::Exr),
        named => format_named(named.strip_suffix(':')?),
    }
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

fn write_exr(image: &Image, writer: &mut (impl Write + std::io::Seek)) -> Result<(), String> {
    use exr::WritableImage;
    let size = exr::Vec2(image.width as usize, image.height as usize);
    let at = |p: exr::Vec2<usize>| image.pixel(p.0 as u32, p.1 as u32);
    let attributes = layer_attributes(image, "");
    let encoding = ENCODING;
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

/// Without loss and fast; in the order of lines, or the bytes of a file would depend on which thread has compressed its lines first.
pub(super) const ENCODING: exr::Encoding =
    exr::Encoding { line_order: exr::LineOrder::Increasing, ..exr::Encoding::FAST_LOSSLESS };

/// The header of a layer that holds the picture; an only layer needs no name.
pub(super) fn layer_attributes(image: &Image, name: &str) -> exr::LayerAttributes {
    exr::LayerAttributes {
        layer_name: Some(name).filter(|name| !name.is_empty()).map(exr::Text::from),
        software_name: Some(text(&format!("velour {}", env!("CARGO_PKG_VERSION")))),
        comments: Some(text(&note(image))),
        ..exr::LayerAttributes::default()
    }
}

/// A text as headers of EXRs have it, one byte a character; what does not fit is written as `\u{43f}`.
pub(super) fn text(text: &str) -> exr::Text {
    let escaped = |c: char| if u32::from(c) < 256 { c.to_string() } else { c.escape_unicode().to_string() };
    exr::Text::new_or_none(text)
        .unwrap_or_else(|| exr::Text::from(text.chars().map(escaped).collect::<String>().as_str()))
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

fn write_png(image: &Image, screen: &Screen, writer: &mut impl Write) -> Result<(), String> {
    use ::image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
    let bytes = screen.bytes(image);
    let kind = if image.channels == 4 { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    PngEncoder::new(writer).write_image(&bytes, image.width, image.height, kind).map_err(|e| e.to_string())
}

fn write_hdr(image: &Image, writer: &mut impl Write) -> Result<(), String> {
    use ::image::{Rgb, codecs::hdr::HdrEncoder};
    let pixels: Vec<Rgb<f32>> =
        image.pixels.chunks_exact(image.channels).map(|p| Rgb([p[0].max(0.0), p[1].max(0.0), p[2].max(0.0)])).collect();
    HdrEncoder::new(writer).encode(&pixels, image.width as usize, image.height as usize).map_err(|e| e.to_string())
}
