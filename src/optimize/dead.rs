//! Removes instructions whose results nobody reads.
//!
//! What is needed is found by demand: from the results and the effects back to what they are computed from, and out to the
//! branches they stand in.

use super::flow::Flow;
use crate::ir::program::*;

/// What is needed so far.
struct Live<'p> {
    flow: Flow<'p>,
    regs: Vec<bool>,
    arrays: Vec<bool>,
    nodes: Vec<bool>,
    /// Needed nodes whose own needs have not been looked at.
    open: Vec<usize>,
}

/// Removes dead instructions, and branches that are empty without them.
pub fn remove(program: &mut Program) {
    let needed = needed(program);
    program.body = sweep(std::mem::take(&mut program.body), &needed, &mut 0);
}

/// Which nodes are needed, in the order of the text.
fn needed(program: &Program) -> Vec<bool> {
    let flow = Flow::of(program);
    let nodes = vec![false; flow.nodes.len()];
    let (regs, arrays) = (vec![false; program.regs.len()], vec![false; program.arrays.len()]);
    let mut live = Live { flow, regs, arrays, nodes, open: Vec::new() };
    live.roots(program);
    while let Some(node) = live.open.pop() {
        live.needs_of(node);
    }
    live.nodes
}

/// Is an index known to be inside an array?
fn inside(program: &Program, index: Reg, array: ArrayId) -> bool {
    match program.regs[index.0 as usize].source {
        Source::Const(Const::Int(at)) => (0..i64::from(program.arrays[array.0 as usize].len)).contains(&i64::from(at)),
        Source::Const(_) | Source::Input(_) | Source::Code => false,
    }
}

impl Live<'_> {
    fn roots(&mut self, program: &Program) {
        program.result.iter().for_each(|&reg| self.reg(reg));
        for output in &program.outputs {
            match &output.value {
                OutputValue::Regs(regs) => regs.iter().for_each(|&reg| self.reg(reg)),
                OutputValue::Array(id) => self.array(*id),
            }
        }
        for node in 0..self.flow.nodes.len() {
            let root = match self.flow.nodes[node].node {
                // An index that may be outside is a mistake to hear of, whether or not the array is read.
                Node::Instr(Instr::ArraySet { array, index, .. }) => !inside(program, *index, *array),
                Node::Instr(instr) => instr.has_effect(),
                // A loop without effect may still run for ever, which is the user's mistake to hear of; it stays.
                Node::Loop { .. } | Node::Leave(_) => true,
                Node::If(..) | Node::Scope(..) => false,
            };
            if root {
                self.node(node);
            }
        }
    }

    fn node(&mut self, node: usize) {
        if !std::mem::replace(&mut self.nodes[node], true) {
            self.open.push(node);
        }
    }

    fn reg(&mut self, reg: Reg) {
        if !std::mem::replace(&mut self.regs[reg.0 as usize], true) {
            for writer in self.flow.writers.of(reg.0).collect::<Vec<_>>() {
                self.node(writer);
            }
        }
    }

    fn array(&mut self, array: ArrayId) {
        if !std::mem::replace(&mut self.arrays[array.0 as usize], true) {
            for setter in self.flow.setters.of(array.0).collect::<Vec<_>>() {
                self.node(setter);
            }
        }
    }

    fn needs_of(&mut self, node: usize) {
        match self.flow.nodes[node].node {
            Node::Instr(instr) => {
                instr.reads(|reg| self.reg(reg));
                if let Instr::ArrayGet { array, .. } = instr {
                    self.array(*array);
                }
            }
            Node::If(condition, ..) | Node::Loop { condition, .. } => self.reg(*condition),
            Node::Scope(..) | Node::Leave(_) => {}
        }
        if let Some(owner) = self.flow.owner(node) {
            self.node(owner);
        }
    }
}

/// Keeps the needed nodes; `next` is the number of the first node of the block.
fn sweep(block: Block, needed: &[bool], next: &mut usize) -> Block {
    let mut out = Block::with_capacity(block.len());
    for node in block {
        let keep = needed[*next];
        *next += 1;
        let node = match node {
            Node::If(condition, a, b) => {
                let a = sweep(a, needed, next);
                Node::If(condition, a, sweep(b, needed, next))
            }
            Node::Loop { head, condition, body, span } => {
                let head = sweep(head, needed, next);
                Node::Loop { head, condition, body: sweep(body, needed, next), span }
            }
            Node::Scope(id, body) => Node::Scope(id, sweep(body, needed, next)),
            Node::Instr(_) | Node::Leave(_) => node,
        };
        if keep {
            out.push(node);
        }
    }
    out
}
