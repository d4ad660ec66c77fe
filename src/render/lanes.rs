//! A batch's paths as columns: gathered once, so that what is done for every lane is done for many at a time.

use super::crossing::Crossing;
use super::path::Path;
use super::random;
use crate::math::columns::Column3;
use glam::Vec3;

/// Random numbers, drawn for many lanes at a time.
#[derive(Clone, Debug, Default)]
pub struct Draws {
    /// The scrambles of the pixels.
    pub seeds: Vec<u32>,
    /// The numbers of the samples.
    pub indices: Vec<u32>,
    /// Four random numbers a lane.
    pub numbers: [Vec<f32>; 4],
}

impl Draws {
    /// Makes room for `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.seeds.resize(len, 0);
        self.indices.resize(len, 0);
        self.numbers.iter_mut().for_each(|column| column.resize(len, 0.0));
    }

    /// Draws the first `count` of the `numbers` from a set of dimensions; the others are left as they are.
    pub fn draw(&mut self, set: u32, count: usize) {
        random::fill(&self.seeds, &self.indices, set, &mut self.numbers[..count]);
    }
}

/// The columns of one batch: paths that hit one material at one bounce.
#[derive(Clone, Debug, Default)]
pub struct Lanes {
    /// The material that all have hit.
    pub material: usize,
    /// How many bounces are behind them.
    pub bounce: u32,
    /// The paths.
    pub paths: Vec<u32>,
    /// The primitives that were hit.
    pub primitives: Vec<u32>,
    /// What a unit of radiance adds to the sample.
    pub throughput: Column3,
    /// The paths' random numbers.
    pub draws: Draws,
}

impl Lanes {
    /// Takes the lights from paths that may not bounce any more.
    pub fn stop(&mut self, crossings: &[Crossing], max_bounces: u32) {
        for (lane, &i) in self.paths.iter().enumerate().filter(|_| !crossings.is_empty()) {
            if crossings[i as usize].bounces >= max_bounces {
                self.throughput.set(lane, Vec3::ZERO);
            }
        }
    }

    /// Fills the columns from the paths of the batch.
    pub fn gather(&mut self, paths: &[Path]) {
        let len = self.paths.len();
        self.draws.resize(len);
        self.primitives.resize(len, 0);
        self.throughput.resize(len);
        for (lane, &i) in self.paths.iter().enumerate() {
            let path = &paths[i as usize];
            self.draws.seeds[lane] = path.seed;
            self.draws.indices[lane] = path.index;
            self.primitives[lane] = path.segment.hit.primitive;
            self.throughput.set(lane, path.throughput);
        }
    }
}
