//! Rounds: how many samples which tiles take next, until the picture is good enough or the time is up.
//!
//! A render of a fixed number of samples is one round over all tiles, unless whoever drives it asks for shorter ones. A render that stops by noise or time goes in
//! rounds: 16 samples a pixel, 24, 32, 48 and so on, every prefix of which fills its strata well. After each round the
//! two halves of the film give every tile's error. With a time, rounds of 1, 2, 4 and 8 samples come first.
//!
//! Decision (2026-11-29): the time ends a render wherever it is, in the middle of the first round or of a shader, instead of after a first
//! round of 16 samples: Figure 1 in 2000 x 2000 pixels took 24 s of `--time 1`. What is unfinished in a tile is dropped.
//!
//! Decision (2026-11-22): with a time and no noise, a round goes to the tiles whose error falls most by one more sample
//! (the error divided by the samples so far is above its median), because an equal share for all leaves the sky as
//! clean as can be and the cloth noisy.

use super::film::Film;
use super::settings::Settings;
use super::tile::Tile;
use std::time::Instant;

/// Samples of the first round.
const FIRST: u32 = 16;

/// The most samples that a round adds when the time is short, so that all tiles end up with about as many.
const MOST_AT_ONCE: u32 = 64;

/// What a tile takes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// The tile's number.
    pub tile: usize,
    /// The first sample.
    pub first: u32,
    /// One behind the last sample.
    pub end: u32,
}

/// How far each tile has come.
pub struct Rounds {
    taken: Vec<u32>,
    /// Mean square error of each tile, at the last look; infinite before the first.
    errors: Vec<f64>,
    /// Pixels of each tile.
    pixels: Vec<f64>,
    /// Tiles in a row of the picture.
    across: usize,
    deadline: Option<Instant>,
}

impl Rounds {
    /// Nothing is done yet. The clock of a time limit runs from `start`.
    pub fn new(settings: &Settings, start: Instant) -> Self {
        let deadline = settings.deadline(start);
        let tiles = Tile::count(settings);
        let pixels = |number: usize| {
            let tile = Tile::number(settings, number);
            f64::from(tile.pixels())
        };
        Rounds {
            taken: vec![0; tiles],
            errors: vec![f64::INFINITY; tiles],
            pixels: (0..tiles).map(pixels).collect(),
            across: settings.width.div_ceil(settings.tile_size) as usize,
            deadline,
        }
    }

