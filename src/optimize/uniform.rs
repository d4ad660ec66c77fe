//! Finds the registers that hold the same value in every lane, and the places where some lanes may be inactive.
//!
//! A register varies when something it is computed from varies, or when it is written where only some lanes run. Starting
//! from "nothing varies", each register that turns out to vary is carried to its readers, each condition to what stands
//! under it, and each way out of a scope to what follows.

use super::flow::Flow;
use crate::ir::op::Reach;
use crate::ir::program::*;

struct Walk<'p> {
    flow: Flow<'p>,
    varying: Vec<bool>,
    varying_arrays: Vec<bool>,
    /// Nodes that may run while some lanes are inactive.
    masked: Vec<bool>,
    /// From which node on each block is masked.
    masked_from: Vec<usize>,
    /// Registers found to vary whose readers have not heard of it.
    open: Vec<Reg>,
}

/// Sets the uniform flags of registers and arrays and the masked flags of moves.
pub fn mark(program: &mut Program, find_uniform: bool) {
    let flow = Flow::of(program);
    let mut walk = Walk {
        varying: vec![false; program.regs.len()],
        varying_arrays: vec![false; program.arrays.len()],
        masked: vec![false; flow.nodes.len()],
        masked_from: flow.blocks.iter().map(|block| block.nodes.len()).collect(),
        open: Vec::new(),
        flow,
    };
    walk.begin(program, find_uniform);
    while let Some(reg) = walk.open.pop() {
        for reader in walk.flow.readers.of(reg.0).collect::<Vec<_>>() {
            walk.reads_varying(reader);
        }
    }
    let Walk { varying, varying_arrays, masked, .. } = walk;
    for (info, varying) in program.regs.iter_mut().zip(varying) {
        info.uniform = !varying;
    }
    for (info, varying) in program.arrays.iter_mut().zip(varying_arrays) {
        info.uniform = !varying;
    }
    set_masked(&mut program.body, &masked, &mut 0);
}

impl Walk<'_> {
    /// What varies to begin with: inputs and what depends on the lane itself, or everything.
    fn begin(&mut self, program: &Program, find_uniform: bool) {
        for (at, info) in program.regs.iter().enumerate() {
            let varies = match info.source {
                Source::Input(_) => true,
                Source::Code => !find_uniform,
                Source::Const(_) => false,
            };
            if varies {
                self.set(Reg(at as u32));
            }
        }
        if !find_uniform {
            (0..program.arrays.len()).for_each(|at| self.set_array(ArrayId(at as u32)));
        }
        for node in 0..self.flow.nodes.len() {
            if let Node::Instr(instr @ Instr::Call { routine, .. }) = self.flow.nodes[node].node
                && routine.declaration().reach == Reach::Lane
            {
                self.set_written(instr);
            }
        }
    }

    fn set(&mut self, reg: Reg) {
        if !std::mem::replace(&mut self.varying[reg.0 as usize], true) {
            self.open.push(reg);
        }
    }

    fn set_written(&mut self, instr: &Instr) {
        instr.writes(|reg| self.set(reg));
    }

    fn set_array(&mut self, array: ArrayId) {
        if std::mem::replace(&mut self.varying_arrays[array.0 as usize], true) {
            return;
        }
        for getter in self.flow.getters.of(array.0).collect::<Vec<_>>() {
            if let Node::Instr(instr) = self.flow.nodes[getter].node {
                self.set_written(instr);
            }
        }
    }

    /// A node reads a register that varies.
    fn reads_varying(&mut self, node: usize) {
        match self.flow.nodes[node].node {
            Node::Instr(Instr::ArraySet { array, .. }) => self.set_array(*array),
            Node::Instr(instr) => self.set_written(instr),
            Node::If(..) | Node::Loop { .. } => self.mask_inside(node),
            Node::Scope(..) | Node::Leave(_) => {}
        }
    }

    fn mask_inside(&mut self, node: usize) {
        for block in self.flow.nodes[node].inside.into_iter().flatten() {
            self.mask_from(block, 0);
        }
    }

    /// Some lanes may be inactive in a block from one of its nodes on.
    fn mask_from(&mut self, block: usize, from: usize) {
        let end = self.masked_from[block];
        self.masked_from[block] = end.min(from);
        for at in from..end {
            self.mask(self.flow.blocks[block].nodes[at]);
        }
    }

    fn mask(&mut self, node: usize) {
        if std::mem::replace(&mut self.masked[node], true) {
            return;
        }
        match self.flow.nodes[node].node {
            Node::Instr(Instr::Move { dst, .. }) => self.set(*dst),
            Node::Instr(Instr::ArraySet { array, .. }) => self.set_array(*array),
            Node::Instr(_) => {}
            Node::If(..) | Node::Loop { .. } | Node::Scope(..) => self.mask_inside(node),
            // Where all lanes are active they leave together, and what follows is skipped.
            Node::Leave(scope) => self.leave(node, *scope),
        }
    }

    /// Some lanes leave a scope: what follows up to its end runs without them, and so does the next round of a loop.
    fn leave(&mut self, node: usize, scope: ScopeId) {
        let mut at = node;
        loop {
            let (block, after) = (self.flow.nodes[at].block, self.flow.nodes[at].at + 1);
            self.mask_from(block, after);
            let Some(owner) = self.flow.blocks[block].owner else { return };
            match self.flow.nodes[owner].node {
                Node::Scope(id, _) if *id == scope => return,
                Node::Loop { .. } => self.mask(owner),
                Node::Instr(_) | Node::If(..) | Node::Scope(..) | Node::Leave(_) => {}
            }
            at = owner;
        }
    }
}

/// Writes the masked flags of moves and stores, in the order of the text.
fn set_masked(block: &mut Block, flags: &[bool], next: &mut usize) {
    for node in block {
        let flag = flags[*next];
        *next += 1;
        match node {
            Node::Instr(Instr::Move { masked, .. } | Instr::ArraySet { masked, .. }) => *masked = flag,
            Node::Instr(_) | Node::Leave(_) => {}
            Node::If(_, a, b) => [a, b].into_iter().for_each(|block| set_masked(block, flags, next)),
            Node::Loop { head, body, .. } => [head, body].into_iter().for_each(|block| set_masked(block, flags, next)),
            Node::Scope(_, body) => set_masked(body, flags, next),
        }
    }
}
