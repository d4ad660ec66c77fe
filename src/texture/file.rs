//! Texture files: PNG, JPEG, HDR, TIFF (tiled and with levels, as `maketx` writes them) and EXR (with levels).

use super::about::About;
use super::pyramid::Texture;
use super::texels::{Level, Texels};
use super::wrap::Wrap;
use crate::limits::{ABOUT_BYTES, TEXTURE_BYTES};
use exr::prelude as exr;
use std::fmt;
use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::{Path, PathBuf};
use velour_grammar::files::Access;

/// Why a texture could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TextureError {
    /// There is no such file in the folders looked in.
    NotFound {
        /// As it was asked for.
        name: String,
        /// Where it was looked for, besides the working folder.
        folders: Vec<PathBuf>,
    },
    /// The file is there and cannot be used.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Textures together need more memory than they may have.
    TooLarge {
        /// The file that did not fit.
        path: PathBuf,
        /// Bytes that textures may have.
        budget: u64,
    },
}

impl fmt::Display for TextureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TextureError::NotFound { name, folders } => {
                write!(f, "there is no texture `{name}` in the working folder")?;
                folders
                    .iter()
                    .filter(|folder| *folder != Path::new("."))
                    .try_for_each(|folder| write!(f, ", {}", folder.display()))
            }
            TextureError::Unreadable { path, reason } => {
                write!(f, "the texture {} cannot be read: {reason}", path.display())
            }
            TextureError::TooLarge { path, budget } => {
                let megabytes = budget >> 20;
                write!(f, "the texture {} does not fit into the {megabytes} MB that textures may have", path.display())
            }
        }
    }
}

impl std::error::Error for TextureError {}

/// The most columns or rows of a file.
const MOST: usize = 1 << 16;

/// Reads a texture whose decoded texels take at most `budget` bytes.
///
/// # Errors
/// The file is missing, wrong, or too large.
pub fn read(path: &Path, budget: u64) -> Result<Texture, TextureError> {
    read_allowed(path, budget, &Access::default())
}

/// The same for a file that may have to be in a sandbox.
///
/// # Errors
/// As for [`read`].
pub fn read_allowed(path: &Path, budget: u64, access: &Access) -> Result<Texture, TextureError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let fail = |reason: String| TextureError::Unreadable { path: path.to_owned(), reason };
    // The decoders are others' code: whatever a broken file makes them do ends here.
    let decode = || {
        let (file, _) = access.open(path, TEXTURE_BYTES).map_err(|error| error.to_string())?;
        let file = BufReader::new(file);
        match extension.as_str() {
            "exr" => read_exr(file, budget),
            "tif" | "tiff" | "tx" | "env" => read_tiff(file, budget),
            _ => read_image(file, budget),
        }
    };
    let decoded = std::panic::catch_unwind(decode).unwrap_or_else(|_| Err("its decoder has given up".to_owned()));
    let texture = decoded.map_err(fail)?;
    let bytes = texture.resident().1 as u64;
    if bytes > budget { Err(TextureError::TooLarge { path: path.to_owned(), budget }) } else { Ok(texture) }
}

/// Refuses sizes that no texture has, before anything of that size is made.
fn sized(width: usize, height: usize, bytes: usize, budget: u64) -> Result<(), String> {
    if width == 0 || height == 0 || width > MOST || height > MOST {
        return Err(format!("it has {width} x {height} texels"));
    }
    let all = (width as u64 * height as u64).saturating_mul(bytes as u64);
    if all > budget {
        Err(format!("it takes {} MB, and textures may have {} MB", all >> 20, budget >> 20))
    } else {
        Ok(())
    }
}

