//! Surfaces: the closures of a batch with their models, parameters and frames made ready for the lane loops.
//!
//! Normals: a zero normal becomes the geometric one. When the viewer is on the inner side of both normals (N and ng agree,
//! the viewer is behind), N is flipped and eta inverted, as OSL's Fresnel functions do. A shading normal that faces away
//! from a viewer in front of the surface is bent just so far that it does not.
//!
//! Decision (2026-11-22): such normals are bent instead of flipped, because a flipped one points into the surface and
//! turns black under the geometric test, and instead of rejected, which leaves black spots on bump maps.

use super::batch::{Each, Same, Triples, localise_lanes};
use crate::bsdf::Scatter;
use crate::bsdf::sheen::shadowing::Shadowing;
use crate::closure::tree::{Floats, Tree};
use crate::math::columns::Column3;
use crate::math::frame::Frame;
use glam::Vec3;

/// No index.
pub const NONE: u32 = u32::MAX;

/// The scattering models a lobe can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Lambert's reflection.
    Lambert,
    /// Lambert's transmission.
    Translucent,
    /// Rough diffuse reflection.
    OrenNayar,
    /// Sheen with its shadowing term, softened or not.
    Sheen(Shadowing, bool),
    /// Rough boundary.
    Microfacet {
        /// Beckmann's distribution, otherwise GGX.
        beckmann: bool,
        /// The refracting half, otherwise the reflecting one.
        refract: bool,
    },
    /// Smooth mirror.
    Reflection,
    /// Smooth refraction.
    Refraction,
    /// Straight through.
    Transparent,
}

impl Kind {
    /// True for lobes of one direction, which have no density.
    pub fn is_delta(self) -> bool {
        matches!(self, Kind::Reflection | Kind::Refraction | Kind::Transparent)
    }
}

/// Parameters of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Params {
    /// The same in every lane.
    Uniform([f32; 4]),
    /// Offsets of four columns in [`Surfaces::data`].
    Columns([u32; 4]),
}

/// One closure ready for the lane loops.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Its model.
    pub kind: Kind,
    /// Its parameters.
    pub params: Params,
    /// Its frame, or [`NONE`] for [`Kind::Transparent`].
    pub frame: u32,
    /// Offset in [`Surfaces::data`] of a column that is 1 where the surface exists and 0 elsewhere; [`NONE`] for all 1.
    pub gate: u32,
    /// The name of its closure.
    pub closure: &'static str,
}

/// What [`Surfaces::push`] makes a surface from.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// The model.
    pub kind: Kind,
    /// The closure's name.
    pub closure: &'static str,
    /// The frame, or [`NONE`].
    pub frame: u32,
    /// The parameters.
    pub params: [Floats; 4],
    /// How many of them count.
    pub count: usize,
    /// Which of them is an index of refraction.
    pub eta: Option<usize>,
    /// The gate, or [`NONE`].
    pub gate: u32,
}

/// A shading frame a lane.
#[derive(Debug, Default)]
pub struct FrameColumns {
    key: Option<([Floats; 3], Option<[Floats; 3]>)>,
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
    /// Lanes whose viewer is inside.
    pub inside: Vec<bool>,
    /// True when any lane is inside.
    pub any_inside: bool,
    /// Lanes whose normal is not a number.
    pub broken: Vec<bool>,
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
    /// The surfaces.
    pub list: Vec<Surface>,
    /// Columns of parameters and gates.
    pub data: Vec<f32>,
    frames: Vec<FrameColumns>,
    frames_used: usize,
}

/// How many of the newest frames are compared with a new one; a scene rarely has more normals than this.
const FRAMES_COMPARED: usize = 8;

impl Surfaces {
    /// Empties the store for a batch.
    pub fn clear(&mut self, lanes: usize) {
        self.lanes = lanes;
        self.list.clear();
        self.data.clear();
        self.frames_used = 0;
    }

