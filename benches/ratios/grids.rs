//! What `velour shade` adds to the machine: a point of a grid by the command, against the same group run on the machine alone.

use super::hand::N;
use super::{Table, instructions, weave};
use std::hint::black_box;
use velour::cli::Rounds;
use velour::exec::{Machine, Points};

/// Batches of a grid.
const BATCHES: usize = 64;

/// Times a shader of one layer both ways.
fn compare(table: &Table, name: &str, text: &str) {
    let what = format!("shade, {name}");
    if !table.wants(&what) {
        return;
    }
    let folder = tempfile::tempdir().unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(folder.path().join("layer.osl"), text).unwrap_or_else(|e| panic!("{e}"));
    let path = folder.path().display().to_string();
    let (width, height) = (N.to_string(), BATCHES.to_string());
    let words = ["-t", "1", "-g", &width, &height, "--path", &path, "-o", "result", "null", "layer"];
    let mut rounds = Rounds::new(&words).unwrap_or_else(|e| panic!("{e}"));
    let (group, mut machine, points) = (rounds.group().clone(), Machine::new(), by_hand());
    let shade = &mut || rounds.shade().unwrap_or_else(|e| panic!("{e}"));
    let alone = &mut || _ = black_box(machine.shade(&group, black_box(&points)));
    table.time(&what, (shade, BATCHES * N), (alone, N), "<= 1.1");
}

/// A row of the grid.
fn by_hand() -> Points {
    let mut points = super::hand::points();
    for lane in 0..N {
        points.u[lane] = lane as f32 / (N - 1) as f32;
        points.p.x[lane] = points.u[lane];
    }
    points
}

/// Prints the rows.
pub fn rows(table: &Table) {
    table.head("grids of points", "machine");
    compare(table, "chain of 10", instructions::TEN);
    compare(table, "loop of 110", instructions::ROUNDS);
    compare(table, "weave", weave::SHADER);
}
