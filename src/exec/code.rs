//! Control flow and instructions: the loop that everything else of the machine is called from.

use super::cost;
use super::kernels as k;
use super::run::Run;
use crate::ir::op::{Binary, Pair, Unary};
use crate::ir::program::*;
use velour_grammar::Span;

/// Takes a column out, fills it from the others, puts it back.
macro_rules! fill {
    ($self:ident . $file:ident [ $dst:expr ], |$column:ident| $body:expr) => {{
        let slot = $dst.0 as usize;
        let mut $column = std::mem::take(&mut $self.regs.$file[slot]);
        $body;
        $self.regs.$file[slot] = $column;
    }};
}

impl Run<'_> {
    /// Runs a block in the active lanes.
    pub(super) fn block(&mut self, block: &Block) {
        self.budget = self.budget.saturating_sub(block.len() as u64);
        for node in block {
            match node {
                // Most instructions are of these four kinds, which cannot end a lane's way through the block.
                Node::Instr(Instr::Binary(op, d, a, b)) => {
                    self.binary(*op, *d, *a, *b);
                    continue;
                }
                Node::Instr(Instr::Fused(op, d, abc)) => {
                    self.fused(*op, *d, *abc);
                    continue;
                }
                Node::Instr(Instr::Unary(op, d, a)) => {
                    self.unary(*op, *d, *a);
                    continue;
                }
                Node::Instr(Instr::Move { dst, src, masked }) => {
                    self.assign(*dst, *src, *masked);
                    continue;
                }
                Node::Instr(instr) => self.instr(instr),
                Node::If(condition, a, b) => self.if_else(*condition, a, b),
                Node::Loop { head, condition, body, span } => self.repeat(head, *condition, body, *span),
                Node::Scope(id, body) => self.scope(*id, body),
                Node::Leave(id) => self.leave(*id),
            }
            if self.active == 0 || self.stopped {
                return;
            }
        }
    }

    fn spare(&mut self) -> Vec<i32> {
        let mut mask = self.s.spare.pop().unwrap_or_default();
        mask.resize(self.n, 0);
        mask
    }

    fn if_else(&mut self, condition: Reg, a: &Block, b: &Block) {
        if self.uniform(condition) {
            let taken = self.regs.i(condition)[0] != 0;
            return self.block(if taken { a } else { b });
        }
        let (mut yes, mut no) = (self.spare(), self.spare());
        let yes_count = k::narrow(&mut yes, &self.s.mask, self.regs.i(condition), true);
        let no_count = k::narrow(&mut no, &self.s.mask, self.regs.i(condition), false);
        let outer = std::mem::replace(&mut self.s.mask, yes);
        self.active = yes_count;
        if yes_count > 0 {
            self.block(a);
        }
        yes = std::mem::replace(&mut self.s.mask, no);
        let after_yes = self.active;
        self.active = no_count;
        if no_count > 0 {
            self.block(b);
        }
        // Lanes that left on either side stay away.
        for (m, y) in self.s.mask.iter_mut().zip(&yes) {
            *m |= y;
        }
        self.active += after_yes;
        self.s.spare.extend([outer, yes]);
    }

    fn scope(&mut self, id: ScopeId, body: &Block) {
        let slot = id.0 as usize;
        self.s.left[slot].clear();
        self.block(body);
        let left = std::mem::take(&mut self.s.left[slot]);
        if !left.is_empty() {
            for (m, l) in self.s.mask.iter_mut().zip(&left) {
                *m |= l;
            }
            self.active = self.s.mask.iter().filter(|&&m| m != 0).count();
        }
        self.s.left[slot] = left;
    }

    fn leave(&mut self, id: ScopeId) {
        let left = &mut self.s.left[id.0 as usize];
        left.resize(self.n, 0);
        for (l, m) in left.iter_mut().zip(&mut self.s.mask) {
            *l |= *m;
            *m = 0;
        }
        self.active = 0;
    }

    fn repeat(&mut self, head: &Block, condition: Reg, body: &Block, span: Span) {
        let mut done = self.spare();
        done.fill(0);
        loop {
            self.block(head);
            if self.active == 0 || self.stopped {
                break;
            }
            if self.uniform(condition) {
                if self.regs.i(condition)[0] == 0 {
                    break;
                }
            } else {
                let mut on = self.spare();
                let count = k::narrow(&mut on, &self.s.mask, self.regs.i(condition), true);
                for ((d, m), o) in done.iter_mut().zip(&self.s.mask).zip(&on) {
                    *d |= *m & !*o;
                }
                self.s.spare.push(std::mem::replace(&mut self.s.mask, on));
                self.active = count;
                if count == 0 {
                    break;
                }
            }
            self.block(body);
            if self.active == 0 || self.stopped {
                break;
            }
            self.charge(8);
            self.check_closures(span);
            self.ask_host();
            if self.budget == 0 {
                self.fatal(span, "a loop does not end: the batch has run as many instructions as it may");
                break;
            }
        }
        for (m, d) in self.s.mask.iter_mut().zip(&done) {
            *m |= d;
        }
        self.active = self.s.mask.iter().filter(|&&m| m != 0).count();
        self.s.spare.push(done);
    }

    fn unary(&mut self, op: Unary, d: Reg, a: Reg) {
        if cost::is_costly(op) {
            self.charge(self.n as u64 / cost::LANES_A_FUNCTION);
        }
        if let Ok([dst, a]) = self.regs.floats.get_disjoint_mut([d.0 as usize, a.0 as usize]) {
            k::unary(op, dst, a);
        }
    }

    fn binary(&mut self, op: Binary, d: Reg, a: Reg, b: Reg) {
        if matches!(op, Binary::Pow | Binary::Atan2 | Binary::Mod) {
            self.charge(self.n as u64 / cost::LANES_A_POWER);
        }
        let floats = &mut self.regs.floats;
        if let Ok([dst, a, b]) = floats.get_disjoint_mut([d.0 as usize, a.0 as usize, b.0 as usize]) {
            k::binary(op, dst, a, b);
        } else if let Ok([dst, a]) = floats.get_disjoint_mut([d.0 as usize, a.0 as usize]) {
            // Both operands are one register, as in a square.
            k::binary(op, dst, a, a);
        }
    }

    fn fused(&mut self, op: Pair, d: Reg, [a, b, c]: [Reg; 3]) {
        fill!(self.floats[d], |o| k::fused(op, &mut o, self.regs.f(a), self.regs.f(b), self.regs.f(c)));
    }

    fn instr(&mut self, instr: &Instr) {
        match instr {
            Instr::Unary(op, d, a) => self.unary(*op, *d, *a),
            Instr::Binary(op, d, a, b) => self.binary(*op, *d, *a, *b),
            Instr::Fused(op, d, abc) => self.fused(*op, *d, *abc),
            Instr::Compare(op, d, a, b) => {
                fill!(self.ints[d], |c| k::compare(*op, &mut c, self.regs.f(*a), self.regs.f(*b)));
            }
            Instr::Test(op, d, a) => fill!(self.ints[d], |c| k::test(*op, &mut c, self.regs.f(*a))),
            Instr::IntUnary(op, d, a) => fill!(self.ints[d], |c| k::int_unary(*op, &mut c, self.regs.i(*a))),
            Instr::IntBinary(op, d, a, b) => {
                fill!(self.ints[d], |c| k::int_binary(*op, &mut c, self.regs.i(*a), self.regs.i(*b)));
            }
            Instr::IntToFloat(d, a) => fill!(self.floats[d], |c| k::int_to_float(&mut c, self.regs.i(*a))),
            Instr::FloatToInt(d, a) => fill!(self.ints[d], |c| k::float_to_int(&mut c, self.regs.f(*a))),
            Instr::Select(d, c, a, b) => self.select(*d, *c, *a, *b),
            Instr::Move { dst, src, masked } => self.assign(*dst, *src, *masked),
            // The optimizer has replaced every derivative.
            Instr::Derivative(d, ..) => self.regs.floats[d.0 as usize].fill(0.0),
            Instr::ArrayGet { dst, array, component, index, span } => {
                self.charge(self.lanes_of(*dst) as u64 / cost::LANES_AN_ELEMENT);
                self.array_get(*dst, *array, *component, *index, *span);
            }
            Instr::ArraySet { array, component, index, src, masked, span } => {
                self.charge(self.n as u64 / cost::LANES_AN_ELEMENT);
                self.array_set(*array, *component, (*index, *src), *masked, *span);
            }
            Instr::Call { routine, dst, src, span } => self.call(routine, dst, src, *span),
            Instr::Leaf { dst, closure, params, keywords, span } => {
                self.leaf(*dst, *closure, params, keywords);
                if let Some(leaf) = self.closure(*dst) {
                    self.tree.note_site(leaf, span.first);
                }
                self.check_closures(*span);
            }
            Instr::ClosureAdd(d, a, b) => {
                let (a, b) = (self.closure(*a), self.closure(*b));
                self.regs.closures[d.0 as usize] = self.tree.add(a, b);
            }
            Instr::ClosureScale(d, a, weight) => self.scale(*d, *a, weight),
            Instr::ClosureSelect(d, c, a, b) => self.closure_select(*d, *c, *a, *b),
            Instr::ClosureAbsent(d, a) => self.closure_absent(*d, *a),
        }
    }

    fn select(&mut self, d: Reg, c: Reg, a: Reg, b: Reg) {
        match self.group.program.kind(d) {
            Kind::Float => fill!(self.floats[d], |o| k::select(&mut o, self.regs.i(c), self.regs.f(a), self.regs.f(b))),
            Kind::Int | Kind::String => {
                fill!(self.ints[d], |o| k::select_int(&mut o, self.regs.i(c), self.regs.i(a), self.regs.i(b)));
            }
            Kind::Closure => self.closure_select(d, c, a, b),
        }
    }

    fn assign(&mut self, dst: Reg, src: Reg, masked: bool) {
        let partial = masked && self.active < self.n;
        if !partial && self.group.spent(src) {
            return self.regs.floats.swap(dst.0 as usize, src.0 as usize);
        }
        match self.group.program.kind(dst) {
            Kind::Closure => self.assign_closure(dst, src, partial),
            Kind::Float => fill!(self.floats[dst], |c| {
                let src = self.regs.f(src);
                if partial {
                    k::masked_move(&mut c, &self.s.mask, src);
                } else if src.len() == 1 {
                    c.fill(src[0]);
                } else {
                    c.copy_from_slice(src);
                }
            }),
            Kind::Int | Kind::String => fill!(self.ints[dst], |c| {
                let src = self.regs.i(src);
                if partial {
                    k::masked_move_int(&mut c, &self.s.mask, src);
                } else if src.len() == 1 {
                    c.fill(src[0]);
                } else {
                    c.copy_from_slice(src);
                }
            }),
        }
    }
}
