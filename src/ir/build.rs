//! The builder of programs: appends instructions, folds constants as it goes, and gives equal values one register.

use super::fold;
use super::op::*;
use super::program::*;
use crate::limits::{INSTRUCTIONS, NUMBERS};
use std::collections::HashMap;

/// What makes two instructions compute the same value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Key {
    Unary(Unary, Reg),
    Binary(Binary, Reg, Reg),
    Compare(Compare, Reg, Reg),
    IntUnary(IntUnary, Reg),
    IntBinary(IntBinary, Reg, Reg),
    IntToFloat(Reg),
    FloatToInt(Reg),
    Select(Reg, Reg, Reg),
    Derivative(Reg, bool),
    Clamped(Reg, u32, bool, u32),
}

/// Builds a program.
pub struct Builder {
    /// The program so far; its body is the outermost open block until [`Builder::finish`].
    pub program: Program,
    blocks: Vec<Block>,
    values: Vec<HashMap<Key, Reg>>,
    constants: HashMap<(Kind, u32), Reg>,
    inputs: HashMap<Input, Reg>,
    simplify: bool,
    nodes: usize,
}

impl std::fmt::Debug for Builder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Builder").field("program", &self.program).finish_non_exhaustive()
    }
}

impl Builder {
    /// A builder. Without `simplify` every instruction is kept as it is asked for.
    pub fn new(simplify: bool) -> Self {
        Builder {
            program: Program::default(),
            blocks: vec![Block::new()],
            values: vec![HashMap::new()],
            constants: HashMap::new(),
            inputs: HashMap::new(),
            simplify,
            nodes: 0,
        }
    }

    /// The program, with the code appended so far.
    pub fn finish(mut self) -> Program {
        self.program.body = self.blocks.pop().unwrap_or_default();
        if self.is_full() {
            // What is left of it is not what was written; this is what `verify` refuses.
            self.program.body = Block::new();
            self.array(Kind::Float, NUMBERS as u32 + 1, 1);
        }
        self.program
    }

    /// Appends to the innermost open block.
    pub fn push(&mut self, node: Node) {
        if let Some(block) = self.blocks.last_mut() {
            self.nodes += 1;
            block.push(node);
        }
    }

    /// Is the program so long that it will be refused, see [`crate::limits::INSTRUCTIONS`]? Nothing more need be added.
    pub fn is_full(&self) -> bool {
        self.nodes > INSTRUCTIONS
    }

    /// Appends an instruction.
    pub fn instr(&mut self, instr: Instr) {
        self.push(Node::Instr(instr));
    }

    /// Opens a block; what follows goes into it.
    pub fn open(&mut self) {
        self.blocks.push(Block::new());
        self.values.push(HashMap::new());
    }

    /// Closes the innermost block and gives it.
    pub fn close(&mut self) -> Block {
        self.values.pop();
        self.blocks.pop().unwrap_or_default()
    }

    /// A new scope that lanes can leave.
    pub fn scope(&mut self) -> ScopeId {
        self.program.scopes += 1;
        ScopeId(self.program.scopes - 1)
    }

    /// A new array.
    pub fn array(&mut self, kind: Kind, len: u32, components: u32) -> ArrayId {
        self.program.arrays.push(ArrayInfo { kind, len, components, uniform: false });
        ArrayId(self.program.arrays.len() as u32 - 1)
    }

    /// The register of a constant.
    pub fn constant(&mut self, value: Const) -> Reg {
        let (kind, bits) = match value {
            Const::Float(x) => (Kind::Float, x.to_bits()),
            Const::Int(i) => (Kind::Int, i as u32),
            Const::String(s) => (Kind::String, s as u32),
            Const::NoClosure => (Kind::Closure, 0),
        };
        let regs = &mut self.program.regs;
        *self.constants.entry((kind, bits)).or_insert_with(|| {
            regs.push(RegInfo { kind, source: Source::Const(value), mutable: false, uniform: true });
            Reg(regs.len() as u32 - 1)
        })
    }

    /// The register of a float constant.
    pub fn float(&mut self, value: f32) -> Reg {
        self.constant(Const::Float(value))
    }

    /// The register of an int constant.
    pub fn int(&mut self, value: i32) -> Reg {
        self.constant(Const::Int(value))
    }

    /// The register of an input.
    pub fn input(&mut self, input: Input) -> Reg {
        let kind = input.kind();
        let regs = &mut self.program.regs;
        *self.inputs.entry(input).or_insert_with(|| {
            regs.push(RegInfo { kind, source: Source::Input(input), mutable: false, uniform: false });
            Reg(regs.len() as u32 - 1)
        })
    }

    /// The float a register is known to hold.
    pub fn known_float(&self, reg: Reg) -> Option<f32> {
        match self.program.constant(reg) {
            Some(Const::Float(value)) => Some(value),
            _ => None,
        }
    }

    /// The int (or symbol) a register is known to hold.
    pub fn known_int(&self, reg: Reg) -> Option<i32> {
        match self.program.constant(reg) {
            Some(Const::Int(value) | Const::String(value)) => Some(value),
            _ => None,
        }
    }

    /// The register of an equal value computed before, or a new one for `make` to write.
    fn value(&mut self, key: Key, kind: Kind, reads: &[Reg], make: impl FnOnce(Reg) -> Instr) -> Reg {
        // A mutable register may hold something else by now, so nothing is remembered of it.
        let stable = self.simplify && reads.iter().all(|r| !self.program.regs[r.0 as usize].mutable);
        if stable && let Some(&known) = self.values.iter().rev().find_map(|scope| scope.get(&key)) {
            return known;
        }
        let dst = self.program.reg(kind, false);
        self.instr(make(dst));
        if stable && let Some(scope) = self.values.last_mut() {
            scope.insert(key, dst);
        }
        dst
    }

