//! Albedo scaling: what each layer lets through, for the layers of a batch in order, linear in their number.
//!
//! A `sheen` layer takes t a(w) with t the largest component of its tint and a the albedo of its lobe; a `layer(top, base)`
//! takes the albedo of any tree: sums add, weights scale by their largest component, and a layer inside the top counts
//! as its own top plus what that lets through of its base. The sum is clamped to 1. The albedo of each leaf is the
//! one its model documents; transmitting lobes count too, as what they pass has left the base's light.

use super::batch::{
    LayerColumns, Triples, albedo_lanes, average_lanes, layer_lanes, sheen_albedo_lanes, top_albedo_lanes,
};
use super::curves::{Curves, curve_albedo_lanes, push_curves};
use super::kinds::Kind;
use super::kinds::with_source;
use super::media::Media;
use super::settings::{Layering, SheenAlbedo};
use super::store::Store;
use super::surfaces::{NONE, Surface, Surfaces, Values};
use super::weights::{MOST_WEIGHT, Operand, multiply, usable};
use crate::bsdf::sheen::albedo::{AlbedoCurve, FIT_METHOD, LONG_METHOD, SHORT_METHOD};
use crate::bsdf::specular::{reflection, refraction};
use crate::bsdf::{GAUSS, between};
use crate::lanes;
use crate::math::columns::Column3;
use glam::Vec3;
use std::borrow::Cow;

/// Which direction an albedo is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// The viewer.
    View,
    /// The light of the last evaluation.
    Light,
    /// A fixed cosine to every normal, to integrate over.
    Fixed(f32),
}

/// What a layer covers its base with.
#[derive(Clone, Copy, Debug)]
pub enum Top {
    /// One lobe.
    Surface(u32),
    /// A tree: index of its operation.
    Tree(u32),
    /// The boundary of the medium that the base lies in.
    Boundary,
}

/// One step of the albedo of a tree; operands are earlier steps.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Nothing.
    Zero,
    /// The lobes `first..last` of [`Layers::leaves`].
    Leaves(u32, u32),
    /// A weight (offset of a column of largest components) times a step.
    Scale(u32, u32),
    /// The sum of two steps.
    Add(u32, u32),
    /// The first step where the column is not 0, else the second.
    Select(u32, u32, u32),
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
    /// The medium that its base lies in, or [`NONE`].
    pub medium: u32,
    /// Offset in the surfaces' data of the column t.
    pub t: u32,
}

/// All layers of a batch.
#[derive(Debug, Default)]
pub struct Layers {
    /// The layers, outer ones first.
    pub list: Vec<Layer>,
    /// Steps of the albedos of trees, operands first.
    pub steps: Vec<Step>,
    /// Surfaces with the offsets of their t, for [`Step::Leaves`].
    pub leaves: Vec<(u32, u32)>,
    /// Where [`Layers::seen`] has the albedo of each surface toward the viewer, or [`NONE`].
    seen_at: Vec<u32>,
    seen: Vec<f32>,
    /// Where [`Layers::curves`] has the albedo curves of each layer's sheen, or [`NONE`].
    curves_at: Vec<u32>,
    curves: Store<Curves>,
    alpha_o: Vec<f32>,
    through: Vec<f32>,
    inverse_mean: Vec<f32>,
    scales: Vec<f32>,
    values: Vec<f32>,
    scratch: Vec<f32>,
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

    /// The albedo of a surface toward the viewer, for picking; a covering sheen's is known by now.
    pub fn albedo_seen(&self, surfaces: &Surfaces, index: u32, out: &mut [f32]) {
        let surface = &surfaces.list[index as usize];
        let at = self.seen_at.get(index as usize).copied().filter(|&at| at != NONE);
        match at {
            // A facet's is an estimate when picking, and a matter of tables when covering.
            Some(at) if !matches!(surface.kind, Kind::Microfacet { .. }) => {
                out.copy_from_slice(&self.seen[at as usize..at as usize + out.len()]);
            }
            _ => surface_albedo(surfaces, surface, Side::View, out),
        }
    }

