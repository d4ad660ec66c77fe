//! Diffuse lobes that lean toward the viewer or away: what the scale of lossless layers over them is corrected by.
//!
//! Over a Lambertian lobe the scale T(i) T(o) / mean T loses nothing (see [`super::lossless`]). Over another diffuse lobe it
//! comes out as 1 + e(o) of what it should, |e| up to half a per cent: e is the difference between the mean of T weighted by
//! the lobe and that weighted by the cosine. With h = 1 / (1 + e), the scale h(i) h(o) T(i) T(o) / mean T, over the mean of h
//! weighted by T, is reciprocal again and right up to the square of e and to how little the lobe leans.
//!
//! Source: the first step of Sinkhorn's scaling (Sinkhorn 1967), started from Kelemen's rule.
//!
//! Decision (2026-11-29): integrated for each lane over eight cosines, because the lobes' azimuthal means are a few operations,
//! instead of a table for each pair of top and base, or of leaving such bases a per cent less, lest they gain.

use super::lobe_models::{LobeModel, LobeModels};
use super::store::NONE;
use crate::math::quadrature::cosine_means;

/// The corrections of a batch.
#[derive(Debug, Default)]
pub struct Leanings {
    /// Where the columns of each lobe begin, or [`NONE`].
    starts: Vec<u32>,
    /// For each such lobe, three columns: h toward the viewer over the mean of h.
    seen: Vec<f32>,
    /// What lossless layers let through at the nodes: for each node, three columns a layer.
    passed_at: Vec<f32>,
    albedo: Vec<f32>,
    turned: Vec<f32>,
    toward: Vec<f32>,
    cos: Vec<f32>,
}

/// The lossless layer that a lobe lies under, and what it and those around it let through on the mean, three columns.
#[derive(Clone, Copy)]
pub struct Cover<'a> {
    /// The layer's number.
    pub layer: usize,
    /// How many there are.
    pub layers: usize,
    /// The mean.
    pub mean: &'a [f32],
}

impl Leanings {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.starts.clear();
        self.seen.clear();
        self.passed_at.clear();
    }

    /// Takes what the layers let through at the next node, three columns each.
    pub fn add_node(&mut self, passed: &[f32]) {
        self.passed_at.extend_from_slice(passed);
    }

    /// Prepares lobe number `lobe`.
    pub fn prepare(&mut self, models: &LobeModels, lobe: usize, model: &LobeModel, cover: Cover) {
        let n = models.lanes;
        let Some(frame) = models.frame_of(model) else { return };
        self.starts.resize(lobe + 1, NONE);
        self.starts[lobe] = self.seen.len() as u32;
        let mut mean = vec![0.0; 3 * n];
        for (node, (cos, weight)) in cosine_means().enumerate() {
            self.cos.clear();
            self.cos.resize(n, cos);
            let cos = std::mem::take(&mut self.cos);
            self.correct(models, model, &cos, cover);
            self.cos = cos;
            let passed = columns_at(&self.passed_at, node, cover, n);
            for (mean, (h, passed)) in mean.iter_mut().zip(self.toward.iter().zip(passed)) {
                *mean += weight * h * passed;
            }
        }
        self.correct(models, model, &frame.wo.z, cover);
        let scaled = self.toward.iter().zip(mean).zip(cover.mean);
        self.seen.extend(scaled.map(|((h, mean), passed)| if mean > 0.0 { h * passed / mean } else { 1.0 }));
    }

    /// Multiplies the three columns of a lobe's weight by what corrects them toward the light in its frame.
    pub fn apply(&mut self, models: &LobeModels, lobe: usize, model: &LobeModel, cover: Cover, out: &mut [f32]) {
        let start = self.starts.get(lobe).copied().unwrap_or(NONE);
        let (Some(frame), true) = (models.frame_of(model), start != NONE) else { return };
        self.correct(models, model, &frame.wi.z, cover);
        for ((out, h_i), h_o) in out.iter_mut().zip(&self.toward).zip(&self.seen[start as usize..]) {
            *out *= h_i * h_o;
        }
    }

    /// h toward the directions of these cosines, three columns.
    fn correct(&mut self, models: &LobeModels, model: &LobeModel, cos: &[f32], cover: Cover) {
        let n = models.lanes;
        self.toward.clear();
        self.toward.resize(3 * n, 0.0);
        let Some(loops) = model.kind.loops() else { return self.toward.fill(1.0) };
        self.albedo.clear();
        self.albedo.resize(n, 0.0);
        self.turned.resize(n, 0.0);
        for (node, (at, weight)) in cosine_means().enumerate() {
            (loops.turned)(models.numbers(model), model.choice, at, cos, &mut self.turned);
            self.turned.iter_mut().for_each(|f| *f *= weight);
            self.albedo.iter_mut().zip(&self.turned).for_each(|(sum, f)| *sum += f);
            let passed = columns_at(&self.passed_at, node, cover, n);
            for (sums, passed) in self.toward.chunks_exact_mut(n).zip(passed.chunks_exact(n)) {
                for ((sum, f), passed) in sums.iter_mut().zip(&self.turned).zip(passed) {
                    *sum += f * passed;
                }
            }
        }
        for (sums, means) in self.toward.chunks_exact_mut(n).zip(cover.mean.chunks_exact(n)) {
            for ((h, albedo), mean) in sums.iter_mut().zip(&self.albedo).zip(means) {
                let right = albedo * mean / h.max(1e-20);
                // A top that lets nearly nothing through may lean on a single direction.
                *h = if right.is_finite() { right.clamp(0.5, 2.0) } else { 1.0 };
            }
        }
    }
}

fn columns_at<'a>(passed_at: &'a [f32], node: usize, cover: Cover, n: usize) -> &'a [f32] {
    let start = 3 * n * (node * cover.layers + cover.layer);
    &passed_at[start..start + 3 * n]
}
