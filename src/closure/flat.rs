//! The flat form of a closure tree: lobes with their weights, layers and coats. Flattening makes it, evaluating and sampling
//! read it.

use super::coats::Coats;
use super::layering::Layers;
use super::lobe_models::{LobeModel, LobeModels};
use super::settings::Settings;
use super::store::Store;
use super::tree::NodeId;
use crate::math::columns::Column3;
use glam::Vec3;

/// A closure that is not rendered, as a batch has met it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Its name.
    pub closure: &'static str,
    /// Where it is in the tree.
    pub node: NodeId,
    /// What is to be said of it.
    pub what: &'static str,
}

/// How many dropped lanes are listed.
const MOST_DROPPED: usize = 256;

/// A closure that was left out of a lane because a weight or parameter was not a number or too large.
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
    /// Sampled by the lobe before it, whose probability to be picked is its own as well.
    pub paired: bool,
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
    /// One column a lobe: the probability to pick it, or the lobe that samples it.
    pub picks: Vec<f32>,
    /// The last lobe of a lane that can be picked, or [`super::store::NONE`].
    pub last: Vec<u32>,
    /// Directions to the viewer, world.
    pub wo: Column3,
    /// Geometric normals, world.
    pub ng: Column3,
    /// Not 0 in lanes that are seen from inside; empty when none is.
    pub backfacing: Vec<i32>,
    /// Whether viewer and light lie on one side, as of the last evaluation; scratch memory before it.
    pub side: Vec<f32>,
    /// Weight, scale and probability of a lobe under a coat, five columns.
    pub within: Vec<f32>,
    /// Weight of a lobe with the scale of its lossless layers, three columns.
    pub scaled: Vec<f32>,
    /// 1 in every lane.
    pub ones: Vec<f32>,
    /// Radiance toward the viewer.
    pub emission: Column3,
    /// How much of a hole there is.
    pub holdout: Vec<f32>,
    /// Did anything emit in the last batch, so that emission and holdout must be cleared?
    pub emits: bool,
    /// What was left out because a number in it is none.
    pub dropped: Vec<Dropped>,
    /// Where there were too many lobes or layers.
    pub crowded: Option<NodeId>,
    /// What was left out because it is not rendered.
    pub left_out: Vec<LeftOut>,
}

impl Flat {
    /// Begins a batch.
    pub fn clear(&mut self, lanes: usize, wo: &Column3, ng: &Column3, backfacing: &[i32]) {
        self.lanes = lanes;
        self.backfacing.clear();
        if backfacing.iter().fold(0, |any, behind| any | behind) != 0 {
            self.backfacing.extend_from_slice(backfacing);
        }
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
        self.crowded = None;
        self.left_out.clear();
    }

    /// The model of a lobe.
    pub fn model(&self, lobe: Lobe) -> &LobeModel {
        &self.models.list[lobe.model as usize]
    }

    /// The weight of a lobe in a lane, with the scale of its layers for the last evaluated direction.
    pub fn scaled_weight(&self, lobe: usize, lane: usize) -> Vec3 {
        let (n, layer) = (self.lanes, self.lobes[lobe].layer);
        let at = 3 * n * lobe + lane;
        let weight = Vec3::new(self.weights[at], self.weights[at + n], self.weights[at + 2 * n]);
        match self.layers.scales_by_lobe(layer) {
            true => weight * self.layers.smaller_part(&self.models, layer, lane),
            false => weight * self.layers.scale_of(layer, &self.ones)[lane],
        }
    }

    /// Notes that a closure was left out of a lane.
    pub fn drop_lane(&mut self, (closure, node): (&'static str, NodeId), lane: usize) {
        let entry = Dropped { closure, lane: lane as u32, node };
        if self.dropped.len() < MOST_DROPPED && !self.dropped.contains(&entry) {
            self.dropped.push(entry);
        }
    }
}
