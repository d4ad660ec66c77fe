//! What a user can set about a render.

use super::error::SettingsError;
use crate::limits::{BOUNCES, FRAME_SIDE, PIXELS, ROULETTE};
use crate::scene::Options;
use crate::{closure, exec};
use std::str::FromStr;
use std::time::{Duration, Instant};

/// How light reaches a surface point: the methods that may be compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightStrategy {
    /// Light samples and scattering samples, weighted by the power heuristic. The least noise almost everywhere.
    #[default]
    Combined,
    /// Scattering samples alone: right for every scene, noisy for small lights.
    ScatteringOnly,
    /// Light samples alone where a light can be sampled: noisy near lights and on shiny surfaces.
    LightsOnly,
}

/// How a light is chosen where there are several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LightChoice {
    /// By power alone, the same everywhere.
    Power,
    /// By a hierarchy, from three lights on: by power, place and normals. Source: Conty and Kulla 2018.
    #[default]
    Tree,
}

impl LightChoice {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, LightChoice); 2] = [("power", LightChoice::Power), ("tree", LightChoice::Tree)];
}

/// How a point of a flat light is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LightPoints {
    /// By area.
    Area,
    /// By solid angle from close by, where the light's area is at least the square of its distance; else by area. Source:
    /// Urena, Fajardo and King 2013; Arvo 1995.
    #[default]
    Solid,
}

impl LightPoints {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, LightPoints); 2] = [("area", LightPoints::Area), ("solid", LightPoints::Solid)];
}

/// What is done about the steps that facets of smooth meshes show where light begins to graze them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Terminator {
    /// Nothing: light from behind a facet is dark, whatever its smooth normals see.
    None,
    /// Light that grazes a facet fades out before it turns away. Source: Chiang, Li and Burley 2019.
    Factor,
    /// Light arrives at the smooth surface that lies over the facet. Source: Hanika 2021.
    #[default]
    Origin,
}

impl Terminator {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, Terminator); 3] =
        [("none", Terminator::None), ("factor", Terminator::Factor), ("origin", Terminator::Origin)];
}

/// How the samples around a pixel count for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Filter {
    /// By a tent two pixels wide, whose samples count for four pixels each: the least noise, which neighbours share.
    #[default]
    Tent,
    /// Those in the pixel alone, equally; the noise of no two pixels has to do with each other, as denoisers want it.
    Box,
    /// By a window three pixels wide (Blackman and Harris, in Harris 1978): each pixel has samples of its own, drawn by it.
    BlackmanHarris,
}

impl Filter {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, Filter); 3] =
        [("tent", Filter::Tent), ("box", Filter::Box), ("blackman-harris", Filter::BlackmanHarris)];
}

impl FromStr for Filter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        let unknown = || format!("unknown filter \"{text}\"; take \"tent\", \"box\" or \"blackman-harris\"");
        found.map(|&(_, v)| v).ok_or_else(unknown)
    }
}

/// A frame that the picture is cut out of: its pixels are those of the frame, but for the outermost, which lack what a tent would
/// give them from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Frame {
    /// Width and height of the frame in pixels.
    pub size: [u32; 2],
    /// Where the upper left pixel of the picture is in it.
    pub at: [u32; 2],
}

impl FromStr for Terminator {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        found.map(|&(_, v)| v).ok_or_else(|| {
            format!("unknown remedy for terminators \"{text}\"; take \"none\", \"factor\" or \"origin\"")
        })
    }
}

impl FromStr for LightChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        found.map(|&(_, v)| v).ok_or_else(|| format!("unknown choice of lights \"{text}\"; take \"power\" or \"tree\""))
    }
}

impl FromStr for LightPoints {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        found.map(|&(_, v)| v).ok_or_else(|| format!("unknown points of lights \"{text}\"; take \"area\" or \"solid\""))
    }
}

/// Halves of a film's samples that an error can be estimated from.
pub(super) const HALVES: usize = 2;

