//! STAND-IN for the exec room, thrown away when the real one arrives: points, groups and a machine for fixed materials.

use crate::closure::Tree;
use crate::math::columns::Column3;
use glam::Vec3;

/// The most lanes of one batch.
pub const MAX_LANES: usize = 128;

/// What a shader can read of its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Global {
    P,
    I,
    N,
    Ng,
    U,
    V,
    DPdu,
    DPdv,
    /// Any of the derivatives of P.
    PDerivatives,
    /// Any of the derivatives of u and v.
    UvDerivatives,
    /// Any of the derivatives of I.
    IDerivatives,
    Time,
    SurfaceArea,
    RayType,
    Backfacing,
}

/// Shading points, structure of arrays.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct Points {
    pub len: usize,
    pub p: Column3,
    pub i: Column3,
    pub n: Column3,
    pub ng: Column3,
    pub u: Vec<f32>,
    pub v: Vec<f32>,
    pub dpdu: Column3,
    pub dpdv: Column3,
    pub dpdx: Column3,
    pub dpdy: Column3,
    pub dudx: Vec<f32>,
    pub dudy: Vec<f32>,
    pub dvdx: Vec<f32>,
    pub dvdy: Vec<f32>,
    pub didx: Column3,
    pub didy: Column3,
    pub time: Vec<f32>,
    pub surface_area: Vec<f32>,
    pub ray_type: Vec<i32>,
    pub backfacing: Vec<i32>,
}

impl Points {
    /// Makes room for `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.len = len;
        for column in [
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
        ] {
            column.resize(len);
        }
        for column in [
            &mut self.u,
            &mut self.v,
            &mut self.dudx,
            &mut self.dudy,
            &mut self.dvdx,
            &mut self.dvdy,
            &mut self.time,
            &mut self.surface_area,
        ] {
            column.resize(len, 0.0);
        }
        self.ray_type.resize(len, 0);
        self.backfacing.resize(len, 0);
    }
}

/// How a stand-in material emits.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub enum Emission {
    None,
    Uniform(Vec3),
    /// `power / (pi * surfacearea())`.
    Power(f32),
    /// A sky that is brighter upward: `base + gain * max(I.y, 0)^sharpness`.
    Sky {
        base: f32,
        gain: f32,
        sharpness: f32,
    },
    /// `2 u`, a light that varies over its surface.
    Ramp,
    /// Not a number.
    NotANumber,
}

/// A stand-in material: Lambert, a part that lets light straight through, and emission.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct Group {
    pub albedo: Vec3,
    pub through: f32,
    pub emission: Emission,
}

impl Group {
    /// True when the material's result depends on `global`.
    pub fn reads(&self, global: Global) -> bool {
        match self.emission {
            Emission::Sky { .. } if global == Global::I => true,
            Emission::Ramp if global == Global::U => true,
            Emission::Power(_) if global == Global::SurfaceArea => true,
            _ => self.can_scatter() && global == Global::N,
        }
    }
    /// True when it may emit.
    pub fn can_emit(&self) -> bool {
        !matches!(self.emission, Emission::None)
    }
    /// True when it may scatter.
    pub fn can_scatter(&self) -> bool {
        self.albedo.max_element() > 0.0 || self.through > 0.0
    }
    /// The emission when it is one constant.
    pub fn emission_is_uniform(&self) -> Option<[f32; 3]> {
        match self.emission {
            Emission::Uniform(c) => Some(c.to_array()),
            _ => None,
        }
    }
}

/// Scratch of the stand-in interpreter.
#[derive(Default)]
pub struct Machine {
    tree: Tree,
}

impl Machine {
    /// A fresh one.
    pub fn new() -> Self {
        Self::default()
    }
    /// Shades a batch.
    pub fn shade<'m>(&'m mut self, group: &Group, points: &Points) -> &'m Tree {
        let len = points.len;
        self.tree.n.clone_from(&points.n);
        self.tree.albedo = group.albedo;
        self.tree.through = group.through;
        self.tree.emission.resize(len);
        for lane in 0..len {
            let e = match group.emission {
                Emission::None => Vec3::ZERO,
                Emission::Uniform(c) => c,
                Emission::Power(w) => Vec3::splat(w / (std::f32::consts::PI * points.surface_area[lane])),
                Emission::Sky { base, gain, sharpness } => {
                    Vec3::splat(base + gain * points.i.y[lane].max(0.0).powf(sharpness))
                }
                Emission::Ramp => Vec3::splat(2.0 * points.u[lane]),
                Emission::NotANumber => Vec3::splat(f32::NAN),
            };
            self.tree.emission.set(lane, e);
        }
        &self.tree
    }
    /// What was printed.
    pub fn take_reports(&mut self) -> Vec<String> {
        Vec::new()
    }
}