    /// How many layers lie over a lobe.
    pub fn depth(&self, layer: u32) -> u32 {
        self.list.get(layer as usize).map_or(0, |l| l.depth)
    }

    /// The medium that lobes under a layer lie in, or [`NONE`].
    pub fn medium(&self, layer: u32) -> u32 {
        self.list.get(layer as usize).map_or(NONE, |l| l.medium)
    }

    /// The layers whose top is a tree, each with the medium that it lies in.
    pub fn tops(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        let trees = self.list.iter().enumerate().filter(|(_, layer)| matches!(layer.top, Top::Tree(_)));
        trees.map(|(index, layer)| (index, self.medium(layer.parent)))
    }

    /// Computes what depends on the viewer alone.
    pub fn prepare(&mut self, surfaces: &Surfaces, media: &Media, ones: &[f32]) {
        let n = surfaces.lanes;
        for store in [&mut self.alpha_o, &mut self.through, &mut self.inverse_mean, &mut self.scales] {
            store.resize(n * self.list.len(), 1.0);
        }
        self.scratch.resize(n, 0.0);
        self.seen.clear();
        self.seen_at.clear();
        self.seen_at.resize(surfaces.list.len(), NONE);
        self.curves.clear();
        self.curves_at.clear();
        self.run_steps(surfaces, Side::View);
        for index in 0..self.list.len() {
            let layer = self.list[index];
            let curves = match layer.top {
                Top::Surface(top) => push_curves(surfaces, &surfaces.list[top as usize], &mut self.curves),
                _ => None,
            };
            self.curves_at.push(curves.unwrap_or(NONE));
            let alpha = &mut self.alpha_o[index * n..(index + 1) * n];
            match (layer.top, media.get(layer.medium)) {
                (Top::Boundary, Some(medium)) => alpha.copy_from_slice(&medium.pass_o),
                _ => {
                    let kept = kept(&self.curves, self.curves_at[index]);
                    top_albedo(&layer, kept, surfaces, Side::View, &self.values, &mut self.scratch);
                    alpha_lanes(surfaces.column(layer.t), &self.scratch, alpha);
                    if let Top::Surface(surface) = layer.top {
                        self.seen_at[surface as usize] = self.seen.len() as u32;
                        self.seen.extend_from_slice(&self.scratch);
                    }
                }
            }
            let (before, here) = self.through.split_at_mut(index * n);
            multiply(Operand::Many(column_or(before, layer.parent, ones)), Operand::Many(alpha), &mut here[..n]);
        }
        if self.list.iter().any(|layer| layer.rule == Layering::Kelemen) {
            self.prepare_means(surfaces);
        }
    }

    fn prepare_means(&mut self, surfaces: &Surfaces) {
        let n = surfaces.lanes;
        self.inverse_mean.fill(0.0);
        for index in 0..self.list.len() {
            let layer = self.list[index];
            if let Top::Surface(surface) = layer.top {
                let surface = &surfaces.list[surface as usize];
                let out = &mut self.inverse_mean[index * n..(index + 1) * n];
                with_source!(surfaces, surface, |M, source| average_lanes::<M, _>(source, out));
            }
        }
        for (x, weight) in GAUSS {
            for t in [0.5 - 0.5 * x, 0.5 + 0.5 * x] {
                self.add_mean(surfaces, t * t * t, 3.0 * weight * t.powi(5));
            }
        }
        for index in 0..self.list.len() {
            let t = surfaces.column(self.list[index].t);
            let out = &mut self.inverse_mean[index * n..(index + 1) * n];
            for i in 0..n {
                out[i] = 1.0 / (1.0 - t[i] * out[i]).max(1e-3);
            }
        }
    }

    /// Adds one node of the mean albedo of the layers whose top is a tree.
    fn add_mean(&mut self, surfaces: &Surfaces, cos: f32, weight: f32) {
        let n = surfaces.lanes;
        if self.steps.is_empty() {
            return;
        }
        self.run_steps(surfaces, Side::Fixed(cos));
        for index in 0..self.list.len() {
            let layer = self.list[index];
            if matches!(layer.top, Top::Tree(_)) {
                top_albedo(&layer, None, surfaces, Side::Fixed(cos), &self.values, &mut self.scratch);
                for (sum, a) in self.inverse_mean[index * n..].iter_mut().zip(&self.scratch) {
                    *sum += weight * a;
                }
            }
        }
    }

