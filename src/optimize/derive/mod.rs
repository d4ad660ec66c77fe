//! Derivatives: forward differentiation of exactly the values whose derivatives are read.
//!
//! A search finds the registers that matter: sources of [`Instr::Derivative`] and whatever they are computed from. A walk
//! writes, after each instruction that computes such a register, the
//! instructions for its two derivatives. What has no derivative (ints, strings, constants, steps) counts as zero.

mod calls;
mod rules;

use super::flow::Flow;
use crate::ir::op::*;
use crate::ir::program::*;
use crate::lang::globals::Global;
use std::collections::HashMap;

/// Replaces every [`Instr::Derivative`] by the derivative itself.
pub fn expand(program: &mut Program) {
    let needs = Needs::of(program);
    if !needs.regs.contains(&true) && !has_derivatives(&program.body) {
        return;
    }
    let body = std::mem::take(&mut program.body);
    let mut writer =
        Writer { program, needs, slopes: HashMap::new(), arrays: HashMap::new(), zero: None, out: Vec::new() };
    let body = writer.block(body);
    program.body = body;
}

fn has_derivatives(block: &Block) -> bool {
    let mut found = false;
    visit_instrs(block, &mut |instr| found |= matches!(instr, Instr::Derivative(..)));
    found
}

struct Needs {
    regs: Vec<bool>,
    arrays: Vec<bool>,
    /// What has been found to matter, and where that is computed has not been looked at.
    open_regs: Vec<Reg>,
    open_arrays: Vec<ArrayId>,
}

impl Needs {
    /// What matters in a program: from the sources of derivatives back to what they are computed from.
    fn of(program: &Program) -> Self {
        let flow = Flow::of(program);
        let (regs, arrays) = (vec![false; program.regs.len()], vec![false; program.arrays.len()]);
        let mut needs = Needs { regs, arrays, open_regs: Vec::new(), open_arrays: Vec::new() };
        for placed in &flow.nodes {
            if let Node::Instr(instr @ Instr::Derivative(..)) = placed.node {
                needs.instr(instr);
            }
        }
        loop {
            let computed = if let Some(reg) = needs.open_regs.pop() {
                flow.writers.of(reg.0)
            } else if let Some(array) = needs.open_arrays.pop() {
                flow.setters.of(array.0)
            } else {
                return needs;
            };
            for node in computed {
                if let Node::Instr(instr) = flow.nodes[node].node {
                    needs.instr(instr);
                }
            }
        }
    }

    fn mark(&mut self, reg: Reg) {
        if !std::mem::replace(&mut self.regs[reg.0 as usize], true) {
            self.open_regs.push(reg);
        }
    }

    fn instr(&mut self, instr: &Instr) {
        if let Instr::Derivative(_, src, _) = instr {
            return self.mark(*src);
        }
        if let Instr::ArraySet { array, src, .. } = instr {
            if self.arrays[array.0 as usize] {
                self.mark(*src);
            }
            return;
        }
        let mut wanted = false;
        instr.writes(|reg| wanted |= self.regs[reg.0 as usize]);
        if !wanted {
            return;
        }
        match instr {
            Instr::Unary(op, _, a) => {
                if !is_step(*op) {
                    self.mark(*a);
                }
            }
            Instr::Binary(Binary::Step, ..) => {}
            Instr::Binary(_, _, a, b) | Instr::Select(_, _, a, b) => {
                self.mark(*a);
                self.mark(*b);
            }
            Instr::Move { src, .. } => self.mark(*src),
            Instr::ArrayGet { array, .. } => {
                if !std::mem::replace(&mut self.arrays[array.0 as usize], true) {
                    self.open_arrays.push(*array);
                }
            }
            Instr::Call { routine, src, .. } => self.call(routine, src),
            // There are no pairs yet, and the others write no floats or floats that are steps.
            Instr::Fused(..) | Instr::IntToFloat(..) | Instr::FloatToInt(..) | Instr::Compare(..) => {}
            Instr::Test(..) | Instr::IntUnary(..) | Instr::IntBinary(..) => {}
            // A second derivative is zero, as OSL has it. Arrays are dealt with above.
            Instr::Derivative(..) | Instr::ArraySet { .. } => {}
            Instr::Leaf { .. } | Instr::ClosureAdd(..) | Instr::ClosureScale(..) => {}
            Instr::ClosureSelect(..) | Instr::ClosureAbsent(..) => {}
        }
    }

    fn call(&mut self, routine: &Routine, src: &[Reg]) {
        let Declaration { takes, slopes, .. } = routine.declaration();
        match (slopes, routine) {
            (Slopes::Rule(_), _) => floats(&takes, src).for_each(|reg| self.mark(reg)),
            (Slopes::Gradient, Routine::Noise(noise)) => {
                src[..noise.dims as usize].iter().for_each(|&reg| self.mark(reg));
            }
            (Slopes::Gradient | Slopes::Given | Slopes::None, _) => {}
        }
    }
}

