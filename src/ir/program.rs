//! The program: structured code over typed registers.
//!
//! A register holds one number for every lane. There are three ways a register gets its value: it is a constant, it is
//! an input of the shading point, or code writes it. Code that computes writes a register once (per time it runs); only
//! [`Instr::Move`] writes a register that has been written before, and such registers are marked [`RegInfo::mutable`].
//! Control flow is nested blocks: [`Node::If`], [`Node::Loop`] and [`Node::Scope`] with [`Node::Leave`].

use super::op::*;
use crate::lang::closures::ClosureId;
use crate::lang::symbols::Symbol;
use crate::lang::types::Type;
use crate::ops::working_space::WorkingSpace;
use velour_grammar::Span;

pub use super::kind::Kind;

/// A register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Reg(pub u32);

/// An array of registers with elements chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArrayId(pub u32);

/// A scope that lanes can leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ScopeId(pub u32);

/// A value known before the program runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Const {
    /// A float.
    Float(f32),
    /// An int.
    Int(i32),
    /// A symbol's number.
    String(i32),
    /// The closure that scatters nothing.
    NoClosure,
}

/// How a register gets its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// It is a constant.
    Const(Const),
    /// It is an input.
    Input(Input),
    /// Code writes it.
    Code,
}

/// A register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegInfo {
    /// What it holds.
    pub kind: Kind,
    /// How it gets its value.
    pub source: Source,
    /// True when a [`Instr::Move`] may write it more than once.
    pub mutable: bool,
    /// True when all lanes hold the same value, so that one number is kept.
    pub uniform: bool,
}

/// An array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrayInfo {
    /// What its elements hold.
    pub kind: Kind,
    /// How many elements there are.
    pub len: u32,
    /// How many numbers make an element.
    pub components: u32,
    /// True when all lanes hold the same values.
    pub uniform: bool,
}

/// An instruction.
#[derive(Clone, Debug, PartialEq)]
pub enum Instr {
    /// `dst = op a`
    Unary(Unary, Reg, Reg),
    /// `dst = a op b`
    Binary(Binary, Reg, Reg, Reg),
    /// `dst = (a first b) second c`, floats; the optimizer makes it of two instructions.
    Fused(Pair, Reg, [Reg; 3]),
    /// `dst = a op b`, an int
    Compare(Compare, Reg, Reg, Reg),
    /// `dst = is a …`, an int
    Test(Test, Reg, Reg),
    /// `dst = op a`, ints
    IntUnary(IntUnary, Reg, Reg),
    /// `dst = a op b`, ints or symbols
    IntBinary(IntBinary, Reg, Reg, Reg),
    /// `dst = (float) a`
    IntToFloat(Reg, Reg),
    /// `dst = (int) a`
    FloatToInt(Reg, Reg),
    /// `dst = c != 0 ? a : b`, any kind but a closure
    Select(Reg, Reg, Reg, Reg),
    /// `dst = a` in the active lanes; `masked` when some lanes of the batch may be inactive here.
    Move {
        /// What is written.
        dst: Reg,
        /// What is read.
        src: Reg,
        /// False when all lanes are known to be active.
        masked: bool,
    },
    /// Derivative of `src` along x (false) or y (true); the optimizer replaces it.
    Derivative(Reg, Reg, bool),
    /// `dst = array[index]`, one component
    ArrayGet {
        /// What is written.
        dst: Reg,
        /// The array.
        array: ArrayId,
        /// The component.
        component: u32,
        /// The element, an int; out of bounds it is clamped and reported.
        index: Reg,
        /// Where the access stands.
        span: Span,
    },
    /// `array[index] = src` in the active lanes, one component
    ArraySet {
        /// The array.
        array: ArrayId,
        /// The component.
        component: u32,
        /// The element, an int.
        index: Reg,
        /// What is stored.
        src: Reg,
        /// False when all lanes are known to be active.
        masked: bool,
        /// Where the access stands.
        span: Span,
    },
    /// A routine, run for the active lanes.
    Call {
        /// Which.
        routine: Routine,
        /// What it writes.
        dst: Vec<Reg>,
        /// What it reads.
        src: Vec<Reg>,
        /// Where it stands.
        span: Span,
    },
    /// A closure with its parameters.
    Leaf {
        /// What is written.
        dst: Reg,
        /// Which closure.
        closure: ClosureId,
        /// The positional parameters, flattened to registers.
        params: Vec<Reg>,
        /// The keyword parameters, each with its registers.
        keywords: Vec<(u32, Vec<Reg>)>,
        /// Where it stands.
        span: Span,
    },
    /// `dst = a + b`, closures
    ClosureAdd(Reg, Reg, Reg),
    /// `dst = a * weight`, a closure and three floats
    ClosureScale(Reg, Reg, [Reg; 3]),
    /// `dst = c != 0 ? a : b`, closures
    ClosureSelect(Reg, Reg, Reg, Reg),
    /// `dst = 1` in the lanes where `a` is no closure at all, an int
    ClosureAbsent(Reg, Reg),
}

