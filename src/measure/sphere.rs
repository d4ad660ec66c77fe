//! Integrals over the sphere of directions, of functions that may be narrow, have steps, or both.
//!
//! A chart turns the sphere into a rectangle. The rectangle is cut into cells at the medians of
//! a few samples, so that a lobe of any width is seen by many cells, and each cell is integrated by a rule that refines
//! itself until halving a patch changes nothing that matters.
//!
//! Decision (2026-11-22): the chart is even in the cube root of the cosine and has cuts at the viewer's own cosine, because in
//! the cosine itself a bend at a grazing viewer's cosine (Oren and Nayar's) fell between the nodes nearest to the horizon,
//! twice, and an albedo of 1.00000 was taken for 1.00071, with an error that looked small.

use crate::math::columns::Column3;
use crate::measure::patch::{Chart, Place};
use crate::measure::statistics::Random;
use glam::Vec3;
use std::f64::consts::PI;

/// How many directions are evaluated at once.
pub const LANES: usize = 128;

/// Nodes along each side of a patch, with their weights: Lobatto's rule of four points, exact to degree 5.
///
/// Its outer nodes lie on the edges of the patch, so that what reaches into it from a neighbour is seen. Gauss's inner ones
/// overlook slivers: 0.2 % of a rough refraction, behind the step where its facets end.
const RULE: [(f64, f64); NODES] =
    [(0.0, 1.0 / 12.0), (0.276_393_202_250_021, 5.0 / 12.0), (0.723_606_797_749_979, 5.0 / 12.0), (1.0, 1.0 / 12.0)];
const NODES: usize = 4;

/// What the nodes of a line count in the third difference: 0 for a parabola, 1 to 1.24 for a step of 1 between two of them.
const THIRD: [f64; NODES] = [-1.0, 2.236_067_977_499_79, -2.236_067_977_499_79, 1.0];

/// A patch that bends along one axis by less than this part of what it bends along the other is halved across the other only.
///
/// A step at one height, such as a refraction has where its facets end, would otherwise take as many patches as fit along it
/// before their share of the error is small, all of which err in the same direction.
const SMOOTH: f64 = 0.1;

/// By how many tolerances a line of a quarter may bend along the axis that is not halved: the rule, which is exact for
/// bends of the third and the two next degrees, errs by a small part of that, and no later round looks at it again.
const FLAT: f64 = 10.0;

const POINTS: usize = NODES * NODES;
const PATCHES: usize = LANES / POINTS;

/// Patches with more samples are refined whatever the rule says.
const FEW: usize = 8;

/// A refinement ends here: each side of a cell that is refined is then a thousandth of its first length.
const DEEPEST: u32 = 10;

/// A rectangle of the chart with the samples that fell into it.
#[derive(Clone, Debug)]
struct Patch {
    low: Place,
    high: Place,
    samples: Vec<Sample>,
}

/// A sample on the chart, with the value of the first function there.
#[derive(Clone, Copy, Debug)]
struct Sample {
    at: Place,
    value: f64,
}

impl Patch {
    /// Does an integral of the first function pass over what one of the samples knows of it?
    ///
    /// An edge of the function may hide all of it from the nodes of a rule, and from those of its quarters.
    fn overlooked(&self, integral: f64, tolerance: f64) -> bool {
        let cubed = |k: f64| (1.0 - k).powi(3);
        let solid_angle = (cubed(self.low[0]) - cubed(self.high[0])) * (self.high[1] - self.low[1]);
        self.samples.iter().any(|sample| sample.value * solid_angle > 2.0 * integral + 2.0 * tolerance)
    }

    /// Where to halve it along an axis: the samples' median if there are enough, and never on an edge.
    fn middle(&mut self, axis: usize) -> f64 {
        let (low, high) = (self.low[axis], self.high[axis]);
        let half = 0.5 * (low + high);
        if self.samples.len() < 2 {
            return half;
        }
        let at = self.samples.len() / 2;
        let (_, median, _) = self.samples.select_nth_unstable_by(at, |a, b| a.at[axis].total_cmp(&b.at[axis]));
        let median = median.at[axis];
        if median > low && median < high { median } else { half }
    }

    /// The middle, but not next to an edge: what is left would be the same patch again, and confirm any mistake.
    fn inner(&mut self, axis: usize) -> f64 {
        let margin = 0.1 * (self.high[axis] - self.low[axis]);
        self.middle(axis).clamp(self.low[axis] + margin, self.high[axis] - margin)
    }

