//! Layering without loss: a scale for each lobe of the base and each color.
//!
//! What a layer lets through is T(w) = 1 - t a(w), t the tint in one color. A reciprocal scale k(i, o) of a lobe f loses nothing
//! when the integral of k f cos is T(o) times the lobe's albedo. Over a Lambertian or translucent lobe that is k = T(i) T(o) over
//! the mean of T (Kelemen and Szirmay-Kalos 2001), and so it is nearly over the other diffuse models ([`super::leaning`] has the
//! difference); over a mirror it is the T of both directions, which are alike, and min(T(i), T(o)) is that there and safe
//! over everything else; reflecting facets are left more than that ([`super::glossy`]). Layers around each other multiply, and of
//! a diffuse lobe the mean is that of their product. Where the base has another normal than a top, the means are not those of
//! the base's light, and the smaller T is taken.

use super::batch::MOST_SCALE;
use super::flat::Lobe;
use super::layering::{Layer, Layers, Top, Toward, kept, model_albedo, top_albedo};
use super::leaning::Cover;
use super::lobe_models::{LobeModel, LobeModels, Values};
use super::store::NONE;
use crate::math::quadrature::cosine_means;
use glam::Vec3;

impl Layers {
    /// The innermost lossless layer at or around one.
    fn lossless_from(&self, mut layer: u32) -> Option<u32> {
        while let Some(at) = self.list.get(layer as usize) {
            if at.lossless() {
                return Some(layer);
            }
            layer = at.parent;
        }
        None
    }

    /// Is a lobe under this layer scaled by itself and by color?
    pub fn scales_by_lobe(&self, layer: u32) -> bool {
        self.by_lobe && self.lossless_from(layer).is_some()
    }

    /// Computes the means that lossless layers divide by, and what corrects the lobes under them that lean or are rough.
    pub fn prepare_lossless(&mut self, models: &LobeModels, lobes: &[Lobe]) {
        if !self.by_lobe {
            return;
        }
        self.leanings.clear();
        self.glossy.clear();
        self.find_tilted(models, lobes);
        let model_of = |lobe: &Lobe| models.list[lobe.model as usize];
        let leaning = |lobe: &Lobe| model_of(lobe).kind.leans() && self.lossless_from(lobe.layer).is_some();
        let leans = lobes.iter().any(leaning);
        let n = models.lanes;
        self.passed.clear();
        self.passed.resize(3 * n * self.list.len(), 0.0);
        let alone = |layer: &Layer| layer.lossless() && self.lossless_from(layer.parent).is_none();
        let simple: Vec<bool> =
            self.list.iter().map(|layer| alone(layer) && matches!(layer.top, Top::Lobe(_))).collect();
        for index in (0..self.list.len()).filter(|&index| simple[index]) {
            self.pass_alone(models, index);
        }
        if leans || self.list.iter().zip(&simple).any(|(layer, simple)| layer.lossless() && !simple) {
            for (cos, weight) in cosine_means() {
                let products = self.add_passed(models, &simple, cos, weight);
                if leans {
                    self.leanings.add_node(&products);
                }
            }
        }
        let mut leanings = std::mem::take(&mut self.leanings);
        for (index, lobe) in lobes.iter().enumerate().filter(|(_, lobe)| model_of(lobe).kind.leans()) {
            if let Some(cover) = self.cover(lobe.layer, n) {
                leanings.prepare(models, index, &model_of(lobe), cover);
            }
        }
        self.leanings = leanings;
        let mut glossy = std::mem::take(&mut self.glossy);
        for (index, lobe) in lobes.iter().enumerate().filter(|(_, lobe)| model_of(lobe).kind.is_rough()) {
            if self.lossless_from(lobe.layer).is_some() {
                let mut passed = |cos: &[f32], out: &mut [f32]| self.passed_toward(models, lobe.layer, cos, out);
                glossy.prepare(models, index, &model_of(lobe), &mut passed);
            }
        }
        self.glossy = glossy;
    }

    /// What the lossless layers at and around one let through at a cosine a lane, three columns.
    fn passed_toward(&mut self, models: &LobeModels, layer: u32, cos: &[f32], out: &mut [f32]) {
        let n = models.lanes;
        if !self.steps.is_empty() {
            self.run_steps(models, Toward::At(cos));
        }
        out.fill(1.0);
        let mut at = self.lossless_from(layer);
        while let Some(index) = at {
            let here = self.list[index as usize];
            let curves = kept(&self.curves, self.curves_at[index as usize]);
            top_albedo(&here, curves, models, Toward::At(cos), &self.values, &mut self.scratch);
            for (out, tint) in out.chunks_exact_mut(n).zip(here.tints) {
                for ((out, tint), albedo) in out.iter_mut().zip(models.column(tint)).zip(&self.scratch) {
                    *out *= (1.0 - tint * albedo).clamp(0.0, 1.0);
                }
            }
            at = self.lossless_from(here.parent);
        }
    }

