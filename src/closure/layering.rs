//! Albedo scaling: what each layer lets through, for the layers of a batch in order, linear in their number.
//!
//! A `sheen` layer takes t a(w) with its coverage t, the largest component of its tint, and a the albedo of its lobe; a `layer(top, base)`
//! takes the albedo of any tree: sums add, weights scale by their largest component, and a layer inside the top counts
//! as its own top plus what that lets through of its base. The sum is clamped to 1. The albedo of each leaf is the
//! one its model documents; transmitting lobes count too, as what they pass has left the base's light.

use super::batch::{LayerColumns, layer_lanes, sheen_albedo_lanes};
use super::coats::Coats;
use super::curves::{Curves, curve_albedo_lanes, push_curves};
use super::glossy::Glossy;
use super::leaning::Leanings;
use super::lobe_kind::Way;
use super::lobe_models::{Column, LobeModel, LobeModels};
use super::settings::{Layering, SheenAlbedo};
use super::source::Triples;
use super::store::{NONE, Store};
use super::weights::{MOST_WEIGHT, Operand, multiply, usable};
use crate::bsdf::between;
use crate::bsdf::sheen::albedo::{AlbedoCurve, FIT_METHOD, LONG_METHOD, SHORT_METHOD, TABLE_METHOD};
use crate::lanes;
use crate::math::columns::Column3;
use crate::math::quadrature::cosine_means;
use glam::Vec3;
use std::borrow::Cow;

/// Which direction an albedo is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Toward<'a> {
    /// The viewer.
    View,
    /// The light of the last evaluation.
    Light,
    /// A fixed cosine to every normal, to integrate over.
    Fixed(f32),
    /// The same, a cosine a lane.
    At(&'a [f32]),
}

/// What a layer covers its base with.
#[derive(Clone, Copy, Debug)]
pub enum Top {
    /// One lobe.
    Lobe(u32),
    /// A tree: index of its operation.
    Tree(u32),
    /// The boundary of the coat that the base lies under.
    Boundary,
}

/// One step of the albedo of a tree; operands are earlier steps.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Nothing.
    Zero,
    /// The lobes `first..last` of [`Layers::leaves`].
    Leaves(u32, u32),
    /// A weight (a column of largest components) times a step.
    Scale(Column, u32),
    /// The sum of two steps.
    Add(u32, u32),
    /// The first step where the column is not 0, else the second.
    Select(Column, u32, u32),
    /// The first step over the second.
    Over(u32, u32),
}

/// One layer.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// The layer around it, or [`NONE`]; always an earlier one.
    pub parent: u32,
    /// How many layers lie over its base.
    pub depth: u32,
    /// How it scales.
    pub rule: Layering,
    /// What it consists of.
    pub top: Top,
    /// The coat that its base lies under, or [`NONE`].
    pub coat: u32,
    /// How much of the base its top covers.
    pub coverage: Column,
    /// How much of it in each color, for [`Layering::Lossless`].
    pub tints: [Column; 3],
}

impl Layer {
    /// Does it scale lobe by lobe and color by color?
    pub fn lossless(&self) -> bool {
        self.rule == Layering::Lossless && !matches!(self.top, Top::Boundary)
    }
}

