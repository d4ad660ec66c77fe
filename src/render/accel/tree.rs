//! The hierarchy that rays walk: nodes of eight boxes, leaves of four triangles side by side, or of one sphere or quad.
//!
//! The shape of the tree is `obvhs`'s (pairs found along a Morton curve, then reinsertion). Its pairs are opened here,
//! largest box first, until a node has eight children, and what holds four triangles or fewer becomes one leaf.

use super::shape::Analytic;
use crate::scene::{Geometry, Shape};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Triangles of a block.
pub const LANES: usize = 4;

/// Marks a child that is a block of triangles; the other bits are its index.
pub const BLOCK: u32 = 1 << 31;

/// Marks a child that is a sphere or a quad; the other bits are its index.
pub const ANALYTIC: u32 = 1 << 30;

/// Eight boxes, each axis its lower planes and then its upper ones. A child that is not there has an empty box.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// Lower x, upper x, lower y, upper y, lower z, upper z.
    pub planes: [[f32; WIDTH]; 6],
    /// A node's index, or a leaf with its mark.
    pub children: [u32; WIDTH],
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
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Block {
    /// By corner, then axis, then triangle.
    pub corners: [[[f32; LANES]; 3]; 3],
    /// The primitives, ascending.
    pub ids: [u32; LANES],
}

/// The whole hierarchy.
#[derive(Debug, Default)]
pub struct Tree {
    /// The nodes; the first is the root.
    pub nodes: Vec<Node>,
    /// The leaves of triangles.
    pub blocks: Vec<Block>,
    /// The leaves of one sphere or quad.
    pub analytic: Vec<Analytic>,
    /// How many entries a walk's stack can need.
    pub stack: usize,
}

impl Tree {
    /// The tree over `geometry`, whose primitives reach as far as `magnitude` from the origin.
    pub fn new(geometry: &Geometry, magnitude: &[f32]) -> Self {
        if geometry.primitives.is_empty() {
            return Tree::default();
        }
        let pairs = pairs(geometry, magnitude);
        Opening::new(&pairs, geometry).run()
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..]) + size_of_val(&self.analytic[..])
    }
}

/// The tree of pairs over the padded boxes of all primitives.
fn pairs(geometry: &Geometry, magnitude: &[f32]) -> Bvh2 {
    let bounds = |(i, p): (usize, &crate::scene::Primitive)| bounds(&p.shape, super::OFFSET * magnitude[i]);
    let bounds: Vec<Aabb> = geometry.primitives.iter().enumerate().map(bounds).collect();
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    build_bvh2(&bounds, params, &mut Duration::default())
}

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
struct Opening<'a> {
    pairs: &'a Bvh2,
    geometry: &'a Geometry,
    /// Of each node of the tree of pairs, how many triangles it holds, and more than a block takes if that is so or
    /// if it holds anything else.
    counts: Vec<u8>,
    tree: Tree,
}

impl<'a> Opening<'a> {
    fn new(pairs: &'a Bvh2, geometry: &'a Geometry) -> Self {
        const MANY: u8 = LANES as u8 + 1;
        let mut counts = vec![0u8; pairs.nodes.len()];
        let mut order = Vec::with_capacity(pairs.nodes.len());
        let mut todo = vec![0u32];
        while let Some(index) = todo.pop() {
            order.push(index);
            let node = &pairs.nodes[index as usize];
            if !node.is_leaf() {
                todo.extend([node.first_index, node.first_index + 1]);
            }
        }
        for &index in order.iter().rev() {
            let node = &pairs.nodes[index as usize];
            let first = node.first_index as usize;
            counts[index as usize] = match node.is_leaf() {
                false => (counts[first] + counts[first + 1]).min(MANY),
                true => match geometry.primitives[pairs.primitive_indices[first] as usize].shape {
                    Shape::Triangle { .. } => 1,
                    _ => MANY,
                },
            };
        }
        Opening { pairs, geometry, counts, tree: Tree::default() }
    }

    fn is_leaf(&self, index: u32) -> bool {
        self.counts[index as usize] as usize <= LANES || self.pairs.nodes[index as usize].is_leaf()
    }

    fn run(mut self) -> Tree {
        self.tree.nodes.push(Node::EMPTY);
        let mut todo = vec![(0u32, 0usize, 1usize)];
        let mut depth = 1;
        while let Some((index, node, level)) = todo.pop() {
            depth = depth.max(level);
            for (slot, &child) in self.open(index).iter().enumerate() {
                let code = if self.is_leaf(child) {
                    self.leaf(child)
                } else {
                    self.tree.nodes.push(Node::EMPTY);
                    todo.push((child, self.tree.nodes.len() - 1, level + 1));
                    self.tree.nodes.len() as u32 - 1
                };
                let bounds = *self.pairs.nodes[child as usize].aabb();
                self.tree.nodes[node].set(slot, &bounds, code);
            }
        }
        // Each level leaves seven behind while the eighth is walked; the last one is pushed whole.
        self.tree.stack = depth * (WIDTH - 1) + 1;
        self.tree
    }

    /// Up to eight nodes that together are `index`.
    fn open(&self, index: u32) -> Vec<u32> {
        if self.is_leaf(index) {
            return vec![index];
        }
        let mut open = Vec::with_capacity(WIDTH);
        open.push(index);
        while open.len() < WIDTH {
            let area = |i: u32| self.pairs.nodes[i as usize].aabb().half_area();
            let candidates = (0..open.len()).filter(|&k| !self.is_leaf(open[k]));
            let Some(k) = candidates.max_by(|&a, &b| area(open[a]).total_cmp(&area(open[b]))) else { break };
            let first = self.pairs.nodes[open[k] as usize].first_index;
            open[k] = first;
            open.push(first + 1);
        }
        open
    }

    /// Stores a leaf; gives its code.
    fn leaf(&mut self, index: u32) -> u32 {
        let mut ids = self.primitives(index);
        ids.sort_unstable();
        if self.counts[index as usize] as usize > LANES {
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
        self.tree.blocks.push(block);
        BLOCK | (self.tree.blocks.len() as u32 - 1)
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