    fn halve(mut self, axis: usize, at: f64) -> [Patch; 2] {
        let (low, high): (Vec<Sample>, Vec<Sample>) = self.samples.drain(..).partition(|s| s.at[axis] < at);
        let mut below = Patch { samples: low, ..self };
        let mut above = Patch { low: below.low, high: below.high, samples: high };
        below.high[axis] = at;
        above.low[axis] = at;
        [below, above]
    }

    /// Halves it along an axis, and both halves along the other.
    fn quarter(mut self, axis: usize) -> [Patch; 4] {
        let at = self.inner(axis);
        let [mut a, mut b] = self.halve(axis, at);
        let (at_a, at_b) = (a.inner(1 - axis), b.inner(1 - axis));
        let ([a, b], [c, d]) = (a.halve(1 - axis, at_a), b.halve(1 - axis, at_b));
        [a, b, c, d]
    }

    /// What two halves were.
    fn joined(mut self, above: Patch) -> Patch {
        self.high = above.high;
        self.samples.extend(above.samples);
        self
    }

    /// The axis along which its samples reach farther, as angles.
    fn longer_axis(&self) -> usize {
        let angle = |across: f64| (1.0 - across).powi(3).clamp(-1.0, 1.0).acos();
        let (mut low, mut high, mut sin) = ([f64::MAX; 2], [f64::MIN; 2], 0.0);
        for sample in &self.samples {
            let here = [angle(sample.at[0]), sample.at[1]];
            for axis in 0..2 {
                low[axis] = low[axis].min(here[axis]);
                high[axis] = high[axis].max(here[axis]);
            }
            sin += here[0].sin() / self.samples.len() as f64;
        }
        usize::from((high[1] - low[1]) * sin > high[0] - low[0])
    }
}

/// A node of the tree that finds the cell of a place.
#[derive(Clone, Copy, Debug)]
enum Cut {
    At { axis: usize, at: f64, children: [u32; 2] },
    Cell(u32),
}

/// A partition of the sphere into cells that are small where samples are dense.
#[derive(Clone, Debug)]
pub struct Cells {
    chart: Chart,
    patches: Vec<Patch>,
    cuts: Vec<Cut>,
}

impl Cells {
    /// Cells of about equally many samples, and some where there are none. No cell straddles the horizon.
    ///
    /// A sample is a direction with the value of the first function that will be integrated, or 0 if that is not known.
    pub fn new(chart: Chart, samples: impl Iterator<Item = (Vec3, f64)>, count: usize, random: &mut Random) -> Self {
        let mut places: Vec<Sample> = samples.map(|(w, value)| Sample { at: chart.place(w), value }).collect();
        // Directions of any kind keep an eye on where the sampler never goes.
        for _ in 0..(places.len() / 8).max(64) {
            let at = [2.0 * f64::from(random.number()), PI * (2.0 * f64::from(random.number()) - 1.0)];
            places.push(Sample { at, value: 0.0 });
        }
        let target = (places.len() / count.max(1)).max(2);
        let mut cells = Cells { chart, patches: Vec::new(), cuts: Vec::new() };
        let whole = Patch { low: [0.0, -PI], high: [2.0, PI], samples: places };
        let edges = [chart.viewer, 1.0, 2.0 - chart.viewer];
        cells.slabs(whole, &edges, target);
        cells
    }

    /// Cuts a patch across at all edges, and divides what lies between.
    fn slabs(&mut self, patch: Patch, edges: &[f64], target: usize) -> u32 {
        let [at, rest @ ..] = edges else { return self.divide(patch, target, 0) };
        if *at <= patch.low[0] + 1e-9 || *at >= patch.high[0] - 1e-9 {
            return self.slabs(patch, rest, target);
        }
        let index = self.cuts.len() as u32;
        self.cuts.push(Cut::Cell(0));
        let [low, high] = patch.halve(0, *at);
        let children = [self.divide(low, target, 0), self.slabs(high, rest, target)];
        self.cuts[index as usize] = Cut::At { axis: 0, at: *at, children };
        index
    }

