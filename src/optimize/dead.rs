//! Removes instructions whose results nobody reads.

use crate::ir::program::*;

/// What is needed so far.
struct Live {
    regs: Vec<bool>,
    arrays: Vec<bool>,
    changed: bool,
}

/// Removes dead instructions, and branches and loops that became empty.
pub fn remove(program: &mut Program) {
    let mut live = roots(program);
    // A branch that only computes dead values keeps its condition alive for one round, so it takes a few.
    loop {
        live.changed = true;
        while live.changed {
            live.changed = false;
            live.block(&program.body);
        }
        let before = count(&program.body);
        program.body = sweep(std::mem::take(&mut program.body), &live);
        if count(&program.body) == before {
            return;
        }
        live = roots(program);
    }
}

fn roots(program: &Program) -> Live {
    let mut live =
        Live { regs: vec![false; program.regs.len()], arrays: vec![false; program.arrays.len()], changed: false };
    program.result.iter().for_each(|&reg| live.reg(reg));
    for output in &program.outputs {
        match &output.value {
            OutputValue::Regs(regs) => regs.iter().for_each(|&reg| live.reg(reg)),
            OutputValue::Array(id) => live.arrays[id.0 as usize] = true,
        }
    }
    live
}

fn count(block: &Block) -> usize {
    let inner = |node: &Node| match node {
        Node::Instr(_) | Node::Leave(_) => 1,
        Node::If(_, a, b) => 1 + count(a) + count(b),
        Node::Loop { head, body, .. } => 1 + count(head) + count(body),
        Node::Scope(_, body) => 1 + count(body),
    };
    block.iter().map(inner).sum()
}

impl Live {
    fn reg(&mut self, reg: Reg) {
        let slot = &mut self.regs[reg.0 as usize];
        self.changed |= !*slot;
        *slot = true;
    }

    /// Marks what a block needs, last node first, so that one walk does for straight code.
    fn block(&mut self, block: &Block) {
        for node in block.iter().rev() {
            match node {
                Node::Instr(instr) => self.instr(instr),
                Node::If(condition, a, b) => {
                    self.block(a);
                    self.block(b);
                    self.reg(*condition);
                }
                Node::Loop { head, condition, body, .. } => {
                    self.block(body);
                    self.reg(*condition);
                    self.block(head);
                }
                Node::Scope(_, body) => self.block(body),
                Node::Leave(_) => {}
            }
        }
    }

    fn instr(&mut self, instr: &Instr) {
        if !self.needed(instr) {
            return;
        }
        instr.reads(|reg| self.reg(reg));
        if let Instr::ArrayGet { array, .. } = instr {
            let slot = &mut self.arrays[array.0 as usize];
            self.changed |= !*slot;
            *slot = true;
        }
    }

    fn needed(&self, instr: &Instr) -> bool {
        if let Instr::ArraySet { array, .. } = instr {
            return self.arrays[array.0 as usize];
        }
        let mut needed = instr.has_effect();
        instr.writes(|reg| needed |= self.regs[reg.0 as usize]);
        needed
    }
}

fn sweep(block: Block, live: &Live) -> Block {
    let mut out = Block::with_capacity(block.len());
    for node in block {
        match node {
            Node::Instr(instr) => {
                if live.needed(&instr) {
                    out.push(Node::Instr(instr));
                }
            }
            Node::If(condition, a, b) => {
                let (a, b) = (sweep(a, live), sweep(b, live));
                if !a.is_empty() || !b.is_empty() {
                    out.push(Node::If(condition, a, b));
                }
            }
            // A loop without effect may still run for ever, which is the user's mistake to hear of; it stays.
            Node::Loop { head, condition, body, span } => {
                out.push(Node::Loop { head: sweep(head, live), condition, body: sweep(body, live), span });
            }
            Node::Scope(id, body) => {
                let body = sweep(body, live);
                if !body.is_empty() {
                    out.push(Node::Scope(id, body));
                }
            }
            leave @ Node::Leave(_) => out.push(leave),
        }
    }
    out
}
