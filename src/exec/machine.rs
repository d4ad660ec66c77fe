//! The machine: runs a program over a batch of points. One machine a thread; it keeps its scratch between batches.

use super::group::Group;
use super::host::{Host, Report};
use super::kernels as k;
use super::points::Points;
use crate::closure::tree::{NodeId, Tree};
use crate::ir::program::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Instructions that one batch may run before its shader counts as endless.
pub const DEFAULT_BUDGET: u64 = 20_000_000;

/// Runs shader groups over batches of points.
pub struct Machine {
    files: HashMap<u64, Registers>,
    tree: Tree,
    host: Arc<Host>,
    reports: Vec<Report>,
    scratch: Scratch,
    /// Instructions a batch may run.
    pub budget: u64,
}

/// The registers of one group.
#[derive(Default)]
pub(super) struct Registers {
    pub floats: Vec<Vec<f32>>,
    pub ints: Vec<Vec<i32>>,
    pub closures: Vec<Option<NodeId>>,
    pub float_arrays: Vec<Vec<f32>>,
    pub int_arrays: Vec<Vec<i32>>,
    pub closure_arrays: Vec<Vec<Option<NodeId>>>,
    /// Lanes that each register file has room for.
    lanes: usize,
}

/// Memory that is used anew by every batch, so that a warm machine allocates nothing.
#[derive(Default)]
pub(super) struct Scratch {
    pub mask: Vec<i32>,
    left: Vec<Vec<i32>>,
    spare: Vec<Vec<i32>>,
    /// What each lane has printed so far.
    pub texts: Vec<Vec<Report>>,
    /// Mistakes that have been reported in this batch.
    pub said: Vec<String>,
    /// Offsets of input columns in the tree, once a closure has used them.
    pub shared: Vec<(Reg, u32)>,
    /// The parameters of the leaf that is being built.
    pub params: Vec<crate::closure::tree::Param>,
    /// Its keyword parameters.
    pub keywords: Vec<crate::closure::tree::Keyword>,
    /// Results of a routine in one lane.
    pub ints: Vec<i32>,
    /// Columns that a noise writes.
    pub columns: Vec<Vec<f32>>,
}

/// One batch under way.
pub(super) struct Run<'a> {
    pub group: &'a Group,
    pub points: &'a Points,
    pub regs: &'a mut Registers,
    pub tree: &'a mut Tree,
    pub host: &'a Host,
    pub reports: &'a mut Vec<Report>,
    pub s: Scratch,
    pub n: usize,
    pub active: usize,
    budget: u64,
    /// True once the batch has been given up.
    stopped: bool,
}

impl Default for Machine {
    fn default() -> Self {
        Self::new()
    }
}

impl Machine {
    /// A machine with an empty host: no named spaces and no attributes.
    pub fn new() -> Self {
        Self::with_host(Arc::new(Host::default()))
    }

    /// A machine whose shaders see the spaces and attributes of a host.
    pub fn with_host(host: Arc<Host>) -> Self {
        let (files, tree, reports) = (HashMap::new(), Tree::default(), Vec::new());
        Machine { files, tree, host, reports, scratch: Scratch::default(), budget: DEFAULT_BUDGET }
    }

    /// Runs a group over points and gives the closure tree of the batch. Further results stay readable through
    /// [`Machine::float`] until the next batch.
    pub fn shade(&mut self, group: &Group, points: &Points) -> &Tree {
        let n = points.len;
        if n == 0 {
            self.tree.clear(0);
            return &self.tree;
        }
        let regs = self.files.entry(group.id).or_default();
        regs.prepare(group, n);
        regs.forget_closures();
        self.tree.clear(n);
        for &(reg, input) in group.inputs() {
            regs.load(reg, input, points);
        }
        let mut run = Run {
            group,
            points,
            regs,
            tree: &mut self.tree,
            host: &self.host,
            reports: &mut self.reports,
            s: std::mem::take(&mut self.scratch),
            n,
            active: n,
            budget: self.budget,
            stopped: false,
        };
        run.s.begin(n, group.program.scopes as usize);
        run.block(&group.program.body);
        run.flush();
        self.scratch = run.s;
        self.tree.root = group.program.result.and_then(|reg| regs.closures[reg.0 as usize]);
        &self.tree
    }

