//! The points of one batch: what the renderer gives to a shader.

use crate::ir::op::Input;
use crate::lang::globals::Global;
use crate::math::columns::Column3;

/// How many points a batch holds at most, and by default.
///
/// Decision (2026-11-23): 512, because the fixed costs of a batch (decoding its instructions, visiting the nodes of its tree) are some
/// 2 µs, and columns of two kilobytes still lie in the second cache: a weave with its lobes took 48 ns a point instead of 51
/// (256 lanes) or 59 (128), its pattern 28 instead of 29 or 32, a loop of 110 operations 24 instead of 26 or 32 (before pairs
/// of operations were fused); scenes render as fast or up to 10 % faster; instead of 128, whose columns lie in the first cache.
pub const MAX_LANES: usize = 512;

/// Bits of [`Points::ray_type`], tested by `raytype("…")`.
pub const RAY_TYPES: &[(&str, i32)] = &[
    ("camera", 1),
    ("shadow", 2),
    ("diffuse", 4),
    ("glossy", 8),
    ("reflection", 16),
    ("refraction", 32),
    ("displacement", 64),
];

/// Shading points, a column a quantity.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// The number of points, at most [`MAX_LANES`].
    pub len: usize,
    /// `P`
    pub p: Column3,
    /// `I`, unit length, from the eye to the point.
    pub i: Column3,
    /// `N`, unit length.
    pub n: Column3,
    /// `Ng`, unit length.
    pub ng: Column3,
    /// `u`
    pub u: Vec<f32>,
    /// `v`
    pub v: Vec<f32>,
    /// `dPdu`
    pub dpdu: Column3,
    /// `dPdv`
    pub dpdv: Column3,
    /// Derivative of `P` along the screen's x.
    pub dpdx: Column3,
    /// Derivative of `P` along the screen's y.
    pub dpdy: Column3,
    /// Derivative of `u` along x.
    pub dudx: Vec<f32>,
    /// Derivative of `u` along y.
    pub dudy: Vec<f32>,
    /// Derivative of `v` along x.
    pub dvdx: Vec<f32>,
    /// Derivative of `v` along y.
    pub dvdy: Vec<f32>,
    /// Derivative of `I` along x.
    pub didx: Column3,
    /// Derivative of `I` along y.
    pub didy: Column3,
    /// `time`
    pub time: Vec<f32>,
    /// `surfacearea()`: area of the whole object.
    pub surface_area: Vec<f32>,
    /// Bits of [`RAY_TYPES`].
    pub ray_type: Vec<i32>,
    /// `backfacing()`
    pub backfacing: Vec<i32>,
    /// A number of each point, for hosts that answer `"shading:index"`.
    pub index: Vec<i32>,
}

impl Points {
    /// Points that are all zero.
    pub fn new(len: usize) -> Self {
        let mut points = Points::default();
        points.resize(len);
        points
    }

    /// One point as most tests want it: at the origin of the plane z = 0, seen from `eye` above it.
    pub fn single(eye: glam::Vec3) -> Self {
        let mut points = Points::new(1);
        let up = glam::Vec3::Z;
        points.i.set(0, -eye.normalize_or(up));
        points.n.set(0, up);
        points.ng.set(0, up);
        points.dpdu.set(0, glam::Vec3::X);
        points.dpdv.set(0, glam::Vec3::Y);
        points.ray_type[0] = 1;
        points.surface_area[0] = 1.0;
        points
    }

    /// Makes room for `len` points; new ones are zero.
    pub fn resize(&mut self, len: usize) {
        self.len = len;
        let triples = [
            &mut self.p,
            &mut self.i,
            &mut self.n,
            &mut self.ng,
            &mut self.dpdu,
            &mut self.dpdv,
            &mut self.dpdx,
            &mut self.dpdy,
            &mut self.didx,
            &mut self.didy,
        ];
        triples.into_iter().for_each(|column| column.resize(len));
        let floats = [
            &mut self.u,
            &mut self.v,
            &mut self.dudx,
            &mut self.dudy,
            &mut self.dvdx,
            &mut self.dvdy,
            &mut self.time,
            &mut self.surface_area,
        ];
        floats.into_iter().for_each(|column| column.resize(len, 0.0));
        self.ray_type.resize(len, 0);
        self.backfacing.resize(len, 0);
        self.index.resize(len, 0);
    }

    /// The column of a float input, or nothing when it is zero everywhere.
    pub(super) fn column(&self, input: Input) -> Option<&[f32]> {
        let triple = match input {
            Input::Global(Global::P | Global::Ps, c) => (&self.p, c),
            Input::Global(Global::I, c) => (&self.i, c),
            Input::Global(Global::N, c) => (&self.n, c),
            Input::Global(Global::Ng, c) => (&self.ng, c),
            Input::Global(Global::DPdu, c) => (&self.dpdu, c),
            Input::Global(Global::DPdv, c) => (&self.dpdv, c),
            Input::GlobalDx(Global::P | Global::Ps, c) => (&self.dpdx, c),
            Input::GlobalDy(Global::P | Global::Ps, c) => (&self.dpdy, c),
            Input::GlobalDx(Global::I, c) => (&self.didx, c),
            Input::GlobalDy(Global::I, c) => (&self.didy, c),
            Input::Global(Global::U, _) => return Some(&self.u),
            Input::Global(Global::V, _) => return Some(&self.v),
            Input::GlobalDx(Global::U, _) => return Some(&self.dudx),
            Input::GlobalDy(Global::U, _) => return Some(&self.dudy),
            Input::GlobalDx(Global::V, _) => return Some(&self.dvdx),
            Input::GlobalDy(Global::V, _) => return Some(&self.dvdy),
            Input::Global(Global::Time, _) => return Some(&self.time),
            Input::SurfaceArea => return Some(&self.surface_area),
            // Nothing moves: these are zero, and so is what has no derivative here.
            Input::Global(Global::Dtime | Global::DPdtime | Global::Ci, _) => return None,
            Input::GlobalDx(Global::N | Global::Ng | Global::DPdu | Global::DPdv | Global::Time, _) => return None,
            Input::GlobalDy(Global::N | Global::Ng | Global::DPdu | Global::DPdv | Global::Time, _) => return None,
            Input::GlobalDx(Global::Dtime | Global::DPdtime | Global::Ci, _) => return None,
            Input::GlobalDy(Global::Dtime | Global::DPdtime | Global::Ci, _) => return None,
            Input::Backfacing => return None,
        };
        Some(match triple.1 {
            0 => &triple.0.x,
            1 => &triple.0.y,
            _ => &triple.0.z,
        })
    }
}