fn read_image(mut file: BufReader<File>, budget: u64) -> Result<Texture, String> {
    use image::{DynamicImage, ImageReader};
    let failed = |error: std::io::Error| error.to_string();
    let looked = ImageReader::new(&mut file).with_guessed_format().map_err(failed)?;
    let (width, height) = looked.into_dimensions().map_err(|error| error.to_string())?;
    sized(width as usize, height as usize, 4, budget)?;
    file.rewind().map_err(failed)?;
    let mut reader = ImageReader::new(file).with_guessed_format().map_err(failed)?;
    reader.no_limits();
    let picture = reader.decode().map_err(|error| error.to_string())?;
    let (width, height) = (width as usize, height as usize);
    let (channels, rows) = match picture {
        DynamicImage::ImageLuma8(p) => (1, Texels::Bytes(p.into_raw())),
        DynamicImage::ImageLumaA8(p) => (2, Texels::Bytes(p.into_raw())),
        DynamicImage::ImageRgb8(p) => (3, Texels::Bytes(p.into_raw())),
        DynamicImage::ImageRgba8(p) => (4, Texels::Bytes(p.into_raw())),
        DynamicImage::ImageLuma16(p) => (1, Texels::Words(p.into_raw())),
        DynamicImage::ImageLumaA16(p) => (2, Texels::Words(p.into_raw())),
        DynamicImage::ImageRgb16(p) => (3, Texels::Words(p.into_raw())),
        DynamicImage::ImageRgba16(p) => (4, Texels::Words(p.into_raw())),
        DynamicImage::ImageRgb32F(p) => (3, Texels::Floats(p.into_raw())),
        other => (4, Texels::Floats(other.into_rgba32f().into_raw())),
    };
    Ok(Texture::of_rows(width, height, channels, &rows))
}

/// The images of a TIFF that are each half of the one before are its levels.
fn read_tiff(file: BufReader<File>, budget: u64) -> Result<Texture, String> {
    use tiff::decoder::{Decoder, DecodingResult, Limits};
    let failed = |error: tiff::TiffError| error.to_string();
    let mut decoder = Decoder::new(file).map_err(failed)?.with_limits(Limits::unlimited());
    let (mut levels, mut of_all): (Vec<Level>, usize) = (Vec::new(), 0);
    let (mut wrap, mut about) = ([Wrap::default(); 2], About::default());
    loop {
        let (width, height) = decoder.dimensions().map_err(failed)?;
        let (width, height) = (width as usize, height as usize);
        // What comes after the picture and is no level of it, such as a mask, is none of ours.
        if let Some(last) = levels.last()
            && (width != (last.width() / 2).max(1) || height != (last.height() / 2).max(1))
        {
            break;
        }
        let layout = match TiffLayout::of(&mut decoder) {
            Err(_) if !levels.is_empty() => break,
            layout => layout?,
        };
        let left = levels.iter().fold(budget, |left, level| left.saturating_sub(level.bytes() as u64));
        sized(width, height, layout.bytes, left)?;
        if levels.is_empty() {
            let mut texts = Limits::unlimited();
            texts.ifd_value_size = ABOUT_BYTES;
            decoder = decoder.with_limits(texts);
            (wrap, about) = (tiff_wrap(&mut decoder), tiff_about(&mut decoder));
            decoder = decoder.with_limits(Limits::unlimited());
        }
        let mut all = DecodingResult::U8(Vec::new());
        let whole = decoder.read_image_to_buffer(&mut all).map_err(failed)?;
        if all.as_buffer(0).as_bytes().len() < whole.complete_len {
            return Err("its channels do not fit into memory together".to_owned());
        }
        let rows = match all {
            DecodingResult::U8(all) => Texels::Bytes(all),
            DecodingResult::U16(all) => Texels::Words(all),
            DecodingResult::F32(all) => Texels::Floats(all),
            DecodingResult::F64(all) => Texels::Floats(all.into_iter().map(|x| x as f32).collect()),
            DecodingResult::F16(all) => Texels::Floats(all.into_iter().map(|x| x.to_f32()).collect()),
            DecodingResult::U32(all) => {
                Texels::Floats(all.into_iter().map(|x| (f64::from(x) / 4_294_967_295.0) as f32).collect())
            }
            _ => return Err("its texels are of a kind that no texture has".to_owned()),
        };
        let (channels, rows) = layout.woven(rows, width * height)?;
        if of_all != 0 && channels != of_all {
            break;
        }
        of_all = channels;
        levels.push(Level::of_rows(width, height, channels, &rows));
        if !decoder.more_images() || decoder.next_image().is_err() {
            break;
        }
    }
    if levels.is_empty() {
        return Err("it has no texels".to_owned());
    }
    Ok(Texture::of_levels(levels, of_all).with_wrap(wrap).with_about(about))
}