/// A piece of structured code.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// An instruction.
    Instr(Instr),
    /// Runs one block in the lanes whose condition is not zero, the other in the rest.
    If(Reg, Block, Block),
    /// Runs `head`, drops the lanes whose condition is zero, runs `body`, and again until no lane is left.
    Loop {
        /// Computes the condition.
        head: Block,
        /// The condition, an int written in `head` (or a constant).
        condition: Reg,
        /// The body.
        body: Block,
        /// Where the loop stands.
        span: Span,
    },
    /// A block that lanes can leave early; they come back at its end.
    Scope(ScopeId, Block),
    /// The active lanes leave a scope.
    Leave(ScopeId),
}

/// Code in order.
pub type Block = Vec<Node>;

/// A named result of the program, such as an output parameter of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The layer's name, or the shader's when it has none.
    pub layer: String,
    /// The parameter's name; fields of structs follow after dots.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// Where its values are.
    pub value: OutputValue,
}

/// Where the values of an output are.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputValue {
    /// One register a component.
    Regs(Vec<Reg>),
    /// An array.
    Array(ArrayId),
}

/// A whole shader group, ready to be optimised and run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// The registers.
    pub regs: Vec<RegInfo>,
    /// The arrays.
    pub arrays: Vec<ArrayInfo>,
    /// How many scopes there are.
    pub scopes: u32,
    /// The code.
    pub body: Block,
    /// The value of `Ci` at the end.
    pub result: Option<Reg>,
    /// Named results.
    pub outputs: Vec<Output>,
    /// What RGB means.
    pub working_space: WorkingSpace,
    /// Instructions there were before the optimizer; 0 in a program it has not seen.
    pub lowered: usize,
}

impl Program {
    /// An output by its name, `name` or `layer.name`; of several layers' the last one's.
    pub fn output(&self, name: &str) -> Option<&Output> {
        let named = |layer: &str, own: &str| {
            own == name || name.strip_prefix(layer).is_some_and(|rest| rest.strip_prefix('.') == Some(own))
        };
        self.outputs.iter().rev().find(|output| named(&output.layer, &output.name))
    }

    /// The texts among its constants, in the order of registers.
    pub fn texts(&self) -> impl Iterator<Item = &'static str> {
        self.regs.iter().filter_map(|info| match info.source {
            Source::Const(Const::String(number)) => Some(Symbol(number).text()),
            Source::Const(_) | Source::Input(_) | Source::Code => None,
        })
    }

    /// How many instructions there are, whether or not they run.
    pub fn instructions(&self) -> usize {
        let mut count = 0;
        visit_instrs(&self.body, &mut |_| count += 1);
        count
    }

    /// A new register that code writes.
    pub fn reg(&mut self, kind: Kind, mutable: bool) -> Reg {
        self.regs.push(RegInfo { kind, source: Source::Code, mutable, uniform: false });
        Reg(self.regs.len() as u32 - 1)
    }

    /// The constant a register holds.
    pub fn constant(&self, reg: Reg) -> Option<Const> {
        match self.regs[reg.0 as usize].source {
            Source::Const(value) => Some(value),
            Source::Input(_) | Source::Code => None,
        }
    }

    /// What a register holds.
    pub fn kind(&self, reg: Reg) -> Kind {
        self.regs[reg.0 as usize].kind
    }
}