    /// What shaders printed and what went wrong since the last call.
    pub fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    /// The float columns of an output of the last batch of a group: `(column, lane stride is 0 for a uniform one)`.
    pub fn float(&self, group: &Group, reg: Reg, lane: usize) -> f32 {
        let column = self.files.get(&group.id).and_then(|regs| regs.floats.get(reg.0 as usize));
        column.and_then(|column| column.get(lane).or(column.first()).copied()).unwrap_or(0.0)
    }

    /// The int (or symbol) of one lane of a register after the last batch of a group.
    pub fn int(&self, group: &Group, reg: Reg, lane: usize) -> i32 {
        let column = self.files.get(&group.id).and_then(|regs| regs.ints.get(reg.0 as usize));
        column.and_then(|column| column.get(lane).or(column.first()).copied()).unwrap_or(0)
    }

    /// One number of an array after the last batch: float arrays as they are, ints and symbols as whole numbers.
    pub fn array_number(&self, group: &Group, array: ArrayId, number: usize, lane: usize) -> f64 {
        let info = &group.program.arrays[array.0 as usize];
        let Some(regs) = self.files.get(&group.id) else { return 0.0 };
        let lanes = if info.uniform { 1 } else { regs.lanes };
        let at = number * lanes + lane.min(lanes - 1);
        match info.kind {
            Kind::Float => regs.float_arrays[array.0 as usize].get(at).map_or(0.0, |&x| x as f64),
            _ => regs.int_arrays[array.0 as usize].get(at).map_or(0.0, |&x| x as f64),
        }
    }
}

impl Scratch {
    fn begin(&mut self, n: usize, scopes: usize) {
        self.mask.clear();
        self.mask.resize(n, 1);
        self.left.resize_with(scopes.max(self.left.len()), Vec::new);
        self.said.clear();
        self.shared.clear();
    }
}

impl Registers {
    /// Drops the closures of the batch before: their nodes are gone with its tree.
    fn forget_closures(&mut self) {
        self.closures.fill(None);
        self.closure_arrays.iter_mut().for_each(|array| array.fill(None));
    }

    /// Makes room for a batch and sets the constants; costs nothing when the width stays the same.
    fn prepare(&mut self, group: &Group, n: usize) {
        let program = &*group.program;
        let count = program.regs.len();
        if self.floats.len() == count && self.lanes == n {
            return;
        }
        self.floats.resize(count, Vec::new());
        self.ints.resize(count, Vec::new());
        self.closures.resize(count, None);
        self.lanes = n;
        for (at, info) in program.regs.iter().enumerate() {
            let lanes = if info.uniform { 1 } else { n };
            match info.kind {
                Kind::Float => self.floats[at].resize(lanes, 0.0),
                Kind::Int | Kind::String => self.ints[at].resize(lanes, 0),
                Kind::Closure => {}
            }
            match info.source {
                Source::Const(Const::Float(value)) => self.floats[at].fill(value),
                Source::Const(Const::Int(value) | Const::String(value)) => self.ints[at].fill(value),
                _ => {}
            }
        }
        let arrays = program.arrays.len();
        self.float_arrays.resize(arrays, Vec::new());
        self.int_arrays.resize(arrays, Vec::new());
        self.closure_arrays.resize(arrays, Vec::new());
        for (at, info) in program.arrays.iter().enumerate() {
            let size = (info.len * info.components) as usize;
            let lanes = if info.uniform { 1 } else { n };
            match info.kind {
                Kind::Float => self.float_arrays[at].resize(size * lanes, 0.0),
                Kind::Int | Kind::String => self.int_arrays[at].resize(size * lanes, 0),
                Kind::Closure => self.closure_arrays[at].resize(size, None),
            }
        }
    }

