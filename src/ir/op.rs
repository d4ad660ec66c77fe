//! The operations of a program. Every one works on single numbers: a triple is three registers, a matrix sixteen.

use super::kind::Kind;
use crate::lang::globals::Global;
use crate::lang::types::Base;

pub use super::routine::*;

/// Float to float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name in `ops`")]
pub enum Unary {
    Neg,
    Abs,
    Sqrt,
    InverseSqrt,
    Cbrt,
    Exp,
    Exp2,
    Expm1,
    Log,
    Log2,
    Log10,
    Logb,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Erf,
    Erfc,
    Floor,
    Ceil,
    Round,
    Trunc,
    Sign,
}

/// Two floats to a float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name in `ops`")]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    Pow,
    Atan2,
    Min,
    Max,
    Step,
}

/// Two operations in one: `t = a first b`, then `t second c`. The result is rounded after each, as if they were apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pair {
    /// Makes `t` of `a` and `b`.
    pub first: Binary,
    /// Makes the result of `t` and `c`.
    pub second: Binary,
    /// True for `c second t`.
    pub swapped: bool,
}

impl Pair {
    /// The operations that may come first.
    pub const FIRST: [Binary; 4] = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div];
    /// The operations that may come second.
    pub const SECOND: [Binary; 6] = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div, Binary::Min, Binary::Max];

    /// Is it one of the pairs that run as one loop over lanes? Sums and products are the same either way, and have one for both.
    pub fn has_loop(self) -> bool {
        let either = matches!(self.second, Binary::Add | Binary::Mul);
        Pair::FIRST.contains(&self.first) && Pair::SECOND.contains(&self.second) && !(self.swapped && either)
    }
}

/// Two floats to an int, 1 for true.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the comparison of its name")]
pub enum Compare {
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
}

/// Int to int.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum IntUnary {
    Neg,
    Abs,
    BitNot,
    /// 1 for 0, else 0.
    Not,
}

/// Two ints (or symbols) to an int.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum IntBinary {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    Shl,
    Shr,
    BitAnd,
    BitOr,
    BitXor,
    Min,
    Max,
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
    /// 1 when both are not zero.
    And,
    /// 1 when one is not zero.
    Or,
}

/// What a float is tested for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// Is it not a number?
    Nan,
    /// Is it infinite?
    Inf,
    /// Is it neither?
    Finite,
}

/// What a shading point gives besides the globals of the language, and the derivatives of those.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// A component of a shader global.
    Global(Global, u8),
    /// Its derivative along the screen's x.
    GlobalDx(Global, u8),
    /// Its derivative along the screen's y.
    GlobalDy(Global, u8),
    /// `surfacearea()`
    SurfaceArea,
    /// `backfacing()`
    Backfacing,
}

impl Input {
    /// What its register holds.
    pub fn kind(self) -> Kind {
        match self {
            Input::Global(..) | Input::GlobalDx(..) | Input::GlobalDy(..) | Input::SurfaceArea => Kind::Float,
            Input::Backfacing => Kind::Int,
        }
    }

    /// Is there such an input? `Ci` is none, and a component is one that the global has.
    pub fn exists(self) -> bool {
        match self {
            Input::Global(global, c) | Input::GlobalDx(global, c) | Input::GlobalDy(global, c) => {
                usize::from(c) < global.ty().base().map_or(0, Base::floats)
            }
            Input::SurfaceArea | Input::Backfacing => true,
        }
    }
}
