//! Finds the registers that hold the same value in every lane, and the places where some lanes may be inactive.
//!
//! A register varies when something it is computed from varies, or when it is written where only some lanes run.
//! Starting from "nothing varies", the walk is repeated until nothing changes, so loops come out right.

use crate::ir::op::Routine;
use crate::ir::program::*;

struct Walk {
    varying: Vec<bool>,
    varying_arrays: Vec<bool>,
    changed: bool,
}

/// Sets the uniform flags of registers and arrays and the masked flags of moves.
pub fn mark(program: &mut Program, find_uniform: bool) {
    let inputs = program.regs.iter().map(|info| matches!(info.source, Source::Input(_)) || !find_uniform);
    let constant = |info: &RegInfo| matches!(info.source, Source::Const(_));
    let varying = inputs.zip(&program.regs).map(|(varying, info)| varying && !constant(info)).collect();
    let mut walk = Walk { varying, varying_arrays: vec![!find_uniform; program.arrays.len()], changed: true };
    while walk.changed {
        walk.changed = false;
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
                    left.extend(left_b);
                    left.dedup();
                }
                Node::Loop { head, condition, body, .. } => {
                    // What a round leaves behind holds for the next one, so the loop is walked with it known.
                    let mut after = left.clone();
                    let masked = masked || self.varies(*condition);
                    self.block(head, masked, &mut after);
                    self.block(body, masked, &mut after);
                    let masked = masked || self.varies(*condition) || !after.is_empty();
                    self.block(head, masked, &mut after);
                    self.block(body, masked, &mut after);
                    *left = after;
                }
                Node::Scope(id, body) => {
                    self.block(body, masked, left);
                    left.retain(|scope| scope != id);
                }
                // Where all lanes are active they leave together, and what follows is skipped.
                Node::Leave(scope) => {
                    if masked {
                        left.push(*scope);
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
            Instr::Call { routine, .. } => varies |= matches!(routine, Routine::RayType),
            _ => {}
        }
        if varies {
            let mut written = Vec::new();
            instr.writes(|reg| written.push(reg));
            written.into_iter().for_each(|reg| self.set(reg));
        }
    }
}