/// All layers of a batch.
#[derive(Debug, Default)]
pub struct Layers {
    /// The layers, outer ones first.
    pub list: Vec<Layer>,
    /// Steps of the albedos of trees, operands first.
    pub steps: Vec<Step>,
    /// Models with their coverages, for [`Step::Leaves`].
    pub leaves: Vec<(u32, Column)>,
    /// Where [`Layers::seen`] has the albedo of each model toward the viewer, or [`NONE`].
    seen_at: Vec<u32>,
    seen: Vec<f32>,
    /// Where [`Layers::curves`] has the albedo curves of each layer's sheen, or [`NONE`].
    pub(super) curves_at: Vec<u32>,
    pub(super) curves: Store<Curves>,
    /// Is any layer lossless? Then the albedos of tops toward viewer and light are kept, a column a layer.
    pub(super) by_lobe: bool,
    pub(super) top_o: Vec<f32>,
    pub(super) top_i: Vec<f32>,
    /// The mean of what a lossless layer and those around it let through, three columns a layer.
    pub(super) passed: Vec<f32>,
    /// What corrects the scale of diffuse lobes that lean.
    pub(super) leanings: Leanings,
    /// What rough lobes are left by the smaller T.
    pub(super) glossy: Glossy,
    /// Where the lanes of each lobe whose normal is not that of all its lossless tops begin in `tilted`, or [`NONE`].
    pub(super) tilted_at: Vec<u32>,
    pub(super) tilted: Vec<bool>,
    alpha_o: Vec<f32>,
    through: Vec<f32>,
    inverse_mean: Vec<f32>,
    pub(super) scales: Vec<f32>,
    pub(super) values: Vec<f32>,
    pub(super) scratch: Vec<f32>,
}

impl Layers {
    /// Empties the store.
    pub fn clear(&mut self) {
        self.list.clear();
        self.steps.clear();
        self.leaves.clear();
    }

    /// The scale of a layer for the last evaluated direction.
    pub fn scale_of<'a>(&'a self, layer: u32, ones: &'a [f32]) -> &'a [f32] {
        column_or(&self.scales, layer, ones)
    }

    /// What a layer and those around it let through to the viewer.
    pub fn through_of(&self, layer: u32) -> &[f32] {
        let n = self.through.len() / self.list.len().max(1);
        &self.through[layer as usize * n..(layer as usize + 1) * n]
    }

    /// The albedo of a model toward the viewer, for picking; a covering sheen's is known by now.
    pub fn albedo_seen(&self, models: &LobeModels, index: u32, out: &mut [f32]) {
        let model = &models.list[index as usize];
        let at = self.seen_at.get(index as usize).copied().filter(|&at| at != NONE);
        match at {
            // A facet's is an estimate when picking, and a matter of tables when covering.
            Some(at) if model.kind.loops().is_none_or(|loops| !loops.top) => {
                out.copy_from_slice(&self.seen[at as usize..at as usize + out.len()]);
            }
            _ => model_albedo(models, model, Toward::View, out),
        }
    }

    /// How many layers lie over a lobe.
    pub fn depth(&self, layer: u32) -> u32 {
        self.list.get(layer as usize).map_or(0, |l| l.depth)
    }

    /// The coat that lobes under a layer lie in, or [`NONE`].
    pub fn coat(&self, layer: u32) -> u32 {
        self.list.get(layer as usize).map_or(NONE, |l| l.coat)
    }

    /// The layers whose top is a tree, each with the coat that it lies in.
    pub fn tops(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        let trees = self.list.iter().enumerate().filter(|(_, layer)| matches!(layer.top, Top::Tree(_)));
        trees.map(|(index, layer)| (index, self.coat(layer.parent)))
    }

