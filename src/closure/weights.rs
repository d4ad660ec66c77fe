//! Weights on their way down the tree: a color for all lanes or a color a lane, and the lane loops that combine them.
//!
//! Decision (2026-11-22): the loops ask for lengths and kinds once a column, and test for numbers with whole words, because a
//! function called for each lane and component, and sums that keep the order of their terms, took 28 % of the time of
//! flattening; instead of one closure a lane, which is shorter.

use super::store::Store;
use super::tree::{Floats, Tree};
use crate::lanes;

/// The largest weight of a lobe or a light that counts; beyond it closures are dropped and reported, like weights that are no numbers.
/// No light is so bright, and what lobes scatter times this, summed over as many lobes as there may be, stays a number.
pub const MOST_WEIGHT: f32 = 1e18;

/// A weight.
#[derive(Clone, Copy, Debug)]
pub enum Weight {
    /// The same in every lane.
    Uniform([f32; 3]),
    /// Offset of three columns in [`Weights`].
    Columns(u32),
}

/// The columns of all weights of a batch.
#[derive(Debug, Default)]
pub struct Weights {
    columns: Store,
}

/// One component of a weight, or one column of the tree.
#[derive(Clone, Copy, Debug)]
pub enum Operand<'a> {
    /// The same in every lane.
    One(f32),
    /// One number a lane.
    Many(&'a [f32]),
}

impl<'a> Operand<'a> {
    /// A column of a tree.
    pub fn of(tree: &'a Tree, from: Floats) -> Self {
        match from {
            Floats::Uniform(value) => Operand::One(value),
            Floats::Varying(at) => Operand::Many(tree.column(at)),
        }
    }
}

impl Weights {
    /// Empties the store.
    pub fn clear(&mut self) {
        self.columns.clear();
    }

    /// A component of a weight in a lane.
    pub fn get(&self, weight: Weight, component: usize, lane: usize, lanes: usize) -> f32 {
        match weight {
            Weight::Uniform(value) => value[component],
            Weight::Columns(at) => self.columns[at as usize + component * lanes + lane],
        }
    }

    /// A component of a weight.
    pub fn operand(&self, weight: Weight, component: usize, lanes: usize) -> Operand<'_> {
        operand(&self.columns, weight, component, lanes)
    }

    /// Three new columns, filled from the old ones component by component.
    fn make(&mut self, lanes: usize, mut fill: impl FnMut(&[f32], usize, &mut [f32])) -> Weight {
        let at = self.columns.take(3 * lanes);
        let (old, new) = self.columns.split_at_mut(at);
        for (component, out) in new.chunks_exact_mut(lanes.max(1)).enumerate() {
            fill(old, component, out);
        }
        Weight::Columns(at as u32)
    }

    /// A weight times a color of the tree.
    pub fn times(&mut self, tree: &Tree, weight: Weight, factor: [Floats; 3]) -> Weight {
        if let (Weight::Uniform(w), [Floats::Uniform(x), Floats::Uniform(y), Floats::Uniform(z)]) = (weight, factor) {
            return Weight::Uniform([w[0] * x, w[1] * y, w[2] * z]);
        }
        let n = tree.lanes;
        self.make(n, |old, c, out| multiply(operand(old, weight, c, n), Operand::of(tree, factor[c]), out))
    }

    /// The sum of two weights.
    pub fn plus(&mut self, lanes: usize, a: Weight, b: Weight) -> Weight {
        if let (Weight::Uniform(a), Weight::Uniform(b)) = (a, b) {
            return Weight::Uniform([a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        }
        self.make(lanes, |old, c, out| add(operand(old, a, c, lanes), operand(old, b, c, lanes), out))
    }

    /// The weight where a condition holds and zero elsewhere.
    pub fn masked(&mut self, lanes: usize, weight: Weight, keep: impl Fn(usize) -> bool) -> Weight {
        self.make(lanes, |old, c, out| {
            let weight = operand(old, weight, c, lanes);
            for (lane, out) in out.iter_mut().enumerate() {
                let value = match weight {
                    Operand::One(value) => value,
                    Operand::Many(values) => values[lane],
                };
                *out = if keep(lane) { value } else { 0.0 };
            }
        })
    }
}

fn operand(columns: &[f32], weight: Weight, component: usize, lanes: usize) -> Operand<'_> {
    match weight {
        Weight::Uniform(value) => Operand::One(value[component]),
        Weight::Columns(at) => Operand::Many(&columns[at as usize + component * lanes..][..lanes]),
    }
}

