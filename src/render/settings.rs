//! What a user can set about a render.

use crate::closure;
use crate::scene::Options;

/// How light reaches a surface point: the methods that may be compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightStrategy {
    /// Light samples and scattering samples, weighted by the power heuristic. The least noise almost everywhere.
    #[default]
    Combined,
    /// Scattering samples alone: right for every scene, noisy for small lights.
    ScatteringOnly,
    /// Light samples alone where a light can be sampled: noisy near lights and on shiny surfaces.
    LightsOnly,
}

/// The settings of one render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples a pixel.
    pub samples: u32,
    /// Seed of the random numbers; a scene, a seed and a sample count make one image.
    pub seed: u32,
    /// Threads; 0 takes one for each core.
    pub threads: usize,
    /// The most bounces of a path.
    pub max_bounces: u32,
    /// From this bounce on, paths that carry little may end early.
    pub rr_depth: u32,
    /// False sends every sample through its pixel's centre.
    pub jitter: bool,
    /// True keeps a fourth channel: the part of the pixel that is not background.
    pub alpha: bool,
    /// How light is sampled.
    pub lights: LightStrategy,
    /// A shader global to show in place of the picture: 0 none, 1 Ng, 2 N, 3 dPdu, 4 dPdv, 5 uv.
    pub show_globals: u32,
    /// Lanes of one shading batch, at most `exec::MAX_LANES`; never changes the image.
    pub batch_width: usize,
    /// Side of a tile in pixels; never changes the image.
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
            samples: 1,
            seed: 0,
            threads: 0,
            max_bounces: 1_000_000,
            rr_depth: 5,
            jitter: true,
            alpha: false,
            lights: LightStrategy::Combined,
            show_globals: 0,
            batch_width: crate::exec::MAX_LANES,
            tile_size: 16,
            wave_size: 4096,
            closure: closure::Settings::default(),
        }
    }
}

impl Settings {
    /// The settings with what a scene's `<Option>`s ask for, which win as they do in testrender.
    pub fn with_options(mut self, options: &Options) -> Self {
        self.max_bounces = options.max_bounces.unwrap_or(self.max_bounces);
        self.rr_depth = options.rr_depth.unwrap_or(self.rr_depth);
        self.samples = options.aa.map_or(self.samples, |aa| aa * aa);
        self.jitter = options.no_jitter.map_or(self.jitter, |no| !no);
        self.show_globals = options.show_globals.unwrap_or(self.show_globals);
        self
    }

    /// Says what cannot be rendered, if anything.
    pub fn check(&self) -> Result<(), String> {
        if self.width == 0 || self.height == 0 || u64::from(self.width) * u64::from(self.height) > 1 << 30 {
            return Err(format!("an image of {} x {} pixels cannot be rendered", self.width, self.height));
        }
        if self.samples == 0 {
            return Err("at least one sample a pixel is needed".into());
        }
        if self.tile_size == 0 || self.wave_size == 0 || self.batch_width == 0 {
            return Err("tile size, wave size and batch width must be above 0".into());
        }
        Ok(())
    }
}
