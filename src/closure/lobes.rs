//! STAND-IN for the lobes of the closure room.

use crate::math::columns::Column3;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// A stand-in closure tree.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct Tree {
    pub n: Column3,
    pub albedo: Vec3,
    pub through: f32,
    pub emission: Column3,
}

/// How a layer scales its base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Layering {
    #[default]
    Min,
    View,
    Kelemen,
}

/// Which shadowing the sheen uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Shadowing {
    #[default]
    Exact,
    Published,
    Ashikhmin,
}

/// What the lobes may be told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct Settings {
    pub layering: Layering,
    pub shadowing: Shadowing,
    pub softening: bool,
}

/// All lobes toward one direction.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct Evaluation {
    pub f_cos: Column3,
    pub pdf: Vec<f32>,
}

/// One sampled direction a lane.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct Samples {
    pub wi: Column3,
    pub weight: Column3,
    pub pdf: Vec<f32>,
    pub event: Vec<u8>,
}

/// The stand-in lobes of a batch.
#[derive(Default)]
pub struct Lobes {
    tree: Tree,
    wo: Column3,
    holdout: Vec<f32>,
}

impl Lobes {
    /// Fresh scratch.
    pub fn new(_: Settings) -> Self {
        Self::default()
    }
    /// Takes the tree of a batch.
    pub fn flatten(&mut self, tree: &Tree, wo: &Column3, _ng: &Column3) {
        self.tree.n.clone_from(&tree.n);
        self.tree.emission.clone_from(&tree.emission);
        self.tree.albedo = tree.albedo;
        self.tree.through = tree.through;
        self.wo.clone_from(wo);
        self.holdout.clear();
        self.holdout.resize(wo.len(), 0.0);
    }
    /// Emitted radiance.
    pub fn emission(&self) -> &Column3 {
        &self.tree.emission
    }
    /// True when light sampling makes sense.
    pub fn has_non_delta(&self) -> bool {
        self.tree.albedo.max_element() > 0.0
    }
    /// All lobes toward `wi`.
    pub fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation) {
        let len = wi.len();
        out.f_cos.resize(len);
        out.pdf.resize(len, 0.0);
        for lane in 0..len {
            let cos = self.tree.n.get(lane).dot(wi.get(lane)).max(0.0) * FRAC_1_PI;
            out.pdf[lane] = cos * (1.0 - self.tree.through);
            out.f_cos.set(lane, cos * self.tree.albedo);
        }
    }
    /// Samples one direction a lane.
    pub fn sample(&mut self, xi: &Column3, out: &mut Samples) {
        let len = self.wo.len();
        out.wi.resize(len);
        out.weight.resize(len);
        out.pdf.resize(len, 0.0);
        out.event.resize(len, 0);
        let through = self.tree.through;
        for lane in 0..len {
            let x = xi.get(lane);
            if x.z < through {
                out.wi.set(lane, -self.wo.get(lane));
                out.weight.set(lane, Vec3::ONE);
                out.pdf[lane] = 1.0;
                out.event[lane] = 5;
                continue;
            }
            let n = self.tree.n.get(lane);
            let (sin, cos) = (2.0 * PI * x.x).sin_cos();
            let radius = x.y.sqrt();
            let (t, b) = n.any_orthonormal_pair();
            let height = (1.0 - x.y).max(0.0).sqrt();
            let wi = (t * (radius * cos) + b * (radius * sin) + n * height).normalize();
            out.wi.set(lane, wi);
            out.weight.set(lane, self.tree.albedo / (1.0 - through));
            out.pdf[lane] = wi.dot(n).max(0.0) * FRAC_1_PI * (1.0 - through);
            out.event[lane] = if out.pdf[lane] > 0.0 { 1 } else { 0 };
        }
    }
    /// Removed alpha.
    pub fn holdout(&self) -> &Vec<f32> {
        &self.holdout
    }
}
