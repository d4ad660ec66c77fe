//! Surfaces: the closures of a batch with their models, parameters and frames made ready for the lane loops.
//!
//! Normals: a zero normal becomes the geometric one. When the viewer is on the inner side of both normals (N and ng agree,
//! the viewer is behind), N is flipped and eta inverted, as OSL's Fresnel functions do. A shading normal that faces away
//! from a viewer in front of the surface is bent just so far that it does not.
//!
//! Decision (2026-11-22): such normals are bent instead of flipped, because a flipped one points into the surface and
//! turns black under the geometric test, and instead of rejected, which leaves black spots on bump maps.

use super::batch::{Each, Same, Triples, Views, localise_lanes, view_lanes};
use super::kinds::{Kind, with_source};
use super::media::Media;
use super::normals::{NormalColumns, normal_lanes, tangent_lanes};
use super::settings::SheenAlbedo;
use super::store::Store;
use super::weights::all_finite;
use crate::bsdf::{MAX_PARAMS, Params, Scatter};
use crate::closure::tree::{Floats, Tree};
use crate::math::columns::Column3;
use crate::math::frame::Frame;
use glam::Vec3;

/// No index.
pub const NONE: u32 = u32::MAX;

/// Parameters of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// The same in every lane.
    Uniform(Params),
    /// Offsets of columns in [`Surfaces::data`].
    Columns([u32; MAX_PARAMS]),
}

/// One closure ready for the lane loops.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Its model.
    pub kind: Kind,
    /// Its parameters.
    pub params: Values,
    /// Its frame, or [`NONE`] for [`Kind::Transparent`].
    pub frame: u32,
    /// Offset in [`Surfaces::data`] of a column that is 1 where the surface exists and 0 elsewhere; [`NONE`] for all 1.
    pub gate: u32,
    /// Offset in [`Surfaces::views`] of what its model derives from the viewer.
    pub view: u32,
    /// The name of its closure.
    pub closure: &'static str,
}

/// What [`Surfaces::push`] makes a surface from.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The model.
    pub kind: Kind,
    /// The closure's name.
    pub closure: &'static str,
    /// The frame, or [`NONE`].
    pub frame: u32,
    /// The parameters.
    pub params: &'a [Floats],
    /// Which of them is an index of refraction.
    pub eta: Option<usize>,
    /// The gate, or [`NONE`].
    pub gate: u32,
}

/// A shading frame a lane.
#[derive(Debug, Default)]
pub struct FrameColumns {
    key: Option<([Floats; 3], Option<[Floats; 3]>, u32)>,
    /// The medium its directions run in, or [`NONE`].
    pub medium: u32,
    /// Tangents.
    pub tangent: Column3,
    /// Bitangents.
    pub bitangent: Column3,
    /// Shading normals.
    pub normal: Column3,
    /// The viewer in local coordinates.
    pub wo: Column3,
    /// The light in local coordinates, as of the last evaluation.
    pub wi: Column3,
    /// 1 in lanes whose viewer is inside.
    pub inside: Vec<f32>,
    /// True when any lane is inside.
    pub any_inside: bool,
    /// 1 in lanes whose normal is not a number.
    pub broken: Vec<f32>,
    /// True when any lane is broken.
    pub any_broken: bool,
}

impl FrameColumns {
    /// The three axes as slices.
    pub fn axes(&self) -> [Triples<'_>; 3] {
        [Triples::of(&self.tangent), Triples::of(&self.bitangent), Triples::of(&self.normal)]
    }

    /// Brings light directions into local coordinates.
    pub fn localise(&mut self, wi: &Column3) {
        let axes = [Triples::of(&self.tangent), Triples::of(&self.bitangent), Triples::of(&self.normal)];
        localise_lanes(axes, Triples::of(wi), &mut self.wi.x, &mut self.wi.y, &mut self.wi.z);
    }
}

/// All surfaces of a batch.
#[derive(Debug, Default)]
pub struct Surfaces {
    /// Number of lanes.
    pub lanes: usize,
    /// How the albedo of sheens is found.
    pub sheen_albedo: SheenAlbedo,
    /// The surfaces.
    pub list: Vec<Surface>,
    /// Columns of parameters and gates.
    pub data: Vec<f32>,
    views: Store,
    given: Column3,
    frames: Vec<FrameColumns>,
    frames_used: usize,
}

/// How a surface is seen.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The viewer, as its direction runs in the medium.
    pub wo: &'a Column3,
    /// Geometric normals.
    pub ng: &'a Column3,
    /// The medium over the surface, or [`NONE`].
    pub medium: u32,
}