    /// Computes what depends on the viewer alone.
    pub fn prepare(&mut self, models: &LobeModels, coats: &Coats, ones: &[f32]) {
        let n = models.lanes;
        for store in [&mut self.alpha_o, &mut self.through, &mut self.inverse_mean, &mut self.scales] {
            store.resize(n * self.list.len(), 1.0);
        }
        self.scratch.resize(n, 0.0);
        self.seen.clear();
        self.seen_at.clear();
        self.seen_at.resize(models.list.len(), NONE);
        self.curves.clear();
        self.curves_at.clear();
        self.by_lobe = self.list.iter().any(Layer::lossless);
        for store in [&mut self.top_o, &mut self.top_i].into_iter().filter(|_| self.by_lobe) {
            store.resize(n * self.list.len(), 0.0);
        }
        self.run_steps(models, Toward::View);
        for index in 0..self.list.len() {
            let layer = self.list[index];
            let curves = match layer.top {
                Top::Lobe(top) => push_curves(models, &models.list[top as usize], &mut self.curves),
                _ => None,
            };
            self.curves_at.push(curves.unwrap_or(NONE));
            let alpha = &mut self.alpha_o[index * n..(index + 1) * n];
            match (layer.top, coats.get(layer.coat)) {
                (Top::Boundary, Some(coat)) => alpha.copy_from_slice(&coat.pass_o),
                _ => {
                    let kept = kept(&self.curves, self.curves_at[index]);
                    top_albedo(&layer, kept, models, Toward::View, &self.values, &mut self.scratch);
                    alpha_lanes(models.column(layer.coverage), &self.scratch, alpha);
                    if self.by_lobe {
                        self.top_o[index * n..(index + 1) * n].copy_from_slice(&self.scratch);
                    }
                    if let Top::Lobe(model) = layer.top {
                        self.seen_at[model as usize] = self.seen.len() as u32;
                        self.seen.extend_from_slice(&self.scratch);
                    }
                }
            }
            let (before, here) = self.through.split_at_mut(index * n);
            multiply(Operand::Many(column_or(before, layer.parent, ones)), Operand::Many(alpha), &mut here[..n]);
        }
        if self.list.iter().any(|layer| layer.rule == Layering::Kelemen) {
            self.prepare_means(models);
        }
    }

    fn prepare_means(&mut self, models: &LobeModels) {
        let n = models.lanes;
        self.inverse_mean.fill(0.0);
        for index in 0..self.list.len() {
            let layer = self.list[index];
            if let Top::Lobe(model) = layer.top {
                let model = &models.list[model as usize];
                let out = &mut self.inverse_mean[index * n..(index + 1) * n];
                if let Some(loops) = model.kind.loops() {
                    (loops.average)(models.numbers(model), model.choice, out);
                }
            }
        }
        for (cos, weight) in cosine_means() {
            self.add_mean(models, cos, weight);
        }
        for index in 0..self.list.len() {
            let coverage = models.column(self.list[index].coverage);
            let out = &mut self.inverse_mean[index * n..(index + 1) * n];
            for i in 0..n {
                out[i] = 1.0 / (1.0 - coverage[i] * out[i]).max(1e-3);
            }
        }
    }

    /// Adds one node of the mean albedo of the layers whose top is a tree.
    fn add_mean(&mut self, models: &LobeModels, cos: f32, weight: f32) {
        let n = models.lanes;
        if self.steps.is_empty() {
            return;
        }
        self.run_steps(models, Toward::Fixed(cos));
        for index in 0..self.list.len() {
            let layer = self.list[index];
            if matches!(layer.top, Top::Tree(_)) {
                top_albedo(&layer, None, models, Toward::Fixed(cos), &self.values, &mut self.scratch);
                for (sum, a) in self.inverse_mean[index * n..].iter_mut().zip(&self.scratch) {
                    *sum += weight * a;
                }
            }
        }
    }

    /// Computes the scale of every layer for the light directions in the frames and coats.
    pub fn scale(&mut self, models: &LobeModels, coats: &Coats, ones: &[f32]) {
        let n = models.lanes;
        if !self.steps.is_empty() {
            self.run_steps(models, Toward::Light);
        }
        for (index, layer) in self.list.iter().enumerate() {
            if let (Top::Boundary, Some(coat)) = (layer.top, coats.get(layer.coat)) {
                let (before, here) = self.scales.split_at_mut(index * n);
                let parent = column_or(before, layer.parent, ones);
                for i in 0..n {
                    here[i] = parent[i] * coat.pass_o[i] * coat.pass_i[i];
                }
                continue;
            }
            if layer.rule != Layering::View {
                let kept = kept(&self.curves, self.curves_at[index]);
                top_albedo(layer, kept, models, Toward::Light, &self.values, &mut self.scratch);
            }
            if self.by_lobe {
                self.top_i[index * n..(index + 1) * n].copy_from_slice(&self.scratch);
            }
            let (before, here) = self.scales.split_at_mut(index * n);
            let columns = LayerColumns {
                top_i: &self.scratch,
                coverage: models.column(layer.coverage),
                alpha_o: &self.alpha_o[index * n..(index + 1) * n],
                inverse_mean: &self.inverse_mean[index * n..(index + 1) * n],
                parent: column_or(before, layer.parent, ones),
            };
            layer_lanes(layer.rule, columns, &mut here[..n]);
        }
    }