/// Runs a function over two operands.
#[inline(always)]
fn combine(a: Operand, b: Operand, out: &mut [f32], f: impl Fn(f32, f32) -> f32) {
    let n = out.len();
    match (a, b) {
        (Operand::One(a), Operand::One(b)) => out.fill(f(a, b)),
        (Operand::One(a), Operand::Many(b)) => {
            let b = &b[..n];
            for i in 0..n {
                out[i] = f(a, b[i]);
            }
        }
        (Operand::Many(a), Operand::One(b)) => {
            let a = &a[..n];
            for i in 0..n {
                out[i] = f(a[i], b);
            }
        }
        (Operand::Many(a), Operand::Many(b)) => {
            let (a, b) = (&a[..n], &b[..n]);
            for i in 0..n {
                out[i] = f(a[i], b[i]);
            }
        }
    }
}

lanes! {
    /// `out = a b`
    pub fn multiply(a: Operand<'_>, b: Operand<'_>, out: &mut [f32]) {
        combine(a, b, out, |a, b| a * b);
    }
}

lanes! {
    /// `out = a + b`
    fn add(a: Operand<'_>, b: Operand<'_>, out: &mut [f32]) {
        combine(a, b, out, |a, b| a + b);
    }
}

lanes! {
    /// Is every one a number of at most [`MOST_WEIGHT`], and is any not zero?
    pub fn usable_and_some(values: &[f32]) -> bool {
        const MOST: u32 = MOST_WEIGHT.to_bits();
        let (mut some, mut broken) = (0, 0);
        for value in values {
            // Words of positive floats are in the order of the floats, with infinity and what is no number last.
            let magnitude = value.to_bits() & 0x7fff_ffff;
            some |= magnitude;
            broken |= (magnitude > MOST) as u32;
        }
        some != 0 && broken == 0
    }
}

/// Is it a number of at most [`MOST_WEIGHT`]?
pub fn usable(weight: f32) -> bool {
    weight.abs() <= MOST_WEIGHT
}

lanes! {
    /// Is every one a finite number?
    pub fn all_finite(values: &[f32]) -> bool {
        values.iter().fold(0, |broken, value| broken | (value.to_bits() & 0x7fff_ffff >= 0x7f80_0000) as u32) == 0
    }
}

lanes! {
    /// Turns the albedo of a lobe into its share, and adds that to the total of all lobes: luminance of the weight's magnitude,
    /// albedo, and what the layers let through.
    pub fn share_lanes(weight: [&[f32]; 3], through: &[f32], least: f32, share: &mut [f32], total: &mut [f32]) {
        let n = share.len();
        let (x, y, z) = (&weight[0][..n], &weight[1][..n], &weight[2][..n]);
        let (through, total) = (&through[..n], &mut total[..n]);
        for i in 0..n {
            let luminance = 0.2126 * x[i].abs() + 0.7152 * y[i].abs() + 0.0722 * z[i].abs();
            share[i] = (luminance * share[i].max(least) * through[i]).min(1e30);
            total[i] += share[i];
        }
    }
}

lanes! {
    /// Shares of all lobes to probabilities; `last` is the last lobe that has any.
    pub fn normalise_lanes(lobe: u32, inverse: &[f32], share: &mut [f32], last: &mut [u32]) {
        let n = share.len();
        let (inverse, last) = (&inverse[..n], &mut last[..n]);
        for i in 0..n {
            share[i] *= inverse[i];
            last[i] = if share[i] > 0.0 { lobe } else { last[i] };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_weights_that_are_numbers_and_not_all_zero_pass() {
        let with = |last: f32| usable_and_some(&[0.0, -0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, last]);
        assert!(with(1e-45) && with(-3.0) && with(MOST_WEIGHT) && !with(f32::MAX) && !with(-1.001e18));
        assert!(!with(0.0) && !with(-0.0) && !with(f32::NAN) && !with(f32::INFINITY) && !with(-f32::INFINITY));
        assert!(!usable_and_some(&[1.0, f32::NAN]) && !usable_and_some(&[]));
        assert!(all_finite(&[0.0, 1.0, -f32::MAX]) && !all_finite(&[0.0, f32::NAN]) && !all_finite(&[f32::INFINITY]));
    }

    #[test]
    fn weights_combine_by_lane_and_component() {
        let mut tree = Tree::default();
        tree.clear(2);
        let column = tree.varying(&[2.0, 3.0]);
        let mut weights = Weights::default();
        let one = Weight::Uniform([1.0, 10.0, 100.0]);
        let scaled = weights.times(&tree, one, [column, Floats::Uniform(0.5), column]);
        let sum = weights.plus(2, scaled, one);
        let masked = weights.masked(2, sum, |lane| lane == 1);
        let all = |w| [0, 1, 2].map(|c| [weights.get(w, c, 0, 2), weights.get(w, c, 1, 2)]);
        assert_eq!(all(scaled), [[2.0, 3.0], [5.0, 5.0], [200.0, 300.0]]);
        assert_eq!(all(sum), [[3.0, 4.0], [15.0, 15.0], [300.0, 400.0]]);
        assert_eq!(all(masked), [[0.0, 4.0], [0.0, 15.0], [0.0, 400.0]]);
    }
}
