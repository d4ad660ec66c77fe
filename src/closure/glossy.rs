//! Rough lobes under layers without loss: how much more than the smaller T they may be left.
//!
//! The scale min(T(i), T(o)) is reciprocal and safe over everything. Of T(w) it leaves the lobe m(w), the mean of
//! min(T(i), T(w)) / T(w) over the light that the lobe sends to w. Divided by (m(i) m(o))^3/4 it leaves n(w), which is nearly the
//! same for all w, and divided by the larger of n(i) and n(o) again it is safe again. The means are sums over the few cosines
//! that stand for a lobe's light ([`crate::bsdf::Scatter::arrivals`]).
//!
//! The exponent: 1/2 would be right for a lobe so narrow that m(i) = m(o), 1 for one whose light comes from everywhere. Over
//! facets of width .3 the minimum alone loses 8.6 %, divided by the larger m twice 2 %, and so less than one per cent.

use super::lobe_models::{LobeModel, LobeModels};
use super::store::NONE;
use crate::bsdf::ARRIVALS;

/// What the lobes of a batch are left, and scratch to compute it.
#[derive(Debug, Default)]
pub struct Glossy {
    /// Where the columns of each lobe begin, or [`NONE`].
    starts: Vec<u32>,
    /// For each such lobe, three columns of m toward the viewer and three of n.
    seen: Vec<f32>,
    /// Light that leaves in the direction in question, and that leaves where the former arrives.
    light: [Arriving; 2],
    /// m and n toward the direction in question.
    left: [Vec<f32>; 2],
    /// m toward the cosines at which the former arrives.
    left_there: [Vec<f32>; ARRIVALS],
}

/// The light that leaves at some cosines.
#[derive(Debug, Default)]
struct Arriving {
    /// The cosines at which it arrives.
    at: [Vec<f32>; ARRIVALS],
    /// The parts that they stand for.
    parts: [Vec<f32>; ARRIVALS],
    /// What the layers let through toward those, over what they let through toward the cosines it leaves to, at most 1.
    passed: [Vec<f32>; ARRIVALS],
    /// The latter.
    here: Vec<f32>,
}

/// No lobe is left less, lest numbers run away.
const LEAST: f32 = 0.05;

/// Fills three columns with what the layers over a lobe let through at a cosine a lane.
pub type Passed<'a> = &'a mut dyn FnMut(&[f32], &mut [f32]);

impl Glossy {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.starts.clear();
        self.seen.clear();
    }

    /// Prepares lobe number `lobe`.
    pub fn prepare(&mut self, models: &LobeModels, lobe: usize, model: &LobeModel, passed: Passed) {
        let Some(frame) = models.frame_of(model) else { return };
        self.starts.resize(lobe + 1, NONE);
        self.starts[lobe] = self.seen.len() as u32;
        self.find_left(models, model, &frame.wo.z, passed);
        self.left.iter().for_each(|columns| self.seen.extend_from_slice(columns));
    }

    /// Divides the three columns of a lobe's weight by what it is left, for the light in its frame.
    pub fn apply(&mut self, models: &LobeModels, lobe: usize, model: &LobeModel, passed: Passed, out: &mut [f32]) {
        let start = self.starts.get(lobe).copied().unwrap_or(NONE);
        let (Some(frame), true) = (models.frame_of(model), start != NONE) else { return };
        self.find_left(models, model, &frame.wi.z, passed);
        let (seen_m, seen_n) = self.seen[start as usize..start as usize + 2 * out.len()].split_at(out.len());
        let [m, n] = &self.left;
        for (i, out) in out.iter_mut().enumerate() {
            *out *= lifted(m[i] * seen_m[i]) / n[i].max(seen_n[i]);
        }
    }

    /// m and n toward the directions of these cosines, three columns each.
    fn find_left(&mut self, models: &LobeModels, model: &LobeModel, cos: &[f32], passed: Passed) {
        let Glossy { light: [near, far], left: [m, n], left_there, .. } = self;
        near.find(models, model, cos, passed);
        near.left(m);
        for (at, left) in near.at.iter().zip(left_there.iter_mut()) {
            far.find(models, model, at, passed);
            far.left(left);
        }
        let lanes = cos.len();
        n.clear();
        n.extend((0..3 * lanes).map(|i| {
            let part = |k: usize| near.parts[k][i % lanes] * near.passed[k][i] * lifted(m[i] * left_there[k][i]);
            (0..ARRIVALS).map(part).sum::<f32>().clamp(LEAST, 1.0 / LEAST)
        }));
    }
}

/// What a product of two m is divided by, turned over.
#[inline(always)]
fn lifted(product: f32) -> f32 {
    let root = product.sqrt();
    1.0 / (root * root.sqrt())
}

impl Arriving {
    /// Finds it for light that leaves toward these cosines.
    fn find(&mut self, models: &LobeModels, model: &LobeModel, cos: &[f32], passed: Passed) {
        let n = cos.len();
        let Arriving { at, parts, passed: over, here } = self;
        for columns in [&mut *at, &mut *parts] {
            columns.iter_mut().for_each(|column| column.resize(n, 0.0));
        }
        if let Some(arrivals) = model.kind.loops().and_then(|loops| loops.arrivals) {
            let columns = (at.each_mut().map(Vec::as_mut_slice), parts.each_mut().map(Vec::as_mut_slice));
            arrivals(models.numbers(model), model.choice, cos, columns.0, columns.1);
        }
        here.resize(3 * n, 0.0);
        passed(cos, here);
        for (at, over) in at.iter().zip(over) {
            over.resize(3 * n, 0.0);
            passed(at, over);
            over.iter_mut().zip(here.iter()).for_each(|(t, here)| *t = (*t / here.max(1e-6)).clamp(0.0, 1.0));
        }
    }

    /// What the smaller T leaves, three columns.
    fn left(&self, out: &mut Vec<f32>) {
        let n = self.at[0].len();
        out.clear();
        out.extend((0..3 * n).map(|i| {
            let lost: f32 = self.passed.iter().zip(&self.parts).map(|(t, parts)| parts[i % n] * (1.0 - t[i])).sum();
            (1.0 - lost).clamp(LEAST, 1.0)
        }));
    }
}
