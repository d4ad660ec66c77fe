//! Leaves made ready: a closure's lobes and how it covers what it nests, made by [`LeafMaker`] from its arguments.
//!
//! What may differ between lanes although the lane loops need it fixed (distribution, refract, keyword strings, a width so small
//! that the boundary is smooth) splits a leaf into parts, each with a gate that is 1 in its lanes.

use super::arguments::{Color, Nested, Normal, Vector, Word};
use super::coats::Coating;
use super::frames::Seen;
use super::lobe_kind::LobeKind;
use super::lobe_models::{Column, LobeModels, Request};
use super::settings::{Layering, Settings};
use super::store::NONE;
use super::tree::{Floats, Ints, NodeId, Tree};
use super::words::Words;
use crate::bsdf::Choice;
use glam::Vec3;
use smallvec::{SmallVec, smallvec};

/// A lobe of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Its model.
    pub model: u32,
    /// How much it covers where it lies on top of something.
    pub coverage: Column,
    /// A color in place of the leaf's.
    pub tint: Option<[Floats; 3]>,
    /// Is it sampled by the part before it?
    pub paired: bool,
    /// Where the part exists, whatever its parameters are.
    gate: Column,
}

/// How a leaf covers what it nests: one entry a variant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cover {
    /// The covering lobe; none for `layer`, whose top is a tree, and for a coat.
    pub model: Option<u32>,
    /// How much of the base it covers.
    pub coverage: Column,
    /// How much of it in each color, for the rule that asks.
    pub tints: [Column; 3],
    /// The rule of scaling.
    pub rule: Layering,
    /// The lanes it applies to.
    pub gate: Column,
}

/// A leaf made ready.
#[derive(Debug, Default)]
pub(super) struct Leaf {
    /// Its lobes.
    pub parts: SmallVec<[Part; 4]>,
    /// How it covers its base.
    pub covers: SmallVec<[Cover; 2]>,
    /// A color that its weight is multiplied with.
    pub tint: Option<[Floats; 3]>,
    /// The tree on top, of `layer`.
    pub top: Option<NodeId>,
    /// The coat over the base, of which flattening makes one of its coats.
    pub coating: Option<Coating>,
    /// The coat that the base lies in.
    pub inner: Option<u32>,
    /// What lies under it.
    pub base: Option<NodeId>,
    /// True for light sources.
    pub emits: bool,
    /// True for holes.
    pub hole: bool,
    /// What is said of lanes in which something is not rendered, and those lanes.
    pub left_out: Option<(&'static str, Vec<bool>)>,
}

/// A shading frame of the leaf being made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameId(u32);

/// The lanes that a variant of a leaf exists in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gate(Column);

impl Gate {
    /// All lanes.
    pub const ALL: Gate = Gate(Column::ONES);
}

/// A lobe that was added to the leaf.
#[derive(Clone, Copy, Debug)]
pub struct PartId(usize);

/// A lobe to be added to a leaf.
#[derive(Clone, Copy, Debug)]
pub struct LobeRequest<'a> {
    /// What it does with light.
    pub kind: LobeKind,
    /// Which of several ways its model goes.
    pub choice: Choice,
    /// The frame it scatters in.
    pub frame: FrameId,
    /// The parameters of its model, in the model's order; at most [`crate::bsdf::MAX_PARAMS`].
    pub params: &'a [Floats],
    /// Which of them is an index of refraction, to be inverted where the viewer is behind the shading normal.
    pub eta: Option<usize>,
    /// Is it an index of the surface's inside over its outside? Then it is inverted too where normals were turned to a viewer
    /// who is inside (`backfacing()`), which other closures leave to the shader.
    pub two_sided: bool,
    /// Where it exists.
    pub gate: Gate,
    /// A color in place of the leaf's.
    pub tint: Option<Color>,
    /// Is it the other half of the lobe added before it, in the same lanes? Then that one's sampling finds the directions of both,
    /// the density of each being a part of one whole.
    pub paired: bool,
}

impl<'a> LobeRequest<'a> {
    /// A lobe in all lanes.
    pub fn new(kind: LobeKind, frame: FrameId, params: &'a [Floats]) -> Self {
        LobeRequest {
            kind,
            choice: Choice::default(),
            frame,
            params,
            eta: None,
            two_sided: false,
            gate: Gate::ALL,
            tint: None,
            paired: false,
        }
    }
}

/// Makes a leaf ready: the functions of closures add lobes to it.
pub struct LeafMaker<'a> {
    tree: &'a Tree,
    settings: Settings,
    seen: Seen<'a>,
    closure: &'static str,
    models: &'a mut LobeModels,
    leaf: Leaf,
}

impl std::fmt::Debug for LeafMaker<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LeafMaker").field("closure", &self.closure).finish_non_exhaustive()
    }
}

