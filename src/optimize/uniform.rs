//! Finds the registers that hold the same value in every lane, and the places where some lanes may be inactive.
//!
//! A register varies when something it is computed from varies, or when it is written where only some lanes run.
//! Starting from "nothing varies", the walk is repeated until nothing changes, so loops come out right.

use crate::ir::op::Reach;
use crate::ir::program::*;

struct Walk {
    varying: Vec<bool>,
    varying_arrays: Vec<bool>,
    changed: bool,
    /// The scopes that some lanes have left by the end of each loop, in the order of the walk.
    behind: Vec<Vec<ScopeId>>,
    /// How many loops this walk has met.
    loops: usize,
}

/// Adds the scopes that are not there yet.
fn join(left: &mut Vec<ScopeId>, more: &[ScopeId]) {
    for scope in more {
        if !left.contains(scope) {
            left.push(*scope);
        }
    }
}

/// Sets the uniform flags of registers and arrays and the masked flags of moves.
pub fn mark(program: &mut Program, find_uniform: bool) {
    let inputs = program.regs.iter().map(|info| matches!(info.source, Source::Input(_)) || !find_uniform);
    let constant = |info: &RegInfo| matches!(info.source, Source::Const(_));
    let varying = inputs.zip(&program.regs).map(|(varying, info)| varying && !constant(info)).collect();
    let mut walk = Walk {
        varying,
        varying_arrays: vec![!find_uniform; program.arrays.len()],
        changed: true,
        behind: Vec::new(),
        loops: 0,
    };
    while walk.changed {
        (walk.changed, walk.loops) = (false, 0);
        walk.block(&mut program.body, false, &mut Vec::new());
    }
    for (info, &varying) in program.regs.iter_mut().zip(&walk.varying) {
        info.uniform = !varying;
    }
    for (info, &varying) in program.arrays.iter_mut().zip(&walk.varying_arrays) {
        info.uniform = !varying;
    }
}

impl Walk {
    fn varies(&self, reg: Reg) -> bool {
        self.varying[reg.0 as usize]
    }

    fn set(&mut self, reg: Reg) {
        let slot = &mut self.varying[reg.0 as usize];
        self.changed |= !*slot;
        *slot = true;
    }

    /// Walks a block. `left` collects the scopes that some, but maybe not all, lanes have left by now.
    fn block(&mut self, block: &mut Block, masked: bool, left: &mut Vec<ScopeId>) {
        for node in block {
            let masked = masked || !left.is_empty();
            match node {
                Node::Instr(instr) => self.instr(instr, masked),
                Node::If(condition, a, b) => {
                    let masked = masked || self.varies(*condition);
                    let mut left_b = left.clone();
                    self.block(a, masked, left);
                    self.block(b, masked, &mut left_b);
                    join(left, &left_b);
                }
                Node::Loop { head, condition, body, .. } => {
                    // What a round leaves behind holds for the next one. It is remembered from walk to walk, as walking
                    // a loop twice here would double the work with every level of nesting.
                    let number = self.loops;
                    self.loops += 1;
                    if self.behind.len() <= number {
                        self.behind.push(Vec::new());
                    }
                    join(left, &self.behind[number]);
                    let masked = masked || self.varies(*condition) || !left.is_empty();
                    self.block(head, masked, left);
                    self.block(body, masked || self.varies(*condition), left);
                    if left.iter().any(|scope| !self.behind[number].contains(scope)) {
                        join(&mut self.behind[number], left);
                        self.changed = true;
                    }
                }
                Node::Scope(id, body) => {
                    self.block(body, masked, left);
                    left.retain(|scope| scope != id);
                }
                // Where all lanes are active they leave together, and what follows is skipped.
                Node::Leave(scope) => {
                    if masked {
                        join(left, &[*scope]);
                    }
                }
            }
        }
    }

    fn instr(&mut self, instr: &mut Instr, in_mask: bool) {
        if let Instr::ArraySet { array, index, src, masked, .. } = instr {
            *masked = in_mask;
            if in_mask || self.varies(*index) || self.varies(*src) {
                let slot = &mut self.varying_arrays[array.0 as usize];
                self.changed |= !*slot;
                *slot = true;
            }
            return;
        }
        let mut varies = false;
        instr.reads(|reg| varies |= self.varies(reg));
        match instr {
            Instr::Move { masked, .. } => {
                *masked = in_mask;
                varies |= in_mask;
            }
            Instr::ArrayGet { array, .. } => varies |= self.varying_arrays[array.0 as usize],
            Instr::Call { routine, .. } => varies |= routine.declaration().reach == Reach::Lane,
            _ => {}
        }
        if varies {
            let mut written = Vec::new();
            instr.writes(|reg| written.push(reg));
            written.into_iter().for_each(|reg| self.set(reg));
        }
    }
}
