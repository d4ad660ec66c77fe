//! A closure tree as text, one lane at a time, as OSL prints closures.
//!
//! The sum is written out flat, each leaf with its whole weight: `(w, w, w) * name (arguments)`, joined by `\n\t+ `. A
//! nested closure stands in its argument's place, in the same notation.

use super::tree::{Node, NodeId, Param, Tree};
use crate::lang::closures::ClosureTable;
use crate::ops::format::{FormatArg, format};
use std::fmt::Write;

/// The text of a whole tree in one lane; empty for no closure.
pub fn tree_text(table: &ClosureTable, tree: &Tree, lane: usize) -> String {
    closure_text(table, tree, tree.root, lane)
}

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

/// The text of one closure in one lane.
pub fn closure_text(table: &ClosureTable, tree: &Tree, root: Option<NodeId>, lane: usize) -> String {
    let mut out = String::new();
    // True while the sum being written has a term already, one entry an open sum.
    let mut started = vec![false];
    let mut tasks = vec![Task::Sum(root, [1.0; 3])];
    while let Some(task) = tasks.pop() {
        match task {
            Task::Text(text) => out.push_str(&text),
            Task::Nested(child) => {
                started.push(false);
                tasks.extend([Task::End, Task::Sum(child, [1.0; 3])]);
            }
            Task::End => {
                if started.pop() == Some(false) {
                    out.push('0');
                }
            }
            Task::Sum(None, _) => {}
            Task::Sum(Some(node), weight) => match tree.nodes[node.0 as usize] {
                Node::Add(a, b) => tasks.extend([Task::Sum(Some(b), weight), Task::Sum(Some(a), weight)]),
                Node::Scale { weight: w, child } => {
                    let own = w.map(|w| tree.float(w, lane));
                    let product = std::array::from_fn(|c| weight[c] * own[c]);
                    // A closure times zero is no closure.
                    if own == [0.0; 3] {
                        continue;
                    }
                    tasks.push(Task::Sum(Some(child), product));
                }
                Node::Select { mask, then, otherwise } => {
                    let taken = if tree.int(mask, lane) != 0 { then } else { otherwise };
                    tasks.push(Task::Sum(taken, weight));
                }
                leaf @ Node::Leaf { .. } => {
                    if let Some(open) = started.last_mut() {
                        out.push_str(if *open { "\n\t+ " } else { "" });
                        *open = true;
                    }
                    let [r, g, b] = weight.map(number);
                    let _ = write!(out, "({r}, {g}, {b}) * ");
                    leaf_tasks(table, tree, leaf, lane, &mut tasks);
                }
            },
        }
    }
    out
}

/// Queues the name and the arguments of a leaf.
fn leaf_tasks(table: &ClosureTable, tree: &Tree, leaf: Node, lane: usize, tasks: &mut Vec<Task>) {
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