impl<'a> LeafMaker<'a> {
    /// Begins a leaf of a closure.
    pub(super) fn new(
        models: &'a mut LobeModels,
        tree: &'a Tree,
        settings: Settings,
        seen: Seen<'a>,
        closure: &'static str,
    ) -> Self {
        LeafMaker { tree, settings, seen, closure, models, leaf: Leaf::default() }
    }

    /// The tree that the arguments' columns lie in.
    pub fn tree(&self) -> &'a Tree {
        self.tree
    }

    /// Choices of the render.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The number of lanes.
    pub fn lanes(&self) -> usize {
        self.models.lanes
    }

    /// A float of a lane.
    pub fn float(&self, column: Floats, lane: usize) -> f32 {
        self.tree.float(column, lane)
    }

    /// A triple of a lane.
    pub fn triple(&self, columns: [Floats; 3], lane: usize) -> Vec3 {
        Vec3::from_array(columns.map(|column| self.tree.float(column, lane)))
    }

    /// An integer of a lane.
    pub fn int(&self, column: Ints, lane: usize) -> i32 {
        self.tree.int(column, lane)
    }

    /// What a keyword chooses in a lane; nothing where it is not given, or is no word that means something.
    pub fn word<E: Words>(&self, keyword: &Option<Word<E>>, lane: usize) -> Option<E> {
        keyword.as_ref().and_then(|word| word.at(self.tree, lane))
    }

    /// The frame of a shading normal, and of the direction of its x axis if that matters.
    pub fn frame(&mut self, normal: Normal, tangent: Option<Vector>) -> FrameId {
        FrameId(self.models.frame(self.tree, normal.0, tangent.map(|u| u.0), &self.seen))
    }

    /// The same for lobes about the mirror direction: a normal that mirrors the viewer into the surface is turned as little as
    /// keeps the mirror direction above it.
    pub fn mirror_frame(&mut self, normal: Normal, tangent: Option<Vector>) -> FrameId {
        FrameId(self.models.mirror_frame(self.tree, normal.0, tangent.map(|u| u.0), &self.seen))
    }

    /// The frame of the geometric normal.
    pub fn geometric_frame(&mut self) -> FrameId {
        self.frame(Normal([Floats::Uniform(0.0); 3]), None)
    }

    /// Multiplies the leaf's weight with a color.
    pub fn tint(&mut self, color: Color) {
        self.leaf.tint = Some(color.0);
    }

    /// Adds a lobe in all lanes, whose model takes these parameters in its own order.
    pub fn lobe(&mut self, kind: LobeKind, frame: FrameId, params: &[Floats]) -> PartId {
        self.add(LobeRequest::new(kind, frame, params))
    }

    /// Leaves the closure out of the lanes in which it would be `seen`; a render says `what` of it.
    pub fn leave_out(&mut self, what: &'static str, seen: impl Fn(&Self, usize) -> bool) {
        let lanes: Vec<bool> = (0..self.lanes()).map(|lane| seen(self, lane)).collect();
        self.leaf.left_out = Some((what, lanes));
    }

    /// Lets light pass straight on.
    pub fn straight(&mut self) -> PartId {
        self.lobe(LobeKind::STRAIGHT, FrameId(NONE), &[])
    }

    /// Adds a lobe.
    pub fn add(&mut self, lobe: LobeRequest) -> PartId {
        let LobeRequest { kind, choice, frame, params, eta, two_sided, gate, tint, paired } = lobe;
        let closure = self.closure;
        let backfacing = if two_sided { self.seen.backfacing } else { &[] };
        let request = Request { kind, choice, closure, frame: frame.0, params, eta, backfacing, gate: gate.0 };
        let model = self.models.push(self.tree, request);
        let tint = tint.map(|color| color.0);
        let coverage = tint.map_or(Column::ONES, |color| self.largest(color));
        self.leaf.parts.push(Part { model, coverage, tint, paired, gate: gate.0 });
        PartId(self.leaf.parts.len() - 1)
    }

    /// The variants of the leaf that occur in the batch, in order, each with its lanes; a lane without a key has none.
    /// `varies` says whether the key can differ between lanes.
    pub fn variants<K: Copy + Ord>(
        &mut self,
        varies: bool,
        key: impl Fn(&Self, usize) -> Option<K>,
    ) -> SmallVec<[(K, Gate); 2]> {
        let first = if self.lanes() > 0 { key(self, 0) } else { None };
        let same = !varies || (1..self.lanes()).all(|lane| key(self, lane) == first);
        if same {
            return first.map_or(SmallVec::new(), |key| smallvec![(key, Gate::ALL)]);
        }
        let of_lane: Vec<Option<K>> = (0..self.lanes()).map(|lane| key(self, lane)).collect();
        let mut keys: SmallVec<[K; 4]> = SmallVec::new();
        for key in of_lane.iter().flatten() {
            if let Err(at) = keys.binary_search(key) {
                keys.insert(at, *key);
            }
        }
        let gate = |key| Gate(self.models.push_column(|lane| if of_lane[lane] == Some(key) { 1.0 } else { 0.0 }));
        keys.iter().copied().zip(keys.iter().copied().map(gate)).collect()
    }

    /// A gate that is closed, and says so, in the lanes of another where a condition does not hold.
    pub(super) fn closed_unless(&mut self, gate: Gate, number: impl Fn(usize) -> bool) -> Gate {
        let open = self.models.column(gate.0).to_vec();
        Gate(self.models.push_column(|lane| if number(lane) || open[lane] == 0.0 { open[lane] } else { f32::NAN }))
    }

    /// Says what lies under the leaf.
    pub fn nest(&mut self, base: Nested) {
        self.leaf.base = base.0;
    }

    /// Covers what the leaf nests by a lobe of it, which takes its albedo times the largest component of a color.
    pub fn cover(&mut self, PartId(part): PartId, color: Color, rule: Layering) {
        // An index of another leaf covers nothing.
        let Some(&Part { model, gate, .. }) = self.leaf.parts.get(part) else { return };
        let made = self.models.list[model as usize];
        let coverage = match color.0 {
            [Floats::Uniform(x), Floats::Uniform(y), Floats::Uniform(z)] if made.gate == Column::ONES => {
                let largest = x.max(y).max(z).max(0.0);
                self.models.push_constant(if largest.is_finite() { largest } else { 0.0 })
            }
            _ => {
                // A lobe that is dropped for its parameters takes nothing from its base.
                let exists: Vec<bool> = (0..self.lanes()).map(|lane| self.models.gate(&made, lane) > 0.0).collect();
                let tree = self.tree;
                self.models.push_column(|lane| {
                    let largest = color.0.iter().map(|&c| tree.float(c, lane)).fold(0.0, f32::max);
                    if exists[lane] && largest.is_finite() { largest } else { 0.0 }
                })
            }
        };
        self.leaf.parts[part].coverage = coverage;
        let tints = if rule == Layering::Lossless { self.tints(color, coverage) } else { [coverage; 3] };
        self.leaf.covers.push(Cover { model: Some(model), coverage, tints, rule, gate });
    }

    /// A column for each component of a color, no larger than that of the largest one.
    fn tints(&mut self, color: Color, largest: Column) -> [Column; 3] {
        let [x, y, z] = color.0;
        if x == y && y == z {
            return [largest; 3];
        }
        let (most, tree) = (self.models.column(largest).to_vec(), self.tree);
        color.0.map(|c| {
            self.models.push_column(|lane| {
                let value = tree.float(c, lane);
                if value.is_finite() { value.clamp(0.0, most[lane].max(0.0)) } else { most[lane] }
            })
        })
    }

    /// Covers what the leaf nests by another closure, which scatters as well.
    pub fn cover_by(&mut self, top: Nested, rule: Layering, gate: Gate) {
        self.leaf.top = top.0;
        self.leaf.covers.push(Cover {
            model: None,
            coverage: Column::ONES,
            tints: [Column::ONES; 3],
            rule,
            gate: gate.0,
        });
    }

    /// Lays a coat over what the leaf nests.
    pub(super) fn coat(&mut self, coating: Coating) {
        self.leaf.coating = Some(coating);
        let rule = self.settings.layering;
        self.leaf.covers.push(Cover {
            model: None,
            coverage: Column::ONES,
            tints: [Column::ONES; 3],
            rule,
            gate: Column::ONES,
        });
    }

    /// The index of a frame among those of the batch.
    pub(super) fn frame_index(frame: FrameId) -> u32 {
        frame.0
    }

    /// The leaf.
    pub(super) fn finish(mut self) -> Leaf {
        // As a top, a colored leaf takes no more than its color reflects; parts that say so themselves are left alone.
        let plain = |part: &Part| part.coverage == Column::ONES;
        if let (Some(tint), true) = (self.leaf.tint, self.leaf.parts.iter().any(plain)) {
            let coverage = self.largest(tint);
            self.leaf.parts.iter_mut().filter(|part| plain(part)).for_each(|part| part.coverage = coverage);
        }
        self.leaf
    }

    /// A column of the largest component of a color, which is how much a layer's top takes.
    fn largest(&mut self, tint: [Floats; 3]) -> Column {
        if tint == [Floats::Uniform(1.0); 3] {
            return Column::ONES;
        }
        let tree = self.tree;
        self.models.push_column(|lane| {
            let most = tint.iter().map(|&c| tree.float(c, lane).abs()).fold(0.0, f32::max);
            if most.is_finite() { most } else { 0.0 }
        })
    }
}