    /// True when the time is up.
    pub fn late(&self) -> bool {
        self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// The tasks of the next round, of at most `most` samples a pixel; none when all is done.
    pub fn next(&self, settings: &Settings, most: u32) -> Vec<Task> {
        if self.late() {
            return Vec::new();
        }
        let most = most.max(1);
        let fewest = self.taken.iter().copied().min().unwrap_or(0);
        let task = |tile: usize| {
            let Task { first, end, .. } = self.task(settings, tile);
            // A round that was stopped has left tiles behind, which catch up when all are to have as many samples.
            let start = if settings.adapts() { first } else { fewest };
            Task { tile, first, end: end.min(start.saturating_add(most)) }
        };
        self.wanting(settings).map(task).filter(|task| task.end > task.first).collect()
    }

    /// Looks at what a round has brought; true says that something is left to do.
    pub fn look(&mut self, settings: &Settings, film: &Film) -> bool {
        if settings.adapts() {
            self.errors = film.errors(settings);
        }
        !self.late() && self.wanting(settings).next().is_some()
    }

    /// The tiles that are to have more samples.
    fn wanting(&self, settings: &Settings) -> impl Iterator<Item = usize> {
        let limit = if settings.adapts() { self.limit(settings) } else { 0.0 };
        let wants = move |tile: &usize| {
            self.taken[*tile] < settings.samples && (!settings.adapts() || self.gain(settings, *tile) > limit)
        };
        (0..self.taken.len()).filter(wants)
    }

    /// Notes that a task is done.
    pub fn done(&mut self, task: &Task) {
        self.taken[task.tile] = task.end;
    }

    /// Samples a pixel of each tile.
    pub fn taken(&self) -> &[u32] {
        &self.taken
    }

    /// Root of the mean square error over the picture, as it was at the last look; `None` when there was none, or when
    /// one sample a pixel leaves nothing to compare.
    pub fn noise(&self) -> Option<f64> {
        let sum: f64 = self.errors.iter().zip(&self.pixels).map(|(error, pixels)| error * pixels).sum();
        let mean = sum / self.pixels.iter().sum::<f64>();
        mean.is_finite().then(|| mean.sqrt())
    }

    /// The error of a tile; that of its worst neighbour where its own is exactly zero, for two halves that have both
    /// seen nothing say little about what there is to be seen.
    fn error(&self, tile: usize) -> f64 {
        if self.errors[tile] != 0.0 {
            return self.errors[tile];
        }
        let (x, y) = (tile % self.across, tile / self.across);
        let columns = x.saturating_sub(1)..(x + 2).min(self.across);
        let rows = y.saturating_sub(1)..(y + 2).min(self.errors.len() / self.across);
        let near = rows.flat_map(|row| columns.clone().map(move |column| row * self.across + column));
        near.map(|tile| self.errors[tile]).fold(0.0, f64::max)
    }

    /// How much a tile wants more samples.
    fn gain(&self, settings: &Settings, tile: usize) -> f64 {
        match settings.noise {
            // Too few samples tell nothing of the error.
            _ if self.taken[tile] < FIRST.min(settings.samples) => f64::INFINITY,
            Some(_) => self.error(tile),
            None => self.error(tile) / f64::from(self.taken[tile].max(1)),
        }
    }

    /// What a tile's gain has to exceed.
    fn limit(&self, settings: &Settings) -> f64 {
        if let Some(noise) = settings.noise {
            return f64::from(noise) * f64::from(noise);
        }
        // Tiles that have had all they may get do not take part.
        let open = (0..self.taken.len()).filter(|tile| self.taken[*tile] < settings.samples);
        let mut gains: Vec<f64> = open.map(|tile| self.gain(settings, tile)).collect();
        gains.sort_unstable_by(f64::total_cmp);
        let median = gains.get(gains.len() / 2).copied().unwrap_or(0.0);
        // In the first round all gains are infinite, and all tiles go.
        if median.is_finite() { 0.999 * median } else { 0.0 }
    }

    /// What a tile takes when nobody asks for less.
    fn task(&self, settings: &Settings, tile: usize) -> Task {
        let first = self.taken[tile];
        if !settings.adapts() {
            return Task { tile, first, end: settings.samples };
        }
        let more = match first {
            // With a time, all of the picture is to be there soon.
            0 if settings.seconds.is_some() => 1,
            0 => FIRST,
            n if n < FIRST => n,
            n if n.is_power_of_two() => n / 2,
            n => n / 3,
        };
        let more = if settings.seconds.is_some() { more.min(MOST_AT_ONCE) } else { more };
        Task { tile, first, end: first.saturating_add(more).min(settings.samples) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_grow_by_a_half_and_a_third() {
        let settings = Settings { noise: Some(0.1), samples: 100, width: 16, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Instant::now());
        let mut ends = Vec::new();
        while rounds.taken[0] < settings.samples {
            let task = rounds.task(&settings, 0);
            assert_eq!(task.first, rounds.taken[0]);
            rounds.done(&task);
            ends.push(task.end);
        }
        assert_eq!(ends, [16, 24, 32, 48, 64, 96, 100]);
    }

    #[test]
    fn a_round_that_was_stopped_is_caught_up_with() {
        let settings = Settings { samples: 20, width: 64, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Instant::now());
        rounds.taken = vec![8, 8, 3, 20];
        let ends = |most| rounds.next(&settings, most).iter().map(|t| (t.tile, t.first, t.end)).collect::<Vec<_>>();
        assert_eq!(ends(5), [(2, 3, 8)]);
        assert_eq!(ends(8), [(0, 8, 11), (1, 8, 11), (2, 3, 11)]);
        assert_eq!(ends(u32::MAX), [(0, 8, 20), (1, 8, 20), (2, 3, 20)]);
    }

    /// Four tiles in a row, with a time.
    fn four(samples: u32, taken: [u32; 4], errors: [f64; 4]) -> Vec<usize> {
        let settings = Settings { seconds: Some(1e6), samples, width: 64, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Instant::now());
        (rounds.taken, rounds.errors) = (taken.to_vec(), errors.to_vec());
        rounds.wanting(&settings).collect()
    }

    #[test]
    fn with_a_time_the_worst_half_goes_on() {
        assert_eq!(four(1000, [16; 4], [0.5, 3.0, 2.0, 1.0]), [1, 2]);
    }

    #[test]
    fn tiles_that_are_done_do_not_keep_the_others_from_going_on() {
        assert_eq!(four(64, [64, 64, 16, 16], [100.0, 90.0, 0.2, 0.1]), [2]);
    }

    #[test]
    fn a_tile_without_any_error_follows_its_neighbours() {
        assert_eq!(four(1000, [16; 4], [3.0, 0.0, 0.0, 1.0]), [0, 1]);
    }
}
