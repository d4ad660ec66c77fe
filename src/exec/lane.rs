//! The arguments of a routine in one lane.

use super::run::Run;
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::matrix::Matrix;

/// The arguments of one lane.
pub(super) struct Lane<'r> {
    pub run: &'r Run<'r>,
    pub src: &'r [Reg],
    pub lane: usize,
}

impl<'r> Lane<'r> {
    /// A float, by its place among the arguments.
    pub fn f(&self, at: usize) -> f32 {
        let column = self.run.regs.f(self.src[at]);
        if column.len() == 1 { column[0] } else { column[self.lane] }
    }

    /// An int or the number of a symbol.
    pub fn i(&self, at: usize) -> i32 {
        let column = self.run.regs.i(self.src[at]);
        if column.len() == 1 { column[0] } else { column[self.lane] }
    }

    /// A string.
    pub fn s(&self, at: usize) -> &'r str {
        let text = self.run.tree.strings.text(Symbol(self.i(at)));
        self.run.read.set(self.run.read.get() + text.len() as u64);
        text
    }

    /// Three floats.
    pub fn triple(&self, at: usize) -> [f32; 3] {
        [self.f(at), self.f(at + 1), self.f(at + 2)]
    }

    /// Sixteen floats.
    pub fn matrix(&self, at: usize) -> Matrix {
        std::array::from_fn(|i| self.f(at + i))
    }
}