    /// Computes the scale of every layer for the light directions in the frames and media.
    pub fn scale(&mut self, surfaces: &Surfaces, media: &Media, ones: &[f32]) {
        let n = surfaces.lanes;
        if !self.steps.is_empty() {
            self.run_steps(surfaces, Side::Light);
        }
        for (index, layer) in self.list.iter().enumerate() {
            if let (Top::Boundary, Some(medium)) = (layer.top, media.get(layer.medium)) {
                let (before, here) = self.scales.split_at_mut(index * n);
                let parent = column_or(before, layer.parent, ones);
                for i in 0..n {
                    here[i] = parent[i] * medium.pass_o[i] * medium.pass_i[i];
                }
                continue;
            }
            if layer.rule != Layering::View {
                let kept = kept(&self.curves, self.curves_at[index]);
                top_albedo(layer, kept, surfaces, Side::Light, &self.values, &mut self.scratch);
            }
            let (before, here) = self.scales.split_at_mut(index * n);
            let columns = LayerColumns {
                top_i: &self.scratch,
                t: surfaces.column(layer.t),
                alpha_o: &self.alpha_o[index * n..(index + 1) * n],
                inverse_mean: &self.inverse_mean[index * n..(index + 1) * n],
                parent: column_or(before, layer.parent, ones),
            };
            layer_lanes(layer.rule, columns, &mut here[..n]);
        }
    }

