//! The flat form of a closure tree: lobes with their weights, layers and coats. Flattening makes it, evaluating and sampling
//! read it.

use super::coats::Coats;
use super::layering::Layers;
use super::lobe_models::{LobeModel, LobeModels};
use super::settings::Settings;
use super::store::Store;
use super::tree::NodeId;
use crate::math::columns::Column3;

/// How many dropped lanes are listed.
const MOST_DROPPED: usize = 256;

/// A closure that was left out of a lane because a weight or parameter was not a number or too large, or lobes were too many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dropped {
    /// The closure's name.
    pub closure: &'static str,
    /// The lane.
    pub lane: u32,
    /// Its node in the tree, for [`super::tree::Tree::site`].
    pub node: NodeId,
}

/// One lobe: a model with a weight, under a layer.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// Its model.
    pub model: u32,
    /// The innermost layer over it, or [`super::store::NONE`].
    pub layer: u32,
}

/// The lobes of a batch.
#[derive(Debug, Default)]
pub struct Flat {
    /// Choices of the render.
    pub settings: Settings,
    /// Number of lanes.
    pub lanes: usize,
    /// The models of the lobes.
    pub models: LobeModels,
    /// What lies over them.
    pub layers: Layers,
    /// The coats that bend what reaches them.
    pub coats: Coats,
    /// The lobes.
    pub lobes: Vec<Lobe>,
    /// Three columns a lobe.
    pub weights: Store,
    /// One column a lobe: the probability to pick it.
    pub picks: Vec<f32>,
    /// The last lobe of a lane that can be picked, or [`super::store::NONE`].
    pub last: Vec<u32>,
    /// Directions to the viewer, world.
    pub wo: Column3,
    /// Geometric normals, world.
    pub ng: Column3,
    /// Whether viewer and light lie on one side, as of the last evaluation; scratch memory before it.
    pub side: Vec<f32>,
    /// Weight, scale and probability of a lobe under a coat, five columns.
    pub within: Vec<f32>,
    /// 1 in every lane.
    pub ones: Vec<f32>,
    /// Radiance toward the viewer.
    pub emission: Column3,
    /// How much of a hole there is.
    pub holdout: Vec<f32>,
    /// Did anything emit in the last batch, so that emission and holdout must be cleared?
    pub emits: bool,
    /// What was left out.
    pub dropped: Vec<Dropped>,
}

impl Flat {
    /// Begins a batch.
    pub fn clear(&mut self, lanes: usize, wo: &Column3, ng: &Column3) {
        self.lanes = lanes;
        self.wo.clone_from(wo);
        self.ng.clone_from(ng);
        self.ones.resize(lanes, 1.0);
        self.models.clear(lanes);
        self.models.sheen_albedo = self.settings.sheen_albedo;
        self.layers.clear();
        self.coats.clear();
        self.lobes.clear();
        self.weights.clear();
        self.dropped.clear();
    }

    /// The model of a lobe.
    pub fn model(&self, lobe: Lobe) -> &LobeModel {
        &self.models.list[lobe.model as usize]
    }

    /// Notes that a closure was left out of a lane.
    pub fn drop_lane(&mut self, (closure, node): (&'static str, NodeId), lane: usize) {
        let entry = Dropped { closure, lane: lane as u32, node };
        if self.dropped.len() < MOST_DROPPED && !self.dropped.contains(&entry) {
            self.dropped.push(entry);
        }
    }
}
