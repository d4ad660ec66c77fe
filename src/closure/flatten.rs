//! Flattening: one sweep over the tree from the root down, which pushes weights and layers to the leaves.
//!
//! Children are older than their parents, so visiting nodes by falling index sees every parent before its children: no
//! recursion, no stack, and a node that several parents share is visited once. What reaches a node under the same layer
//! is summed there, so `Ci = Ci + Ci` fifty times is one lobe and not 2^50.

use super::darkening::{Coated, darken};
use super::flat::{Flat, LeftOut, Lobe};
use super::frames::Seen;
use super::layering::{Layer, Top};
use super::leaf::{Leaf, LeafMaker, Part};
use super::library::Library;
use super::lobe_models::Column;
use super::store::NONE;
use super::tops::Tops;
use super::tree::{Ints, Node, NodeId, Tree};
use super::weights::{Operand, Weight, Weights, multiply, normalise_lanes, share_lanes, usable, usable_and_some};
use crate::limits;
use glam::Vec3;
use std::collections::HashMap;

/// What reaches a node, as a list a node.
#[derive(Clone, Copy, Debug)]
struct Entry {
    next: u32,
    node: u32,
    layer: u32,
    weight: Weight,
}

/// Entries of a node that are looked through before the table is asked.
const FEW: usize = 8;

/// Light or a hole on its way to the sums of a batch.
#[derive(Clone, Copy, Debug)]
struct Emitter {
    weight: Weight,
    layer: u32,
    hole: bool,
    node: NodeId,
}

/// Scratch memory of flattening.
#[derive(Debug, Default)]
pub struct Sweep {
    heads: Vec<u32>,
    entries: Vec<Entry>,
    /// Entries by node and layer, as far as they are noted.
    places: HashMap<(u32, u32), u32>,
    noted: usize,
    weights: Weights,
    tops: Tops,
    emitters: Vec<Emitter>,
    coated: Vec<Coated>,
    ready: Vec<(u32, Leaf)>,
}

impl Sweep {
    fn clear(&mut self, nodes: usize) {
        self.heads.clear();
        self.heads.resize(nodes, NONE);
        self.tops.clear(nodes);
        self.entries.clear();
        if self.noted > 0 {
            (self.places, self.noted) = (HashMap::new(), 0);
        }
        self.weights.clear();
        self.emitters.clear();
        self.coated.clear();
    }

    /// Sends a weight to a node; false when there are too many.
    fn send(&mut self, lanes: usize, node: Option<NodeId>, layer: u32, weight: Weight) -> bool {
        let Some(NodeId(node)) = node else { return true };
        let (mut at, mut seen) = (self.heads[node as usize], 0);
        while at != NONE && seen < FEW {
            let entry = self.entries[at as usize];
            if entry.layer == layer {
                let sum = self.weights.plus(lanes, entry.weight, weight);
                self.entries[at as usize].weight = sum;
                return true;
            }
            (at, seen) = (entry.next, seen + 1);
        }
        if at != NONE {
            // A long list is a hash table as well, or many layers over one node would be quadratic.
            for (index, entry) in self.entries.iter().enumerate().skip(self.noted) {
                self.places.insert((entry.node, entry.layer), index as u32);
            }
            self.noted = self.entries.len();
            if let Some(&known) = self.places.get(&(node, layer)) {
                let sum = self.weights.plus(lanes, self.entries[known as usize].weight, weight);
                self.entries[known as usize].weight = sum;
                return true;
            }
        }
        if self.entries.len() >= limits::lobes(lanes) {
            return false;
        }
        self.entries.push(Entry { next: self.heads[node as usize], node, layer, weight });
        self.heads[node as usize] = self.entries.len() as u32 - 1;
        true
    }
}

