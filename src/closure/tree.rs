//! The closure tree of one batch: what a shader's `Ci` is, for all lanes at once.
//!
//! Leaves carry their parameters as columns, weights are columns, and a branch that some lanes did not take is a
//! [`Node::Select`] with a mask. So one walk over the tree serves every lane. A missing closure (`Ci = 0`) is `None`.

use crate::lang::closures::ClosureId;
use crate::lang::symbols::{Strings, Symbol};
use std::collections::HashSet;

/// Index of a node in its tree. Children are always older, so their index is smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// A column of floats in a tree: one number for all lanes, or one a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Floats {
    /// The same in every lane.
    Uniform(f32),
    /// Offset of the first lane in [`Tree::floats`].
    Varying(u32),
}

/// A column of integers (or of symbols, or of masks) in a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ints {
    /// The same in every lane.
    Uniform(i32),
    /// Offset of the first lane in [`Tree::ints`].
    Varying(u32),
}

/// The value of one closure parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Param {
    /// A float.
    Float(Floats),
    /// A color, vector or normal.
    Triple([Floats; 3]),
    /// An integer.
    Int(Ints),
    /// A string, as symbols.
    String(Ints),
    /// A nested closure.
    Closure(Option<NodeId>),
}

/// A keyword parameter: its index in [`crate::lang::closures::ClosureSpec::keywords`] and its value.
pub type Keyword = (u32, Param);

/// A node of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A closure with its parameters.
    Leaf {
        /// Which closure.
        closure: ClosureId,
        /// First of its parameters in [`Tree::params`]; the closure's declaration says how many there are.
        first_param: u32,
        /// How many positional parameters there are.
        param_count: u32,
        /// First of its keywords in [`Tree::keywords`].
        first_keyword: u32,
        /// How many keywords are given.
        keyword_count: u32,
    },
    /// A closure times a weight.
    Scale {
        /// The weight.
        weight: [Floats; 3],
        /// What is scaled.
        child: NodeId,
    },
    /// The sum of two closures.
    Add(NodeId, NodeId),
    /// One closure where the mask is not zero, another elsewhere.
    Select {
        /// The mask.
        mask: Ints,
        /// Lanes whose mask is set.
        then: Option<NodeId>,
        /// The other lanes.
        otherwise: Option<NodeId>,
    },
}

/// A closure tree with the columns its nodes refer to. Cleared and filled again for every batch.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Number of lanes of every varying column.
    pub lanes: usize,
    /// The nodes; children before parents.
    pub nodes: Vec<Node>,
    /// Positional parameters of all leaves.
    pub params: Vec<Param>,
    /// Keyword parameters of all leaves.
    pub keywords: Vec<Keyword>,
    /// Varying float columns, one after the other.
    pub floats: Vec<f32>,
    /// Varying integer columns, one after the other.
    pub ints: Vec<i32>,
    /// The value of `Ci`.
    pub root: Option<NodeId>,
    /// The strings that the shader made in this batch.
    pub strings: Strings,
    /// Where in the text each leaf was written, as the host numbers places; in the order of the nodes.
    sites: Vec<(NodeId, u32)>,
}

impl Tree {
    /// Empties the tree for a batch of `lanes`.
    pub fn clear(&mut self, lanes: usize) {
        self.lanes = lanes;
        self.nodes.clear();
        self.params.clear();
        self.keywords.clear();
        self.floats.clear();
        self.ints.clear();
        self.root = None;
        self.strings.clear();
        self.sites.clear();
    }

    /// Notes where in the text the newest leaf was written.
    pub fn note_site(&mut self, leaf: NodeId, site: u32) {
        self.sites.push((leaf, site));
    }

    /// Where in the text a leaf was written, if that was noted.
    pub fn site(&self, leaf: NodeId) -> Option<u32> {
        let at = self.sites.binary_search_by_key(&leaf, |&(node, _)| node).ok()?;
        Some(self.sites[at].1)
    }

    /// Where the last leaf of those up to a node was written, if that was noted.
    pub fn site_near(&self, node: NodeId) -> Option<u32> {
        let after = self.sites.partition_point(|&(leaf, _)| leaf <= node);
        self.sites[..after].last().map(|&(_, site)| site)
    }

    /// Adds a node.
    pub fn push(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// Adds a leaf.
    pub fn leaf(&mut self, closure: ClosureId, params: &[Param], keywords: &[Keyword]) -> NodeId {
        let (first_param, first_keyword) = (self.params.len() as u32, self.keywords.len() as u32);
        self.params.extend_from_slice(params);
        self.keywords.extend_from_slice(keywords);
        self.push(Node::Leaf {
            closure,
            first_param,
            param_count: params.len() as u32,
            first_keyword,
            keyword_count: keywords.len() as u32,
        })
    }

    /// Adds two closures; a missing one adds nothing.
    pub fn add(&mut self, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.push(Node::Add(a, b))),
            (one, None) | (None, one) => one,
        }
    }

    /// Scales a closure; a missing one stays missing.
    pub fn scale(&mut self, child: Option<NodeId>, weight: [Floats; 3]) -> Option<NodeId> {
        child.map(|child| self.push(Node::Scale { weight, child }))
    }

    /// Is there a closure in this lane? As in OSL, one whose weight is zero is none.
    pub fn present(&self, root: Option<NodeId>, lane: usize) -> bool {
        let mut open = vec![root];
        // A closure added to itself many times is looked at once.
        let mut seen = HashSet::new();
        while let Some(node) = open.pop() {
            match node.map(|id| self.nodes[id.0 as usize]) {
                None => {}
                Some(Node::Leaf { .. }) => return true,
                Some(Node::Add(a, b)) if seen.insert(node) => open.extend([Some(a), Some(b)]),
                Some(Node::Add(..)) => {}
                Some(Node::Scale { weight, child }) => {
                    let zero = weight.iter().all(|w| self.float(*w, lane) == 0.0);
                    open.push(Some(child).filter(|_| !zero));
                }
                Some(Node::Select { mask, then, otherwise }) => {
                    open.push(if self.int(mask, lane) != 0 { then } else { otherwise });
                }
            }
        }
        false
    }

    /// Stores a column of floats, one a lane.
    pub fn varying(&mut self, column: &[f32]) -> Floats {
        let at = self.floats.len() as u32;
        self.floats.extend_from_slice(&column[..self.lanes]);
        Floats::Varying(at)
    }

    /// Stores a column of integers, one a lane.
    pub fn varying_ints(&mut self, column: &[i32]) -> Ints {
        let at = self.ints.len() as u32;
        self.ints.extend_from_slice(&column[..self.lanes]);
        Ints::Varying(at)
    }

    /// The lanes of a varying column, from its offset.
    pub fn column(&self, at: u32) -> &[f32] {
        &self.floats[at as usize..at as usize + self.lanes]
    }

    /// The float of one lane.
    #[inline(always)]
    pub fn float(&self, column: Floats, lane: usize) -> f32 {
        match column {
            Floats::Uniform(value) => value,
            Floats::Varying(at) => self.floats[at as usize + lane],
        }
    }

    /// The text of one lane of a column of symbols.
    pub fn text(&self, column: Ints, lane: usize) -> &str {
        self.strings.text(Symbol(self.int(column, lane)))
    }

    /// The integer of one lane.
    #[inline(always)]
    pub fn int(&self, column: Ints, lane: usize) -> i32 {
        match column {
            Ints::Uniform(value) => value,
            Ints::Varying(at) => self.ints[at as usize + lane],
        }
    }
}
