//! Times of competing methods, measured in turns so that a slow moment of the machine strikes all of them.

use std::fmt;
use std::time::Instant;

/// Something to be timed.
pub struct Runner<'a> {
    /// How many evaluations one call makes.
    pub count: usize,
    /// Makes them.
    pub run: Box<dyn FnMut() + 'a>,
}

impl fmt::Debug for Runner<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Runner").field("count", &self.count).finish_non_exhaustive()
    }
}

impl<'a> Runner<'a> {
    /// A runner of `count` evaluations a call.
    pub fn new(count: usize, run: impl FnMut() + 'a) -> Self {
        Runner { count, run: Box::new(run) }
    }
}

/// What a cost is in figures whose methods are timed in turns.
pub const MEDIANS: &str = "Cost: the median of interleaved rounds, with its quartiles.";

/// Nanoseconds an evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Median of the rounds.
    pub median: f64,
    /// Lower and upper quartile.
    pub spread: [f64; 2],
}

/// How long a race takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laps {
    /// Rounds in which every runner has one turn.
    pub rounds: usize,
    /// Seconds of one turn.
    pub turn: f64,
}

/// Times all runners in turns.
pub fn race(runners: &mut [Runner], laps: Laps) -> Vec<Cost> {
    let calls: Vec<usize> = runners.iter_mut().map(|runner| calls_in(runner, laps.turn)).collect();
    let mut times = vec![Vec::with_capacity(laps.rounds); runners.len()];
    for _ in 0..laps.rounds.max(1) {
        for ((runner, times), &calls) in runners.iter_mut().zip(&mut times).zip(&calls) {
            let start = Instant::now();
            (0..calls).for_each(|_| (runner.run)());
            times.push(start.elapsed().as_secs_f64() * 1e9 / (calls * runner.count) as f64);
        }
    }
    times.into_iter().map(summary).collect()
}

/// How many calls fill a turn; at least one. The first call warms caches up and is not counted.
fn calls_in(runner: &mut Runner, turn: f64) -> usize {
    (runner.run)();
    let mut calls = 1;
    loop {
        let start = Instant::now();
        (0..calls).for_each(|_| (runner.run)());
        let seconds = start.elapsed().as_secs_f64();
        if seconds > 0.25 * turn || calls > 1 << 24 {
            return ((calls as f64 * turn / seconds.max(1e-9)) as usize).clamp(1, 1 << 26);
        }
        calls *= 4;
    }
}

/// Median and quartiles.
pub fn summary(mut times: Vec<f64>) -> Cost {
    times.sort_by(f64::total_cmp);
    let at = |part: f64| times.get(((times.len().max(1) - 1) as f64 * part).round() as usize).copied().unwrap_or(0.0);
    Cost { median: at(0.5), spread: [at(0.25), at(0.75)] }
}