    /// `op a`
    pub fn unary(&mut self, op: Unary, a: Reg) -> Reg {
        match self.known_float(a) {
            Some(x) if self.simplify => self.float(fold::unary(op, x)),
            _ => self.value(Key::Unary(op, a), Kind::Float, &[a], |dst| Instr::Unary(op, dst, a)),
        }
    }

    /// `a op b`
    pub fn binary(&mut self, op: Binary, a: Reg, b: Reg) -> Reg {
        if self.simplify {
            let (x, y) = (self.known_float(a), self.known_float(b));
            if let (Some(x), Some(y)) = (x, y) {
                return self.float(fold::binary(op, x, y));
            }
            // Exact for every value, not-a-number and minus zero included. A division by one is not: it makes what is
            // infinite zero.
            let same = (op == Binary::Mul && y == Some(1.0)) || (op == Binary::Sub && y.map(f32::to_bits) == Some(0));
            if same {
                return a;
            }
            if op == Binary::Mul && x == Some(1.0) {
                return b;
            }
        }
        self.value(Key::Binary(op, a, b), Kind::Float, &[a, b], |dst| Instr::Binary(op, dst, a, b))
    }

    /// `a op b` of floats, an int
    pub fn compare(&mut self, op: Compare, a: Reg, b: Reg) -> Reg {
        match (self.known_float(a), self.known_float(b)) {
            (Some(x), Some(y)) if self.simplify => self.int(fold::compare(op, x, y)),
            _ => self.value(Key::Compare(op, a, b), Kind::Int, &[a, b], |dst| Instr::Compare(op, dst, a, b)),
        }
    }

    /// Is `a` not a number, infinite, finite?
    pub fn test(&mut self, test: Test, a: Reg) -> Reg {
        let dst = self.program.reg(Kind::Int, false);
        self.instr(Instr::Test(test, dst, a));
        dst
    }

    /// `op a` of an int
    pub fn int_unary(&mut self, op: IntUnary, a: Reg) -> Reg {
        match self.known_int(a) {
            Some(x) if self.simplify => self.int(fold::int_unary(op, x)),
            _ => self.value(Key::IntUnary(op, a), Kind::Int, &[a], |dst| Instr::IntUnary(op, dst, a)),
        }
    }

    /// `a op b` of ints
    pub fn int_binary(&mut self, op: IntBinary, a: Reg, b: Reg) -> Reg {
        match (self.known_int(a), self.known_int(b)) {
            (Some(x), Some(y)) if self.simplify => self.int(fold::int_binary(op, x, y)),
            _ => self.value(Key::IntBinary(op, a, b), Kind::Int, &[a, b], |dst| Instr::IntBinary(op, dst, a, b)),
        }
    }

    /// An int as a float
    pub fn int_to_float(&mut self, a: Reg) -> Reg {
        match self.known_int(a) {
            Some(x) if self.simplify => self.float(x as f32),
            _ => self.value(Key::IntToFloat(a), Kind::Float, &[a], |dst| Instr::IntToFloat(dst, a)),
        }
    }

    /// A float cut to an int
    pub fn float_to_int(&mut self, a: Reg) -> Reg {
        match self.known_float(a) {
            Some(x) if self.simplify => self.int(fold::float_to_int(x)),
            _ => self.value(Key::FloatToInt(a), Kind::Int, &[a], |dst| Instr::FloatToInt(dst, a)),
        }
    }

    /// `c ? a : b` of any kind, both sides computed
    pub fn select(&mut self, c: Reg, a: Reg, b: Reg) -> Reg {
        match self.known_int(c) {
            Some(c) if self.simplify => return if c != 0 { a } else { b },
            _ if a == b && self.simplify => return a,
            _ => {}
        }
        let kind = self.program.kind(a);
        if kind == Kind::Closure {
            let dst = self.program.reg(kind, false);
            self.instr(Instr::ClosureSelect(dst, c, a, b));
            return dst;
        }
        self.value(Key::Select(c, a, b), kind, &[c, a, b], |dst| Instr::Select(dst, c, a, b))
    }

    /// Derivative along x or y
    pub fn derivative(&mut self, a: Reg, along_y: bool) -> Reg {
        self.value(Key::Derivative(a, along_y), Kind::Float, &[a], |dst| Instr::Derivative(dst, a, along_y))
    }

    /// An index kept inside `0..len`, and reported when it is outside
    pub fn clamped(&mut self, a: Reg, len: u32, written: bool, span: velour_grammar::Span) -> Reg {
        let routine = Routine::ClampIndex { len, written };
        // Each place that looks outside is told of, so what is shared is of one place.
        self.value(Key::Clamped(a, len, written, span.first), Kind::Int, &[a], |dst| Instr::Call {
            routine,
            dst: vec![dst],
            src: vec![a],
            span,
        })
    }

    /// A copy in a register of its own.
    pub fn copy(&mut self, src: Reg, mutable: bool) -> Reg {
        let dst = self.program.reg(self.program.kind(src), mutable);
        self.instr(Instr::Move { dst, src, masked: true });
        dst
    }

    /// A routine, with new registers for the results that it declares.
    pub fn call(&mut self, routine: Routine, src: Vec<Reg>, span: velour_grammar::Span) -> Vec<Reg> {
        let gives = routine.declaration().gives;
        let dst: Vec<Reg> = each(&gives).map(|kind| self.program.reg(kind, false)).collect();
        self.instr(Instr::Call { routine, dst: dst.clone(), src, span });
        dst
    }
}
