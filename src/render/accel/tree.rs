//! The hierarchy that rays walk: nodes of eight boxes, leaves of four triangles side by side, or of one sphere or quad.
//!
//! The tree begins as pairs found along a Morton curve (see `cluster`), which `obvhs` improves by reinsertion. They are put
//! together here to nodes of up to eight children and leaves of up to four triangles.

use super::cluster::cluster;
use super::pages::Pages;
use super::shape::Analytic;
use crate::scene::{Geometry, Shape};
use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Triangles of a block.
pub const LANES: usize = 4;

/// Marks a child that is a block of triangles; the other bits are its index.
pub const BLOCK: u32 = 1 << 31;

/// Marks a child that is a sphere or a quad; the other bits are its index.
pub const ANALYTIC: u32 = 1 << 30;

/// Eight boxes, each axis its lower planes and then its upper ones. A child that is not there has an empty box.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Node {
    /// Lower x, upper x, lower y, upper y, lower z, upper z.
    pub planes: [[f32; WIDTH]; 6],
    /// A node's index, or a leaf with its mark.
    pub children: [u32; WIDTH],
    /// Fills the last cache line.
    spare: [u32; WIDTH],
}

impl Node {
    const EMPTY: Node = Node {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [0; WIDTH],
        spare: [0; WIDTH],
    };

    fn set(&mut self, slot: usize, bounds: &Aabb, child: u32) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }
}

/// Four triangles. A lane that is empty repeats the first triangle, which changes no answer.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Block {
    /// By corner, then axis, then triangle.
    pub corners: [[[f32; LANES]; 3]; 3],
    /// The primitives, ascending.
    pub ids: [u32; LANES],
}

/// The whole hierarchy.
#[derive(Debug)]
pub struct Tree {
    /// The nodes; the first is the root.
    pub nodes: Pages<Node>,
    /// The leaves of triangles.
    pub blocks: Pages<Block>,
    /// The leaves of one sphere or quad.
    pub analytic: Vec<Analytic>,
    /// How many entries a walk's stack can need.
    pub stack: usize,
}

impl Tree {
    /// The tree over `geometry`; the box of each primitive is wider by its `margin` on all sides.
    pub fn new(geometry: &Geometry, margin: &[f32]) -> Self {
        if geometry.primitives.is_empty() {
            let mut tree = Tree::empty(0);
            tree.nodes.push(Node::EMPTY);
            return tree;
        }
        let pairs = pairs(geometry, margin);
        Opening::new(&pairs, geometry).run()
    }

    /// A tree without nodes, with room for those of `primitives`.
    fn empty(primitives: usize) -> Self {
        // As pairs, all inner nodes would be one less than the leaves.
        let (nodes, blocks) = (Pages::new(primitives.max(1)), Pages::new(primitives));
        Tree { nodes, blocks, analytic: Vec::new(), stack: 0 }
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.items()) + size_of_val(self.blocks.items()) + size_of_val(&self.analytic[..])
    }
}

/// The tree of pairs over the padded boxes of all primitives.
fn pairs(geometry: &Geometry, margin: &[f32]) -> Bvh2 {
    let bounds = |(i, p): (usize, &crate::scene::Primitive)| bounds(&p.shape, margin[i]);
    let bounds: Vec<Aabb> = geometry.primitives.iter().enumerate().map(bounds).collect();
    let mut pairs = cluster(&bounds);
    // Differences of infinite areas are no numbers, which the search does not take.
    if pairs.nodes[0].aabb().half_area() < MOST_AREA {
        ReinsertionOptimizer::default().run(&mut pairs, REINSERTED, None);
    }
    pairs
}

/// The share of nodes that are put elsewhere in the first round; a third, a fifth and so on of it in the next ones.
///
/// Decision (2026-11-29): a tenth in one run, instead of a tenth in one and a fifth in another, because the second run takes
/// as long as all else together and saves a ray 2 % of its nodes.
const REINSERTED: f32 = 0.1;

/// Half the area of the largest scene whose areas can be added up.
const MOST_AREA: f32 = 1e36;