/// The texts of a TIFF.
fn tiff_about<R: std::io::Read + std::io::Seek>(decoder: &mut tiff::decoder::Decoder<R>) -> About {
    use tiff::tags::Tag;
    let mut about = About::default();
    let tags = [
        (Tag::DateTime, "DateTime"),
        (Tag::Software, "Software"),
        (Tag::Artist, "Artist"),
        (Tag::Copyright, "Copyright"),
        (Tag::ImageDescription, "ImageDescription"),
    ];
    for (tag, name) in tags {
        if let Ok(text) = decoder.get_tag_ascii_string(tag) {
            about.add(name, text.trim_end_matches('\0').to_owned());
        }
    }
    let description = about.text("ImageDescription").unwrap_or_default().to_owned();
    about.describe(&description);
    about
}

/// How the numbers of a TIFF lie.
struct TiffLayout {
    samples: usize,
    /// Of one texel.
    bytes: usize,
    /// Channels one after the other, each of the whole picture.
    planar: bool,
}

impl TiffLayout {
    /// Refuses what its decoder would misread.
    fn of<R: std::io::Read + std::io::Seek>(decoder: &mut tiff::decoder::Decoder<R>) -> Result<Self, String> {
        use tiff::tags::Tag;
        let mut number = |tag: Tag, otherwise: u32| match decoder.find_tag_unsigned_vec::<u32>(tag) {
            Ok(Some(numbers)) => numbers.iter().copied().max().unwrap_or(otherwise),
            _ => otherwise,
        };
        let samples = number(Tag::SamplesPerPixel, 1) as usize;
        let planar = number(Tag::PlanarConfiguration, 1) == 2;
        let bits = number(Tag::BitsPerSample, 1);
        if bits < 8 {
            return Err(format!("its texels have {bits} bits a channel, and 8 are the least"));
        }
        if samples > 4 && !planar && number(Tag::Predictor, 1) != 1 {
            return Err(format!("it is compressed with a predictor over {samples} channels, and 4 are the most"));
        }
        Ok(TiffLayout { samples, bytes: samples * bits.div_ceil(8) as usize, planar })
    }

    /// The numbers of one texel side by side, and how many they are.
    fn woven(&self, numbers: Texels, texels: usize) -> Result<(usize, Texels), String> {
        let weave = match &numbers {
            _ if !self.planar || self.samples < 2 => None,
            Texels::Bytes(all) => Some(Texels::Bytes(interleaved(all, texels))),
            Texels::Words(all) => Some(Texels::Words(interleaved(all, texels))),
            Texels::Floats(all) => Some(Texels::Floats(interleaved(all, texels))),
        };
        let numbers = weave.unwrap_or(numbers);
        let count = match &numbers {
            Texels::Bytes(all) => all.len(),
            Texels::Words(all) => all.len(),
            Texels::Floats(all) => all.len(),
        };
        match count / texels {
            0 => Err("it has no texels".to_owned()),
            channels => Ok((channels, numbers)),
        }
    }
}

/// Planes of so many texels, one texel after the other.
fn interleaved<T: Copy>(planes: &[T], texels: usize) -> Vec<T> {
    (0..texels).flat_map(|at| planes[at..].iter().step_by(texels).copied()).collect()
}

/// How `maketx --wrap` has marked a file: `mode` or `mode,mode` in a tag of Pixar's.
fn tiff_wrap<R: std::io::Read + std::io::Seek>(decoder: &mut tiff::decoder::Decoder<R>) -> [Wrap; 2] {
    let text = decoder.get_tag_ascii_string(tiff::tags::Tag::Unknown(33304)).unwrap_or_default();
    wrap_modes(&text)
}

fn wrap_modes(text: &str) -> [Wrap; 2] {
    let mut names = text.trim_end_matches('\0').split(',').map(|name| Wrap::from_name(name.trim()).unwrap_or_default());
    let s = names.next().unwrap_or_default();
    [s, names.next().unwrap_or(s)]
}

/// The order of channels that shaders count in: red, green, blue, alpha, then the others by name.
fn rank(name: &str) -> (usize, String) {
    let last = name.rsplit('.').next().unwrap_or(name);
    let known =
        [["R", "r", "red", "Y"], ["G", "g", "green", "RY"], ["B", "b", "blue", "BY"], ["A", "a", "alpha", "Alpha"]];
    let at = known.iter().position(|names| names.contains(&last)).unwrap_or(known.len());
    (at, name.to_owned())
}

