//! Models of a batch's lobes: what closures scatter, with parameters and frames made ready for the lane loops.

use super::coats::Coats;
use super::frames::{FrameColumns, Frames, Seen};
use super::lobe_kind::LobeKind;
use super::settings::SheenAlbedo;
use super::source::{Numbers, Triples, Views};
use super::store::{NONE, Store};
use super::tree::{Floats, Tree};
use super::weights::all_finite;
use crate::bsdf::{Choice, MAX_PARAMS, Params};
use crate::math::columns::Column3;

/// A column of [`LobeModels`]: what lanes a part of a leaf exists in, or how much of its base it covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column(u32);

impl Column {
    /// 1 in every lane.
    pub const ONES: Column = Column(0);
}

/// Parameters of a lobe's model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// The same in every lane.
    Uniform(Params),
    /// Offsets of columns.
    Columns([u32; MAX_PARAMS]),
}

/// One model ready for the lane loops.
#[derive(Clone, Copy, Debug)]
pub struct LobeModel {
    /// Its lane loops.
    pub kind: LobeKind,
    /// Which way of several its model goes.
    pub choice: Choice,
    /// Its parameters.
    pub params: Values,
    /// Its frame, or [`NONE`] for [`LobeKind::STRAIGHT`].
    pub frame: u32,
    /// 1 where it exists and 0 elsewhere; not a number where its parameters are none.
    pub gate: Column,
    /// Offset of what its model derives from the viewer.
    view: u32,
    /// The name of its closure.
    pub closure: &'static str,
}

/// What [`LobeModels::push`] makes a model from.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The kind.
    pub kind: LobeKind,
    /// Which way of several.
    pub choice: Choice,
    /// The closure's name.
    pub closure: &'static str,
    /// The frame, or [`NONE`].
    pub frame: u32,
    /// The parameters.
    pub params: &'a [Floats],
    /// Which of them is an index of refraction.
    pub eta: Option<usize>,
    /// Where the index is inverted although the frame faces the viewer: in lanes that are not 0. Empty means nowhere.
    pub backfacing: &'a [i32],
    /// Where it exists.
    pub gate: Column,
}

/// All models of a batch.
#[derive(Debug, Default)]
pub struct LobeModels {
    /// Number of lanes.
    pub lanes: usize,
    /// How the albedo of sheens is found.
    pub sheen_albedo: SheenAlbedo,
    /// The models.
    pub list: Vec<LobeModel>,
    /// Columns of parameters, gates and coverages.
    data: Vec<f32>,
    views: Store,
    frames: Frames,
}

impl LobeModels {
    /// Empties the store for a batch.
    pub fn clear(&mut self, lanes: usize) {
        self.lanes = lanes;
        self.list.clear();
        self.data.clear();
        self.views.clear();
        self.frames.clear();
        // See `Column::ONES`.
        self.data.resize(lanes, 1.0);
    }

    /// The frames in use.
    pub fn frames(&self) -> &[FrameColumns] {
        self.frames.list()
    }

    /// The frame of a normal and tangent.
    pub fn frame(&mut self, tree: &Tree, normal: [Floats; 3], tangent: Option<[Floats; 3]>, seen: &Seen) -> u32 {
        self.frames.push(tree, normal, tangent, seen, false)
    }

    /// The frame of a normal and tangent for lobes about the mirror direction.
    pub fn mirror_frame(&mut self, tree: &Tree, normal: [Floats; 3], tangent: Option<[Floats; 3]>, seen: &Seen) -> u32 {
        self.frames.push_mirror(tree, normal, tangent, seen)
    }

    /// Brings light directions into every frame in use.
    pub fn localise(&mut self, coats: &Coats, wi: &Column3) {
        for frame in self.frames.list_mut() {
            frame.localise(coats.get(frame.coat).map_or(wi, |coat| &coat.wi));
        }
    }

    /// The numbers of a column.
    pub fn column(&self, column: Column) -> &[f32] {
        self.at(column.0)
    }

    fn at(&self, offset: u32) -> &[f32] {
        &self.data[offset as usize..offset as usize + self.lanes]
    }

    /// A column of one number.
    pub fn push_constant(&mut self, value: f32) -> Column {
        let at = self.data.len();
        self.data.resize(at + self.lanes, value);
        Column(at as u32)
    }

    /// Makes a column from a function of the lane.
    pub fn push_column(&mut self, value: impl FnMut(usize) -> f32) -> Column {
        let at = self.data.len() as u32;
        self.data.extend((0..self.lanes).map(value));
        Column(at)
    }

    /// The gate's value in a lane.
    pub fn gate(&self, model: &LobeModel, lane: usize) -> f32 {
        if model.gate == Column::ONES { 1.0 } else { self.data[model.gate.0 as usize + lane] }
    }

    /// A column of the parameter that a model reads first, where it differs between lanes.
    pub fn first_param(&self, model: &LobeModel) -> Option<&[f32]> {
        if let Values::Columns(offsets) = model.params { Some(self.at(offsets[0])) } else { None }
    }

    /// A parameter of a model in a lane.
    pub fn param(&self, model: &LobeModel, index: usize, lane: usize) -> f32 {
        match model.params {
            Values::Uniform(values) => values[index],
            Values::Columns(offsets) => self.data[offsets[index] as usize + lane],
        }
    }

