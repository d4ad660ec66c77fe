//! Rounds: how many samples which tiles take next, until the picture is good enough or the time is up.
//!
//! A render of a fixed number of samples is one round over all tiles, unless whoever drives it asks for shorter ones. A render that
//! stops by noise or time goes in rounds: 16 samples a pixel, 24, 32, 48 and so on, every prefix of which fills its strata well. After each round the
//! two halves of the film give every tile's error. With a time, rounds of 1 and 3 samples come first.
//!
//! Decision (2026-11-29): the time ends a render wherever it is, in the middle of the first round or of a shader, instead of after a first
//! round of 16 samples: Figure 1 in 2000 x 2000 pixels took 24 s of `--time 1`. What is unfinished in a tile is dropped.
//!
//! Decision (2026-11-22): with a time and no noise, a round goes to the tiles whose error falls most by one more sample
//! (the error divided by the samples so far is above its median), because an equal share for all leaves the sky as
//! clean as can be and the cloth noisy.

use super::film::Film;
use super::part::Ranges;
use super::settings::Settings;
use super::stop::Stop;
use super::tile::Tile;
use std::sync::Arc;

/// Samples of the first round; what there is to see after fewer says little about the error.
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
    /// Which samples each tile has had.
    held: Vec<Ranges>,
    /// Tiles of a round that stops by noise or time, and the sample that each goes to: a round that was cut short is brought to its end
    /// before errors are looked at, so that where it was cut does not show.
    open: Vec<Task>,
    /// Mean square error of each tile, at the last look; infinite before the first.
    errors: Vec<f64>,
    /// Pixels of each tile.
    pixels: Vec<f64>,
    /// Tiles in a row of the picture.
    across: usize,
    /// Whose clock says when the time is up.
    stop: Arc<Stop>,
}

impl Rounds {
    /// Nothing is done yet; `stop` has the clock of a time limit.
    pub fn new(settings: &Settings, stop: Arc<Stop>) -> Self {
        let tiles = Tile::count(settings);
        let pixels = |number: usize| {
            let tile = Tile::number(settings, number);
            f64::from(tile.pixels())
        };
        Rounds {
            held: vec![Ranges::default(); tiles],
            open: Vec::new(),
            errors: vec![f64::INFINITY; tiles],
            pixels: (0..tiles).map(pixels).collect(),
            across: settings.width.div_ceil(settings.tile_size) as usize,
            stop,
        }
    }

    /// True when the time is up.
    pub fn late(&self) -> bool {
        self.stop.late()
    }

    /// The tasks of the next round, of at most `most` samples a pixel; none when all is done.
    pub fn next(&mut self, settings: &Settings, most: u32) -> Vec<Task> {
        if self.late() {
            return Vec::new();
        }
        let unfinished = self.unfinished();
        if !unfinished.is_empty() {
            return unfinished;
        }
        let wanted = |tile: usize| self.held[tile].missing(settings.first_sample..settings.samples).count();
        let furthest = if settings.adapts() { 0 } else { (0..self.held.len()).map(wanted).max().unwrap_or(0) };
        let task = |tile: usize| {
            let Task { first, end, .. } = self.task(settings, tile);
            // A round that was stopped has left tiles behind, which catch up when all are to have as many samples.
            let ahead = if settings.adapts() { 0 } else { furthest - wanted(tile) };
            Task { tile, first, end: end.min(first.saturating_add(most.max(1).saturating_sub(ahead))) }
        };
        let tasks: Vec<Task> = self.wanting(settings).map(task).filter(|task| task.end > task.first).collect();
        if settings.adapts() {
            self.open.clone_from(&tasks);
        }
        tasks
    }

    /// What is left of the round that is open.
    fn unfinished(&self) -> Vec<Task> {
        let rest = |task: &Task| Task { first: self.held[task.tile].end().max(task.first), ..*task };
        self.open.iter().map(rest).filter(|task| task.first < task.end).collect()
    }

    /// Looks at what a round has brought; true says that something is left to do.
    pub fn look(&mut self, settings: &Settings, film: &Film) -> bool {
        if !self.late() && !self.unfinished().is_empty() {
            return true;
        }
        if settings.adapts() && (self.taken().all(|samples| samples >= FIRST) || self.late()) {
            self.errors = film.errors(settings);
        }
        !self.late() && self.wanting(settings).next().is_some()
    }

    /// The tiles that are to have more samples.
    fn wanting(&self, settings: &Settings) -> impl Iterator<Item = usize> {
        let limit = if settings.adapts() { self.limit(settings) } else { 0.0 };
        let wants = move |tile: &usize| {
            if settings.adapts() {
                let taken = self.held[*tile].count();
                taken < settings.samples && (taken < FIRST || self.gain(settings, *tile) > limit)
            } else {
                !self.held[*tile].missing(settings.first_sample..settings.samples).is_empty()
            }
        };
        (0..self.held.len()).filter(wants)
    }

