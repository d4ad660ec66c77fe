//! Ratios of velour's times to limits measured in the same run: `cargo bench --bench ratios`, or with words that choose rows.
//!
//! A limit is what the machine could do at best: the same formula as one loop over lanes, written by hand, without tree, lobes
//! or registers. Both are run in turns, so that a busy machine slows both. Times are the best turns', in ns a lane; the
//! ratio is the median of the ratios of each turn.

mod closures;
mod grids;
mod hand;
mod instructions;
mod layers;
mod noises;
mod textures;
mod tops;
mod weave;

use std::time::Instant;

/// Turns of every pair.
const TURNS: usize = 41;
/// How long one side of a turn lasts, in seconds.
const SLICE: f64 = 3e-4;

/// Best times of two sides in ns a lane, and the median of their ratios.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The first side.
    pub here: f64,
    /// The second side.
    pub limit: f64,
    /// First over second.
    pub ratio: f64,
}

/// What runs, and how many lanes a run does.
pub type Side<'a> = (&'a mut dyn FnMut(), usize);

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs a side for about a slice and gives ns a lane.
fn slice(side: &mut Side, runs: usize) -> f64 {
    let start = Instant::now();
    for _ in 0..runs {
        (side.0)();
    }
    start.elapsed().as_secs_f64() * 1e9 / (runs * side.1) as f64
}

fn runs_of(side: &mut Side) -> usize {
    slice(side, 2);
    let once = slice(side, 4) * side.1 as f64 * 1e-9;
    ((SLICE / once) as usize).clamp(1, 1 << 20)
}

/// True under `cargo bench`. Under `cargo test --bench ratios` each side runs a few times, to see whether both are the same
/// function still.
fn measures() -> bool {
    std::env::args().any(|word| word == "--bench")
}

/// Times two sides in turns.
pub fn pair(mut here: Side, mut limit: Side) -> Pair {
    let turns = if measures() { TURNS } else { 1 };
    let (runs_here, runs_limit) = (runs_of(&mut here), runs_of(&mut limit));
    let (mut a, mut b, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..turns {
        let (x, y) = (slice(&mut here, runs_here), slice(&mut limit, runs_limit));
        a.push(x);
        b.push(y);
        ratios.push(x / y);
    }
    let best = |times: Vec<f64>| times.into_iter().fold(f64::INFINITY, f64::min);
    Pair { here: best(a), limit: best(b), ratio: median(ratios) }
}

/// The table as it grows.
#[derive(Debug)]
pub struct Table {
    words: Vec<String>,
}

impl Table {
    /// Is a row asked for?
    pub fn wants(&self, what: &str) -> bool {
        self.words.is_empty() || self.words.iter().any(|word| what.contains(word.as_str()))
    }

    /// Begins a group of rows.
    pub fn head(&self, title: &str, limit: &str) {
        println!("\n{title:<44} {:>9} {:>11} {:>7}  bar", "velour ns", limit, "ratio");
    }

    /// Prints a row; `bar` says what the ratio or the time should be.
    pub fn row(&self, what: &str, pair: Pair, bar: &str) {
        println!("{what:<44} {:>9.2} {:>11.2} {:>7.2}  {bar}", pair.here, pair.limit, pair.ratio);
    }

    /// Times a pair and prints it, unless other rows are asked for.
    pub fn time(&self, what: &str, here: Side, limit: Side, bar: &str) {
        if self.wants(what) {
            self.row(what, pair(here, limit), bar);
        }
    }
}

fn main() {
    // Cargo adds a flag of its own.
    let table = Table { words: std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect() };
    instructions::rows(&table);
    noises::rows(&table);
    textures::rows(&table);
    weave::rows(&table);
    closures::rows(&table);
    tops::rows(&table);
    layers::rows(&table);
    grids::rows(&table);
}
