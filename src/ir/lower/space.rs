//! Matrices between named spaces, and what is transformed by them.

use super::state::Lower;
use crate::check::typed::{Argument, Expr};
use crate::ir::op::{Binary, Routine, Smooth};
use crate::ir::program::Reg;
use crate::lang::types::Base;

impl Lower<'_> {
    /// The matrix from one named space to another, and whether both are known.
    pub(super) fn space_matrix(&mut self, from: Reg, to: Reg) -> (Vec<Reg>, Reg) {
        let same = self.b.known_int(from).is_some() && self.b.known_int(from) == self.b.known_int(to);
        if same {
            let (zero, one) = (self.b.float(0.0), self.b.float(1.0));
            return ((0..16).map(|i| if i % 5 == 0 { one } else { zero }).collect(), self.b.int(1));
        }
        let mut results = self.b.call(Routine::SpaceMatrix, vec![from, to], self.span);
        let found = results.pop().unwrap_or(from);
        (results, found)
    }

    /// `transform(matrix, x)` and `transform(from, to, x)`
    pub(super) fn transform_call(&mut self, a: &[&[Reg]], args: &[Argument]) -> Vec<Reg> {
        let base = args.last().and_then(|arg| arg.ty().base()).unwrap_or(Base::Point);
        let matrix = if a.len() == 3 { self.space_matrix(a[0][0], a[1][0]).0 } else { a[0].to_vec() };
        self.transformed(&matrix, a[a.len() - 1], base)
    }

    /// A point, vector or normal times a matrix.
    pub(super) fn transformed(&mut self, m: &[Reg], v: &[Reg], base: Base) -> Vec<Reg> {
        let matrix = if base == Base::Normal {
            // Normals go by the transpose of the inverse.
            let inverse = self.inverse(m);
            (0..16).map(|i| inverse[4 * (i % 4) + i / 4]).collect()
        } else {
            m.to_vec()
        };
        let row = |c: usize| [matrix[c], matrix[4 + c], matrix[8 + c]];
        if base != Base::Point {
            return (0..3).map(|c| self.dot(v, &row(c))).collect();
        }
        let mut parts = [v[0]; 4];
        for (c, part) in parts.iter_mut().enumerate() {
            let product = self.dot(v, &row(c));
            *part = self.b.binary(Binary::Add, product, matrix[12 + c]);
        }
        let [x, y, z, w] = parts;
        [x, y, z].into_iter().map(|c| self.b.binary(Binary::Div, c, w)).collect()
    }

    /// `point("space", x, y, z)`, `color("hsv", …)`, `matrix("space", …)`
    pub(super) fn construct_in(&mut self, space: &Expr, parts: &[Expr], whole: &Expr) -> Vec<Reg> {
        let exprs: Vec<&Expr> = [space].into_iter().chain(parts).collect();
        let operands = self.operand_regs(&exprs);
        let (space, mut regs) = (operands[0][0], operands[1..].concat());
        self.at(whole.span);
        let base = whole.ty.base().unwrap_or(Base::Point);
        let to = self.symbol(if base == Base::Color { "rgb" } else { "common" });
        match base {
            Base::Color => {
                let src = [space, to].into_iter().chain(regs).collect();
                self.b.call(Routine::Smooth(Smooth::TransformColor), src, self.span)
            }
            Base::Matrix => {
                if regs.len() == 1 {
                    regs = self.convert(&regs, Base::Float, Base::Matrix);
                }
                let (matrix, _) = self.space_matrix(space, to);
                // Differs from the manual, as OSL does: the numbers come before the space on a column vector.
                self.matrix_product(&matrix, &regs)
            }
            _ => {
                let (matrix, _) = self.space_matrix(space, to);
                self.transformed(&matrix, &regs, base)
            }
        }
    }
}
