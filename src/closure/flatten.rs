//! Flattening: one sweep over the tree from the root down, which pushes weights and layers to the leaves.
//!
//! Children are older than their parents, so visiting nodes by falling index sees every parent before its children: no
//! recursion, no stack, and a node that several parents share is visited once. What reaches a node under the same layer
//! is summed there, so `Ci = Ci + Ci` fifty times is one lobe and not 2^50.

use super::layering::{Layer, Layers, Step, Top};
use super::leaves::{Leaf, LeafContext, prepare_leaf};
use super::lobes::{Dropped, Lobe, Lobes};
use super::settings::Layering;
use super::surfaces::{NONE, Seen, Surfaces};
use super::tree::{Floats, Ints, Node, NodeId, Param, Tree};
use super::weights::{Operand, Weight, Weights, multiply, normalise_lanes, share_lanes, usable, usable_and_some};
use crate::lang::closures::{ClosureSpec, ClosureTable, Model};
use crate::math::columns::Column3;
use smallvec::SmallVec;

/// More lobes or pending weights than this are dropped and reported: a shared base under many different layers could
/// otherwise grow without bound. So many lobes take a gigabyte in a batch of 512 lanes.
const MOST: usize = 1 << 17;
/// How many dropped lanes are listed.
const MOST_DROPPED: usize = 256;

/// What reaches a node, as a list a node.
#[derive(Clone, Copy, Debug)]
struct Entry {
    next: u32,
    layer: u32,
    weight: Weight,
}

/// Scratch memory of flattening.
#[derive(Debug, Default)]
pub struct Sweep {
    heads: Vec<u32>,
    entries: Vec<Entry>,
    weights: Weights,
    in_top: Vec<bool>,
    step_of: Vec<u32>,
    /// Where the leaves of a node in a medium lie in [`Layers::leaves`], by falling node.
    top_leaves: Vec<((u32, u32), (u32, u32))>,
    emitters: Vec<(Weight, u32, bool, NodeId)>,
    ready: Vec<(u32, Leaf)>,
}

impl Sweep {
    fn clear(&mut self, nodes: usize) {
        self.heads.clear();
        self.heads.resize(nodes, NONE);
        self.in_top.clear();
        self.in_top.resize(nodes, false);
        self.step_of.clear();
        self.step_of.resize(nodes, 0);
        self.top_leaves.clear();
        self.entries.clear();
        self.weights.clear();
        self.emitters.clear();
    }

    /// Where the leaves of a node in a medium lie; nodes were visited by falling index, each in a few media.
    fn leaves_of(&self, index: u32, medium: u32) -> (u32, u32) {
        let from = self.top_leaves.partition_point(|((node, _), _)| *node > index);
        let mut of_node = self.top_leaves[from..].iter().take_while(|((node, _), _)| *node == index);
        of_node.find(|((_, m), _)| *m == medium).map_or((0, 0), |&(_, leaves)| leaves)
    }

    /// Sends a weight to a node; false when there are too many.
    fn send(&mut self, lanes: usize, node: Option<NodeId>, layer: u32, weight: Weight) -> bool {
        let Some(NodeId(node)) = node else { return true };
        let mut at = self.heads[node as usize];
        while at != NONE {
            let entry = self.entries[at as usize];
            if entry.layer == layer {
                let sum = self.weights.plus(lanes, entry.weight, weight);
                self.entries[at as usize].weight = sum;
                return true;
            }
            at = entry.next;
        }
        if self.entries.len() >= MOST {
            return false;
        }
        self.entries.push(Entry { next: self.heads[node as usize], layer, weight });
        self.heads[node as usize] = self.entries.len() as u32 - 1;
        true
    }
}

/// See [`Lobes::flatten`].
pub(super) fn flatten(lobes: &mut Lobes, table: &ClosureTable, tree: &Tree, wo: &Column3, ng: &Column3) {
    let n = tree.lanes;
    lobes.lanes = n;
    lobes.wo.clone_from(wo);
    lobes.ng.clone_from(ng);
    lobes.ones.resize(n, 1.0);
    lobes.surfaces.clear(n);
    lobes.surfaces.sheen_albedo = lobes.settings.sheen_albedo;
    lobes.layers.clear();
    lobes.media.clear();
    lobes.lobes.clear();
    lobes.weights.clear();
    lobes.dropped.clear();
    lobes.sweep.clear(tree.nodes.len());
    // The first column is 1 everywhere: the t of whatever has none.
    lobes.surfaces.push_column(|_| 1.0);
    if let Some(root) = tree.root {
        lobes.sweep.send(n, Some(root), NONE, Weight::Uniform([1.0; 3]));
        for index in (0..=root.0).rev() {
            if lobes.sweep.heads[index as usize] != NONE {
                visit(lobes, table, tree, index);
            }
        }
        build_steps(&mut lobes.sweep, &mut lobes.layers, &mut lobes.surfaces, table, tree, root);
    }
    lobes.layers.prepare(&lobes.surfaces, &lobes.media, &lobes.ones);
    emit(lobes);
    pick(lobes);
}