    fn divide(&mut self, mut patch: Patch, target: usize, depth: u32) -> u32 {
        let index = self.cuts.len() as u32;
        self.cuts.push(Cut::Cell(self.patches.len() as u32));
        if patch.samples.len() < 2 * target || depth > 24 {
            self.patches.push(patch);
            return index;
        }
        let axis = patch.longer_axis();
        let at = patch.middle(axis);
        let children = patch.halve(axis, at).map(|half| self.divide(half, target, depth + 1));
        self.cuts[index as usize] = Cut::At { axis, at, children };
        index
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// True when there is no cell, which never happens.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The cell of a unit direction.
    pub fn find(&self, w: Vec3) -> usize {
        let place = self.chart.place(w);
        let mut node = 0;
        loop {
            match self.cuts[node as usize] {
                Cut::At { axis, at, children } => node = children[usize::from(place[axis] >= at)],
                Cut::Cell(cell) => return cell as usize,
            }
        }
    }

    /// The integrals of a function over every cell.
    ///
    /// `evaluate` gives the four values of the function at each of [`LANES`] directions. A patch is refined until its
    /// quarters differ from it by less than `tolerance` in every value; `most` limits the number of directions.
    pub fn integrate(
        &self,
        tolerance: [f64; 4],
        most: usize,
        mut evaluate: impl FnMut(&Column3, &mut [[f64; 4]]),
    ) -> Integrals {
        let mut out = Integrals::new(self.len());
        let mut rule = Rule::new(self.chart, tolerance);
        let mut open: Vec<(Patch, usize)> = self.patches.iter().cloned().zip(0..).collect();
        let (mut squares, mut drift) = ([0.0; 4], [0.0; 4]);
        let mut before = rule.apply(open.iter().map(|(patch, _)| patch), &mut evaluate);
        for depth in 0..=DEEPEST {
            let mut quarters = Vec::with_capacity(4 * open.len());
            for ((patch, cell), axis) in open.into_iter().zip(before.iter().map(Estimate::rougher)) {
                quarters.extend(patch.quarter(axis).map(|quarter| (quarter, cell)));
            }
            let values = rule.apply(quarters.iter().map(|(patch, _)| patch), &mut evaluate);
            out.directions += LANES * quarters.len().div_ceil(PATCHES);
            let last = depth == DEEPEST || out.directions > most;
            let (mut next, mut kept) = (Vec::new(), Vec::new());
            let mut quarters = quarters.into_iter();
            for (parts, whole) in values.chunks(4).zip(&before) {
                let mine: Vec<(Patch, usize)> = quarters.by_ref().take(4).collect();
                let sum: [f64; 4] = std::array::from_fn(|k| parts.iter().map(|part| part.sum[k]).sum());
                let change: [f64; 4] = std::array::from_fn(|k| sum[k] - whole.sum[k]);
                if !last && unsettled(&mine, parts, change, tolerance) {
                    let (patches, estimates) = kept_apart(mine, parts, whole.rougher());
                    next.extend(patches);
                    kept.extend(estimates);
                    continue;
                }
                let cell = mine[0].1;
                out.cell_errors[cell] += change[0].abs();
                for k in 0..4 {
                    out.cells[cell][k] += sum[k];
                    squares[k] += change[k] * change[k];
                    drift[k] += change[k];
                }
            }
            (open, before) = (next, kept);
            if open.is_empty() {
                break;
            }
        }
        // Changes of either sign cancel; those of one sign add up, and what is still to come may be as much.
        for k in 0..4 {
            out.error[k] = 2.0 * (squares[k].sqrt() + drift[k].abs());
        }
        out
    }
}

/// Do the quarters of a patch need another round?
fn unsettled(quarters: &[(Patch, usize)], values: &[Estimate], change: [f64; 4], tolerance: [f64; 4]) -> bool {
    let changes = (0..4).any(|k| change[k].abs() > tolerance[k]);
    changes
        || quarters
            .iter()
            .zip(values)
            .any(|((quarter, _), value)| quarter.samples.len() > FEW || quarter.overlooked(value.sum[0], tolerance[0]))
}

/// The quarters of a patch, or only its halves along an axis if next to nothing happens along the other.
fn kept_apart(quarters: Vec<(Patch, usize)>, values: &[Estimate], axis: usize) -> (Vec<(Patch, usize)>, Vec<Estimate>) {
    let bend = |axis: usize| values.iter().map(|value| value.bend[axis]).sum::<f64>();
    let flat = FLAT * (NODES * values.len()) as f64;
    if bend(1 - axis) >= (SMOOTH * bend(axis)).min(flat) {
        return (quarters, values.to_vec());
    }
    let mut quarters = quarters.into_iter();
    let halves = std::iter::from_fn(|| {
        let ((below, cell), (above, _)) = (quarters.next()?, quarters.next()?);
        Some((below.joined(above), cell))
    });
    (halves.collect(), values.chunks(2).map(|pair| pair[0].joined(&pair[1])).collect())
}

/// What the rule makes of a patch.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    /// The integrals of the four functions.
    sum: [f64; 4],
    /// How much the functions depart from parabolas along either axis, in tolerances.
    bend: [f64; 2],
}

