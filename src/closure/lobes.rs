//! The lobes of a batch: what a closure tree scatters, ready to be evaluated and sampled for all lanes at once.

use super::batch::{LobeColumns, Triples, evaluate_lanes, side_lanes};
use super::flatten::Sweep;
use super::kinds::with_source;
use super::layering::Layers;
use super::media::Media;
use super::sampling::SampleScratch;
use super::settings::Settings;
use super::store::Store;
use super::surfaces::{NONE, Surfaces};
use super::tree::{NodeId, Tree};
use crate::lang::closures::ClosureTable;
use crate::math::columns::Column3;

/// f cos and density of one direction a lane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// Sum over the lobes of weight * scale * f |cos|, 1/sr.
    pub f_cos: Column3,
    /// Density (solid angle, 1/sr) with which [`Lobes::sample`] chooses the direction.
    pub pdf: Vec<f32>,
}

/// A closure that was left out of a lane because a weight or parameter was not a number, or lobes were too many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dropped {
    /// The closure's name.
    pub closure: &'static str,
    /// The lane.
    pub lane: u32,
    /// Its node in the tree, for [`super::tree::Tree::site`].
    pub node: NodeId,
}

/// One lobe of one lane, for people to read.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeInfo {
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
    /// The probability that sampling picks it.
    pub pick: f32,
}

/// One lobe: a surface with a weight, under a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobe {
    /// Its surface.
    pub surface: u32,
    /// The innermost layer over it, or [`NONE`].
    pub layer: u32,
}

/// The flattened lobes of a batch, with all scratch memory; made once and used for every batch.
#[derive(Debug)]
pub struct Lobes {
    pub(super) settings: Settings,
    pub(super) lanes: usize,
    pub(super) surfaces: Surfaces,
    pub(super) layers: Layers,
    pub(super) media: Media,
    /// Weight, scale and probability of a lobe in a medium, five columns.
    pub(super) within: Vec<f32>,
    pub(super) lobes: Vec<Lobe>,
    /// Three columns a lobe.
    pub(super) weights: Store,
    /// One column a lobe: the probability to pick it.
    pub(super) picks: Vec<f32>,
    /// The last lobe of a lane that can be picked, or [`NONE`].
    pub(super) last: Vec<u32>,
    pub(super) wo: Column3,
    pub(super) ng: Column3,
    pub(super) side: Vec<f32>,
    pub(super) ones: Vec<f32>,
    pub(super) emission: Column3,
    pub(super) holdout: Vec<f32>,
    /// Did anything emit in the last batch, so that emission and holdout must be cleared?
    pub(super) emits: bool,
    pub(super) dropped: Vec<Dropped>,
    pub(super) sweep: Sweep,
    pub(super) scratch: SampleScratch,
}

impl Lobes {
    /// Empty lobes.
    pub fn new(settings: Settings) -> Self {
        Lobes {
            settings,
            lanes: 0,
            surfaces: Surfaces::default(),
            layers: Layers::default(),
            media: Media::default(),
            within: Vec::new(),
            lobes: Vec::new(),
            weights: Store::default(),
            picks: Vec::new(),
            last: Vec::new(),
            wo: Column3::default(),
            ng: Column3::default(),
            side: Vec::new(),
            ones: Vec::new(),
            emission: Column3::default(),
            holdout: Vec::new(),
            emits: false,
            dropped: Vec::new(),
            sweep: Sweep::default(),
            scratch: SampleScratch::default(),
        }
    }

    /// Flattens a tree as seen from `wo` (world, unit, toward the viewer) at points of geometric normal `ng`.
    ///
    /// Linear in nodes, lobes and layers, without recursion.
    pub fn flatten(&mut self, table: &ClosureTable, tree: &Tree, wo: &Column3, ng: &Column3) {
        super::flatten::flatten(self, table, tree, wo, ng);
    }

    /// The directions to the viewer, world, as [`Lobes::flatten`] got them.
    pub fn viewer(&self) -> &Column3 {
        &self.wo
    }