    /// The frames in use.
    pub fn frames(&self) -> &[FrameColumns] {
        &self.frames[..self.frames_used]
    }

    /// Brings light directions into every frame in use.
    pub fn localise(&mut self, wi: &Column3) {
        for frame in &mut self.frames[..self.frames_used] {
            frame.localise(wi);
        }
    }

    /// A column of [`Surfaces::data`].
    pub fn column(&self, at: u32) -> &[f32] {
        &self.data[at as usize..at as usize + self.lanes]
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
            Params::Uniform(values) => values[index],
            Params::Columns(offsets) => self.data[offsets[index] as usize + lane],
        }
    }

    /// Adds a surface and gives its index. Its first `count` parameters come from the tree; the one at `eta` is inverted
    /// where the viewer is inside. Lanes with a parameter or normal that is not a number get a gate that is not a number.
    pub fn push(&mut self, tree: &Tree, request: Request) -> u32 {
        let Request { kind, closure, frame, params, count, eta, gate } = request;
        let (inside, broken) = match self.frames.get(frame as usize) {
            Some(f) => (f.any_inside && eta.is_some(), f.any_broken),
            None => (false, false),
        };
        let constant = params.map(|p| if let Floats::Uniform(v) = p { v } else { f32::NAN });
        let mut surface = Surface { kind, params: Params::Uniform(constant), frame, gate, closure };
        if inside || broken || constant[..count].iter().any(|v| !v.is_finite()) {
            let bad = |this: &Self, lane: usize| {
                broken && this.frames[frame as usize].broken[lane]
                    || params[..count].iter().any(|&p| !tree.float(p, lane).is_finite())
            };
            if (0..self.lanes).any(|lane| bad(self, lane)) {
                let gates: u32 = self.data.len() as u32;
                for lane in 0..self.lanes {
                    let value = if bad(self, lane) { f32::NAN } else { self.gate(&surface, lane) };
                    self.data.push(value);
                }
                surface.gate = gates;
            }
            let mut offsets = [0; 4];
            for k in 0..count {
                offsets[k] = self.data.len() as u32;
                for lane in 0..self.lanes {
                    let value = tree.float(params[k], lane);
                    let value = if value.is_finite() { value } else { 0.0 };
                    let flip = eta == Some(k) && inside && self.frames[frame as usize].inside[lane] && value > 0.0;
                    self.data.push(if flip { 1.0 / value } else { value });
                }
            }
            // The others are never read for their value.
            let first = offsets[0];
            offsets[count..].fill(first);
            surface.params = Params::Columns(offsets);
        }
        self.list.push(surface);
        self.list.len() as u32 - 1
    }

    /// The frame of a normal and tangent; one that was made for the same columns is used again.
    pub fn frame(
        &mut self,
        tree: &Tree,
        normal: [Floats; 3],
        tangent: Option<[Floats; 3]>,
        wo: &Column3,
        ng: &Column3,
    ) -> u32 {
        let newest = self.frames_used.saturating_sub(FRAMES_COMPARED);
        let key = Some((normal, tangent));
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
        for column in [&mut frame.tangent, &mut frame.bitangent, &mut frame.normal, &mut frame.wo, &mut frame.wi] {
            column.resize(n);
        }
        frame.inside.resize(n, false);
        frame.broken.resize(n, false);
        (frame.any_inside, frame.any_broken) = (false, false);
        let triple = |t: [Floats; 3], lane| Vec3::from_array(t.map(|c| tree.float(c, lane)));
        for lane in 0..n {
            let given = triple(normal, lane);
            let (n, inside) = facing(given, wo.get(lane), ng.get(lane));
            let axes = match tangent {
                Some(u) => Frame::from_normal_and_tangent(n, triple(u, lane)),
                None => Frame::from_normal(n),
            };
            frame.tangent.set(lane, axes.tangent);
            frame.bitangent.set(lane, axes.bitangent);
            frame.normal.set(lane, axes.normal);
            frame.wo.set(lane, axes.to_local(wo.get(lane)));
            frame.inside[lane] = inside;
            frame.any_inside |= inside;
            frame.broken[lane] = !given.is_finite();
            frame.any_broken |= frame.broken[lane];
        }
        index as u32
    }
}