/// Rows of a part of a picture in the whole, which is 0 elsewhere.
fn placed(rows: &[f32], [width, _]: [usize; 2], count: usize, offset: [i64; 2], display: [usize; 2]) -> Vec<f32> {
    let mut out = vec![0.0; display[0] * display[1] * count];
    for (at, texel) in rows.chunks_exact(count).enumerate() {
        let (x, y) = (offset[0] + (at % width) as i64, offset[1] + (at / width) as i64);
        if (0..display[0] as i64).contains(&x) && (0..display[1] as i64).contains(&y) {
            let to = (y as usize * display[0] + x as usize) * count;
            out[to..to + count].copy_from_slice(texel);
        }
    }
    out
}

fn read_exr(mut file: BufReader<File>, budget: u64) -> Result<Texture, String> {
    use exr::ReadChannels;
    use exr::ReadLayers;
    let claims = exr::MetaData::read_from_unbuffered(&mut file, false).map_err(|error| error.to_string())?;
    for header in &claims.headers {
        sized(header.layer_size.0, header.layer_size.1, 2 * header.channels.list.len().max(1), budget)?;
    }
    file.rewind().map_err(|error| error.to_string())?;
    let image = exr::read().no_deep_data().all_resolution_levels().all_channels().first_valid_layer().all_attributes();
    let image = image.from_buffered(file).map_err(|error| error.to_string())?;
    let layer = image.layer_data;
    let size = [layer.size.0, layer.size.1];
    // s and t span the display window, of which the data may be a part.
    let (whole, data) = (image.attributes.display_window, layer.attributes.layer_position);
    let offset = [(data.0, whole.position.0), (data.1, whole.position.1)].map(|(a, b)| i64::from(a) - i64::from(b));
    let display = [whole.size.0, whole.size.1];
    let part = (offset, display) != ([0; 2], size);
    let mut channels: Vec<_> = layer.channel_data.list.into_iter().collect();
    channels.sort_by_key(|channel| rank(&channel.name.to_string()));
    let count = channels.len();
    if part {
        sized(display[0], display[1], 4 * count.max(1), budget)?;
    }
    let pyramids: Vec<Vec<exr::FlatSamples>> = channels
        .into_iter()
        .map(|channel| match channel.sample_data {
            exr::Levels::Singular(samples) => vec![samples],
            exr::Levels::Mip { level_data, .. } => level_data,
            exr::Levels::Rip { level_data, .. } => level_data.map_data.into_iter().take(1).collect(),
        })
        .collect();
    let mut levels = Vec::new();
    for number in 0..pyramids.iter().map(Vec::len).min().unwrap_or(0) {
        let [width, height] = size.map(|side| (side >> number).max(1));
        let planes: Vec<Vec<f32>> = pyramids.iter().map(|pyramid| pyramid[number].values_as_f32().collect()).collect();
        if planes.iter().any(|plane| plane.len() != width * height) {
            break;
        }
        let rows: Vec<f32> = (0..width * height).flat_map(|at| planes.iter().map(move |plane| plane[at])).collect();
        if part {
            let rows = placed(&rows, size, count, offset, display);
            levels.push(Level::of_rows(display[0], display[1], count, &Texels::Floats(rows)));
            // Levels of a part do not lie on those of the whole.
            break;
        }
        levels.push(Level::of_rows(width, height, count, &Texels::Floats(rows)));
    }
    if levels.is_empty() {
        return Err("it has no texels".to_owned());
    }
    let mut about = About::default();
    if part {
        let first = offset.map(|x| x as i32);
        about.data = Some([first[0], first[1], first[0] + size[0] as i32 - 1, first[1] + size[1] as i32 - 1]);
    }
    layer.attributes.capture_date.iter().for_each(|date| about.add("DateTime", date.to_string()));
    for (name, value) in image.attributes.other.iter().chain(&layer.attributes.other) {
        if let exr::AttributeValue::Text(text) = value {
            about.add(&name.to_string(), text.to_string());
        }
    }
    let wrap = image.attributes.other.iter().chain(&layer.attributes.other).find_map(|(name, value)| match value {
        exr::AttributeValue::Text(text) if name.eq("wrapmodes") => Some(wrap_modes(&text.to_string())),
        _ => None,
    });
    Ok(Texture::of_levels(levels, count).with_wrap(wrap.unwrap_or_default()).with_about(about))
}
