//! The file of a part: an EXR of two parts, of which the first is the picture, and the second has the sums as pairs of 32-bit
//! integers and says in its comments what they are.

use super::super::error::OutputError;
use super::super::exact::{self, PARTS, Sums, Tier};
use super::super::image::Image;
use super::super::output;
use super::error::PartError;
use super::ranges::Ranges;
use super::samples::{Part, Whole};
use crate::limits::{PART_CHANNELS, PART_PACKED, PIXELS};
use ::exr::meta::header::Header;
use exr::prelude as exr;
use std::fmt::Write as _;
use std::path::Path;

/// The first line of the comments; a later one of another form has another number.
const FORM: &str = "velour part 1";

/// The name of the layer with the sums.
const LAYER: &str = "velour sums";

/// The words of a sum in the names of channels.
const WORDS: [&str; PARTS] = ["red", "green", "blue", "alpha", "weight"];

/// Writes the picture with its sums: an EXR that any viewer opens.
///
/// # Errors
/// The file cannot be written.
pub fn write(part: &Part, path: &Path) -> Result<(), OutputError> {
    let image = part.picture();
    output::write_with(path, |sink| encode(part, &image, sink))
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
    let tiers = part.sums().clone().settled();
    let channels = tiers.iter().flat_map(|tier| (0..PARTS).flat_map(move |k| words(tier, k)));
    let attributes = exr::LayerAttributes {
        comments: Some(output::text(&description(part, checked(&tiers)))),
        ..exr::LayerAttributes::named(LAYER)
    };
    let sums = exr::Layer::new(size, attributes, output::ENCODING, exr::AnyChannels::sort(channels.collect()));
    let window = exr::ImageAttributes::with_size(size);
    exr::Image::empty(window).with_layer(picture).with_layer(sums).write().to_buffered(sink).map_err(|e| e.to_string())
}

/// The two channels of one number of a tier's sums; nothing where all are zero, but for the weights, without which nothing is known.
fn words(tier: &Tier, k: usize) -> Vec<exr::AnyChannel<exr::FlatSamples>> {
    let weights = tier.number == 0 && k == PARTS - 1;
    if !weights && tier.sums.iter().all(|sum| sum[k] == 0) {
        return Vec::new();
    }
    let channel = |word: &str, shift: u32| {
        let samples = tier.sums.iter().map(|sum| (sum[k] as u64 >> shift) as u32).collect();
        let name = format!("tier{}.{}.{word}", tier.number, WORDS[k]);
        exr::AnyChannel::new(name.as_str(), exr::FlatSamples::U32(samples))
    };
    vec![channel("high", 32), channel("low", 0)]
}

/// A number that changes when a bit of the sums does.
fn checked(tiers: &[Tier]) -> u64 {
    let bytes = |tier: &Tier| {
        let numbers = tier.sums.iter().flatten().flat_map(|sum| sum.to_le_bytes());
        tier.number.to_le_bytes().into_iter().chain(numbers).collect::<Vec<u8>>()
    };
    tiers.iter().fold(0, |sum, tier| sum.rotate_left(1) ^ farmhash::fingerprint64(&bytes(tier)))
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
    // The decoder is others' code: whatever a broken file makes it do ends here.
    let fail = |reason: String| PartError::Unreadable { path: path.to_owned(), reason };
    let given_up = || Err("its decoder has given up".to_owned());
    std::panic::catch_unwind(|| bounded(path)).unwrap_or_else(|_| given_up()).map_err(fail)?;
    let image =
        std::panic::catch_unwind(|| layers(path)).unwrap_or_else(|_| Err("its decoder has given up".to_owned()));
    assemble(&image.map_err(fail)?).map_err(fail)
}

/// Refuses what claims to be larger than any part is, before memory is taken for it.
fn bounded(path: &Path) -> Result<(), String> {
    // Before it is opened, for a pipe would wait for ever.
    let found = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !found.is_file() {
        return Err("it is no regular file".to_owned());
    }
    let file = std::fs::File::open(path).map_err(|error| error.to_string())?;
    let headers = exr::MetaData::read_from_unbuffered(file, false).map_err(|error| error.to_string())?.headers;
    let size = |header: &Header| header.layer_size.0.saturating_mul(header.layer_size.1);
    let numbers = |header: &Header| size(header).saturating_mul(header.channels.list.len()) as u64;
    let room = found.len().saturating_mul(PART_PACKED) / 4;
    let large = |header: &Header| {
        size(header) as u64 > PIXELS || header.channels.list.len() > PART_CHANNELS || numbers(header) > room
    };
    if headers.len() > 2 || headers.iter().any(large) { Err("it is larger than parts are".to_owned()) } else { Ok(()) }
}

/// What the decoder makes of the file.
type Layers = exr::Image<exr::Layers<exr::AnyChannels<exr::FlatSamples>>>;

fn layers(path: &Path) -> Result<Layers, String> {
    use exr::{ReadChannels, ReadLayers};
    let reader = exr::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    reader.from_file(path).map_err(|error| error.to_string())
}

fn assemble(image: &Layers) -> Result<Part, String> {
    let named = |layer: &&exr::Layer<exr::AnyChannels<exr::FlatSamples>>| {
        layer.attributes.layer_name.as_ref().is_some_and(|name| name.eq(LAYER))
    };
    let none = "it has no sums; a render leaves them with --samples, or when it is stopped";
    let layer = image.layer_data.iter().find(named).ok_or(none)?;
    let text = layer.attributes.comments.as_ref().map(ToString::to_string).unwrap_or_default();
    let (of, held, sums) = understand(&text, layer.size).ok_or("it does not say what its sums are")?;
    let mut tiers: Vec<Tier> = Vec::new();
    for channel in &layer.channel_data.list {
        let name = channel.name.to_string();
        let (number, k, shift) = placed(&name).ok_or_else(|| format!("it has an unknown channel `{name}`"))?;
        let exr::FlatSamples::U32(samples) = &channel.sample_data else {
            return Err(format!("its channel `{name}` has no integers"));
        };
        let at = tiers.iter().position(|tier| tier.number == number).unwrap_or_else(|| {
            tiers.push(Tier { number, sums: vec![[0; PARTS]; samples.len()] });
            tiers.len() - 1
        });
        let sums = tiers[at].sums.iter_mut();
        sums.zip(samples).for_each(|(sum, word)| sum[k] |= ((u64::from(*word)) << shift) as i64);
    }
    tiers.sort_unstable_by_key(|tier| tier.number);
    if checked(&tiers) != sums {
        return Err("it is damaged: its sums are not those that were written".to_owned());
    }
    let sums = Sums::of(tiers).ok_or("its sums are incomplete")?;
    Ok(Part::new(of, held, sums))
}

/// The tier, the number in it and the place of its word that a channel is for.
fn placed(name: &str) -> Option<(i32, usize, u32)> {
    let mut names = name.strip_prefix("tier")?.split('.');
    let (number, part, word) = (names.next()?.parse().ok()?, names.next()?, names.next()?);
    let shift = match word {
        "high" => 32,
        "low" => 0,
        _ => return None,
    };
    exact::is_tier(number).then_some(())?;
    Some((number, WORDS.iter().position(|word| *word == part)?, shift))
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
