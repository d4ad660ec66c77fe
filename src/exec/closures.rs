//! Closures: building the tree of the batch.

use super::run::Run;
use crate::closure::tree::{Floats, Ints, Node, NodeId, Param};
use crate::ir::program::*;
use crate::lang::closures::{ClosureId, ParamKind};
use crate::limits::{CLOSURE_NODES, CLOSURE_NUMBERS};
use velour_grammar::Span;

impl Run<'_> {
    /// Gives the batch up when its closures take too much memory.
    pub(super) fn check_closures(&mut self, span: Span) {
        if self.tree.nodes.len() > CLOSURE_NODES {
            self.fatal(span, &format!("a batch has more than {CLOSURE_NODES} closures, sums and products of them"));
        } else if self.tree.floats.len() + self.tree.ints.len() > CLOSURE_NUMBERS {
            self.fatal(span, &format!("the closures of a batch have more than {CLOSURE_NUMBERS} numbers together"));
        }
    }

    fn floats(&mut self, reg: Reg) -> Floats {
        let column = &self.regs.floats[reg.0 as usize];
        if self.group.program.regs[reg.0 as usize].uniform {
            return Floats::Uniform(column[0]);
        }
        // An input never changes within a batch, so closures that share `N` share its column, and say so by doing it.
        let input = matches!(self.group.program.regs[reg.0 as usize].source, Source::Input(_));
        if let Some(&(_, at)) = self.s.shared.iter().find(|entry| input && entry.0 == reg) {
            return Floats::Varying(at);
        }
        let stored = self.tree.varying(column);
        if let (true, Floats::Varying(at)) = (input, stored) {
            self.s.shared.push((reg, at));
        }
        stored
    }

    fn ints(&mut self, reg: Reg) -> Ints {
        let column = &self.regs.ints[reg.0 as usize];
        if self.group.program.regs[reg.0 as usize].uniform {
            return Ints::Uniform(column[0]);
        }
        self.tree.varying_ints(column)
    }

    /// The parameter of a kind that starts at the front of `regs`, which it takes off.
    fn param(&mut self, kind: ParamKind, regs: &mut &[Reg]) -> Param {
        let width = match kind {
            ParamKind::Color | ParamKind::Vector | ParamKind::Normal => 3,
            ParamKind::Float | ParamKind::Int | ParamKind::String | ParamKind::Closure => 1,
        };
        let (own, rest) = regs.split_at(width);
        *regs = rest;
        match kind {
            ParamKind::Float => Param::Float(self.floats(own[0])),
            ParamKind::Int => Param::Int(self.ints(own[0])),
            ParamKind::String => Param::String(self.ints(own[0])),
            ParamKind::Closure => Param::Closure(self.closure(own[0])),
            ParamKind::Color | ParamKind::Vector | ParamKind::Normal => {
                Param::Triple([self.floats(own[0]), self.floats(own[1]), self.floats(own[2])])
            }
        }
    }

    pub(super) fn leaf(&mut self, dst: Reg, closure: ClosureId, params: &[Reg], keywords: &[(u32, Vec<Reg>)]) {
        let group = self.group;
        let spec = group.library.get(closure);
        let mut rest = params;
        self.s.params.clear();
        self.s.keywords.clear();
        for param in &spec.params {
            let value = self.param(param.kind, &mut rest);
            self.s.params.push(value);
        }
        for (at, regs) in keywords {
            let mut regs = regs.as_slice();
            let value = self.param(spec.keywords[*at as usize].kind, &mut regs);
            self.s.keywords.push((*at, value));
        }
        self.regs.closures[dst.0 as usize] = Some(self.tree.leaf(closure, &self.s.params, &self.s.keywords));
    }

    pub(super) fn scale(&mut self, dst: Reg, a: Reg, weight: &[Reg; 3]) {
        let child = self.closure(a);
        // A missing closure needs no weight.
        let scaled = child.and_then(|child| {
            let weight = weight.map(|reg| self.floats(reg));
            self.tree.scale(Some(child), weight)
        });
        self.regs.closures[dst.0 as usize] = scaled;
    }

    /// `a` where the mask is set, `b` elsewhere.
    pub(super) fn choose_closure(&mut self, mask: &[i32], a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
        if a == b {
            return a;
        }
        let mask = self.tree.varying_ints(mask);
        Some(self.tree.push(Node::Select { mask, then: a, otherwise: b }))
    }

    pub(super) fn assign_closure(&mut self, dst: Reg, src: Reg, partial: bool) {
        let new = self.closure(src);
        let old = self.closure(dst);
        let value = if partial {
            let mask = std::mem::take(&mut self.s.mask);
            let value = self.choose_closure(&mask, new, old);
            self.s.mask = mask;
            value
        } else {
            new
        };
        self.regs.closures[dst.0 as usize] = value;
    }

    pub(super) fn closure_absent(&mut self, dst: Reg, a: Reg) {
        let root = self.closure(a);
        for lane in 0..self.lanes_of(dst) {
            self.regs.ints[dst.0 as usize][lane] = !self.tree.present(root, lane) as i32;
        }
    }

    pub(super) fn closure_select(&mut self, dst: Reg, c: Reg, a: Reg, b: Reg) {
        let (a, b) = (self.closure(a), self.closure(b));
        let column = self.regs.i(c);
        let value = if column.len() == 1 {
            if column[0] != 0 { a } else { b }
        } else {
            let mask = column.to_vec();
            self.choose_closure(&mask, a, b)
        };
        self.regs.closures[dst.0 as usize] = value;
    }
}
