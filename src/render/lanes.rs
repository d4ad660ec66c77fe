//! A batch's paths as columns: gathered once, so that what is done for every lane is done for many at a time.

use super::random;
use super::wave::Path;
use crate::math::columns::Column3;

/// The columns of one batch.
#[derive(Clone, Debug, Default)]
pub struct Lanes {
    /// The scrambles of the pixels.
    pub seeds: Vec<u32>,
    /// The numbers of the samples.
    pub indices: Vec<u32>,
    /// The primitives that were hit.
    pub primitives: Vec<u32>,
    /// What a unit of radiance adds to the sample.
    pub throughput: Column3,
    /// Four random numbers a lane.
    pub numbers: [Vec<f32>; 4],
}

impl Lanes {
    /// Takes in the paths of `batch`.
    pub fn gather(&mut self, paths: &[Path], batch: &[u32]) {
        self.resize(batch.len());
        for (lane, &i) in batch.iter().enumerate() {
            let path = &paths[i as usize];
            self.seeds[lane] = path.seed;
            self.indices[lane] = path.index;
            self.primitives[lane] = path.hit.primitive;
            self.throughput.set(lane, path.throughput);
        }
    }

    /// Makes room for `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.seeds.resize(len, 0);
        self.indices.resize(len, 0);
        self.primitives.resize(len, 0);
        self.throughput.resize(len);
        self.numbers.iter_mut().for_each(|column| column.resize(len, 0.0));
    }

    /// Draws the first `count` of the `numbers` from a set of dimensions; the others are left as they are.
    pub fn draw(&mut self, set: u32, count: usize) {
        random::fill(&self.seeds, &self.indices, set, &mut self.numbers[..count]);
    }
}