impl Instr {
    /// Calls `visit` for every register the instruction reads.
    pub fn reads(&self, mut visit: impl FnMut(Reg)) {
        use Instr::*;
        match self {
            Unary(_, _, a) | Test(_, _, a) | IntUnary(_, _, a) | IntToFloat(_, a) | FloatToInt(_, a) => visit(*a),
            ClosureAbsent(_, a) | Derivative(_, a, _) | Move { src: a, .. } => visit(*a),
            Binary(_, _, a, b) | Compare(_, _, a, b) | IntBinary(_, _, a, b) | ClosureAdd(_, a, b) => {
                visit(*a);
                visit(*b);
            }
            Select(_, c, a, b) | ClosureSelect(_, c, a, b) => [c, a, b].into_iter().for_each(|r| visit(*r)),
            Fused(_, _, abc) => abc.iter().for_each(|r| visit(*r)),
            ArrayGet { index, .. } => visit(*index),
            ArraySet { index, src, .. } => {
                visit(*index);
                visit(*src);
            }
            Call { src, .. } => src.iter().for_each(|r| visit(*r)),
            Leaf { params, keywords, .. } => {
                params.iter().for_each(|r| visit(*r));
                keywords.iter().flat_map(|k| &k.1).for_each(|r| visit(*r));
            }
            ClosureScale(_, a, w) => {
                visit(*a);
                w.iter().for_each(|r| visit(*r));
            }
        }
    }

    /// Calls `visit` for every register the instruction writes.
    pub fn writes(&self, mut visit: impl FnMut(Reg)) {
        use Instr::*;
        match self {
            Unary(_, d, _) | Test(_, d, _) | IntUnary(_, d, _) | IntToFloat(d, _) | FloatToInt(d, _) => visit(*d),
            Derivative(d, ..) | Move { dst: d, .. } | Binary(_, d, ..) | Compare(_, d, ..) => visit(*d),
            IntBinary(_, d, ..) | Select(d, ..) | ClosureSelect(d, ..) | ClosureAdd(d, ..) => visit(*d),
            ArrayGet { dst, .. } | Leaf { dst, .. } => visit(*dst),
            ArraySet { .. } => {}
            Call { dst, .. } => dst.iter().for_each(|r| visit(*r)),
            ClosureScale(d, ..) | ClosureAbsent(d, _) | Fused(_, d, _) => visit(*d),
        }
    }

    /// True when the instruction does something besides writing its registers.
    pub fn has_effect(&self) -> bool {
        match self {
            Instr::Call { routine, .. } => routine.declaration().effect != Effect::None,
            // An array matters to those who read it, which is for the reader of the program to find out.
            Instr::ArraySet { .. } => false,
            Instr::Unary(..) | Instr::Binary(..) | Instr::Fused(..) | Instr::Compare(..) | Instr::Test(..) => false,
            Instr::IntUnary(..) | Instr::IntBinary(..) | Instr::IntToFloat(..) | Instr::FloatToInt(..) => false,
            Instr::Select(..) | Instr::Move { .. } | Instr::Derivative(..) | Instr::ArrayGet { .. } => false,
            Instr::Leaf { .. } | Instr::ClosureAdd(..) | Instr::ClosureScale(..) => false,
            Instr::ClosureSelect(..) | Instr::ClosureAbsent(..) => false,
        }
    }
}

/// Visits every instruction of a block, innermost ones too, in order.
pub fn visit_instrs(block: &Block, visit: &mut impl FnMut(&Instr)) {
    for node in block {
        match node {
            Node::Instr(instr) => visit(instr),
            Node::If(_, a, b) => {
                visit_instrs(a, visit);
                visit_instrs(b, visit);
            }
            Node::Loop { head, body, .. } => {
                visit_instrs(head, visit);
                visit_instrs(body, visit);
            }
            Node::Scope(_, body) => visit_instrs(body, visit),
            Node::Leave(_) => {}
        }
    }
}