    /// Finds the lanes in which a lobe has another normal than one of the lossless tops over it.
    fn find_tilted(&mut self, models: &LobeModels, lobes: &[Lobe]) {
        let n = models.lanes;
        self.tilted_at.clear();
        self.tilted.clear();
        for lobe in lobes {
            let start = self.tilted.len();
            self.tilted_at.push(NONE);
            let Some(frame) = models.frame_of(&models.list[lobe.model as usize]) else { continue };
            let mut at = self.lossless_from(lobe.layer);
            let mut tops = Vec::new();
            while let Some(index) = at {
                let layer = self.list[index as usize];
                match layer.top {
                    Top::Lobe(top) => tops.push(top),
                    // Of trees the leaves are not told apart.
                    Top::Tree(_) => tops.extend(self.leaves.iter().map(|(model, _)| *model)),
                    Top::Boundary => {}
                }
                at = self.lossless_from(layer.parent);
            }
            tops.sort_unstable();
            tops.dedup();
            let frames = tops.iter().filter_map(|top| models.frame_of(&models.list[*top as usize]));
            for top in frames.filter(|top| top.normal != frame.normal) {
                self.tilted.resize(start + n, false);
                for (lane, tilted) in self.tilted[start..].iter_mut().enumerate() {
                    *tilted |= top.normal.get(lane).dot(frame.normal.get(lane)) < 1.0 - 1e-5;
                }
            }
            if let Some(last) = self.tilted_at.last_mut().filter(|_| self.tilted.len() > start) {
                *last = start as u32;
            }
        }
    }