/// Flattens a tree into a `flat` that was cleared for its batch.
pub fn flatten(flat: &mut Flat, sweep: &mut Sweep, library: &Library, tree: &Tree) {
    sweep.clear(tree.nodes.len());
    let mut pass = Pass { flat, sweep, library, tree };
    if let Some(root) = tree.root {
        pass.sweep.send(tree.lanes, Some(root), NONE, Weight::Uniform([1.0; 3]));
        for index in (0..=root.0).rev() {
            if pass.sweep.heads[index as usize] != NONE && pass.flat.crowded.is_none() {
                pass.visit(index);
            }
        }
        let Pass { flat, sweep, .. } = &mut pass;
        sweep.tops.build_steps(&mut flat.layers, &mut flat.models, tree, root);
    }
    flat.layers.prepare(&flat.models, &flat.coats, &flat.ones);
    flat.layers.prepare_lossless(&flat.models, &flat.lobes);
    emit(flat, sweep);
    darken(flat, &sweep.weights, &sweep.coated);
    pick(flat);
}

/// A flattening under way.
struct Pass<'a> {
    flat: &'a mut Flat,
    sweep: &'a mut Sweep,
    library: &'a Library,
    tree: &'a Tree,
}

impl Pass<'_> {
    fn visit(&mut self, index: u32) {
        let (n, tree) = (self.tree.lanes, self.tree);
        self.sweep.tops.mark_children(tree, index);
        // A leaf is made ready once for every coat it lies under.
        let mut ready = std::mem::take(&mut self.sweep.ready);
        let mut at = self.sweep.heads[index as usize];
        while at != NONE {
            let Entry { next, layer, weight, .. } = self.sweep.entries[at as usize];
            at = next;
            let sweep = &mut *self.sweep;
            let fits = match tree.nodes[index as usize] {
                Node::Scale { weight: factor, child } => {
                    let weight = sweep.weights.times(tree, weight, factor);
                    sweep.send(n, Some(child), layer, weight)
                }
                Node::Add(a, b) => sweep.send(n, Some(a), layer, weight) && sweep.send(n, Some(b), layer, weight),
                Node::Select { mask: Ints::Uniform(mask), then, otherwise } => {
                    sweep.send(n, if mask != 0 { then } else { otherwise }, layer, weight)
                }
                Node::Select { mask, then, otherwise } => {
                    let yes = then.map(|_| sweep.weights.masked(n, weight, |lane| tree.int(mask, lane) != 0));
                    let no = otherwise.map(|_| sweep.weights.masked(n, weight, |lane| tree.int(mask, lane) == 0));
                    yes.is_none_or(|w| sweep.send(n, then, layer, w))
                        && no.is_none_or(|w| sweep.send(n, otherwise, layer, w))
                }
                Node::Leaf { closure, .. } => {
                    let name = self.library.get(closure).name;
                    let coat = self.flat.layers.coat(layer);
                    if !ready.iter().any(|(c, _)| *c == coat) {
                        ready.push((coat, self.make_ready(index, coat)));
                    }
                    let leaf = ready.iter().find(|(c, _)| *c == coat);
                    leaf.is_none_or(|(_, leaf)| self.place(leaf, (name, NodeId(index)), layer, weight))
                }
            };
            if !fits {
                self.flat.crowded = Some(NodeId(index));
                break;
            }
        }
        ready.clear();
        self.sweep.ready = ready;
    }

    /// Makes a leaf's lobes, and what lies under it when it is a coat.
    fn make_ready(&mut self, index: u32, coat: u32) -> Leaf {
        let (tree, settings) = (self.tree, self.flat.settings);
        let Flat { models, coats, wo, ng, backfacing, .. } = &mut *self.flat;
        let seen = Seen { wo: coats.get(coat).map_or(&*wo, |c| &c.wo), ng, coat, backfacing };
        let node = &tree.nodes[index as usize];
        let mut leaf = self.library.leaf(tree, node, |closure| LeafMaker::new(models, tree, settings, seen, closure));
        if let Some(coating) = leaf.coating.take() {
            leaf.inner = Some(coats.push(coat, coating, models.frames(), wo));
        }
        let nests = matches!(node, Node::Leaf { closure, .. } if self.library.get(*closure).nests());
        self.sweep.tops.note_leaf(&mut self.flat.layers, (index, coat), &leaf, nests);
        leaf
    }

    /// Places a leaf under a layer: adds its lobes, and sends the weight on to what it nests.
    fn place(&mut self, leaf: &Leaf, name: (&'static str, NodeId), layer: u32, weight: Weight) -> bool {
        let (n, tree) = (self.tree.lanes, self.tree);
        let mut fits = true;
        if leaf.emits || leaf.hole {
            let weight = leaf.tint.map_or(weight, |tint| self.sweep.weights.times(tree, weight, tint));
            self.sweep.emitters.push(Emitter { weight, layer, hole: leaf.hole, node: name.1 });
        }
        if let Some((what, lanes)) = &leaf.left_out {
            let weighs = |lane: usize| (0..3).any(|c| self.sweep.weights.get(weight, c, lane, n) != 0.0);
            let out = LeftOut { closure: name.0, node: name.1, what };
            if !self.flat.left_out.contains(&out) && (0..n).any(|lane| lanes[lane] && weighs(lane)) {
                self.flat.left_out.push(out);
            }
        }
        fits &= self.sweep.send(n, leaf.top, layer, weight);
        let mut paired_with = None;
        for part in &leaf.parts {
            // A half whose partner was left out samples for itself.
            let before = self.flat.lobes.len();
            let partner =
                paired_with.is_some_and(|model| self.flat.lobes.last().is_some_and(|lobe| lobe.model == model));
            fits &= self.add_lobe(part, leaf, layer, weight, name);
            if let Some(lobe) = self.flat.lobes.get_mut(before) {
                lobe.paired = part.paired && partner;
            }
            paired_with = Some(part.model);
        }
        if leaf.base.is_none() {
            return fits;
        }
        for cover in &leaf.covers {
            let top = match (cover.model, leaf.top, leaf.inner) {
                (Some(model), ..) => Top::Lobe(model),
                // Holds the node until the steps are built.
                (None, Some(NodeId(node)), _) => Top::Tree(node),
                (None, None, Some(_)) => Top::Boundary,
                (None, None, None) => {
                    fits &= self.sweep.send(n, leaf.base, layer, weight);
                    continue;
                }
            };
            let layers = &mut self.flat.layers;
            if layers.list.len() >= limits::lobes(n) {
                return false;
            }
            let depth = layers.depth(layer) + 1;
            let coat = leaf.inner.unwrap_or(layers.coat(layer));
            let (rule, coverage, tints) = (cover.rule, cover.coverage, cover.tints);
            layers.list.push(Layer { parent: layer, depth, rule, top, coat, coverage, tints });
            let inner = layers.list.len() as u32 - 1;
            if matches!(top, Top::Boundary) {
                self.sweep.coated.push(Coated { layer: inner, weight });
            }
            let weight = if cover.gate == Column::ONES {
                weight
            } else {
                let gate = self.flat.models.column(cover.gate);
                self.sweep.weights.masked(n, weight, |lane| gate[lane] != 0.0)
            };
            fits &= self.sweep.send(n, leaf.base, inner, weight);
        }
        fits
    }

    /// Adds one lobe; lanes whose weight or parameters are not numbers get weight 0 and are reported.
    fn add_lobe(&mut self, part: &Part, leaf: &Leaf, layer: u32, weight: Weight, name: (&'static str, NodeId)) -> bool {
        let (n, tree) = (self.tree.lanes, self.tree);
        let (tint, model) = (part.tint.or(leaf.tint), part.model);
        let flat = &mut *self.flat;
        if flat.lobes.len() >= limits::lobes(n) {
            return false;
        }
        let made = flat.models.list[model as usize];
        let start = flat.weights.take(3 * n);
        for component in 0..3 {
            let factor = tint.map_or(Operand::One(1.0), |t| Operand::of(tree, t[component]));
            let out = &mut flat.weights[start + component * n..start + (component + 1) * n];
            multiply(self.sweep.weights.operand(weight, component, n), factor, out);
        }
        if made.gate == Column::ONES && usable_and_some(&flat.weights[start..]) {
            // The common case: every weight is a number and the lobe exists in every lane.
            flat.lobes.push(Lobe { model, layer, paired: false });
            return true;
        }
        let mut any = false;
        for lane in 0..n {
            let at = [start + lane, start + n + lane, start + 2 * n + lane];
            let gate = flat.models.gate(&made, lane);
            let w = at.map(|i| flat.weights[i]);
            // Lanes that did not run this closure have weight zero before the tint; their parameters do not matter.
            let absent = (0..3).all(|c| self.sweep.weights.get(weight, c, lane, n) == 0.0) || gate == 0.0;
            let broken = gate.is_nan() || w.iter().any(|&v| !usable(v));
            if broken && !absent {
                flat.drop_lane(name, lane);
            }
            if broken || absent {
                for i in at {
                    flat.weights[i] = 0.0;
                }
            }
            any |= !(broken || absent) && w != [0.0; 3];
        }
        if any {
            flat.lobes.push(Lobe { model, layer, paired: false });
        } else {
            flat.weights.truncate(start);
        }
        true
    }
}

/// Sums emission and holes, seen through the layers over them.
fn emit(flat: &mut Flat, sweep: &Sweep) {
    let n = flat.lanes;
    if flat.emits || flat.holdout.len() != n {
        flat.emission.resize(n);
        flat.holdout.resize(n, 0.0);
        for column in [&mut flat.emission.x, &mut flat.emission.y, &mut flat.emission.z, &mut flat.holdout] {
            column.fill(0.0);
        }
    }
    flat.emits = !sweep.emitters.is_empty();
    for &Emitter { weight, layer, hole, node } in &sweep.emitters {
        for lane in 0..n {
            let through = if layer == NONE { 1.0 } else { flat.layers.through_of(layer)[lane] };
            let tint = flat.coats.get(flat.layers.coat(layer)).map_or([1.0; 3], |c| c.viewer_tint(lane).to_array());
            let [x, y, z] = std::array::from_fn(|c| sweep.weights.get(weight, c, lane, n) * through * tint[c]);
            if ![x, y, z].into_iter().all(usable) {
                flat.drop_lane((if hole { "holdout" } else { "emission" }, node), lane);
            } else if hole {
                flat.holdout[lane] += (x + y + z) / 3.0;
            } else {
                let sum = flat.emission.get(lane) + Vec3::new(x, y, z);
                flat.emission.set(lane, sum);
            }
        }
    }
}

/// Gives every lobe its probability: luminance of the weight's magnitude, albedo, and what the layers let through.
fn pick(flat: &mut Flat) {
    let n = flat.lanes;
    flat.picks.resize(n * flat.lobes.len(), 0.0);
    flat.last.clear();
    flat.last.resize(n, NONE);
    let mut total = std::mem::take(&mut flat.side);
    total.clear();
    total.resize(n, 0.0);
    for (index, lobe) in flat.lobes.iter().enumerate() {
        let out = &mut flat.picks[index * n..(index + 1) * n];
        flat.layers.albedo_seen(&flat.models, lobe.model, out);
        let through = if lobe.layer == NONE { &flat.ones } else { flat.layers.through_of(lobe.layer) };
        let weight = &flat.weights[3 * n * index..3 * n * (index + 1)];
        let coat = flat.coats.get(flat.layers.coat(lobe.layer)).filter(|coat| coat.colored);
        for i in (0..n).filter(|_| coat.is_some()) {
            out[i] *= coat.map_or(1.0, |coat| coat.viewer_tint(i).element_sum() / 3.0);
        }
        let (x, rest) = weight.split_at(n);
        let (y, z) = rest.split_at(n);
        // An albedo is an estimate, for which a lobe that may scatter is never excluded; that of one direction is known.
        let least = if flat.models.list[lobe.model as usize].kind.is_delta() { 0.0 } else { 1e-3 };
        share_lanes([x, y, z], through, least, out, &mut total);
        if lobe.paired {
            let (before, here) = flat.picks.split_at_mut(index * n);
            before[(index - 1) * n..].iter_mut().zip(here).for_each(|(pick, more)| *pick += *more);
        }
    }
    for value in &mut total {
        // The inverse of a smaller sum would be infinite.
        *value = if *value >= f32::MIN_POSITIVE { 1.0 / *value } else { 0.0 };
    }
    for index in 0..flat.lobes.len() {
        if flat.lobes[index].paired {
            flat.picks.copy_within((index - 1) * n..index * n, index * n);
            continue;
        }
        let picks = &mut flat.picks[index * n..(index + 1) * n];
        normalise_lanes(index as u32, &total, picks, &mut flat.last);
    }
    flat.side = total;
}
