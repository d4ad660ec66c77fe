//! Programs made from nothing: registers of all kinds, and nodes over them that mostly fit.

use super::mutate::{Choice, another};
use velour::ir::op::*;
use velour::ir::program::*;
use velour::lang::closures::{ClosureId, ClosureTable, ParamKind};
use velour::lang::globals::GLOBALS;
use velour::lang::symbols::Symbol;
use velour_grammar::Span;

/// What is known while a program grows.
struct Maker<'c> {
    program: Program,
    choice: &'c mut Choice,
    table: &'c ClosureTable,
    /// Registers that hold something here.
    ready: Vec<Reg>,
    /// Scopes that are open here.
    open: Vec<ScopeId>,
    /// Nodes that may still be made.
    left: usize,
}

/// A program of some forty nodes.
pub fn program(choice: &mut Choice, table: &ClosureTable) -> Program {
    let left = 5 + choice.below(40);
    let mut maker = Maker { program: Program::default(), choice, table, ready: Vec::new(), open: Vec::new(), left };
    maker.registers();
    for _ in 0..maker.choice.below(3) {
        let (kind, len, components) =
            (maker.choice.kind(), maker.choice.below(5) as u32, 1 + maker.choice.below(3) as u32);
        let components = if kind == Kind::Closure { 1 } else { components };
        let uniform = maker.choice.once_in(4);
        maker.program.arrays.push(ArrayInfo { kind, len, components, uniform });
    }
    maker.program.scopes = 3;
    maker.program.body = maker.block(0);
    maker.program.result = maker.of(Kind::Closure);
    maker.program
}