    /// Computes the albedo of every tree that lies on top of something.
    pub(super) fn run_steps(&mut self, models: &LobeModels, toward: Toward) {
        let n = models.lanes;
        self.values.resize(n * self.steps.len(), 0.0);
        for (index, step) in self.steps.iter().enumerate() {
            let (before, here) = self.values.split_at_mut(index * n);
            let here = &mut here[..n];
            let value = |step: u32| &before[step as usize * n..(step as usize + 1) * n];
            match *step {
                Step::Zero => here.fill(0.0),
                Step::Leaves(first, last) => {
                    here.fill(0.0);
                    for &(model, coverage) in &self.leaves[first as usize..last as usize] {
                        let model = &models.list[model as usize];
                        covering_albedo(models, model, toward, &mut self.scratch);
                        let coverage = models.column(coverage);
                        for i in 0..n {
                            let there = models.gate(model, i) > 0.0;
                            here[i] += if there { coverage[i] * self.scratch[i] } else { 0.0 };
                        }
                    }
                }
                Step::Scale(weight, child) => {
                    let (weight, child) = (models.column(weight), value(child));
                    for i in 0..n {
                        // What is too heavy scatters nothing, and takes nothing.
                        let there = weight[i] > 0.0 && usable(weight[i]);
                        here[i] = if there { weight[i] * child[i] } else { 0.0 };
                    }
                }
                Step::Add(a, b) => {
                    let (a, b) = (value(a), value(b));
                    for i in 0..n {
                        here[i] = a[i] + b[i];
                    }
                }
                Step::Select(mask, a, b) => {
                    let (mask, a, b) = (models.column(mask), value(a), value(b));
                    for i in 0..n {
                        here[i] = if mask[i] != 0.0 { a[i] } else { b[i] };
                    }
                }
                Step::Over(a, b) => {
                    let (a, b) = (value(a), value(b));
                    for i in 0..n {
                        let top = a[i].clamp(0.0, 1.0);
                        // A top that takes everything takes it of any base, of a sum beyond all numbers as well.
                        here[i] = top + (1.0 - top) * b[i].min(MOST_WEIGHT);
                    }
                }
            }
        }
    }
}

lanes! {
    /// What a top of a coverage lets through.
    fn alpha_lanes(coverage: &[f32], top: &[f32], alpha: &mut [f32]) {
        let n = alpha.len();
        let (coverage, top) = (&coverage[..n], &top[..n]);
        for i in 0..n {
            alpha[i] = (1.0 - coverage[i] * top[i]).clamp(0.0, 1.0);
        }
    }
}

/// A layer's column, or the column of no layer.
fn column_or<'a>(store: &'a [f32], layer: u32, ones: &'a [f32]) -> &'a [f32] {
    let n = ones.len();
    if layer == NONE { ones } else { &store[layer as usize * n..(layer as usize + 1) * n] }
}

/// The curves from an offset on; none from [`NONE`] on.
pub(super) fn kept(curves: &[Curves], at: u32) -> Option<&[Curves]> {
    curves.get(at as usize..)
}

/// The albedo of what a layer consists of, without its coverage; `kept` are the curves of its sheen, if they were.
pub(super) fn top_albedo(
    layer: &Layer,
    kept: Option<&[Curves]>,
    models: &LobeModels,
    toward: Toward,
    values: &[f32],
    out: &mut [f32],
) {
    let n = models.lanes;
    match (layer.top, kept) {
        (Top::Lobe(model), Some(curves)) => {
            let cos = cosines(models, &models.list[model as usize], toward);
            curve_albedo_lanes(curves, &cos, out);
        }
        (Top::Lobe(model), None) => covering_albedo(models, &models.list[model as usize], toward, out),
        (Top::Boundary, _) => out.fill(0.0),
        (Top::Tree(step), _) => {
            for (o, v) in out.iter_mut().zip(&values[step as usize * n..(step as usize + 1) * n]) {
                *o = v.clamp(0.0, 1.0);
            }
        }
    }
}