/// How many of the newest frames are compared with a new one; a scene rarely has more normals than this.
const FRAMES_COMPARED: usize = 8;

impl Surfaces {
    /// Empties the store for a batch.
    pub fn clear(&mut self, lanes: usize) {
        self.lanes = lanes;
        self.list.clear();
        self.data.clear();
        self.views.clear();
        self.frames_used = 0;
    }

    /// The frames in use.
    pub fn frames(&self) -> &[FrameColumns] {
        &self.frames[..self.frames_used]
    }

    /// Brings light directions into every frame in use.
    pub fn localise(&mut self, media: &Media, wi: &Column3) {
        for frame in &mut self.frames[..self.frames_used] {
            frame.localise(media.get(frame.medium).map_or(wi, |medium| &medium.wi));
        }
    }

    /// A column of [`Surfaces::data`].
    pub fn column(&self, at: u32) -> &[f32] {
        &self.data[at as usize..at as usize + self.lanes]
    }

    /// A column of one number.
    pub fn push_constant(&mut self, value: f32) -> u32 {
        let at = self.data.len();
        self.data.resize(at + self.lanes, value);
        at as u32
    }

    /// Makes a column from a function of the lane and gives its offset.
    pub fn push_column(&mut self, value: impl FnMut(usize) -> f32) -> u32 {
        let at = self.data.len() as u32;
        self.data.extend((0..self.lanes).map(value));
        at
    }

    /// The gate's value in a lane.
    pub fn gate(&self, surface: &Surface, lane: usize) -> f32 {
        if surface.gate == NONE { 1.0 } else { self.data[surface.gate as usize + lane] }
    }

    /// A parameter of a surface in a lane.
    pub fn param(&self, surface: &Surface, index: usize, lane: usize) -> f32 {
        match surface.params {
            Values::Uniform(values) => values[index],
            Values::Columns(offsets) => self.data[offsets[index] as usize + lane],
        }
    }

    /// All parameters of a surface in a lane; those that its model does not read may be anything.
    pub fn params(&self, surface: &Surface, lane: usize) -> Params {
        std::array::from_fn(|index| self.param(surface, index, lane))
    }

    /// Adds a surface and gives its index. Its parameters come from the tree; the one at `eta` is inverted
    /// where the viewer is inside. Lanes with a parameter or normal that is not a number get a gate that is not a number.
    pub fn push(&mut self, tree: &Tree, request: Request) -> u32 {
        let Request { kind, closure, frame, params, eta, gate } = request;
        let (inside, broken) = match self.frames.get(frame as usize) {
            Some(f) => (f.any_inside && eta.is_some(), f.any_broken),
            None => (false, false),
        };
        let mut constant = [0.0; MAX_PARAMS];
        for (value, &param) in constant.iter_mut().zip(params) {
            *value = if let Floats::Uniform(v) = param { v } else { f32::NAN };
        }
        let mut surface = Surface { kind, params: Values::Uniform(constant), frame, gate, view: 0, closure };
        if inside || broken || constant.iter().any(|v| !v.is_finite()) {
            let finite = params.iter().all(|&param| match param {
                Floats::Uniform(value) => value.is_finite(),
                Floats::Varying(at) => all_finite(tree.column(at)),
            });
            if broken || !finite {
                surface.gate = self.push_gate(tree, &surface, params, broken);
            }
            // The others are never read.
            let mut offsets = [0; MAX_PARAMS];
            for k in 0..params.len() {
                let flips = inside && eta == Some(k);
                offsets[k] = self.push_param(tree, params[k], flips.then_some(frame), finite);
            }
            surface.params = Values::Columns(offsets);
        }
        self.list.push(surface);
        self.look();
        self.list.len() as u32 - 1
    }

    /// A surface's gate, not a number in lanes with a parameter or normal that is none.
    fn push_gate(&mut self, tree: &Tree, surface: &Surface, params: &[Floats], broken: bool) -> u32 {
        let bad = |this: &Self, lane: usize| {
            broken && this.frames[surface.frame as usize].broken[lane] > 0.0
                || params.iter().any(|&p| !tree.float(p, lane).is_finite())
        };
        if !(0..self.lanes).any(|lane| bad(self, lane)) {
            return surface.gate;
        }
        let at = self.data.len() as u32;
        for lane in 0..self.lanes {
            let value = if bad(self, lane) { f32::NAN } else { self.gate(surface, lane) };
            self.data.push(value);
        }
        at
    }