/// The unit normal to shade with, and whether the viewer is on its inner side.
fn facing(given: Vec3, wo: Vec3, ng: Vec3) -> (Vec3, bool) {
    let fallback = if ng.length_squared() > 0.5 { ng } else { wo };
    let scale = given.abs().max_element();
    let usable = given.is_finite() && scale > 1e-18;
    // Dividing by the largest component first keeps the square of tiny and huge normals in range.
    let unit = if usable { (given / scale).normalize() } else { fallback };
    let inside = unit.dot(ng) * wo.dot(ng) < 0.0;
    let unit = if inside { -unit } else { unit };
    let cos = unit.dot(wo);
    // Below this the cosine of the viewer counts as negative.
    const LEAST: f32 = 1e-6;
    if cos < LEAST { ((unit + wo * (LEAST - cos)).normalize_or(wo), inside) } else { (unit, inside) }
}

/// A parameter source made for a model: what [`with_source`] hands to a lane loop.
pub fn same<M: Scatter>(params: [f32; 4]) -> Same<M> {
    Same(M::prepare(params))
}

/// The columns of a varying surface.
pub fn each(data: &[f32], offsets: [u32; 4], lanes: usize) -> Each<'_> {
    Each(offsets.map(|at| &data[at as usize..at as usize + lanes]))
}

/// Runs an expression with the type `$M` of a surface's model and a source `$source` of its constants.
/// Lobes of one direction have no lane loop and run nothing.
macro_rules! with_source {
    ($surfaces:expr, $surface:expr, |$M:ident, $source:ident| $body:expr) => {{
        use $crate::bsdf::sheen::shadowing::Shadowing;
        use $crate::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, Sheen};
        use $crate::bsdf::{lambert, microfacet::Microfacet, oren_nayar};
        use $crate::closure::surfaces::Kind;
        macro_rules! run {
            ($model:ty) => {{
                #[allow(unused)]
                type $M = $model;
                match $surface.params {
                    $crate::closure::surfaces::Params::Uniform(params) => {
                        let $source = $crate::closure::surfaces::same::<$M>(params);
                        $body
                    }
                    $crate::closure::surfaces::Params::Columns(offsets) => {
                        let $source = $crate::closure::surfaces::each(&$surfaces.data, offsets, $surfaces.lanes);
                        $body
                    }
                }
            }};
        }
        match $surface.kind {
            Kind::Lambert => run!(lambert::Lambert),
            Kind::Translucent => run!(lambert::Translucent),
            Kind::OrenNayar => run!(oren_nayar::OrenNayar),
            Kind::Sheen(Shadowing::Exact, true) => run!(Sheen<EXACT, true>),
            Kind::Sheen(Shadowing::Exact, false) => run!(Sheen<EXACT, false>),
            Kind::Sheen(Shadowing::Published, true) => run!(Sheen<PUBLISHED, true>),
            Kind::Sheen(Shadowing::Published, false) => run!(Sheen<PUBLISHED, false>),
            Kind::Sheen(Shadowing::Ashikhmin, _) => run!(Sheen<ASHIKHMIN, false>),
            Kind::Microfacet { beckmann: false, refract: false } => run!(Microfacet<false, false>),
            Kind::Microfacet { beckmann: false, refract: true } => run!(Microfacet<false, true>),
            Kind::Microfacet { beckmann: true, refract: false } => run!(Microfacet<true, false>),
            Kind::Microfacet { beckmann: true, refract: true } => run!(Microfacet<true, true>),
            Kind::Reflection | Kind::Refraction | Kind::Transparent => {}
        }
    }};
}
pub(super) use with_source;
