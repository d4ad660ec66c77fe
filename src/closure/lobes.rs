//! The lobes of a batch: what a closure tree scatters, ready to be evaluated and sampled for all lanes at once.

use super::evaluate::{Evaluation, evaluate, evaluate_some, straight};
use super::flat::{Dropped, Flat, LeftOut};
use super::flatten::{Sweep, flatten};
use super::layering::{Toward, covering_albedo};
use super::library::Library;
use super::sampling::{Sampler, Samples};
use super::settings::Settings;
use super::store::NONE;
use super::tree::{NodeId, Tree};
use crate::math::columns::Column3;

/// One lobe of one lane, for people to read.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeInfo {
    /// Its number in the batch, below [`Lobes::len`].
    pub number: usize,
    /// The closure it came from.
    pub closure: &'static str,
    /// Its weight, without the scale of layers.
    pub weight: [f32; 3],
    /// Its directional albedo toward the viewer, without weight, as a layer takes it from its base.
    pub albedo: f32,
    /// How many layers lie over it.
    pub depth: u32,
    /// What the layers let through on the viewer's side, 0..1.
    pub through: f32,
    /// The probability that sampling picks it; 0 for the second half of a rough boundary, which the first samples.
    pub pick: f32,
}

/// The flattened lobes of a batch, with all scratch memory; made once and used for every batch.
#[derive(Debug)]
pub struct Lobes {
    flat: Flat,
    sweep: Sweep,
    sampler: Sampler,
}

impl Lobes {
    /// Empty lobes.
    pub fn new(settings: Settings) -> Self {
        let flat = Flat { settings, ..Flat::default() };
        Lobes { flat, sweep: Sweep::default(), sampler: Sampler::default() }
    }

    /// Flattens a tree of a library's closures as seen from `wo` (world, unit, toward the viewer) at points of geometric normal
    /// `ng`.
    ///
    /// Linear in nodes, lobes and layers, without recursion.
    pub fn flatten(&mut self, library: &Library, tree: &Tree, wo: &Column3, ng: &Column3) {
        self.flatten_sides(library, tree, wo, ng, &[]);
    }

    /// Flattens as [`Lobes::flatten`] does, at points whose normals were turned to the viewer: `backfacing` is not 0 in the lanes
    /// that were seen from inside, where closures with two sides invert their index of refraction. Empty means nowhere.
    pub fn flatten_sides(&mut self, library: &Library, tree: &Tree, wo: &Column3, ng: &Column3, backfacing: &[i32]) {
        self.flat.clear(tree.lanes, wo, ng, backfacing);
        flatten(&mut self.flat, &mut self.sweep, library, tree);
    }

    /// The directions to the viewer, world, as [`Lobes::flatten`] got them.
    pub fn viewer(&self) -> &Column3 {
        &self.flat.wo
    }

    /// Radiance toward the viewer, of `emission()` and `background()`, seen through the layers over them.
    pub fn emission(&self) -> &Column3 {
        &self.flat.emission
    }

    /// How much of the lane is a hole: the mean of the weights of `holdout()`.
    pub fn holdout(&self) -> &Vec<f32> {
        &self.flat.holdout
    }

    /// What was left out, one entry a closure and lane.
    pub fn dropped(&self) -> &[Dropped] {
        &self.flat.dropped
    }

    /// The node at which there were more lobes or layers than [`crate::limits::lobes`]; the others are not there.
    pub fn crowded(&self) -> Option<NodeId> {
        self.flat.crowded
    }

    /// What was left out of the batch because it is not rendered, each closure of the tree once.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.flat.left_out
    }

    /// True when some lobe scatters into more than one direction, so that lights are worth asking.
    pub fn has_non_delta(&self) -> bool {
        self.flat.lobes.iter().any(|&lobe| !self.flat.model(lobe).kind.is_delta())
    }

    /// Calls `mark` with each lane, once or more, in which a lobe with a density sees light behind the surface.
    pub fn crossing(&self, mut mark: impl FnMut(usize)) {
        let (flat, n) = (&self.flat, self.flat.lanes);
        let crosses = |index: &usize| flat.model(flat.lobes[*index]).kind.crosses();
        for index in (0..flat.lobes.len()).filter(crosses) {
            let weight = |k: usize, lane: usize| flat.weights[(3 * index + k) * n + lane];
            (0..n).filter(|lane| (0..3).any(|k| weight(k, *lane) != 0.0)).for_each(&mut mark);
        }
    }

    /// The number of lobes.
    pub fn len(&self) -> usize {
        self.flat.lobes.len()
    }

    /// True when nothing scatters.
    pub fn is_empty(&self) -> bool {
        self.flat.lobes.is_empty()
    }

    /// Evaluates all lobes that have a density, with their layers, for one unit world direction a lane.
    pub fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation) {
        evaluate(&mut self.flat, wi, out);
    }

    /// Evaluates one lobe, by its number, with the layers over it; what it takes from the density is its share. Nothing for a number
    /// that there is not.
    pub fn evaluate_one(&mut self, number: usize, wi: &Column3, out: &mut Evaluation) {
        let end = self.len().min(number.saturating_add(1));
        evaluate_some(&mut self.flat, number.min(end)..end, wi, out);
    }

    /// Samples one direction a lane from three numbers in [0, 1) a lane.
    pub fn sample(&mut self, xi: &Column3, out: &mut Samples) {
        self.sampler.sample(&mut self.flat, xi, out);
    }

    /// The part of the light from behind that goes straight on to the viewer, a color a lane, with what layers and coats over
    /// it take: the weight of [`super::event::STRAIGHT`] in the mean of all samples.
    pub fn straight(&mut self, out: &mut Column3) {
        straight(&mut self.flat, &mut self.sampler.evaluation, out);
    }

    /// The lobes of one lane, outer ones first; those without weight in the lane are left out.
    pub fn describe(&self, lane: usize) -> Vec<LobeInfo> {
        let (flat, n) = (&self.flat, self.flat.lanes);
        let mut infos = Vec::new();
        let mut albedo = vec![0.0; n];
        for (index, &lobe) in flat.lobes.iter().enumerate() {
            let weight: [f32; 3] = std::array::from_fn(|k| flat.weights[(3 * index + k) * n + lane]);
            if weight == [0.0; 3] {
                continue;
            }
            let model = flat.model(lobe);
            covering_albedo(&flat.models, model, Toward::View, &mut albedo);
            infos.push(LobeInfo {
                number: index,
                closure: model.closure,
                weight,
                albedo: albedo[lane],
                depth: flat.layers.depth(lobe.layer),
                through: if lobe.layer == NONE { 1.0 } else { flat.layers.through_of(lobe.layer)[lane] },
                pick: if lobe.paired { 0.0 } else { flat.picks[index * n + lane] },
            });
        }
        infos
    }
}