fn bounds(shape: &Shape, pad: f32) -> Aabb {
    let bounds = match *shape {
        Shape::Sphere { center, radius } => Aabb::new((center - radius).into(), (center + radius).into()),
        Shape::Quad { corner: a, edge_x: x, edge_y: y } => {
            Aabb::from_points(&[a.into(), (a + x).into(), (a + y).into(), (a + x + y).into()])
        }
        Shape::Triangle { a, b, c } => Aabb::from_points(&[a.into(), b.into(), c.into()]),
    };
    // A flat box has a slab of no thickness, which rounding could miss.
    Aabb::new(bounds.min - Vec3A::splat(pad), bounds.max + Vec3A::splat(pad))
}

/// From pairs to nodes of eight.
///
/// Which pairs to open is chosen to cost a random ray least, by dynamic programming from the leaves up. Source: Ylitie,
/// Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.1, with
/// areas for probabilities. Departs from source: leaves are blocks of up to four triangles, or one other primitive.
struct Opening<'a> {
    pairs: &'a Bvh2,
    geometry: &'a Geometry,
    choices: Vec<Choice>,
    tree: Tree,
}

/// What is best done with one node of the tree of pairs.
#[derive(Clone, Copy, Default)]
struct Choice {
    /// `left[i - 1]`: how many of i children its left half gets; 0 to take one less, or not to divide it at all.
    left: [u8; WIDTH],
    /// How many triangles it holds; `MANY` and more: too many for a block, or anything else among them.
    count: u8,
    /// As one child it is a leaf.
    leaf: bool,
}

/// The least cost of one node of the tree of pairs as one to seven children of a wide node.
type Costs = [f32; WIDTH - 1];

const MANY: u8 = LANES as u8 + 1;

/// What a block costs, where a node costs 1. Chosen; no measurement of it is recorded. It shapes the tree, never an
/// answer.
const COST_OF_BLOCK: f32 = 0.6;

impl<'a> Opening<'a> {
    fn new(pairs: &'a Bvh2, geometry: &'a Geometry) -> Self {
        let mut order = Vec::with_capacity(pairs.nodes.len());
        let mut todo = vec![0u32];
        while let Some(index) = todo.pop() {
            order.push(index);
            let node = &pairs.nodes[index as usize];
            if !node.is_leaf() {
                todo.extend([node.first_index, node.first_index + 1]);
            }
        }
        let mut opening =
            Opening { pairs, geometry, choices: Vec::new(), tree: Tree::empty(geometry.primitives.len()) };
        opening.choices.resize(pairs.nodes.len(), Choice::default());
        // Backward, both halves of a node come before it, the left one first.
        let mut costs: Vec<Costs> = Vec::new();
        for &index in order.iter().rev() {
            let of_node = if pairs.nodes[index as usize].is_leaf() {
                opening.end(index)
            } else {
                let right = costs.pop().unwrap_or_default();
                let left = costs.pop().unwrap_or_default();
                opening.choose(index, &left, &right)
            };
            costs.push(of_node);
        }
        opening
    }

    fn area(&self, index: u32) -> f32 {
        self.pairs.nodes[index as usize].aabb().half_area()
    }

    /// The costs of a node with one primitive.
    fn end(&mut self, index: u32) -> Costs {
        let primitive = self.pairs.primitive_indices[self.pairs.nodes[index as usize].first_index as usize];
        let triangle = matches!(self.geometry.primitives[primitive as usize].shape, Shape::Triangle { .. });
        let count = if triangle { 1 } else { MANY };
        self.choices[index as usize] = Choice { left: [0; WIDTH], count, leaf: true };
        [COST_OF_BLOCK * self.area(index); WIDTH - 1]
    }

