//! Rounds: how many samples which tiles take next, until the picture is good enough or the time is up.
//!
//! A render of a fixed number of samples is one round over all tiles. A render that stops by noise or time goes in
//! rounds: 16 samples a pixel, 24, 32, 48 and so on, every prefix of which fills its strata well. After each round the
//! two halves of the film give every tile's error.
//!
//! Decision (2026-11-22): with a time and no noise, a round goes to the tiles whose error falls most by one more sample
//! (the error divided by the samples so far is above its median), because an equal share for all leaves the sky as
//! clean as can be and the cloth noisy.

use super::film::Film;
use super::settings::Settings;
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
    errors: Vec<f64>,
    started: bool,
    deadline: Option<Instant>,
}

impl Rounds {
    /// Nothing is done yet. The clock of a time limit runs from `start`.
    pub fn new(settings: &Settings, tiles: usize, start: Instant) -> Self {
        let deadline = settings.seconds.map(|s| start + std::time::Duration::from_secs_f64(s.min(1e9)));
        Rounds { taken: vec![0; tiles], errors: vec![f64::INFINITY; tiles], started: false, deadline }
    }

    /// True when the time is up; the first round is always done, or there would be no picture.
    pub fn late(&self) -> bool {
        self.errors.first().is_some_and(|e| e.is_finite()) && self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// The tasks of the next round; none when all is done.
    pub fn next(&mut self, settings: &Settings, film: &Film) -> Vec<Task> {
        if !settings.adapts() {
            let all = |tile| Task { tile, first: 0, end: settings.samples };
            return if std::mem::replace(&mut self.started, true) {
                Vec::new()
            } else {
                (0..self.taken.len()).map(all).collect()
            };
        }
        if std::mem::replace(&mut self.started, true) {
            self.errors = film.errors(settings);
        }
        if self.late() {
            return Vec::new();
        }
        let limit = self.limit(settings);
        let wanting = |tile: &usize| self.taken[*tile] < settings.samples && self.gain(settings, *tile) > limit;
        (0..self.taken.len()).filter(wanting).map(|tile| self.task(settings, tile)).collect()
    }

    /// Notes that a task is done.
    pub fn done(&mut self, task: &Task) {
        self.taken[task.tile] = task.end;
    }

    /// Samples a pixel of each tile.
    pub fn taken(&self) -> &[u32] {
        &self.taken
    }

    /// Root of the mean square error over the picture, as it was at the last look; `None` when none was taken.
    pub fn noise(&self) -> Option<f64> {
        let mean = self.errors.iter().sum::<f64>() / self.errors.len().max(1) as f64;
        mean.is_finite().then(|| mean.sqrt())
    }

    /// How much a tile wants more samples.
    fn gain(&self, settings: &Settings, tile: usize) -> f64 {
        match settings.noise {
            Some(_) => self.errors[tile],
            None => self.errors[tile] / f64::from(self.taken[tile].max(1)),
        }
    }

    /// What a tile's gain has to exceed.
    fn limit(&self, settings: &Settings) -> f64 {
        if let Some(noise) = settings.noise {
            return f64::from(noise) * f64::from(noise);
        }
        let mut gains: Vec<f64> = (0..self.taken.len()).map(|tile| self.gain(settings, tile)).collect();
        gains.sort_unstable_by(f64::total_cmp);
        let median = gains.get(gains.len() / 2).copied().unwrap_or(0.0);
        // In the first round all gains are infinite, and all tiles go.
        if median.is_finite() { 0.999 * median } else { 0.0 }
    }

    fn task(&self, settings: &Settings, tile: usize) -> Task {
        let first = self.taken[tile];
        let more = match first {
            0 => FIRST,
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
        let settings = Settings { noise: Some(0.1), samples: 100, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, 1, Instant::now());
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
    fn with_a_time_the_worst_half_goes_on() {
        let settings = Settings { seconds: Some(1e6), samples: 1000, ..Settings::default() };
        let mut rounds = Rounds::new(&settings, 4, Instant::now());
        rounds.taken = vec![16; 4];
        rounds.errors = vec![0.0, 3.0, 2.0, 1.0];
        let limit = rounds.limit(&settings);
        let on: Vec<usize> = (0..4).filter(|t| rounds.gain(&settings, *t) > limit).collect();
        assert_eq!(on, [1, 2]);
    }
}