    /// Notes that a task is done.
    pub fn done(&mut self, task: &Task) {
        self.held[task.tile].insert(task.first..task.end);
    }

    /// Goes on from samples that there are already.
    pub fn resume(&mut self, held: Vec<Ranges>) {
        self.held = held;
    }

    /// Which samples each tile has had.
    pub fn held(&self) -> &[Ranges] {
        &self.held
    }

    /// Samples a pixel of each tile.
    pub fn taken(&self) -> impl Iterator<Item = u32> {
        self.held.iter().map(Ranges::count)
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
            Some(_) => self.error(tile),
            None => self.error(tile) / f64::from(self.held[tile].count().max(1)),
        }
    }

    /// What a tile's gain has to exceed.
    fn limit(&self, settings: &Settings) -> f64 {
        if let Some(noise) = settings.noise {
            return f64::from(noise) * f64::from(noise);
        }
        // Tiles that have had all they may get do not take part.
        let open = (0..self.held.len()).filter(|tile| self.held[*tile].count() < settings.samples);
        let mut gains: Vec<f64> = open.map(|tile| self.gain(settings, tile)).collect();
        gains.sort_unstable_by(f64::total_cmp);
        let median = gains.get(gains.len() / 2).copied().unwrap_or(0.0);
        // In the first round all gains are infinite, and all tiles go.
        if median.is_finite() { 0.999 * median } else { 0.0 }
    }

    /// What a tile takes when nobody asks for less.
    fn task(&self, settings: &Settings, tile: usize) -> Task {
        if !settings.adapts() {
            let missing = self.held[tile].missing(settings.first_sample..settings.samples);
            let range = missing.iter().next().cloned().unwrap_or_default();
            return Task { tile, first: range.start, end: range.end };
        }
        let first = self.held[tile].count();
        let more = match first {
            // When the time is short, the whole picture is there after one sample.
            0 if settings.seconds.is_some() => 1,
            n if n < FIRST && settings.seconds.is_some() => (3 * n).min(FIRST - n),
            n if n < FIRST => FIRST - n,
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
        let mut rounds = Rounds::new(&settings, Arc::new(Stop::new(Arc::default())));
        let mut ends = Vec::new();
        while rounds.held[0].count() < settings.samples {
            let task = rounds.task(&settings, 0);
            assert_eq!(task.first, rounds.held[0].count());
            rounds.done(&task);
            ends.push(task.end);
        }
        assert_eq!(ends, [16, 24, 32, 48, 64, 96, 100]);
    }

    #[test]
    fn a_round_that_was_stopped_is_caught_up_with() {
        let settings = Settings { samples: 20, width: 64, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Arc::new(Stop::new(Arc::default())));
        rounds.held = vec![Ranges::of(0..8), Ranges::of(0..8), Ranges::of(0..3), Ranges::of(0..20)];
        let mut ends = |most| rounds.next(&settings, most).iter().map(|t| (t.tile, t.first, t.end)).collect::<Vec<_>>();
        assert_eq!(ends(5), [(2, 3, 8)]);
        assert_eq!(ends(8), [(0, 8, 11), (1, 8, 11), (2, 3, 11)]);
        assert_eq!(ends(u32::MAX), [(0, 8, 20), (1, 8, 20), (2, 3, 20)]);
    }

    #[test]
    fn what_is_missing_in_between_is_made() {
        let settings = Settings { first_sample: 4, samples: 20, width: 32, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Arc::new(Stop::new(Arc::default())));
        let mut made = Vec::new();
        rounds.resume(vec!["0..6,10..12".parse().unwrap(), "4..20".parse().unwrap()]);
        loop {
            let tasks = rounds.next(&settings, u32::MAX);
            if tasks.is_empty() {
                break;
            }
            tasks.iter().for_each(|task| rounds.done(task));
            made.extend(tasks.iter().map(|t| (t.tile, t.first, t.end)));
        }
        assert_eq!(made, [(0, 6, 10), (0, 12, 20)]);
        assert_eq!(rounds.held[0].to_string(), "0..20");
    }

    #[test]
    fn a_short_time_begins_with_one_sample_of_all() {
        let settings = Settings { seconds: Some(1e6), samples: 100, width: 16, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Arc::new(Stop::new(Arc::default())));
        let mut ends = Vec::new();
        for _ in 0..5 {
            let task = rounds.next(&settings, u32::MAX)[0];
            rounds.done(&task);
            ends.push(task.end);
        }
        assert_eq!(ends, [1, 4, 16, 24, 32]);
    }

    /// Four tiles in a row, with a time.
    fn four(samples: u32, taken: [u32; 4], errors: [f64; 4]) -> Vec<usize> {
        let settings = Settings { seconds: Some(1e6), samples, width: 64, height: 16, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, Arc::new(Stop::new(Arc::default())));
        (rounds.held, rounds.errors) = (taken.map(|n| Ranges::of(0..n)).to_vec(), errors.to_vec());
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
