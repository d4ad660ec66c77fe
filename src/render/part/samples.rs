//! The samples of a part, and what they are samples of.

use super::super::exact::Sums;
use super::super::film::picture_of;
use super::super::image::{About, Image};
use super::super::tile::Tile;
use super::error::PartError;
use super::ranges::{Ranges, counts};
use crate::limits::PIXELS;

/// Samples of a picture, and how to tell whether others are of the same.
#[derive(Clone, Debug)]
pub struct Part {
    /// What they are samples of.
    pub of: Whole,
    /// Which samples each tile's pixels have had, row by row.
    pub held: Vec<Ranges>,
    sums: Sums,
}

/// The picture that a part belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Whole {
    /// The name of the scene's file.
    pub scene: String,
    /// See [`fingerprint`](super::fingerprint).
    pub fingerprint: u64,
    /// The version of this crate, of which another may make other samples.
    pub version: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Whether it has an alpha channel.
    pub alpha: bool,
    /// The seed.
    pub seed: u32,
    /// Side of a tile in pixels.
    pub tile_size: u32,
}

impl Whole {
    /// How many tiles it is cut into; nothing for a size that no picture has.
    pub fn tiles(&self) -> Option<usize> {
        let known = self.tile_size > 0 && u64::from(self.width) * u64::from(self.height) <= PIXELS;
        known.then(|| Tile::count_of([self.width, self.height], self.tile_size))
    }

    /// The first thing in which two differ, said of the second.
    fn difference(&self, other: &Whole) -> Option<String> {
        let size = |whole: &Whole| format!("{} x {} pixels", whole.width, whole.height);
        let pairs = [
            ("the version of velour", self.version.clone(), other.version.clone()),
            ("the size", size(self), size(other)),
            ("the seed", self.seed.to_string(), other.seed.to_string()),
            ("the size of tiles", self.tile_size.to_string(), other.tile_size.to_string()),
        ];
        for (what, mine, others) in pairs {
            if mine != others {
                return Some(format!("{what} is {others} and not {mine}"));
            }
        }
        // The name of the scene does not count: another machine may have it elsewhere.
        let same = self.fingerprint == other.fingerprint && self.alpha == other.alpha;
        let what = "scene, shaders, textures or settings";
        (!same).then(|| match self.scene == other.scene {
            true => format!("{what} have changed"),
            false => format!("{what} are those of {} and not of {}", other.scene, self.scene),
        })
    }
}

impl Part {
    /// A part of a picture, from the sums over its pixels.
    pub(in crate::render) fn new(of: Whole, held: Vec<Ranges>, sums: Sums) -> Self {
        Part { of, held, sums }
    }

    /// Which samples each tile has had, and their sums.
    pub(in crate::render) fn into_sums(self) -> (Vec<Ranges>, Sums) {
        (self.held, self.sums)
    }

    /// The sums over its pixels.
    pub(super) fn sums(&self) -> &Sums {
        &self.sums
    }

    /// Says whether it is a part of `whole`.
    ///
    /// # Errors
    /// It is not.
    pub fn is_of(&self, whole: &Whole) -> Result<(), PartError> {
        whole.difference(&self.of).map_or(Ok(()), |difference| Err(PartError::OfAnother(difference)))
    }

    /// The samples that all pixels have had.
    pub fn common(&self) -> Ranges {
        let first = self.held.first().cloned().unwrap_or_default();
        self.held.iter().fold(first, |common, held| if common == *held { common } else { common.shared(held) })
    }

    /// The fewest and the most samples that pixels have had.
    pub fn counts(&self) -> [u32; 2] {
        counts(&self.held)
    }

    /// Says which samples it holds, such as `samples 0..64`.
    pub fn summary(&self) -> String {
        let common = self.common();
        let [fewest, most] = self.counts();
        match (common.is_empty(), fewest == most && common.count() == most) {
            (true, true) => "no sample".to_owned(),
            (false, true) => format!("samples {common}"),
            (true, false) => format!("{fewest} to {most} samples, of which pixels have none in common"),
            (false, false) => format!("samples {common} and of some pixels up to {most}"),
        }
    }

    /// Adds the samples of another part of the same picture.
    ///
    /// # Errors
    /// It is of another picture, or holds samples that are here already.
    pub fn merge(&mut self, mut other: Part) -> Result<(), PartError> {
        other.is_of(&self.of)?;
        for (tile, (mine, others)) in self.held.iter().zip(&other.held).enumerate() {
            let both = mine.shared(others);
            if !both.is_empty() {
                return Err(PartError::Twice { samples: both, tile });
            }
        }
        for (mine, others) in self.held.iter_mut().zip(&other.held) {
            *mine = mine.union(others);
        }
        self.sums.drain(&mut other.sums);
        self.sums.settle();
        Ok(())
    }

    /// The picture of its samples.
    pub fn picture(&self) -> Image {
        let Whole { width, height, alpha, .. } = self.of;
        let channels = if alpha { 4 } else { 3 };
        let taken = self.counts();
        let about =
            About { scene: self.of.scene.clone(), samples: taken[1], taken, seed: self.of.seed, ..About::default() };
        let pixels = picture_of(&self.sums, channels);
        Image { width, height, channels, pixels, about }
    }
}