    /// A column of a parameter, 0 where it is no number; inverted in the lanes that are inside the frame `flip`.
    fn push_param(&mut self, tree: &Tree, param: Floats, flip: Option<u32>, finite: bool) -> u32 {
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
                    let inside = flip.is_some_and(|frame| self.frames[frame as usize].inside[lane] > 0.0);
                    self.data.push(if inside && value > 0.0 { 1.0 / value } else { value });
                }
            }
        }
        at as u32
    }

    /// Computes what the newest surface derives from the viewer.
    fn look(&mut self) {
        let n = self.lanes;
        let Some(mut surface) = self.list.pop() else { return };
        surface.view = self.views.len() as u32;
        if !surface.kind.is_delta() {
            let mut views = std::mem::take(&mut self.views);
            let wo = Triples::of(&self.frames[surface.frame as usize].wo);
            with_source!(self, surface, |M, source| {
                let at = views.take(n * M::VIEW);
                view_lanes::<M, _>(source, wo, &mut views[at..]);
            });
            self.views = views;
        }
        self.list.push(surface);
    }

    /// What a surface's model derives from the viewer.
    pub fn views(&self, surface: &Surface) -> Views<'_> {
        Views(&self.views[surface.view as usize..])
    }

    /// The frame of a normal and tangent; one that was made for the same columns is used again.
    pub fn frame(&mut self, tree: &Tree, normal: [Floats; 3], tangent: Option<[Floats; 3]>, seen: &Seen) -> u32 {
        let Seen { wo, ng, medium } = *seen;
        let newest = self.frames_used.saturating_sub(FRAMES_COMPARED);
        let key = Some((normal, tangent, medium));
        if let Some(found) = (newest..self.frames_used).find(|&i| self.frames[i].key == key) {
            return found as u32;
        }
        if self.frames_used == self.frames.len() {
            self.frames.push(FrameColumns::default());
        }
        let (index, n) = (self.frames_used, self.lanes);
        self.frames_used += 1;
        let frame = &mut self.frames[index];
        frame.key = key;
        frame.medium = medium;
        for column in [&mut frame.tangent, &mut frame.bitangent, &mut frame.normal, &mut frame.wo, &mut frame.wi] {
            column.resize(n);
        }
        frame.inside.resize(n, 0.0);
        frame.broken.resize(n, 0.0);
        for (k, column) in [&mut self.given.x, &mut self.given.y, &mut self.given.z].into_iter().enumerate() {
            if let Floats::Uniform(value) = normal[k] {
                column.clear();
                column.resize(n, value);
            }
        }
        let given = Triples {
            x: column_of(tree, normal[0], &self.given.x),
            y: column_of(tree, normal[1], &self.given.y),
            z: column_of(tree, normal[2], &self.given.z),
        };
        let from = NormalColumns { given, wo: Triples::of(wo), ng: Triples::of(ng) };
        let normals = &mut frame.normal;
        normal_lanes(from, &mut normals.x, &mut normals.y, &mut normals.z, &mut frame.inside, &mut frame.broken);
        (frame.any_inside, frame.any_broken) = (any(&frame.inside), any(&frame.broken));
        let (t, b) = (&mut frame.tangent, &mut frame.bitangent);
        tangent_lanes(Triples::of(&frame.normal), &mut t.x, &mut t.y, &mut t.z, &mut b.x, &mut b.y, &mut b.z);
        if let Some(u) = tangent {
            for lane in 0..n {
                let u = Vec3::from_array(u.map(|c| tree.float(c, lane)));
                let axes = Frame::from_normal_and_tangent(frame.normal.get(lane), u);
                frame.tangent.set(lane, axes.tangent);
                frame.bitangent.set(lane, axes.bitangent);
            }
        }
        let axes = [Triples::of(&frame.tangent), Triples::of(&frame.bitangent), Triples::of(&frame.normal)];
        localise_lanes(axes, Triples::of(wo), &mut frame.wo.x, &mut frame.wo.y, &mut frame.wo.z);
        index as u32
    }
}

/// Is any number not +0? Words need no order, as a sum of floats would.
fn any(values: &[f32]) -> bool {
    values.iter().fold(0, |bits, value| bits | value.to_bits()) != 0
}

/// A column of the tree, or another in place of a single number.
fn column_of<'a>(tree: &'a Tree, from: Floats, single: &'a [f32]) -> &'a [f32] {
    match from {
        Floats::Uniform(_) => single,
        Floats::Varying(at) => tree.column(at),
    }
}

/// A parameter source made for a model: what [`with_source`] hands to a lane loop.
pub fn same<M: Scatter>(params: Params) -> Same<M> {
    Same(M::prepare(params))
}

/// The columns of a varying surface.
pub fn each(data: &[f32], offsets: [u32; MAX_PARAMS], lanes: usize) -> Each<'_> {
    Each(offsets.map(|at| &data[at as usize..at as usize + lanes]))
}