    /// Radiance toward the viewer, of `emission()` and `background()`, seen through the layers over them.
    pub fn emission(&self) -> &Column3 {
        &self.emission
    }

    /// How much of the lane is a hole: the mean of the weights of `holdout()`.
    pub fn holdout(&self) -> &Vec<f32> {
        &self.holdout
    }

    /// What was left out, one entry a closure and lane.
    pub fn dropped(&self) -> &[Dropped] {
        &self.dropped
    }

    /// True when some lobe scatters into more than one direction, so that lights are worth asking.
    pub fn has_non_delta(&self) -> bool {
        self.lobes.iter().any(|lobe| !self.surfaces.list[lobe.surface as usize].kind.is_delta())
    }

    /// The number of lobes.
    pub fn len(&self) -> usize {
        self.lobes.len()
    }

    /// True when nothing scatters.
    pub fn is_empty(&self) -> bool {
        self.lobes.is_empty()
    }

    /// Evaluates all lobes that have a density, with their layers, for one unit world direction a lane.
    pub fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation) {
        let n = self.lanes;
        for column in [&mut out.f_cos.x, &mut out.f_cos.y, &mut out.f_cos.z, &mut out.pdf] {
            column.clear();
            column.resize(n, 0.0);
        }
        self.side.resize(n, 0.0);
        side_lanes(Triples::of(&self.ng), Triples::of(&self.wo), Triples::of(wi), &mut self.side);
        self.media.light(self.surfaces.frames(), wi);
        self.surfaces.localise(&self.media, wi);
        self.layers.scale(&self.surfaces, &self.media, &self.ones);
        for (index, lobe) in self.lobes.iter().enumerate() {
            let surface = &self.surfaces.list[lobe.surface as usize];
            if surface.kind.is_delta() {
                continue;
            }
            let frame = &self.surfaces.frames()[surface.frame as usize];
            let mut columns = LobeColumns {
                wo: Triples::of(&frame.wo),
                views: self.surfaces.views(surface),
                wi: Triples::of(&frame.wi),
                side: &self.side,
                weight: Triples::packed(&self.weights[3 * n * index..], n),
                scale: self.layers.scale_of(lobe.layer, &self.ones),
                pick: &self.picks[n * index..n * (index + 1)],
            };
            if let Some(medium) = self.media.get(self.layers.medium(lobe.layer)) {
                medium.carry(&columns, surface.kind.is_diffuse(), &mut self.within);
                columns.weight = Triples::packed(&self.within, n);
                (columns.scale, columns.pick) = (&self.within[3 * n..4 * n], &self.within[4 * n..]);
            }
            let (x, y, z) = (&mut out.f_cos.x, &mut out.f_cos.y, &mut out.f_cos.z);
            with_source!(self.surfaces, surface, |M, source| evaluate_lanes::<M, _>(
                source,
                columns,
                x,
                y,
                z,
                &mut out.pdf
            ));
        }
    }

    /// The lobes of one lane, outer ones first; those without weight in the lane are left out.
    pub fn describe(&self, lane: usize) -> Vec<LobeInfo> {
        let mut infos = Vec::new();
        let mut albedo = vec![0.0; self.lanes];
        for (index, lobe) in self.lobes.iter().enumerate() {
            let weight: [f32; 3] = std::array::from_fn(|k| self.weights[(3 * index + k) * self.lanes + lane]);
            if weight == [0.0; 3] {
                continue;
            }
            let surface = &self.surfaces.list[lobe.surface as usize];
            super::layering::covering_albedo(&self.surfaces, surface, super::layering::Side::View, &mut albedo);
            infos.push(LobeInfo {
                closure: surface.closure,
                weight,
                albedo: albedo[lane],
                depth: self.layers.depth(lobe.layer),
                through: if lobe.layer == NONE { 1.0 } else { self.layers.through_of(lobe.layer)[lane] },
                pick: self.picks[index * self.lanes + lane],
            });
        }
        infos
    }
}
