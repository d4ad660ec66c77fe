//! A texture as a pyramid of levels, of which the coarser ones are made when they are first asked for.

use super::about::About;
use super::texels::{Level, Texels};
use super::wrap::Wrap;
use std::sync::OnceLock;

/// A picture to look up. Its coarser levels are made when they are first asked for.
#[derive(Debug)]
pub struct Texture {
    levels: Vec<OnceLock<Level>>,
    size: [usize; 2],
    channels: usize,
    wrap: [Wrap; 2],
    about: About,
}

impl Texture {
    /// A texture of rows from the top, `width * height * channels` numbers.
    pub fn of_rows(width: usize, height: usize, channels: usize, rows: &Texels) -> Self {
        Texture::of_levels(vec![Level::of_rows(width, height, channels, rows)], channels)
    }

    /// A texture whose finest levels are given, from the largest on; there must be one.
    pub fn of_levels(given: Vec<Level>, channels: usize) -> Self {
        let size = given.first().map_or([1, 1], |level| [level.width(), level.height()]);
        let count = usize::BITS - size[0].max(size[1]).max(1).leading_zeros();
        let mut levels: Vec<OnceLock<Level>> = given.into_iter().map(OnceLock::from).collect();
        levels.truncate(count as usize);
        levels.resize_with(count as usize, OnceLock::new);
        Texture { levels, size, channels, wrap: [Wrap::default(); 2], about: About::default() }
    }

    /// Uses these ways where a look-up names none.
    pub fn with_wrap(mut self, wrap: [Wrap; 2]) -> Self {
        self.wrap = wrap;
        self
    }

    /// Keeps what its file says of it.
    pub fn with_about(mut self, about: About) -> Self {
        self.about = about;
        self
    }

    /// What its file says of it.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Columns and rows of the finest level.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// What it is outside where a look-up does not say.
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// How many levels there are, down to a single texel.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// A level, 0 the finest.
    pub fn level(&self, number: usize) -> &Level {
        let number = number.min(self.levels.len() - 1);
        self.levels[number].get_or_init(|| self.level(number - 1).halved())
    }

    /// Levels that have been made or read, and the bytes they take, with those of the texts of the file.
    pub fn resident(&self) -> (usize, usize) {
        let there = self.levels.iter().filter_map(OnceLock::get);
        there.fold((0, self.about.bytes()), |(count, bytes), level| (count + 1, bytes + level.bytes()))
    }

    /// The mean of up to four channels.
    pub fn mean(&self) -> [f32; 4] {
        let mut mean = [0.0; 4];
        self.level(self.levels.len() - 1).read(0, 0, 0, &mut mean);
        mean
    }
}