/// The settings of one render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The frame that the picture is a part of; else it is the whole.
    pub frame: Option<Frame>,
    /// How samples count for pixels.
    pub filter: Filter,
    /// Samples a pixel; the most of them when `noise` or `seconds` is set.
    pub samples: u32,
    /// The number of the first sample, below `samples`: samples are numbered, and a sample of a number is the same in any render.
    pub first_sample: u32,
    /// Stops a tile when the root of its mean square error, estimated from two half pictures, is below this; in units
    /// of radiance, as the picture has it.
    pub noise: Option<f32>,
    /// Stops when this many seconds have gone by since the render began, in the middle of a shader if need be; the picture then
    /// depends on the machine, and what had no sample by then is black.
    pub seconds: Option<f64>,
    /// Seed of the random numbers; a scene, a seed and a sample count make one image.
    pub seed: u32,
    /// Threads; 0 takes one for each core.
    pub threads: usize,
    /// The most bounces of a path.
    pub max_bounces: u32,
    /// From this bounce on, paths that carry little may end early; from [`ROULETTE`] on all may.
    pub rr_depth: u32,
    /// False sends every sample through its pixel's centre.
    pub jitter: bool,
    /// True keeps a fourth channel, alpha: the part of the pixel that is not background, in [0, 1]. Colors are then
    /// premultiplied: the background that is seen directly or through clear surfaces is left out of them.
    pub alpha: bool,
    /// How light is sampled.
    pub lights: LightStrategy,
    /// How a light is chosen.
    pub light_choice: LightChoice,
    /// How a point of it is.
    pub light_points: LightPoints,
    /// What is done about facets at the terminator of smooth meshes.
    pub terminator: Terminator,
    /// A shader global to show in place of the picture: 0 none, 1 Ng, 2 N, 3 dPdu, 4 dPdv, 5 uv.
    pub show_globals: u32,
    /// Lanes of one shading batch, at most `exec::MAX_LANES`; never changes the image.
    pub batch_width: usize,
    /// Side of a tile in pixels; changes nothing of the image, unless `noise` or `seconds` is set.
    pub tile_size: u32,
    /// Paths in flight in one tile; never changes the image.
    pub wave_size: usize,
    /// What the closures are told.
    pub closure: closure::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            width: 640,
            height: 480,
            frame: None,
            filter: Filter::Tent,
            samples: 1,
            first_sample: 0,
            noise: None,
            seconds: None,
            seed: 0,
            threads: 0,
            max_bounces: BOUNCES,
            rr_depth: 5,
            jitter: true,
            alpha: false,
            lights: LightStrategy::Combined,
            light_choice: LightChoice::Tree,
            light_points: LightPoints::Solid,
            terminator: Terminator::Origin,
            show_globals: 0,
            batch_width: exec::MAX_LANES,
            tile_size: 16,
            wave_size: 8192,
            closure: closure::Settings::default(),
        }
    }
}

impl Settings {
    /// The settings with what a scene's `<Option>`s ask for, which win as they do in testrender.
    pub fn with_options(mut self, options: &Options) -> Self {
        self.max_bounces = options.max_bounces.unwrap_or(self.max_bounces).min(BOUNCES);
        self.rr_depth = options.rr_depth.unwrap_or(self.rr_depth).min(ROULETTE);
        // A number of samples does not mean much to a render that stops by itself.
        let fixed = options.aa.filter(|_| !self.adapts());
        self.samples = fixed.map_or(self.samples, |aa| aa.saturating_mul(aa));
        self.jitter = options.no_jitter.map_or(self.jitter, |no| !no);
        self.show_globals = options.show_globals.unwrap_or(self.show_globals);
        self
    }

    /// True when the number of samples is found out while rendering.
    pub fn adapts(&self) -> bool {
        self.noise.is_some() || self.seconds.is_some()
    }

    /// When a render that began at `start` stops, if it has a time.
    pub(super) fn deadline(&self, start: Instant) -> Option<Instant> {
        self.seconds.map(|seconds| start + Duration::from_secs_f64(seconds.min(1e9)))
    }

    /// The frame, or the picture as one.
    pub fn whole_frame(&self) -> Frame {
        self.frame.unwrap_or(Frame { size: [self.width, self.height], at: [0, 0] })
    }

    /// How many halves the samples are split into.
    pub(super) fn halves(&self) -> usize {
        if self.adapts() { HALVES } else { 1 }
    }

    /// Lanes of a shading batch.
    pub(super) fn lanes(&self) -> usize {
        self.batch_width.clamp(1, exec::MAX_LANES)
    }

    /// Says what cannot be rendered, if anything.
    pub fn check(&self) -> Result<(), SettingsError> {
        if self.width == 0 || self.height == 0 || u64::from(self.width) * u64::from(self.height) > PIXELS {
            return Err(SettingsError::Size { width: self.width, height: self.height });
        }
        let Frame { size, at } = self.whole_frame();
        let end = [u64::from(at[0]) + u64::from(self.width), u64::from(at[1]) + u64::from(self.height)];
        if (0..2).any(|k| end[k] > u64::from(size[k]) || size[k] > FRAME_SIDE) {
            return Err(SettingsError::Frame { end, size });
        }
        if self.samples <= self.first_sample {
            return Err(SettingsError::NoSamples);
        }
        if self.adapts() && self.first_sample > 0 {
            return Err(SettingsError::First);
        }
        if self.noise.is_some_and(|noise| !(noise > 0.0 && noise.is_finite())) {
            return Err(SettingsError::Noise);
        }
        if self.seconds.is_some_and(|seconds| !(seconds > 0.0 && seconds.is_finite())) {
            return Err(SettingsError::Seconds);
        }
        if self.tile_size == 0 || self.wave_size == 0 || self.batch_width == 0 {
            return Err(SettingsError::Batches);
        }
        Ok(())
    }
}
