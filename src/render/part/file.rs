//! The file of a part: an EXR of two parts, of which the first is the picture, and the second has the sums as 32-bit
//! integers and says in its comments what they are.

use super::super::error::OutputError;
use super::super::exact::{self, PARTS};
use super::super::image::Image;
use super::super::output;
use super::columns::{Column, checked, columns, sums};
use super::error::PartError;
use super::ranges::Ranges;
use super::samples::{Part, Whole};
use crate::files::Room;
use crate::limits::{PART_CHANNELS, PART_PACKED, PIXELS};
use ::exr::meta::header::Header;
use exr::prelude as exr;
use std::fmt::Write as _;
use std::io::{Read, Seek};
use std::panic::AssertUnwindSafe;
use std::path::Path;

/// The first line of the comments; a later one of another form has another number.
const FORM: &str = "velour part 1";

/// The name of the layer with the sums.
const LAYER: &str = "velour sums";

/// The words of a sum in the names of channels.
const WORDS: [&str; PARTS] = ["red", "green", "blue", "alpha", "weight"];

/// Those of the words of a number: its last 32 bits, and those before.
const PLACES: [&str; 2] = ["low", "high"];

/// Writes the picture with its sums: an EXR that any viewer opens.
///
/// # Errors
/// The file cannot be written.
pub fn write(part: &Part, path: &Path) -> Result<(), OutputError> {
    write_into(part, &part.picture(), path, None)
}

/// The same, with a picture that has been made of it already, into room that is held for it.
///
/// # Errors
/// The file cannot be written.
pub fn write_into(part: &Part, picture: &Image, path: &Path, room: Option<Room>) -> Result<(), OutputError> {
    output::write_with(path, room, |sink| encode(part, picture, sink))
}

fn encode(part: &Part, image: &Image, sink: &mut (impl std::io::Write + std::io::Seek)) -> Result<(), String> {
    use exr::WritableImage;
    let size = exr::Vec2(image.width as usize, image.height as usize);
    let channels = (0..image.channels).map(|k| {
        let samples = image.pixels.iter().skip(k).step_by(image.channels).copied().collect();
        exr::AnyChannel::new(["R", "G", "B", "A"][k], exr::FlatSamples::F32(samples))
    });
    let picture = output::layer_attributes(image, "picture");
    let picture = exr::Layer::new(size, picture, output::ENCODING, exr::AnyChannels::sort(channels.collect()));
    let columns = columns(part.sums(), part.of.alpha);
    let attributes = exr::LayerAttributes {
        comments: Some(output::text(&description(part, checked(&columns)))),
        ..exr::LayerAttributes::named(LAYER)
    };
    let channels: Vec<_> = columns.into_iter().map(channel).collect();
    let sums = exr::Layer::new(size, attributes, output::ENCODING, exr::AnyChannels::sort(channels.into()));
    let window = exr::ImageAttributes::with_size(size);
    exr::Image::empty(window).with_layer(picture).with_layer(sums).write().to_buffered(sink).map_err(|e| e.to_string())
}

/// The channel of a column.
fn channel(column: Column) -> exr::AnyChannel<exr::FlatSamples> {
    let (tier, part, high) = column.of;
    let name = format!("tier{tier}.{}.{}", WORDS[part], PLACES[usize::from(high)]);
    exr::AnyChannel::new(name.as_str(), exr::FlatSamples::U32(column.words))
}

/// What the sums are, a line each. Tiles are told in runs: `240x0..64` for 240 tiles of the same samples.
fn description(part: &Part, sums: u64) -> String {
    let Whole { scene, fingerprint, version, width, height, alpha, seed, tile_size } = &part.of;
    let mut text = format!("{FORM}\nversion {version}\nfingerprint {fingerprint:016x}\nsize {width} {height}\n");
    let _ = write!(text, "alpha {alpha}\nseed {seed}\nsums {sums:016x}\ntile {tile_size}\ntiles ");
    for run in part.held.chunk_by(|a, b| a == b) {
        let _ = write!(text, " {}x{}", run.len(), run[0]);
    }
    // Last, because it may be anything.
    let _ = write!(text, "\nscene {scene}");
    text
}

/// Reads a part that [`write()`] has written.
///
/// # Errors
/// The file cannot be read, or is no part.
pub fn read(path: &Path) -> Result<Part, PartError> {
    let fail = |reason: String| PartError::Unreadable { path: path.to_owned(), reason };
    // Before it is opened, for a pipe would wait for ever.
    let found = std::fs::metadata(path).map_err(|error| fail(error.to_string()))?;
    if !found.is_file() {
        return Err(fail("it is no regular file".to_owned()));
    }
    let file = std::fs::File::open(path).map_err(|error| fail(error.to_string()))?;
    of_file(&file, found.len()).map_err(fail)
}

/// Reads a part that an open file has, of which messages say `path`.
///
/// # Errors
/// It is no part.
pub fn read_file(file: &std::fs::File, path: &Path) -> Result<Part, PartError> {
    let fail = |reason: String| PartError::Unreadable { path: path.to_owned(), reason };
    let found = file.metadata().map_err(|error| fail(error.to_string()))?;
    of_file(file, found.len()).map_err(fail)
}

/// Reads a part whose file is in memory.
///
/// # Errors
/// It is no part, for this reason.
pub fn read_bytes(bytes: &[u8]) -> Result<Part, String> {
    decoded(&|| Ok(std::io::Cursor::new(bytes)), bytes.len() as u64)
}