    /// All parameters of a model in a lane; those that it does not read may be anything.
    pub fn params(&self, model: &LobeModel, lane: usize) -> Params {
        std::array::from_fn(|index| self.param(model, index, lane))
    }

    /// The parameters of a model as the lane loops take them.
    pub fn numbers(&self, model: &LobeModel) -> Numbers<'_> {
        match model.params {
            Values::Uniform(params) => Numbers::Same(params),
            Values::Columns(offsets) => Numbers::Each(offsets.map(|at| self.at(at))),
        }
    }

    /// Adds a model and gives its index. Its parameters come from the tree; the one at `eta` is inverted
    /// where the viewer is inside. Lanes with a parameter or normal that is not a number get a gate that is not a number.
    pub fn push(&mut self, tree: &Tree, request: Request) -> u32 {
        let Request { kind, choice, closure, frame, params, eta, backfacing, gate } = request;
        // What a model cannot read is not kept.
        let params = &params[..params.len().min(MAX_PARAMS)];
        let (inside, broken) = match self.frames.list().get(frame as usize) {
            Some(f) => (eta.is_some() && (f.any_inside || !backfacing.is_empty()), f.any_broken),
            None => (false, false),
        };
        let mut constant = [0.0; MAX_PARAMS];
        for (value, &param) in constant.iter_mut().zip(params) {
            *value = if let Floats::Uniform(v) = param { v } else { f32::NAN };
        }
        let mut model = LobeModel { kind, choice, params: Values::Uniform(constant), frame, gate, view: 0, closure };
        if inside || broken || constant.iter().any(|v| !v.is_finite()) {
            let finite = params.iter().all(|&param| match param {
                Floats::Uniform(value) => value.is_finite(),
                Floats::Varying(at) => all_finite(tree.column(at)),
            });
            if broken || !finite {
                model.gate = self.push_gate(tree, &model, params, broken);
            }
            // Those that are read and were not given are 0; the others are never read.
            let missing = kind.loops().is_some_and(|loops| loops.params > params.len());
            let mut offsets = [if missing { self.push_constant(0.0).0 } else { 0 }; MAX_PARAMS];
            for k in 0..params.len() {
                let flips = inside && eta == Some(k);
                offsets[k] = self.push_param(tree, params[k], flips.then_some((frame, backfacing)), finite);
            }
            model.params = Values::Columns(offsets);
        }
        self.look(&mut model);
        self.list.push(model);
        self.list.len() as u32 - 1
    }

    /// A model's gate, not a number in lanes with a parameter or normal that is none.
    fn push_gate(&mut self, tree: &Tree, model: &LobeModel, params: &[Floats], broken: bool) -> Column {
        let bad = |this: &Self, lane: usize| {
            broken && this.frames()[model.frame as usize].broken[lane] > 0.0
                || params.iter().any(|&p| !tree.float(p, lane).is_finite())
        };
        if !(0..self.lanes).any(|lane| bad(self, lane)) {
            return model.gate;
        }
        let at = self.data.len() as u32;
        for lane in 0..self.lanes {
            let value = if bad(self, lane) { f32::NAN } else { self.gate(model, lane) };
            self.data.push(value);
        }
        Column(at)
    }

    /// A column of a parameter, 0 where it is no number; inverted in the lanes that are inside the frame of `flip`, or that the
    /// list beside it says.
    fn push_param(&mut self, tree: &Tree, param: Floats, flip: Option<(u32, &[i32])>, finite: bool) -> u32 {
        let at = self.data.len();
        match (param, flip) {
            (Floats::Varying(from), None) if finite => {
                self.data.extend_from_slice(tree.column(from));
            }
            (Floats::Uniform(value), None) => {
                self.data.resize(at + self.lanes, if value.is_finite() { value } else { 0.0 });
            }
            _ => {
                for lane in 0..self.lanes {
                    let value = tree.float(param, lane);
                    let value = if value.is_finite() { value } else { 0.0 };
                    let inside = flip.is_some_and(|(frame, backfacing)| {
                        self.frames()[frame as usize].inside[lane] > 0.0
                            || backfacing.get(lane).is_some_and(|b| *b != 0)
                    });
                    self.data.push(if inside && value > 0.0 { 1.0 / value } else { value });
                }
            }
        }
        at as u32
    }

    /// Computes what a model derives from the viewer.
    fn look(&mut self, model: &mut LobeModel) {
        model.view = self.views.len() as u32;
        let Some(loops) = model.kind.loops() else { return };
        let mut views = std::mem::take(&mut self.views);
        let at = views.take(self.lanes * loops.views);
        let wo = Triples::of(&self.frames()[model.frame as usize].wo);
        (loops.view)(self.numbers(model), model.choice, wo, &mut views[at..]);
        self.views = views;
    }

    /// What a model derives from the viewer.
    pub fn views(&self, model: &LobeModel) -> Views<'_> {
        Views(&self.views[model.view as usize..])
    }

    /// The frame of a model; nothing for light that passes straight on.
    pub fn frame_of(&self, model: &LobeModel) -> Option<&FrameColumns> {
        if model.frame == NONE { None } else { self.frames().get(model.frame as usize) }
    }
}