impl Maker<'_> {
    fn add(&mut self, kind: Kind, source: Source, uniform: bool) -> Reg {
        self.program.regs.push(RegInfo { kind, source, mutable: false, uniform });
        let reg = Reg(self.program.regs.len() as u32 - 1);
        self.ready.push(reg);
        reg
    }

    fn registers(&mut self) {
        for value in [0.0, 1.0, 0.3, f32::NAN, 1e30] {
            self.add(Kind::Float, Source::Const(Const::Float(value)), true);
        }
        for value in [0, 1, -7, 3, i32::MAX] {
            self.add(Kind::Int, Source::Const(Const::Int(value)), true);
        }
        for text in ["", "rgb", "hsv", "common", "a,b", "["] {
            self.add(Kind::String, Source::Const(Const::String(Symbol::new(text).0)), true);
        }
        self.add(Kind::Closure, Source::Const(Const::NoClosure), true);
        for _ in 0..4 {
            let global = GLOBALS[self.choice.below(GLOBALS.len() - 1)].1;
            let most = if self.choice.once_in(40) { 4 } else { 1 };
            let component = self.choice.below(most) as u8;
            self.add(Kind::Float, Source::Input(Input::Global(global, component)), false);
        }
        self.add(Kind::Int, Source::Input(Input::Backfacing), false);
        for kind in [Kind::Float, Kind::Int, Kind::String, Kind::Closure] {
            let reg = self.program.reg(kind, true);
            self.ready.push(reg);
        }
    }

    /// A register of a kind that holds something, once in a while any register.
    fn of(&mut self, kind: Kind) -> Option<Reg> {
        if self.choice.once_in(150) {
            return Some(self.choice.reg(self.program.regs.len()));
        }
        let fitting: Vec<Reg> = self.ready.iter().copied().filter(|&reg| self.program.kind(reg) == kind).collect();
        (!fitting.is_empty()).then(|| fitting[self.choice.below(fitting.len())])
    }

    fn some(&mut self, kind: Kind) -> Reg {
        self.of(kind).unwrap_or(Reg(0))
    }

    fn block(&mut self, depth: u32) -> Block {
        let mut block = Block::new();
        let ready = self.ready.len();
        let nodes = 1 + self.choice.below(14);
        for _ in 0..nodes {
            if self.left == 0 {
                break;
            }
            self.left -= 1;
            let node = match self.choice.below(if depth < 4 { 14 } else { 9 }) {
                10 => {
                    let condition = self.some(Kind::Int);
                    let (a, b) = (self.block(depth + 1), self.block(depth + 1));
                    Node::If(condition, a, b)
                }
                11 => {
                    let head = self.block(depth + 1);
                    let condition = self.some(Kind::Int);
                    Node::Loop { head, condition, body: self.block(depth + 1), span: Span::NONE }
                }
                12 => {
                    let scope = ScopeId(self.choice.below(3) as u32);
                    self.open.push(scope);
                    let body = self.block(depth + 1);
                    self.open.pop();
                    Node::Scope(scope, body)
                }
                13 if !self.open.is_empty() => Node::Leave(self.open[self.choice.below(self.open.len())]),
                _ => Node::Instr(self.instr()),
            };
            block.push(node);
        }
        self.ready.truncate(ready);
        block
    }

    /// A new register for a result.
    fn result(&mut self, kind: Kind) -> Reg {
        let uniform = self.choice.once_in(40);
        let reg = self.add(kind, Source::Code, uniform);
        // It holds nothing before the instruction that is being made.
        self.ready.pop();
        reg
    }

    fn instr(&mut self) -> Instr {
        let made = self.unready_instr();
        made.writes(|reg| self.ready.push(reg));
        made
    }

    fn unready_instr(&mut self) -> Instr {
        use Kind::{Closure, Float, Int};
        match self.choice.below(18) {
            0 => Instr::Unary(Unary::Exp, self.result(Float), self.some(Float)),
            1 | 2 => Instr::Binary(Binary::Pow, self.result(Float), self.some(Float), self.some(Float)),
            3 => {
                let pair = Pair { first: Binary::Mul, second: Binary::Min, swapped: self.choice.once_in(2) };
                Instr::Fused(pair, self.result(Float), [self.some(Float), self.some(Float), self.some(Float)])
            }
            4 => Instr::Compare(Compare::Lt, self.result(Int), self.some(Float), self.some(Float)),
            5 => Instr::IntBinary(IntBinary::Div, self.result(Int), self.some(Int), self.some(Int)),
            6 => Instr::FloatToInt(self.result(Int), self.some(Float)),
            7 => {
                let kind = self.choice.kind();
                Instr::Select(self.result(kind), self.some(Int), self.some(kind), self.some(kind))
            }
            8 | 9 => self.moved(),
            10 | 11 => self.element(),
            12 | 13 => self.called(),
            14 => self.leaf(),
            15 => Instr::ClosureAdd(self.result(Closure), self.some(Closure), self.some(Closure)),
            16 => {
                let weight = [self.some(Float), self.some(Float), self.some(Float)];
                Instr::ClosureScale(self.result(Closure), self.some(Closure), weight)
            }
            _ => match self.choice.below(2) {
                0 => Instr::ClosureAbsent(self.result(Int), self.some(Closure)),
                _ => Instr::ClosureSelect(self.result(Closure), self.some(Int), self.some(Closure), self.some(Closure)),
            },
        }
    }

    fn moved(&mut self) -> Instr {
        let mutable: Vec<Reg> =
            self.ready.iter().copied().filter(|reg| self.program.regs[reg.0 as usize].mutable).collect();
        let dst = mutable[self.choice.below(mutable.len())];
        let src = self.some(self.program.kind(dst));
        Instr::Move { dst, src, masked: !self.choice.once_in(3) }
    }

    fn element(&mut self) -> Instr {
        let span = Span::NONE;
        if self.program.arrays.is_empty() {
            return Instr::IntToFloat(self.result(Kind::Float), self.some(Kind::Int));
        }
        let array = ArrayId(self.choice.below(self.program.arrays.len()) as u32);
        let info = self.program.arrays[array.0 as usize];
        let component = self.choice.below(info.components as usize) as u32;
        let index = self.some(Kind::Int);
        match self.choice.below(2) {
            0 => Instr::ArrayGet { dst: self.result(info.kind), array, component, index, span },
            _ => {
                let masked = !info.uniform;
                Instr::ArraySet { array, component, index, src: self.some(info.kind), masked, span }
            }
        }
    }

    fn called(&mut self) -> Instr {
        let routine = another(self.choice);
        let Declaration { takes, gives, .. } = routine.declaration();
        let src = each(&takes).collect::<Vec<Kind>>().into_iter().map(|kind| self.some(kind)).collect();
        let dst = each(&gives).collect::<Vec<Kind>>().into_iter().map(|kind| self.result(kind)).collect();
        Instr::Call { routine, dst, src, span: Span::NONE }
    }

    fn leaf(&mut self) -> Instr {
        let closure = ClosureId(self.choice.below(self.table.specs.len()) as u32);
        let spec = self.table.get(closure).clone();
        let mut params = Vec::new();
        for param in &spec.params {
            params.extend(self.argument(param.kind));
        }
        let mut keywords = Vec::new();
        if self.choice.once_in(3) && !spec.keywords.is_empty() {
            let at = self.choice.below(spec.keywords.len());
            keywords.push((at as u32, self.argument(spec.keywords[at].kind)));
        }
        Instr::Leaf { dst: self.result(Kind::Closure), closure, params, keywords, span: Span::NONE }
    }

    fn argument(&mut self, kind: ParamKind) -> Vec<Reg> {
        match kind {
            ParamKind::Float => vec![self.some(Kind::Float)],
            ParamKind::Int => vec![self.some(Kind::Int)],
            ParamKind::String => vec![self.some(Kind::String)],
            ParamKind::Closure => vec![self.some(Kind::Closure)],
            ParamKind::Color | ParamKind::Vector | ParamKind::Normal => {
                (0..3).map(|_| self.some(Kind::Float)).collect()
            }
        }
    }
}
