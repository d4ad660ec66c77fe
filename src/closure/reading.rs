//! Reading a tree in one lane: its leaves in order, with weight, name and arguments, as a unit test asks for them.

use super::tree::{Node, NodeId, Param, Tree};
use crate::lang::closures::{ClosureSpec, ClosureTable, ParamSpec};

/// The leaves of a sum in one lane, in the order in which it is printed. Leaves that a branch or a weight of zero keeps out
/// are left out.
#[derive(Clone, Debug)]
pub struct Leaves<'t> {
    table: &'t ClosureTable,
    tree: &'t Tree,
    lane: usize,
    /// What is still to come, last one first, each with the weight above it.
    open: Vec<(NodeId, [f32; 3])>,
}

/// A leaf in one lane.
#[derive(Clone, Copy)]
pub struct Leaf<'t> {
    table: &'t ClosureTable,
    tree: &'t Tree,
    spec: &'t ClosureSpec,
    lane: usize,
    node: NodeId,
    weight: [f32; 3],
}

/// The value of an argument.
#[derive(Clone, Debug)]
pub enum Value<'t> {
    /// A float.
    Float(f32),
    /// A color, vector or normal.
    Triple([f32; 3]),
    /// An int.
    Int(i32),
    /// A string.
    String(&'t str),
    /// A nested closure, as its leaves.
    Closure(Leaves<'t>),
}

impl Tree {
    /// The leaves of `Ci` in one lane, below [`Tree::lanes`]. The table is the group's.
    pub fn lane<'t>(&'t self, table: &'t ClosureTable, lane: usize) -> Leaves<'t> {
        self.leaves(table, self.root, lane)
    }

    /// The leaves of any closure of the batch in one lane.
    pub fn leaves<'t>(&'t self, table: &'t ClosureTable, root: Option<NodeId>, lane: usize) -> Leaves<'t> {
        Leaves { table, tree: self, lane, open: root.map(|root| (root, [1.0; 3])).into_iter().collect() }
    }
}

impl<'t> Iterator for Leaves<'t> {
    type Item = Leaf<'t>;

    fn next(&mut self) -> Option<Leaf<'t>> {
        let (tree, table, lane) = (self.tree, self.table, self.lane);
        while let Some((node, weight)) = self.open.pop() {
            match tree.nodes[node.0 as usize] {
                Node::Add(a, b) => self.open.extend([(b, weight), (a, weight)]),
                Node::Scale { weight: own, child } => {
                    let own = own.map(|w| tree.float(w, lane));
                    // A closure times zero is no closure.
                    if own != [0.0; 3] {
                        self.open.push((child, std::array::from_fn(|c| weight[c] * own[c])));
                    }
                }
                Node::Select { mask, then, otherwise } => {
                    let taken = if tree.int(mask, lane) != 0 { then } else { otherwise };
                    self.open.extend(taken.map(|taken| (taken, weight)));
                }
                Node::Leaf { closure, .. } => {
                    return Some(Leaf { table, tree, spec: table.get(closure), lane, node, weight });
                }
            }
        }
        None
    }
}

impl<'t> Leaf<'t> {
    /// The closure's name in the language.
    pub fn name(&self) -> &'t str {
        self.spec.name
    }

    /// Its weight: the product of all factors above it, red, green and blue.
    pub fn weight(&self) -> [f32; 3] {
        self.weight
    }

    /// An argument by the name of its parameter or keyword; nothing for a name it was not given.
    pub fn get(&self, name: &str) -> Option<Value<'t>> {
        self.arguments().filter(|(own, _)| *own == name).last().map(|(_, value)| value)
    }

    /// Its arguments with their names: the positional ones, then the keywords that were given.
    pub fn arguments(&self) -> impl Iterator<Item = (&'t str, Value<'t>)> + use<'t> {
        let Leaf { table, tree, spec, lane, node, .. } = *self;
        let Node::Leaf { first_param, param_count, first_keyword, keyword_count, .. } = tree.nodes[node.0 as usize]
        else {
            unreachable!("a leaf is made of a leaf's node")
        };
        let params = &tree.params[first_param as usize..][..param_count as usize];
        let keywords = &tree.keywords[first_keyword as usize..][..keyword_count as usize];
        let name = |spec: &'t ParamSpec| spec.name;
        let positional = spec.params.iter().map(name).zip(params);
        let named = keywords.iter().map(move |(at, value)| (name(&spec.keywords[*at as usize]), value));
        positional.chain(named).map(move |(name, &param)| (name, argument(table, tree, param, lane)))
    }
}

fn argument<'t>(table: &'t ClosureTable, tree: &'t Tree, param: Param, lane: usize) -> Value<'t> {
    match param {
        Param::Float(column) => Value::Float(tree.float(column, lane)),
        Param::Triple(columns) => Value::Triple(columns.map(|column| tree.float(column, lane))),
        Param::Int(column) => Value::Int(tree.int(column, lane)),
        Param::String(column) => Value::String(tree.text(column, lane)),
        Param::Closure(root) => Value::Closure(tree.leaves(table, root, lane)),
    }
}

impl std::fmt::Debug for Leaf<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let arguments: Vec<_> = self.arguments().collect();
        f.debug_struct("Leaf")
            .field("name", &self.name())
            .field("weight", &self.weight)
            .field("arguments", &arguments)
            .finish()
    }
}

/// Leaves are equal when they read the same, wherever they come from.
impl PartialEq for Leaf<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.weight == other.weight && self.arguments().eq(other.arguments())
    }
}

impl PartialEq for Value<'_> {
    fn eq(&self, other: &Self) -> bool {
        use Value::{Closure, Float, Int, String, Triple};
        match (self, other) {
            (Float(a), Float(b)) => a == b,
            (Triple(a), Triple(b)) => a == b,
            (Int(a), Int(b)) => a == b,
            (String(a), String(b)) => a == b,
            (Closure(a), Closure(b)) => a.clone().eq(b.clone()),
            (Float(_) | Triple(_) | Int(_) | String(_) | Closure(_), _) => false,
        }
    }
}

impl<'t> Value<'t> {
    /// The leaves of a nested closure; none for anything else.
    pub fn leaves(self) -> Option<Leaves<'t>> {
        match self {
            Value::Closure(leaves) => Some(leaves),
            Value::Float(_) | Value::Triple(_) | Value::Int(_) | Value::String(_) => None,
        }
    }
}

impl From<f32> for Value<'_> {
    fn from(value: f32) -> Self {
        Value::Float(value)
    }
}

impl From<[f32; 3]> for Value<'_> {
    fn from(value: [f32; 3]) -> Self {
        Value::Triple(value)
    }
}

impl From<i32> for Value<'_> {
    fn from(value: i32) -> Self {
        Value::Int(value)
    }
}

impl<'t> From<&'t str> for Value<'t> {
    fn from(value: &'t str) -> Self {
        Value::String(value)
    }
}