/// The float registers of a list.
fn floats<'r>(kinds: &'r Kinds, regs: &'r [Reg]) -> impl Iterator<Item = Reg> + 'r {
    each(kinds).zip(regs).filter(|(kind, _)| *kind == Kind::Float).map(|(_, &reg)| reg)
}

fn is_step(op: Unary) -> bool {
    matches!(op, Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Sign | Unary::Logb)
}

/// The two derivatives of a register; `None` for zero.
type Slope = [Option<Reg>; 2];

struct Writer<'p> {
    program: &'p mut Program,
    needs: Needs,
    slopes: HashMap<Reg, Slope>,
    arrays: HashMap<ArrayId, [ArrayId; 2]>,
    zero: Option<Reg>,
    out: Block,
}

impl Writer<'_> {
    fn block(&mut self, block: Block) -> Block {
        let outer = std::mem::take(&mut self.out);
        for node in block {
            let node = match node {
                Node::Instr(instr) => {
                    self.instr(instr);
                    continue;
                }
                Node::If(condition, a, b) => Node::If(condition, self.block(a), self.block(b)),
                Node::Loop { head, condition, body, span } => {
                    Node::Loop { head: self.block(head), condition, body: self.block(body), span }
                }
                Node::Scope(id, body) => Node::Scope(id, self.block(body)),
                leave @ Node::Leave(_) => leave,
            };
            self.out.push(node);
        }
        std::mem::replace(&mut self.out, outer)
    }

    fn emit(&mut self, instr: Instr) {
        self.out.push(Node::Instr(instr));
    }

    fn constant(&mut self, value: f32) -> Reg {
        let source = Source::Const(Const::Float(value));
        self.program.regs.push(RegInfo { kind: Kind::Float, source, mutable: false, uniform: true });
        Reg(self.program.regs.len() as u32 - 1)
    }

    fn zero(&mut self) -> Reg {
        if self.zero.is_none() {
            self.zero = Some(self.constant(0.0));
        }
        self.zero.unwrap_or(Reg(0))
    }

    fn input(&mut self, input: Input) -> Reg {
        let source = Source::Input(input);
        self.program.regs.push(RegInfo { kind: Kind::Float, source, mutable: false, uniform: false });
        Reg(self.program.regs.len() as u32 - 1)
    }

    /// The derivatives of a register.
    fn slope(&mut self, reg: Reg) -> Slope {
        if let Some(&slope) = self.slopes.get(&reg) {
            return slope;
        }
        let info = self.program.regs[reg.0 as usize];
        let slope = match info.source {
            Source::Input(input) => self.input_slope(input),
            Source::Code if info.mutable && info.kind == Kind::Float => {
                [Some(self.program.reg(Kind::Float, true)), Some(self.program.reg(Kind::Float, true))]
            }
            Source::Code | Source::Const(_) => [None, None],
        };
        self.slopes.insert(reg, slope);
        slope
    }

    /// The derivatives of an input: points have them for what moves along the surface.
    fn input_slope(&mut self, input: Input) -> Slope {
        let Input::Global(global, c) = input else { return [None, None] };
        match global {
            Global::P | Global::Ps | Global::I | Global::U | Global::V => {
                [Some(self.input(Input::GlobalDx(global, c))), Some(self.input(Input::GlobalDy(global, c)))]
            }
            Global::N | Global::Ng | Global::DPdu | Global::DPdv => [None, None],
            Global::Time | Global::Dtime | Global::DPdtime | Global::Ci => [None, None],
        }
    }

    fn un(&mut self, op: Unary, a: Reg) -> Reg {
        let dst = self.program.reg(Kind::Float, false);
        self.emit(Instr::Unary(op, dst, a));
        dst
    }

    fn bin(&mut self, op: Binary, a: Reg, b: Reg) -> Reg {
        let dst = self.program.reg(Kind::Float, false);
        self.emit(Instr::Binary(op, dst, a, b));
        dst
    }

    fn mul(&mut self, slope: Option<Reg>, factor: Reg) -> Option<Reg> {
        slope.map(|slope| self.bin(Binary::Mul, slope, factor))
    }

    fn add(&mut self, a: Option<Reg>, b: Option<Reg>) -> Option<Reg> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.bin(Binary::Add, a, b)),
            (one, None) | (None, one) => one,
        }
    }

    /// Emits an instruction, and after it the derivatives of what it computed.
    fn instr(&mut self, instr: Instr) {
        if let Instr::Derivative(dst, src, along_y) = instr {
            let slope = self.slope(src)[along_y as usize];
            let src = slope.unwrap_or_else(|| self.zero());
            return self.emit(Instr::Move { dst, src, masked: true });
        }
        let mut wanted = false;
        instr.writes(|reg| wanted |= self.needs.regs.get(reg.0 as usize).copied().unwrap_or(false));
        if let Instr::ArraySet { array, .. } = instr {
            wanted = self.needs.arrays[array.0 as usize];
        }
        if wanted {
            self.with_slope(instr);
        } else {
            self.emit(instr);
        }
    }

    fn with_slope(&mut self, instr: Instr) {
        match instr {
            Instr::Unary(op, dst, a) => {
                self.emit(instr);
                let from = self.slope(a);
                if !is_step(op) && from != [None, None] {
                    let factor = self.unary_factor(op, a, dst);
                    let slope = from.map(|slope| self.mul(slope, factor));
                    self.slopes.insert(dst, slope);
                }
            }
            Instr::Binary(op, dst, a, b) => {
                self.emit(instr);
                let slope = self.binary_slope(op, dst, a, b);
                let slope = self.kept(slope);
                self.slopes.insert(dst, slope);
            }
            Instr::Select(dst, c, a, b) => {
                self.emit(instr);
                let slope = self.choose(c, a, b);
                self.slopes.insert(dst, slope);
            }
            Instr::Move { dst, src, .. } => self.move_slope(instr, dst, src),
            Instr::ArrayGet { dst, array, component, index, span } => {
                self.emit(instr);
                let slope = self.twins(array).map(|array| {
                    let dst = self.program.reg(Kind::Float, false);
                    self.emit(Instr::ArrayGet { dst, array, component, index, span });
                    Some(dst)
                });
                self.slopes.insert(dst, slope);
            }
            Instr::ArraySet { array, component, index, src, masked, span } => {
                self.emit(instr);
                for (array, slope) in self.twins(array).into_iter().zip(self.slope(src)) {
                    let src = slope.unwrap_or_else(|| self.zero());
                    self.emit(Instr::ArraySet { array, component, index, src, masked, span });
                }
            }
            Instr::Call { routine, dst, src, span } => self.call_slope(routine, dst, src, span),
            // What has no slope is never asked for one; see `Needs::instr`.
            Instr::Derivative(..) | Instr::Fused(..) | Instr::IntToFloat(..) | Instr::FloatToInt(..) => {
                self.emit(instr)
            }
            Instr::Compare(..) | Instr::Test(..) | Instr::IntUnary(..) | Instr::IntBinary(..) => self.emit(instr),
            Instr::Leaf { .. } | Instr::ClosureAdd(..) | Instr::ClosureScale(..) => self.emit(instr),
            Instr::ClosureSelect(..) | Instr::ClosureAbsent(..) => self.emit(instr),
        }
    }

    /// Slopes that later assignments do not change: the slope of `x + 1` is that of `x` at this moment.
    fn kept(&mut self, slope: Slope) -> Slope {
        slope.map(|slope| {
            slope.map(|src| {
                if !self.program.regs[src.0 as usize].mutable {
                    return src;
                }
                let dst = self.program.reg(Kind::Float, false);
                self.emit(Instr::Move { dst, src, masked: true });
                dst
            })
        })
    }

    fn move_slope(&mut self, instr: Instr, dst: Reg, src: Reg) {
        let from = self.slope(src);
        self.emit(instr);
        if !self.program.regs[dst.0 as usize].mutable {
            // The source may be mutable and change later, so its derivatives are copied as well.
            let copy = from.map(|slope| {
                slope.map(|src| {
                    let dst = self.program.reg(Kind::Float, false);
                    self.emit(Instr::Move { dst, src, masked: true });
                    dst
                })
            });
            self.slopes.insert(dst, copy);
            return;
        }
        for (to, from) in self.slope(dst).into_iter().zip(from) {
            let src = from.unwrap_or_else(|| self.zero());
            if let Some(dst) = to {
                self.emit(Instr::Move { dst, src, masked: true });
            }
        }
    }

    /// `c ? da : db`
    fn choose(&mut self, c: Reg, a: Reg, b: Reg) -> Slope {
        let (a, b) = (self.slope(a), self.slope(b));
        let mut out = [None; 2];
        for (i, slot) in out.iter_mut().enumerate() {
            if a[i].is_some() || b[i].is_some() {
                let (x, y) = (a[i].unwrap_or_else(|| self.zero()), b[i].unwrap_or_else(|| self.zero()));
                let dst = self.program.reg(Kind::Float, false);
                self.emit(Instr::Select(dst, c, x, y));
                *slot = Some(dst);
            }
        }
        out
    }

    /// The arrays that hold the derivatives of an array's elements.
    fn twins(&mut self, array: ArrayId) -> [ArrayId; 2] {
        let info = self.program.arrays[array.0 as usize];
        let program = &mut *self.program;
        *self.arrays.entry(array).or_insert_with(|| {
            [0, 1].map(|_| {
                program.arrays.push(info);
                ArrayId(program.arrays.len() as u32 - 1)
            })
        })
    }
}
