//! Tops: the trees that lie on top of something, and the steps that their albedo is computed in.

use super::layering::{Layers, Step, Top};
use super::leaf::Leaf;
use super::lobe_models::LobeModels;
use super::tree::{Node, NodeId, Param, Tree};
use smallvec::SmallVec;

/// What a leaf of a top consists of: its lobes, and what it nests.
#[derive(Clone, Copy, Debug, Default)]
struct TopLeaf {
    /// First and last of its lobes in [`Layers::leaves`].
    lobes: (u32, u32),
    /// Does it lay anything over a base?
    nests: bool,
    /// The tree that it lays over its base.
    top: Option<NodeId>,
    /// Its base.
    base: Option<NodeId>,
}

/// The nodes that tops consist of.
#[derive(Debug, Default)]
pub struct Tops {
    in_top: Vec<bool>,
    step_of: Vec<u32>,
    /// Nodes with the coats they lie under, and what they consist of; by falling node.
    leaves: Vec<((u32, u32), TopLeaf)>,
}

impl Tops {
    /// Empties the store for a tree of so many nodes.
    pub fn clear(&mut self, nodes: usize) {
        self.in_top.clear();
        self.in_top.resize(nodes, false);
        self.step_of.clear();
        self.step_of.resize(nodes, 0);
        self.leaves.clear();
    }

    /// Marks what a node consists of, if it is in a top.
    pub fn mark_children(&mut self, tree: &Tree, index: u32) {
        if !self.in_top[index as usize] {
            return;
        }
        let mut mark = |child: Option<NodeId>| {
            if let Some(NodeId(child)) = child {
                self.in_top[child as usize] = true;
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

    /// Marks the top of a leaf that was made ready, and notes what the leaf consists of if it is in a top itself.
    pub fn note_leaf(&mut self, layers: &mut Layers, (index, coat): (u32, u32), leaf: &Leaf, nests: bool) {
        if let Some(top) = leaf.top {
            self.in_top[top.0 as usize] = true;
        }
        if self.in_top[index as usize] {
            let first = layers.leaves.len() as u32;
            layers.leaves.extend(leaf.parts.iter().map(|part| (part.model, part.coverage)));
            let lobes = (first, layers.leaves.len() as u32);
            debug_assert!(self.leaves.last().is_none_or(|((node, _), _)| *node >= index));
            self.leaves.push(((index, coat), TopLeaf { lobes, nests, top: leaf.top, base: leaf.base }));
        }
    }

    /// What a leaf under a coat consists of; nodes were visited by falling index, each under a few coats.
    fn leaf_of(&self, index: u32, coat: u32) -> TopLeaf {
        let from = self.leaves.partition_point(|((node, _), _)| *node > index);
        let mut of_node = self.leaves[from..].iter().take_while(|((node, _), _)| *node == index);
        of_node.find(|((_, c), _)| *c == coat).map_or(TopLeaf::default(), |&(_, leaf)| leaf)
    }

    /// Writes the albedo of every tree that lies on top of something as steps, children first, for every coat it lies under.
    pub fn build_steps(&mut self, layers: &mut Layers, models: &mut LobeModels, tree: &Tree, root: NodeId) {
        if !self.in_top.iter().any(|&needed| needed) {
            return;
        }
        layers.steps.push(Step::Zero);
        let mut coats: SmallVec<[u32; 4]> = layers.tops().map(|(_, coat)| coat).collect();
        coats.sort_unstable();
        coats.dedup();
        for coat in coats {
            for index in (0..=root.0).filter(|&index| self.in_top[index as usize]) {
                let step = self.step(layers, models, tree, (index, coat));
                layers.steps.push(step);
                self.step_of[index as usize] = layers.steps.len() as u32 - 1;
            }
            let here: SmallVec<[usize; 8]> =
                layers.tops().filter(|&(_, c)| c == coat).map(|(layer, _)| layer).collect();
            for layer in here {
                if let Top::Tree(node) = &mut layers.list[layer].top {
                    *node = self.step_of[*node as usize];
                }
            }
        }
    }

    /// The albedo of one node under a coat, from those of its children there.
    fn step(&self, layers: &mut Layers, models: &mut LobeModels, tree: &Tree, (index, coat): (u32, u32)) -> Step {
        let of = |child: Option<NodeId>| child.map_or(0, |c| self.step_of[c.0 as usize]);
        match tree.nodes[index as usize] {
            Node::Scale { weight, child } => {
                let largest = |lane| weight.iter().map(|&w| tree.float(w, lane).abs()).fold(0.0, f32::max);
                Step::Scale(models.push_column(largest), of(Some(child)))
            }
            Node::Add(a, b) => Step::Add(of(Some(a)), of(Some(b))),
            Node::Select { mask, then, otherwise } => {
                let column = models.push_column(|lane| if tree.int(mask, lane) != 0 { 1.0 } else { 0.0 });
                Step::Select(column, of(then), of(otherwise))
            }
            Node::Leaf { .. } => {
                let TopLeaf { lobes: (first, last), nests, top, base } = self.leaf_of(index, coat);
                if !nests {
                    return Step::Leaves(first, last);
                }
                let mut over = of(top);
                if last > first || top.is_none() {
                    layers.steps.push(Step::Leaves(first, last));
                    let own = layers.steps.len() as u32 - 1;
                    over = own;
                    if top.is_some() {
                        layers.steps.push(Step::Add(own, of(top)));
                        over = own + 1;
                    }
                }
                Step::Over(over, of(base))
            }
        }
    }
}