    fn load(&mut self, reg: Reg, input: crate::ir::op::Input, points: &Points) {
        let n = points.len;
        if input == crate::ir::op::Input::Backfacing {
            self.ints[reg.0 as usize][..n].copy_from_slice(&points.backfacing[..n]);
            return;
        }
        let column = &mut self.floats[reg.0 as usize];
        match points.column(input) {
            Some(values) => column[..n].copy_from_slice(&values[..n]),
            None => column.fill(0.0),
        }
    }

    pub fn f(&self, reg: Reg) -> &[f32] {
        &self.floats[reg.0 as usize]
    }

    pub fn i(&self, reg: Reg) -> &[i32] {
        &self.ints[reg.0 as usize]
    }
}

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
    fn block(&mut self, block: &Block) {
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

    fn uniform(&self, reg: Reg) -> bool {
        self.group.program.regs[reg.0 as usize].uniform
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

    fn repeat(&mut self, head: &Block, condition: Reg, body: &Block, span: velour_grammar::Span) {
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
            if !self.spend(8) {
                self.fatal(span, "a loop does not end");
                break;
            }
        }
        for (m, d) in self.s.mask.iter_mut().zip(&done) {
            *m |= d;
        }
        self.active = self.s.mask.iter().filter(|&&m| m != 0).count();
        self.s.spare.push(done);
    }

    /// Takes from the budget; false when it is used up.
    fn spend(&mut self, cost: u64) -> bool {
        self.budget = self.budget.saturating_sub(cost);
        self.budget > 0
    }

    fn fatal(&mut self, span: velour_grammar::Span, what: &str) {
        let place = (self.group.locate)(span);
        let message = format!("{place}: error: {what}: the batch has run as many instructions as it may");
        self.reports.push(Report::Fatal(message));
        self.stopped = true;
    }

    fn unary(&mut self, op: crate::ir::op::Unary, d: Reg, a: Reg) {
        if let Ok([dst, a]) = self.regs.floats.get_disjoint_mut([d.0 as usize, a.0 as usize]) {
            k::unary(op, dst, a);
        }
    }

    fn binary(&mut self, op: crate::ir::op::Binary, d: Reg, a: Reg, b: Reg) {
        let floats = &mut self.regs.floats;
        if let Ok([dst, a, b]) = floats.get_disjoint_mut([d.0 as usize, a.0 as usize, b.0 as usize]) {
            k::binary(op, dst, a, b);
        } else if let Ok([dst, a]) = floats.get_disjoint_mut([d.0 as usize, a.0 as usize]) {
            // Both operands are one register, as in a square.
            k::binary(op, dst, a, a);
        }
    }

    fn fused(&mut self, op: crate::ir::op::Pair, d: Reg, [a, b, c]: [Reg; 3]) {
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
                self.array_get(*dst, *array, *component, *index, *span);
            }
            Instr::ArraySet { array, component, index, src, masked, span } => {
                self.array_set(*array, *component, (*index, *src), *masked, *span);
            }
            Instr::Call { routine, dst, src, span } => self.call(routine, dst, src, *span),
            Instr::Leaf { dst, closure, params, keywords, span } => {
                self.leaf(*dst, *closure, params, keywords);
                if let Some(leaf) = self.closure(*dst) {
                    self.tree.note_site(leaf, span.first);
                }
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

    pub(super) fn closure(&self, reg: Reg) -> Option<NodeId> {
        self.regs.closures[reg.0 as usize]
    }

    fn select(&mut self, d: Reg, c: Reg, a: Reg, b: Reg) {
        if self.group.program.kind(d) == Kind::Float {
            fill!(self.floats[d], |o| k::select(&mut o, self.regs.i(c), self.regs.f(a), self.regs.f(b)));
        } else {
            fill!(self.ints[d], |o| k::select_int(&mut o, self.regs.i(c), self.regs.i(a), self.regs.i(b)));
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
            _ => fill!(self.ints[dst], |c| {
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