/// The albedo of a model that lies on top of something: [`model_albedo`], from tables where that is an estimate.
pub fn covering_albedo(models: &LobeModels, model: &LobeModel, toward: Toward, out: &mut [f32]) {
    let (Some(loops), Some(frame)) = (model.kind.loops().filter(|loops| loops.top), models.frame_of(model)) else {
        return model_albedo(models, model, toward, out);
    };
    let fixed;
    let w = match toward {
        Toward::View => &frame.wo,
        Toward::Light => &frame.wi,
        Toward::Fixed(cos) => {
            fixed = Column3::splat(between(cos), models.lanes);
            &fixed
        }
        Toward::At(cosines) => {
            let mut column = Column3::zeros(models.lanes);
            cosines.iter().enumerate().for_each(|(lane, cos)| column.set(lane, between(*cos)));
            fixed = column;
            &fixed
        }
    };
    (loops.top_albedo)(models.numbers(model), model.choice, Triples::of(w), out);
}

/// The cosines of a direction to a model's normal.
fn cosines<'a>(models: &'a LobeModels, model: &LobeModel, toward: Toward<'a>) -> Cow<'a, [f32]> {
    let frame = &models.frames()[model.frame as usize];
    match toward {
        Toward::View => Cow::Borrowed(&frame.wo.z),
        Toward::Light => Cow::Borrowed(&frame.wi.z),
        Toward::Fixed(value) => Cow::Owned(vec![value; models.lanes]),
        Toward::At(cosines) => Cow::Borrowed(cosines),
    }
}

/// The albedo of one model in every lane.
pub fn model_albedo(models: &LobeModels, model: &LobeModel, toward: Toward, out: &mut [f32]) {
    match model.kind.way() {
        Way::Straight => out.fill(1.0),
        Way::One(single) => {
            let cos = cosines(models, model, toward);
            for (lane, value) in out.iter_mut().enumerate() {
                let c = cos[lane].abs().min(1.0);
                let viewer = Vec3::new(((1.0 - c) * (1.0 + c)).sqrt(), 0.0, c);
                *value = (single.meet)(viewer, models.params(model, lane)).part.max_element();
            }
        }
        Way::Many(loops) => {
            let cos = cosines(models, model, toward);
            match loops.sheen.filter(|_| models.sheen_albedo != SheenAlbedo::Fit) {
                Some(soft) => sheen_albedo(models, model, soft, &cos, out),
                None => (loops.albedo)(models.numbers(model), model.choice, &cos, out),
            }
        }
    }
}

/// The albedo of a sheen by another method than the default.
fn sheen_albedo(models: &LobeModels, model: &LobeModel, soft: bool, cos: &[f32], out: &mut [f32]) {
    let method = models.sheen_albedo;
    let curve = |lane| AlbedoCurve::exact(method, soft, models.param(model, 0, lane));
    if models.first_param(model).is_none() {
        return match method {
            SheenAlbedo::Short => sheen_albedo_lanes::<SHORT_METHOD>(curve(0), cos, out),
            SheenAlbedo::Fit => sheen_albedo_lanes::<FIT_METHOD>(curve(0), cos, out),
            SheenAlbedo::Long => sheen_albedo_lanes::<LONG_METHOD>(curve(0), cos, out),
            SheenAlbedo::Table => sheen_albedo_lanes::<TABLE_METHOD>(curve(0), cos, out),
        };
    }
    for lane in 0..out.len() {
        out[lane] = curve(lane).by_method(method, cos[lane].abs().min(1.0));
    }
}