    /// What covers a lobe under this layer without loss.
    fn cover(&self, layer: u32, n: usize) -> Option<Cover<'_>> {
        let layer = self.lossless_from(layer)? as usize;
        Some(Cover { layer, layers: self.list.len(), mean: &self.passed[3 * layer * n..3 * (layer + 1) * n] })
    }

    /// The mean of what one lobe lets through by itself.
    fn pass_alone(&mut self, models: &LobeModels, index: usize) {
        let n = models.lanes;
        let layer = self.list[index];
        let Top::Lobe(top) = layer.top else { return };
        mean_albedo(models, &models.list[top as usize], &mut self.scratch);
        for (c, tint) in layer.tints.into_iter().enumerate() {
            let tint = models.column(tint);
            let out = &mut self.passed[(3 * index + c) * n..(3 * index + c + 1) * n];
            for i in 0..n {
                out[i] = 1.0 - tint[i] * self.scratch[i];
            }
        }
    }

    /// Adds one cosine to the means of the products of lossless layers in each other, and of those whose top is a tree.
    ///
    /// Gives what each lossless layer and those around it let through there, three columns a layer.
    fn add_passed(&mut self, models: &LobeModels, simple: &[bool], cos: f32, weight: f32) -> Vec<f32> {
        let n = models.lanes;
        if !self.steps.is_empty() {
            self.run_steps(models, Toward::Fixed(cos));
        }
        let mut products = vec![1.0; 3 * n * self.list.len()];
        for index in 0..self.list.len() {
            let layer = self.list[index];
            if !layer.lossless() {
                continue;
            }
            top_albedo(&layer, None, models, Toward::Fixed(cos), &self.values, &mut self.scratch);
            let outer = self.lossless_from(layer.parent).map(|outer| outer as usize);
            for (c, tint) in layer.tints.into_iter().enumerate() {
                let tint = models.column(tint);
                for i in 0..n {
                    let around = outer.map_or(1.0, |outer| products[(3 * outer + c) * n + i]);
                    let product = around * (1.0 - tint[i] * self.scratch[i]).clamp(0.0, 1.0);
                    products[(3 * index + c) * n + i] = product;
                    self.passed[(3 * index + c) * n + i] += if simple[index] { 0.0 } else { weight * product };
                }
            }
        }
        products
    }

    /// Multiplies the three columns of a lobe's weight by what all layers over it let through for the light of the last
    /// evaluation.
    pub fn scale_lobe(&mut self, models: &LobeModels, index: usize, lobe: Lobe, weight: &[f32], out: &mut Vec<f32>) {
        let (layer, model) = (lobe.layer, &models.list[lobe.model as usize]);
        let (n, diffuse) = (models.lanes, model.kind.is_even());
        out.clear();
        out.extend_from_slice(&weight[..3 * n]);
        let innermost = self.lossless_from(layer);
        let mut at = layer;
        while let Some(here) = self.list.get(at as usize) {
            let index = at as usize;
            if here.lossless() {
                let mean = if diffuse && innermost == Some(at) { Some(&self.passed[3 * index * n..]) } else { None };
                self.scale_lossless(models, index, diffuse, mean, out);
            } else {
                self.scale_plain(index, n, out);
            }
            at = here.parent;
        }
        if model.kind.is_rough() {
            let mut glossy = std::mem::take(&mut self.glossy);
            let mut passed = |cos: &[f32], out: &mut [f32]| self.passed_toward(models, layer, cos, out);
            glossy.apply(models, index, model, &mut passed, out);
            self.glossy = glossy;
        }
        if model.kind.leans() {
            let mut leanings = std::mem::take(&mut self.leanings);
            if let Some(cover) = self.cover(layer, n) {
                leanings.apply(models, index, model, cover, out);
            }
            self.leanings = leanings;
        }
        let start = self.tilted_at.get(index).copied().unwrap_or(NONE);
        if start != NONE {
            let tilted = &self.tilted[start as usize..start as usize + n];
            for lane in (0..n).filter(|lane| tilted[*lane]) {
                let part = self.smaller_part(models, layer, lane);
                (0..3).for_each(|c| out[c * n + lane] = weight[c * n + lane] * part[c]);
            }
        }
    }

    /// What all layers over a lobe that is not diffuse let through in one lane, for the light of the last evaluation.
    pub fn smaller_part(&self, models: &LobeModels, layer: u32, lane: usize) -> Vec3 {
        let n = models.lanes;
        let (mut out, mut at) = (Vec3::ONE, layer);
        while let Some(here) = self.list.get(at as usize) {
            let (index, parent) = (at as usize, here.parent);
            out *= if here.lossless() {
                let part = |c: usize| {
                    let (t, k) = (models.column(here.tints[c])[lane], index * n + lane);
                    (1.0 - t * self.top_i[k].max(self.top_o[k])).clamp(0.0, 1.0)
                };
                Vec3::new(part(0), part(1), part(2))
            } else {
                let around = if parent == NONE { 1.0 } else { self.scales[parent as usize * n + lane] };
                Vec3::splat(if around > 0.0 { self.scales[index * n + lane] / around } else { 0.0 })
            };
            at = parent;
        }
        out
    }

    /// One lossless layer's part of [`Layers::scale_lobe`]; the innermost one divides by the mean of all.
    fn scale_lossless(&self, models: &LobeModels, index: usize, diffuse: bool, mean: Option<&[f32]>, out: &mut [f32]) {
        let n = models.lanes;
        let (top_i, top_o) = (&self.top_i[index * n..(index + 1) * n], &self.top_o[index * n..(index + 1) * n]);
        for (c, tint) in self.list[index].tints.into_iter().enumerate() {
            let (tint, out) = (models.column(tint), &mut out[c * n..(c + 1) * n]);
            for i in 0..n {
                let (t_i, t_o) =
                    ((1.0 - tint[i] * top_i[i]).clamp(0.0, 1.0), (1.0 - tint[i] * top_o[i]).clamp(0.0, 1.0));
                out[i] *= if diffuse { t_i * t_o } else { t_i.min(t_o) };
            }
            let Some(mean) = mean else { continue };
            for (value, mean) in out.iter_mut().zip(&mean[c * n..(c + 1) * n]) {
                *value *= (1.0 / mean.max(1e-6)).min(MOST_SCALE);
            }
        }
    }

    /// The part of a layer of another rule: its scale without that of the layers around it.
    fn scale_plain(&self, index: usize, n: usize, out: &mut [f32]) {
        let parent = self.list[index].parent;
        for i in 0..n {
            let whole = self.scales[index * n + i];
            let around = if parent == NONE { 1.0 } else { self.scales[parent as usize * n + i] };
            // What lets nothing through lets nothing through in a layer either.
            let own = if around > 0.0 { whole / around } else { 0.0 };
            for c in 0..3 {
                out[c * n + i] *= own;
            }
        }
    }
}

/// The mean albedo of a lobe on top; one lane is enough for a lobe that is the same in all.
fn mean_albedo(models: &LobeModels, model: &LobeModel, out: &mut [f32]) {
    let Some(loops) = model.kind.loops() else {
        let mut sum = vec![0.0; out.len()];
        let mut here = vec![0.0; out.len()];
        for (cos, weight) in cosine_means() {
            model_albedo(models, model, Toward::Fixed(cos), &mut here);
            sum.iter_mut().zip(&here).for_each(|(sum, a)| *sum += weight * a);
        }
        out.copy_from_slice(&sum);
        return;
    };
    let same = matches!(model.params, Values::Uniform(_));
    let lanes = if same { 1.min(out.len()) } else { out.len() };
    (loops.average)(models.numbers(model), model.choice, &mut out[..lanes]);
    if same && !out.is_empty() {
        let first = out[0];
        out.fill(first);
    }
}