fn of_file(file: &std::fs::File, size: u64) -> Result<Part, String> {
    let again = || {
        let mut file = file;
        file.rewind().map(|()| std::io::BufReader::new(file)).map_err(|error| error.to_string())
    };
    decoded(&again, size)
}

/// The part in a file of so many bytes, which `begin` reads from its start.
fn decoded<R: Read + Seek>(begin: &dyn Fn() -> Result<R, String>, size: u64) -> Result<Part, String> {
    // The decoder is others' code: whatever a broken file makes it do ends here.
    let decode = || bounded(begin()?, size).and_then(|()| layers(begin()?, size));
    let given_up = |_| Err("its decoder has given up".to_owned());
    assemble(std::panic::catch_unwind(AssertUnwindSafe(decode)).unwrap_or_else(given_up)?)
}

/// Refuses what claims to be larger than any part is, before memory is taken for it.
fn bounded(file: impl Read + Seek, bytes: u64) -> Result<(), String> {
    let headers = exr::MetaData::read_from_buffered(file, false).map_err(|error| error.to_string())?.headers;
    let size = |header: &Header| header.layer_size.0.saturating_mul(header.layer_size.1);
    let numbers = |header: &Header| size(header).saturating_mul(header.channels.list.len()) as u64;
    let room = bytes.saturating_mul(PART_PACKED) / 4;
    let large = |header: &Header| {
        size(header) as u64 > PIXELS || header.channels.list.len() > PART_CHANNELS || numbers(header) > room
    };
    if headers.len() > 2 || headers.iter().any(large) { Err("it is larger than parts are".to_owned()) } else { Ok(()) }
}

/// What the decoder makes of the file.
type Layers = exr::Image<exr::Layers<exr::AnyChannels<exr::FlatSamples>>>;

fn layers(file: impl Read + Seek, bytes: u64) -> Result<Layers, String> {
    use exr::{ReadChannels, ReadLayers};
    let reader = exr::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    // What is small is read before its threads would have begun.
    let reader = if bytes < 1 << 18 { reader.non_parallel() } else { reader };
    reader.from_buffered(file).map_err(|error| error.to_string())
}

fn assemble(image: Layers) -> Result<Part, String> {
    let named = |layer: &exr::Layer<exr::AnyChannels<exr::FlatSamples>>| {
        layer.attributes.layer_name.as_ref().is_some_and(|name| name.eq(LAYER))
    };
    let none = "it has no sums; a render leaves them with --samples, or when it is stopped";
    let layer = image.layer_data.into_iter().find(named).ok_or(none)?;
    let text = layer.attributes.comments.as_ref().map(ToString::to_string).unwrap_or_default();
    let (of, held, sums) = understand(&text, layer.size).ok_or("it does not say what its sums are")?;
    let mut columns = Vec::new();
    for channel in layer.channel_data.list {
        let name = channel.name.to_string();
        let of = placed(&name).ok_or_else(|| format!("it has an unknown channel `{name}`"))?;
        match channel.sample_data {
            exr::FlatSamples::U32(words) => columns.push(Column { of, words }),
            _ => return Err(format!("its channel `{name}` has no integers")),
        }
    }
    columns.sort_by_key(|column| column.of);
    if checked(&columns) != sums {
        return Err("it is damaged: its sums are not those that were written".to_owned());
    }
    let sums = self::sums(&columns, layer.size.area()).ok_or("its sums are incomplete")?;
    Ok(Part::new(of, held, sums))
}

/// What the channel of a name is a column of.
fn placed(name: &str) -> Option<(i32, usize, bool)> {
    let mut names = name.strip_prefix("tier")?.split('.');
    let (number, part, place) = (names.next()?.parse().ok()?, names.next()?, names.next()?);
    let place = PLACES.iter().position(|known| *known == place)?;
    exact::is_tier(number).then_some((number, WORDS.iter().position(|word| *word == part)?, place == 1))
}

/// What a description of sums of this size says: of which picture, the samples of each tile, and what the sums were when written.
fn understand(text: &str, size: exr::Vec2<usize>) -> Option<(Whole, Vec<Ranges>, u64)> {
    let (lines, scene) = text.strip_prefix(FORM)?.strip_prefix('\n')?.split_once("\nscene ")?;
    let field = |name: &str| lines.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    let (width, height) = field("size")?.split_once(' ')?;
    let of = Whole {
        scene: scene.to_owned(),
        fingerprint: u64::from_str_radix(field("fingerprint")?, 16).ok()?,
        version: field("version")?.to_owned(),
        width: width.parse().ok()?,
        height: height.parse().ok()?,
        alpha: field("alpha")?.parse().ok()?,
        seed: field("seed")?.parse().ok()?,
        tile_size: field("tile")?.parse().ok()?,
    };
    if (of.width as usize, of.height as usize) != (size.0, size.1) {
        return None;
    }
    let sums = u64::from_str_radix(field("sums")?, 16).ok()?;
    let tiles = of.tiles()?;
    let mut held = Vec::new();
    for run in field("tiles")?.split_whitespace() {
        let (count, ranges) = run.split_once('x')?;
        let count: usize = count.parse().ok()?;
        let ranges = if ranges.is_empty() { Ranges::default() } else { ranges.parse().ok()? };
        // A count that is a lie would take all memory.
        if count > tiles - held.len() {
            return None;
        }
        held.extend(std::iter::repeat_n(ranges, count));
    }
    (held.len() == tiles).then_some((of, held, sums))
}