fn visit(lobes: &mut Lobes, table: &ClosureTable, tree: &Tree, index: u32) {
    let n = tree.lanes;
    if lobes.sweep.in_top[index as usize] {
        mark_children(&mut lobes.sweep.in_top, tree, index);
    }
    // A leaf is made ready once for every medium it lies in.
    let mut ready = std::mem::take(&mut lobes.sweep.ready);
    let mut at = lobes.sweep.heads[index as usize];
    while at != NONE {
        let entry = lobes.sweep.entries[at as usize];
        at = entry.next;
        let Entry { layer, weight, .. } = entry;
        let sweep = &mut lobes.sweep;
        let mut name = "too many lobes";
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
                name = table.get(closure).name;
                let medium = lobes.layers.medium(layer);
                if !ready.iter().any(|(m, _)| *m == medium) {
                    ready.push((medium, make_ready(lobes, table.get(closure), tree, index, medium)));
                }
                let leaf = ready.iter().find(|(m, _)| *m == medium);
                leaf.is_none_or(|(_, leaf)| place(lobes, tree, leaf, (name, NodeId(index)), layer, weight))
            }
        };
        if !fits {
            drop_lane(&mut lobes.dropped, (name, NodeId(index)), 0);
        }
    }
    ready.clear();
    lobes.sweep.ready = ready;
}

/// Marks what a node of a layer's top consists of.
fn mark_children(in_top: &mut [bool], tree: &Tree, index: u32) {
    let mut mark = |child: Option<NodeId>| {
        if let Some(NodeId(child)) = child {
            in_top[child as usize] = true;
        }
    };
    match tree.nodes[index as usize] {
        Node::Leaf { first_param, param_count, .. } => {
            for param in &tree.params[first_param as usize..(first_param + param_count) as usize] {
                if let Param::Closure(child) = param {
                    mark(*child);
                }
            }
        }
        Node::Scale { child, .. } => mark(Some(child)),
        Node::Add(a, b) => [a, b].into_iter().for_each(|child| mark(Some(child))),
        Node::Select { then, otherwise, .. } => [then, otherwise].into_iter().for_each(mark),
    }
}

/// Makes a leaf's surfaces, and the medium under it when it is a coat.
fn make_ready(lobes: &mut Lobes, spec: &ClosureSpec, tree: &Tree, index: u32, medium: u32) -> Leaf {
    let wo = lobes.media.get(medium).map_or(&lobes.wo, |m| &m.wo);
    let seen = Seen { wo, ng: &lobes.ng, medium };
    let context = LeafContext { tree, settings: lobes.settings, seen };
    let mut leaf = prepare_leaf(&mut lobes.surfaces, &context, spec, &tree.nodes[index as usize]);
    if let Some(coat) = leaf.coat.take() {
        leaf.inner = Some(lobes.media.push(medium, coat, lobes.surfaces.frames(), &lobes.wo));
    }
    if let Some(top) = leaf.top {
        lobes.sweep.in_top[top.0 as usize] = true;
    }
    if lobes.sweep.in_top[index as usize] {
        let first = lobes.layers.leaves.len() as u32;
        lobes.layers.leaves.extend(leaf.parts.iter().map(|part| (part.surface, part.t)));
        debug_assert!(lobes.sweep.top_leaves.last().is_none_or(|((node, _), _)| *node >= index));
        lobes.sweep.top_leaves.push(((index, medium), (first, lobes.layers.leaves.len() as u32)));
    }
    leaf
}