    /// Computes the albedo of every tree that lies on top of something.
    fn run_steps(&mut self, surfaces: &Surfaces, side: Side) {
        let n = surfaces.lanes;
        self.values.resize(n * self.steps.len(), 0.0);
        for (index, step) in self.steps.iter().enumerate() {
            let (before, here) = self.values.split_at_mut(index * n);
            let here = &mut here[..n];
            let value = |step: u32| &before[step as usize * n..(step as usize + 1) * n];
            match *step {
                Step::Zero => here.fill(0.0),
                Step::Leaves(first, last) => {
                    here.fill(0.0);
                    for &(surface, t) in &self.leaves[first as usize..last as usize] {
                        let surface = &surfaces.list[surface as usize];
                        covering_albedo(surfaces, surface, side, &mut self.scratch);
                        let t = surfaces.column(t);
                        for i in 0..n {
                            let there = surfaces.gate(surface, i) > 0.0;
                            here[i] += if there { t[i] * self.scratch[i] } else { 0.0 };
                        }
                    }
                }
                Step::Scale(weight, child) => {
                    let (weight, child) = (surfaces.column(weight), value(child));
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
                    let (mask, a, b) = (surfaces.column(mask), value(a), value(b));
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
    /// What a top of coverage `t` lets through.
    fn alpha_lanes(t: &[f32], top: &[f32], alpha: &mut [f32]) {
        let n = alpha.len();
        let (t, top) = (&t[..n], &top[..n]);
        for i in 0..n {
            alpha[i] = (1.0 - t[i] * top[i]).clamp(0.0, 1.0);
        }
    }
}

/// A layer's column, or the column of no layer.
fn column_or<'a>(store: &'a [f32], layer: u32, ones: &'a [f32]) -> &'a [f32] {
    let n = ones.len();
    if layer == NONE { ones } else { &store[layer as usize * n..(layer as usize + 1) * n] }
}

/// The curves from an offset on; none from [`NONE`] on.
fn kept(curves: &[Curves], at: u32) -> Option<&[Curves]> {
    curves.get(at as usize..)
}

/// The albedo of what a layer consists of, without its t; `kept` are the curves of its sheen, if they were.
fn top_albedo(
    layer: &Layer,
    kept: Option<&[Curves]>,
    surfaces: &Surfaces,
    side: Side,
    values: &[f32],
    out: &mut [f32],
) {
    let n = surfaces.lanes;
    match (layer.top, kept) {
        (Top::Surface(surface), Some(curves)) => {
            let cos = cosines(surfaces, &surfaces.list[surface as usize], side);
            curve_albedo_lanes(curves, &cos, out);
        }
        (Top::Surface(surface), None) => covering_albedo(surfaces, &surfaces.list[surface as usize], side, out),
        (Top::Boundary, _) => out.fill(0.0),
        (Top::Tree(step), _) => {
            for (o, v) in out.iter_mut().zip(&values[step as usize * n..(step as usize + 1) * n]) {
                *o = v.clamp(0.0, 1.0);
            }
        }
    }
}

/// The albedo of a surface that lies on top of something: [`surface_albedo`], from tables where that is an estimate.
pub fn covering_albedo(surfaces: &Surfaces, surface: &Surface, side: Side, out: &mut [f32]) {
    if !matches!(surface.kind, Kind::Microfacet { .. }) {
        return surface_albedo(surfaces, surface, side, out);
    }
    let frame = &surfaces.frames()[surface.frame as usize];
    let fixed;
    let w = match side {
        Side::View => &frame.wo,
        Side::Light => &frame.wi,
        Side::Fixed(cos) => {
            fixed = Column3::splat(between(cos), surfaces.lanes);
            &fixed
        }
    };
    with_source!(surfaces, surface, |M, source| top_albedo_lanes::<M, _>(source, Triples::of(w), out));
}

/// The cosines of a direction to a surface's normal.
fn cosines<'a>(surfaces: &'a Surfaces, surface: &Surface, side: Side) -> Cow<'a, [f32]> {
    let frame = &surfaces.frames()[surface.frame as usize];
    match side {
        Side::View => Cow::Borrowed(&frame.wo.z),
        Side::Light => Cow::Borrowed(&frame.wi.z),
        Side::Fixed(value) => Cow::Owned(vec![value; surfaces.lanes]),
    }
}

/// The albedo of one surface in every lane.
pub fn surface_albedo(surfaces: &Surfaces, surface: &Surface, side: Side, out: &mut [f32]) {
    if surface.kind == Kind::Transparent {
        out.fill(1.0);
        return;
    }
    let cos = cosines(surfaces, surface, side);
    if let Kind::Reflection(term) | Kind::Refraction(term) = surface.kind {
        let meet = if matches!(surface.kind, Kind::Reflection(_)) { reflection } else { refraction };
        for (lane, value) in out.iter_mut().enumerate() {
            let c = cos[lane].abs().min(1.0);
            let viewer = Vec3::new(((1.0 - c) * (1.0 + c)).sqrt(), 0.0, c);
            *value = meet(viewer, term, surfaces.params(surface, lane)).part.max_element();
        }
        return;
    }
    let method = surfaces.sheen_albedo;
    if let Kind::Sheen(term, soft) | Kind::SheenByNormals(term, soft) = surface.kind
        && term.is_exact()
        && method != SheenAlbedo::Fit
    {
        return sheen_albedo(surfaces, surface, soft, &cos, out);
    }
    with_source!(surfaces, surface, |M, source| albedo_lanes::<M, _>(source, &cos, out));
}

/// The albedo of a sheen by another method than the default.
fn sheen_albedo(surfaces: &Surfaces, surface: &Surface, soft: bool, cos: &[f32], out: &mut [f32]) {
    let method = surfaces.sheen_albedo;
    let curve = |lane| AlbedoCurve::exact(method, soft, surfaces.param(surface, 0, lane));
    if let Values::Uniform(_) = surface.params {
        return match method {
            SheenAlbedo::Short => sheen_albedo_lanes::<SHORT_METHOD>(curve(0), cos, out),
            SheenAlbedo::Fit => sheen_albedo_lanes::<FIT_METHOD>(curve(0), cos, out),
            SheenAlbedo::Long => sheen_albedo_lanes::<LONG_METHOD>(curve(0), cos, out),
        };
    }
    for lane in 0..out.len() {
        out[lane] = curve(lane).by_method(method, cos[lane].abs().min(1.0));
    }
}