impl Estimate {
    /// The axis along which the functions are farther from what the rule can integrate.
    fn rougher(&self) -> usize {
        usize::from(self.bend[1] > self.bend[0])
    }

    fn joined(&self, above: &Estimate) -> Estimate {
        Estimate {
            sum: std::array::from_fn(|k| self.sum[k] + above.sum[k]),
            bend: std::array::from_fn(|axis| self.bend[axis] + above.bend[axis]),
        }
    }
}

/// What [`Cells::integrate`] gives.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// The four integrals over each cell.
    pub cells: Vec<[f64; 4]>,
    /// The most that the first integral of each cell may be wrong by.
    pub cell_errors: Vec<f64>,
    /// About how much the sums over all cells are wrong by.
    pub error: [f64; 4],
    /// How many directions were evaluated.
    pub directions: usize,
}

impl Integrals {
    fn new(cells: usize) -> Self {
        Integrals { cells: vec![[0.0; 4]; cells], cell_errors: vec![0.0; cells], error: [0.0; 4], directions: 0 }
    }

    /// The integrals over the sphere.
    pub fn total(&self) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for cell in &self.cells {
            for (s, v) in sum.iter_mut().zip(cell) {
                *s += v;
            }
        }
        sum
    }
}

/// The rule on patches, many patches at a time.
struct Rule {
    chart: Chart,
    tolerance: [f64; 4],
    directions: Column3,
    densities: Vec<f64>,
    values: Vec<[f64; 4]>,
}

impl Rule {
    fn new(chart: Chart, tolerance: [f64; 4]) -> Self {
        let directions = Column3::splat(Vec3::Z, LANES);
        Rule { chart, tolerance, directions, densities: vec![0.0; LANES], values: vec![[0.0; 4]; LANES] }
    }

    fn apply<'p>(
        &mut self,
        patches: impl Iterator<Item = &'p Patch>,
        evaluate: &mut impl FnMut(&Column3, &mut [[f64; 4]]),
    ) -> Vec<Estimate> {
        let mut out = Vec::new();
        let mut areas = Vec::with_capacity(PATCHES);
        for patch in patches {
            let first = POINTS * areas.len();
            let at = |axis: usize, k: usize| patch.low[axis] + RULE[k].0 * (patch.high[axis] - patch.low[axis]);
            for k in 0..POINTS {
                let place = [at(0, k / NODES), at(1, k % NODES)];
                self.densities[first + k] = Chart::density(place);
                self.directions.set(first + k, self.chart.direction(place));
            }
            areas.push((patch.high[0] - patch.low[0]) * (patch.high[1] - patch.low[1]));
            if areas.len() == PATCHES {
                self.flush(&mut areas, &mut out, evaluate);
            }
        }
        if !areas.is_empty() {
            self.flush(&mut areas, &mut out, evaluate);
        }
        out
    }

    fn flush(
        &mut self,
        areas: &mut Vec<f64>,
        out: &mut Vec<Estimate>,
        evaluate: &mut impl FnMut(&Column3, &mut [[f64; 4]]),
    ) {
        evaluate(&self.directions, &mut self.values);
        let nodes = self.values.chunks(POINTS).zip(self.densities.chunks(POINTS));
        for ((values, densities), area) in nodes.zip(areas.drain(..)) {
            let nodes: [[f64; 4]; POINTS] = std::array::from_fn(|k| values[k].map(|v| v * area * densities[k]));
            let mut sum = [0.0; 4];
            for (k, node) in nodes.iter().enumerate() {
                let weight = RULE[k / NODES].1 * RULE[k % NODES].1;
                for (s, v) in sum.iter_mut().zip(node) {
                    *s += weight * v;
                }
            }
            out.push(Estimate { sum, bend: [self.bend(&nodes, NODES, 1), self.bend(&nodes, 1, NODES)] });
        }
    }

    /// Third differences along lines of nodes that lie `step` apart, the lines `line` apart.
    fn bend(&self, nodes: &[[f64; 4]; POINTS], step: usize, line: usize) -> f64 {
        let along = |k: usize, line: usize| -> f64 {
            (0..NODES).map(|i| THIRD[i] * nodes[i * step + line][k]).sum::<f64>().abs() / self.tolerance[k]
        };
        (0..NODES).map(|l| (0..4).map(|k| along(k, l * line)).fold(0.0, f64::max)).sum()
    }
}

#[cfg(test)]
mod tests;