    /// The costs of a node with two halves, and what to do for them.
    fn choose(&mut self, index: u32, left: &Costs, right: &Costs) -> Costs {
        let first = self.pairs.nodes[index as usize].first_index as usize;
        let count = (self.choices[first].count + self.choices[first + 1].count).min(MANY);
        let mut choice = Choice { left: [0; WIDTH], count, leaf: false };
        let best = |children: usize| {
            let ways = (1..children).filter(|k| *k < WIDTH && children - k < WIDTH);
            let costs = ways.map(|k| (left[k - 1] + right[children - k - 1], k as u8));
            costs.fold((f32::INFINITY, 1), |a, b| if b.0 < a.0 { b } else { a })
        };
        let (inside, k) = best(WIDTH);
        choice.left[WIDTH - 1] = k;
        let area = self.area(index);
        let mut costs = [area + inside; WIDTH - 1];
        if count < MANY && COST_OF_BLOCK * area <= costs[0] {
            choice.leaf = true;
            costs[0] = COST_OF_BLOCK * area;
        }
        for children in 2..WIDTH {
            let (cost, k) = best(children);
            costs[children - 1] = costs[children - 2];
            if cost < costs[children - 1] {
                costs[children - 1] = cost;
                choice.left[children - 1] = k;
            }
        }
        self.choices[index as usize] = choice;
        costs
    }

    fn run(mut self) -> Tree {
        self.tree.nodes.push(Node::EMPTY);
        let (mut todo, mut depth) = (vec![(0u32, 0usize, 1usize)], 1);
        let mut children = Vec::with_capacity(WIDTH);
        while let Some((index, node, level)) = todo.pop() {
            depth = depth.max(level);
            children.clear();
            self.open(index, WIDTH, &mut children);
            for (slot, &child) in children.iter().enumerate() {
                let code = if self.choices[child as usize].leaf {
                    self.leaf(child)
                } else {
                    let new = self.tree.nodes.push(Node::EMPTY);
                    todo.push((child, new as usize, level + 1));
                    new
                };
                let bounds = *self.pairs.nodes[child as usize].aabb();
                self.tree.nodes.items_mut()[node].set(slot, &bounds, code);
            }
        }
        // Each level leaves seven behind while the eighth is walked; the last one is pushed whole.
        self.tree.stack = depth * (WIDTH - 1) + 1;
        self.tree
    }

    /// Appends the nodes that make `index` as up to `count` children; never deeper than `count` calls.
    fn open(&self, index: u32, count: usize, children: &mut Vec<u32>) {
        let choice = &self.choices[index as usize];
        let count = (2..=count).rev().find(|i| choice.left[i - 1] > 0);
        match count {
            Some(count) if !self.pairs.nodes[index as usize].is_leaf() => {
                let first = self.pairs.nodes[index as usize].first_index;
                let left = choice.left[count - 1] as usize;
                self.open(first, left, children);
                self.open(first + 1, count - left, children);
            }
            _ => children.push(index),
        }
    }

    /// Stores a leaf; gives its code.
    fn leaf(&mut self, index: u32) -> u32 {
        let mut ids = self.primitives(index);
        ids.sort_unstable();
        if self.choices[index as usize].count == MANY {
            let id = ids[0];
            self.tree.analytic.push(Analytic { shape: self.geometry.primitives[id as usize].shape, id });
            return ANALYTIC | (self.tree.analytic.len() as u32 - 1);
        }
        let mut block = Block { corners: [[[0.0; LANES]; 3]; 3], ids: [ids[0]; LANES] };
        for lane in 0..LANES {
            let id = ids.get(lane).copied().unwrap_or(ids[0]);
            block.ids[lane] = id;
            if let Shape::Triangle { a, b, c } = self.geometry.primitives[id as usize].shape {
                for (corner, p) in [a, b, c].iter().enumerate() {
                    (0..3).for_each(|axis| block.corners[corner][axis][lane] = p[axis]);
                }
            }
        }
        BLOCK | self.tree.blocks.push(block)
    }

    /// All primitives below a node.
    fn primitives(&self, index: u32) -> Vec<u32> {
        let (mut ids, mut todo) = (Vec::with_capacity(LANES), vec![index]);
        while let Some(index) = todo.pop() {
            let node = &self.pairs.nodes[index as usize];
            if node.is_leaf() {
                let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                ids.extend_from_slice(&self.pairs.primitive_indices[range]);
            } else {
                todo.extend([node.first_index, node.first_index + 1]);
            }
        }
        ids
    }
}
