//! A closure tree as text, one lane at a time, as OSL prints closures.
//!
//! The sum is written out flat, each leaf with its whole weight: `(w, w, w) * name (arguments)`, joined by `\n\t+ `. A
//! nested closure stands in its argument's place, in the same notation.
//!
//! A tree shares what is used twice, so that a loop which adds a closure to itself has exponentially many terms in its text.
//! After [`MOST_TERMS`] terms each sum ends with how many more there are.

use super::tree::{Node, NodeId, Param, Tree};
use crate::lang::closures::ClosureTable;
use crate::ops::format::{FormatArg, format};
use std::fmt::Write;

/// The text of a whole tree in one lane; empty for no closure.
pub fn tree_text(table: &ClosureTable, tree: &Tree, lane: usize) -> String {
    closure_text(table, tree, tree.root, lane, |_| false)
}

/// So many terms are written, nested ones included.
pub const MOST_TERMS: usize = 256;

/// The keyword that names a leaf for a renderer's outputs.
const LABEL: &str = "label";

/// What is left to write, last one first.
enum Task {
    /// The sum under a node, with the weight above it.
    Sum(Option<NodeId>, [f32; 3]),
    /// A nested sum in its own place.
    Nested(Option<NodeId>),
    /// The end of a nested sum.
    End,
    /// Text as it is.
    Text(String),
}

/// A sum that is being written.
#[derive(Default)]
struct OpenSum {
    /// Does it have a term already?
    started: bool,
    /// How many terms were left out.
    more: u64,
}

impl OpenSum {
    fn plus(&mut self) -> &'static str {
        if std::mem::replace(&mut self.started, true) { "\n\t+ " } else { "" }
    }

    /// Writes what stands for the terms that were left out.
    fn close(mut self, out: &mut String) {
        if self.more > 0 {
            let _ = write!(out, "{}... and {} more", self.plus(), self.more);
        }
    }
}

/// How many terms the sum under each node up to `root` has in one lane.
fn terms(tree: &Tree, root: Option<NodeId>, lane: usize) -> Vec<u64> {
    let mut terms: Vec<u64> = Vec::new();
    for node in tree.nodes.iter().take(root.map_or(0, |root| root.0 as usize + 1)) {
        let of = |child: NodeId| terms.get(child.0 as usize).copied().unwrap_or(0);
        terms.push(match *node {
            Node::Add(a, b) => of(a).saturating_add(of(b)),
            Node::Scale { weight, child } => {
                // A closure times zero is no closure.
                if weight.iter().all(|w| tree.float(*w, lane) == 0.0) { 0 } else { of(child) }
            }
            Node::Select { mask, then, otherwise } => {
                if tree.int(mask, lane) != 0 { then } else { otherwise }.map_or(0, of)
            }
            Node::Leaf { .. } => 1,
        });
    }
    terms
}

/// The text of one closure in one lane. Closures that are `labelled`, by name, have their label written even where none is given.
pub fn closure_text(
    table: &ClosureTable,
    tree: &Tree,
    root: Option<NodeId>,
    lane: usize,
    labelled: impl Fn(&str) -> bool,
) -> String {
    let terms = terms(tree, root, lane);
    let mut out = String::new();
    let mut written = 0;
    let mut open = vec![OpenSum::default()];
    let mut tasks = vec![Task::Sum(root, [1.0; 3])];
    while let Some(task) = tasks.pop() {
        match task {
            Task::Text(text) => out.push_str(&text),
            Task::Nested(child) => {
                open.push(OpenSum::default());
                tasks.extend([Task::End, Task::Sum(child, [1.0; 3])]);
            }
            Task::End => {
                let sum = open.pop().unwrap_or_default();
                if !sum.started && sum.more == 0 {
                    out.push('0');
                }
                sum.close(&mut out);
            }
            Task::Sum(None, _) => {}
            Task::Sum(Some(node), _) if terms[node.0 as usize] == 0 => {}
            Task::Sum(Some(node), _) if written >= MOST_TERMS => {
                let sum = open.last_mut();
                sum.into_iter().for_each(|sum| sum.more = sum.more.saturating_add(terms[node.0 as usize]));
            }
            Task::Sum(Some(node), weight) => match tree.nodes[node.0 as usize] {
                Node::Add(a, b) => tasks.extend([Task::Sum(Some(b), weight), Task::Sum(Some(a), weight)]),
                Node::Scale { weight: w, child } => {
                    let product = std::array::from_fn(|c| weight[c] * tree.float(w[c], lane));
                    tasks.push(Task::Sum(Some(child), product));
                }
                Node::Select { mask, then, otherwise } => {
                    let taken = if tree.int(mask, lane) != 0 { then } else { otherwise };
                    tasks.push(Task::Sum(taken, weight));
                }
                leaf @ Node::Leaf { .. } => {
                    written += 1;
                    open.last_mut().into_iter().for_each(|sum| out.push_str(sum.plus()));
                    let [r, g, b] = weight.map(number);
                    let _ = write!(out, "({r}, {g}, {b}) * ");
                    leaf_tasks(table, tree, leaf, lane, &labelled, &mut tasks);
                }
            },
        }
    }
    open.pop().unwrap_or_default().close(&mut out);
    out
}

/// Queues the name and the arguments of a leaf.
fn leaf_tasks(
    table: &ClosureTable,
    tree: &Tree,
    leaf: Node,
    lane: usize,
    labelled: &dyn Fn(&str) -> bool,
    tasks: &mut Vec<Task>,
) {
    let Node::Leaf { closure, first_param, param_count, first_keyword, keyword_count } = leaf else { return };
    let spec = table.get(closure);
    let params = &tree.params[first_param as usize..(first_param + param_count) as usize];
    let keywords = &tree.keywords[first_keyword as usize..(first_keyword + keyword_count) as usize];
    let mut parts = vec![Task::Text(format!("{} (", spec.name))];
    let comma = |parts: &mut Vec<Task>| {
        if parts.len() > 1 {
            parts.push(Task::Text(", ".to_owned()));
        }
    };
    for param in params {
        comma(&mut parts);
        parts.push(argument(tree, *param, lane));
    }
    for (at, param) in keywords {
        comma(&mut parts);
        parts.push(Task::Text(format!("{:?}, ", spec.keywords[*at as usize].name)));
        parts.push(argument(tree, *param, lane));
    }
    let labels = keywords.iter().any(|(at, _)| spec.keywords[*at as usize].name == LABEL);
    if labelled(spec.name) && !labels {
        comma(&mut parts);
        parts.push(Task::Text(format!("{LABEL:?}, \"\"")));
    }
    parts.push(Task::Text(")".to_owned()));
    tasks.extend(parts.into_iter().rev());
}

fn argument(tree: &Tree, param: Param, lane: usize) -> Task {
    match param {
        Param::Closure(child) => Task::Nested(child),
        other => Task::Text(value(tree, other, lane)),
    }
}

/// A number as OSL's `%g` writes it.
fn number(x: f32) -> String {
    format("%g", &[FormatArg::Float(&[x])]).unwrap_or_default()
}

/// A parameter that is not a closure.
fn value(tree: &Tree, param: Param, lane: usize) -> String {
    match param {
        Param::Float(column) => number(tree.float(column, lane)),
        Param::Triple(columns) => {
            let [x, y, z] = columns.map(|column| number(tree.float(column, lane)));
            format!("({x}, {y}, {z})")
        }
        Param::Int(column) => tree.int(column, lane).to_string(),
        Param::String(column) => format!("{:?}", tree.text(column, lane)),
        Param::Closure(_) => String::new(),
    }
}