/// Places a leaf under a layer: adds its lobes, and sends the weight on to what it nests.
fn place(
    lobes: &mut Lobes,
    tree: &Tree,
    leaf: &Leaf,
    name: (&'static str, NodeId),
    layer: u32,
    weight: Weight,
) -> bool {
    let n = tree.lanes;
    let mut fits = true;
    if leaf.emits || leaf.hole {
        let weight = leaf.tint.map_or(weight, |tint| lobes.sweep.weights.times(tree, weight, tint));
        lobes.sweep.emitters.push((weight, layer, leaf.hole, name.1));
    }
    fits &= lobes.sweep.send(n, leaf.top, layer, weight);
    for (k, part) in leaf.parts.iter().enumerate() {
        let tint = leaf.tints.get(k).copied().or(leaf.tint);
        fits &= add_lobe(lobes, tree, part.surface, layer, weight, tint, name);
    }
    if leaf.base.is_none() {
        return fits;
    }
    for cover in leaf.covers.iter() {
        let top = match (cover.surface, leaf.top, leaf.inner) {
            (Some(surface), ..) => Top::Surface(surface),
            // Holds the node until the steps are built.
            (None, Some(NodeId(node)), _) => Top::Tree(node),
            (None, None, Some(_)) => Top::Boundary,
            (None, None, None) => {
                fits &= lobes.sweep.send(n, leaf.base, layer, weight);
                continue;
            }
        };
        if lobes.layers.list.len() >= MOST {
            return false;
        }
        let depth = lobes.layers.depth(layer) + 1;
        let medium = leaf.inner.unwrap_or(lobes.layers.medium(layer));
        lobes.layers.list.push(Layer { parent: layer, depth, rule: cover.rule, top, medium, t: cover.t });
        let inner = lobes.layers.list.len() as u32 - 1;
        let surfaces = &lobes.surfaces;
        let weight = if cover.gate == NONE {
            weight
        } else {
            let gate = surfaces.column(cover.gate);
            lobes.sweep.weights.masked(n, weight, |lane| gate[lane] != 0.0)
        };
        fits &= lobes.sweep.send(n, leaf.base, inner, weight);
    }
    fits
}

fn drop_lane(dropped: &mut Vec<Dropped>, (closure, node): (&'static str, NodeId), lane: usize) {
    let entry = Dropped { closure, lane: lane as u32, node };
    if dropped.len() < MOST_DROPPED && !dropped.contains(&entry) {
        dropped.push(entry);
    }
}

/// Adds one lobe; lanes whose weight or parameters are not numbers get weight 0 and are reported.
fn add_lobe(
    lobes: &mut Lobes,
    tree: &Tree,
    surface: u32,
    layer: u32,
    weight: Weight,
    tint: Option<[Floats; 3]>,
    name: (&'static str, NodeId),
) -> bool {
    if lobes.lobes.len() >= MOST {
        return false;
    }
    let n = tree.lanes;
    let made = &lobes.surfaces.list[surface as usize];
    let start = lobes.weights.take(3 * n);
    for component in 0..3 {
        let factor = tint.map_or(Operand::One(1.0), |t| Operand::of(tree, t[component]));
        let out = &mut lobes.weights[start + component * n..start + (component + 1) * n];
        multiply(lobes.sweep.weights.operand(weight, component, n), factor, out);
    }
    if made.gate == NONE && usable_and_some(&lobes.weights[start..]) {
        // The common case: every weight is a number and the surface exists in every lane.
        lobes.lobes.push(Lobe { surface, layer });
        return true;
    }
    let mut any = false;
    for lane in 0..n {
        let at = [start + lane, start + n + lane, start + 2 * n + lane];
        let gate = lobes.surfaces.gate(made, lane);
        let w = at.map(|i| lobes.weights[i]);
        // Lanes that did not run this closure have weight zero before the tint; their parameters do not matter.
        let absent = (0..3).all(|c| lobes.sweep.weights.get(weight, c, lane, n) == 0.0) || gate == 0.0;
        let broken = gate.is_nan() || w.iter().any(|&v| !usable(v));
        if broken && !absent {
            drop_lane(&mut lobes.dropped, name, lane);
        }
        if broken || absent {
            for i in at {
                lobes.weights[i] = 0.0;
            }
        }
        any |= !(broken || absent) && w != [0.0; 3];
    }
    if any {
        lobes.lobes.push(Lobe { surface, layer });
    } else {
        lobes.weights.truncate(start);
    }
    true
}

/// Writes the albedo of every tree that lies on top of something as steps, children first, for every medium it lies in.
fn build_steps(
    sweep: &mut Sweep,
    layers: &mut Layers,
    surfaces: &mut Surfaces,
    table: &ClosureTable,
    tree: &Tree,
    root: NodeId,
) {
    if !sweep.in_top.iter().any(|&needed| needed) {
        return;
    }
    layers.steps.push(Step::Zero);
    let mut media: SmallVec<[u32; 4]> = layers.tops().map(|(_, medium)| medium).collect();
    media.sort_unstable();
    media.dedup();
    for medium in media {
        for index in (0..=root.0).filter(|&index| sweep.in_top[index as usize]) {
            let step = step_of(sweep, layers, surfaces, table, (tree, index, medium));
            layers.steps.push(step);
            sweep.step_of[index as usize] = layers.steps.len() as u32 - 1;
        }
        let here: SmallVec<[usize; 8]> = layers.tops().filter(|&(_, m)| m == medium).map(|(layer, _)| layer).collect();
        for layer in here {
            if let Top::Tree(node) = &mut layers.list[layer].top {
                *node = sweep.step_of[*node as usize];
            }
        }
    }
}

/// The albedo of one node in a medium, from those of its children there.
fn step_of(
    sweep: &Sweep,
    layers: &mut Layers,
    surfaces: &mut Surfaces,
    table: &ClosureTable,
    (tree, index, medium): (&Tree, u32, u32),
) -> Step {
    let of = |child: Option<NodeId>| child.map_or(0, |c| sweep.step_of[c.0 as usize]);
    match tree.nodes[index as usize] {
        Node::Scale { weight, child } => {
            let largest = |lane| weight.iter().map(|&w| tree.float(w, lane).abs()).fold(0.0, f32::max);
            Step::Scale(surfaces.push_column(largest), of(Some(child)))
        }
        Node::Add(a, b) => Step::Add(of(Some(a)), of(Some(b))),
        Node::Select { mask, then, otherwise } => {
            let column = surfaces.push_column(|lane| if tree.int(mask, lane) != 0 { 1.0 } else { 0.0 });
            Step::Select(column, of(then), of(otherwise))
        }
        Node::Leaf { closure, first_param, param_count, .. } => {
            let nested = |k: u32| match tree.params.get((first_param + k) as usize) {
                Some(Param::Closure(child)) if k < param_count => of(*child),
                _ => 0,
            };
            let (first, last) = sweep.leaves_of(index, medium);
            match table.get(closure).model {
                Model::Layer => Step::Over(nested(0), nested(1)),
                Model::Sheen | Model::Coat => {
                    let base = nested(0);
                    layers.steps.push(Step::Leaves(first, last));
                    Step::Over(layers.steps.len() as u32 - 1, base)
                }
                _ => Step::Leaves(first, last),
            }
        }
    }
}

/// Sums emission and holes, seen through the layers over them.
fn emit(lobes: &mut Lobes) {
    let n = lobes.lanes;
    if lobes.emits || lobes.holdout.len() != n {
        lobes.emission.resize(n);
        lobes.holdout.resize(n, 0.0);
        for column in [&mut lobes.emission.x, &mut lobes.emission.y, &mut lobes.emission.z, &mut lobes.holdout] {
            column.fill(0.0);
        }
    }
    lobes.emits = !lobes.sweep.emitters.is_empty();
    for &(weight, layer, hole, node) in &lobes.sweep.emitters {
        for lane in 0..n {
            let through = if layer == NONE { 1.0 } else { lobes.layers.through_of(layer)[lane] };
            let tint = lobes.media.get(lobes.layers.medium(layer)).map_or([1.0; 3], |m| m.viewer_tint(lane).to_array());
            let [x, y, z] = std::array::from_fn(|c| lobes.sweep.weights.get(weight, c, lane, n) * through * tint[c]);
            if ![x, y, z].into_iter().all(usable) {
                drop_lane(&mut lobes.dropped, (if hole { "holdout" } else { "emission" }, node), lane);
            } else if hole {
                lobes.holdout[lane] += (x + y + z) / 3.0;
            } else {
                let sum = lobes.emission.get(lane) + glam::Vec3::new(x, y, z);
                lobes.emission.set(lane, sum);
            }
        }
    }
}

/// Gives every lobe its probability: luminance of the weight's magnitude, albedo, and what the layers let through.
fn pick(lobes: &mut Lobes) {
    let n = lobes.lanes;
    lobes.picks.resize(n * lobes.lobes.len(), 0.0);
    lobes.last.clear();
    lobes.last.resize(n, NONE);
    let mut total = std::mem::take(&mut lobes.side);
    total.clear();
    total.resize(n, 0.0);
    for (index, lobe) in lobes.lobes.iter().enumerate() {
        let out = &mut lobes.picks[index * n..(index + 1) * n];
        lobes.layers.albedo_seen(&lobes.surfaces, lobe.surface, out);
        let through = if lobe.layer == NONE { &lobes.ones } else { lobes.layers.through_of(lobe.layer) };
        let weight = &lobes.weights[3 * n * index..3 * n * (index + 1)];
        let medium = lobes.media.get(lobes.layers.medium(lobe.layer)).filter(|medium| medium.colored);
        for i in (0..n).filter(|_| medium.is_some()) {
            out[i] *= medium.map_or(1.0, |medium| medium.viewer_tint(i).element_sum() / 3.0);
        }
        let (x, rest) = weight.split_at(n);
        let (y, z) = rest.split_at(n);
        share_lanes([x, y, z], through, out, &mut total);
    }
    for value in &mut total {
        // The inverse of a smaller sum would be infinite.
        *value = if *value >= f32::MIN_POSITIVE { 1.0 / *value } else { 0.0 };
    }
    for index in 0..lobes.lobes.len() {
        let picks = &mut lobes.picks[index * n..(index + 1) * n];
        normalise_lanes(index as u32, &total, picks, &mut lobes.last);
    }
    lobes.side = total;
}

/// The rule a layering keyword chooses.
pub(super) fn rule_of(text: &str, fallback: Layering) -> Layering {
    text.parse().unwrap_or(fallback)
}
