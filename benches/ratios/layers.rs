//! Cost of nested layers: one sheen over the other, from 1 to 40, in time a layer against that of five.

use super::hand::{Batch, N, directions, numbers};
use super::{Pair, Table, pair};
use std::fmt::Write;
use std::hint::black_box;
use velour::closure::{Evaluation, Samples};

fn nested(layers: usize) -> Batch {
    let mut text = String::from("surface s() { Ci = diffuse(N);");
    for layer in 0..layers {
        let _ = write!(text, " Ci = sheen(Ci, N, color({:.3}), 0.3);", 0.1 + 0.001 * layer as f32);
    }
    text.push_str(" }");
    Batch::new(&text)
}

/// Times one kind of work of two batches; the ratio is that of times a layer.
fn compare(table: &Table, what: &str, layers: usize, mut work: impl FnMut(&mut Batch)) {
    let what = format!("{what}, {layers} layers, a layer");
    if !table.wants(&what) {
        return;
    }
    const FEW: usize = 5;
    let (mut many, mut few) = (nested(layers), nested(FEW));
    let work = std::cell::RefCell::new(&mut work);
    let timed = pair((&mut || work.borrow_mut()(&mut many), N), (&mut || work.borrow_mut()(&mut few), N));
    let (here, limit) = (timed.here / layers as f64, timed.limit / FEW as f64);
    let ratio = timed.ratio * FEW as f64 / layers as f64;
    table.row(&what, Pair { here, limit, ratio }, if layers == 40 { "<= 1" } else { "" });
}

/// Prints the rows.
pub fn rows(table: &Table) {
    table.head("nested layers", "of 5 layers");
    let (wi, xi) = (directions(2), numbers(3));
    let (mut out, mut samples) = (Evaluation::default(), Samples::default());
    for layers in [1, 2, 10, 20, 40] {
        compare(table, "shade and flatten", layers, |batch| batch.flatten());
    }
    for layers in [1, 2, 10, 20, 40] {
        compare(table, "evaluate", layers, |batch| batch.lobes.evaluate(black_box(&wi), &mut out));
    }
    for layers in [1, 2, 10, 20, 40] {
        compare(table, "sample", layers, |batch| batch.lobes.sample(black_box(&xi), &mut samples));
    }
}
