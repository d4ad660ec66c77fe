//! Operators on registers, by the types of their operands.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::Expr;
use crate::ir::op::{Binary, Compare, IntBinary, IntUnary, Routine, Smooth, Unary};
use crate::ir::program::*;
use crate::lang::types::{Base, Type};
use velour_grammar::ast::{BinaryOp, UnaryOp};

impl Lower<'_> {
    /// Converts the registers of a single value from one base type to another.
    pub(super) fn convert(&mut self, regs: &[Reg], from: Base, to: Base) -> Vec<Reg> {
        match (from, to) {
            _ if from == to || (from.is_triple() && to.is_triple()) => regs.to_vec(),
            (Base::Int, Base::Float) => vec![self.b.int_to_float(regs[0])],
            (Base::Float, Base::Int) => vec![self.b.float_to_int(regs[0])],
            (_, Base::Closure) if from != Base::Closure => vec![self.b.constant(Const::NoClosure)],
            (Base::Int, _) => {
                let float = self.b.int_to_float(regs[0]);
                self.convert(&[float], Base::Float, to)
            }
            (Base::Float, Base::Matrix) => {
                let zero = self.b.float(0.0);
                (0..16).map(|i| if i % 5 == 0 { regs[0] } else { zero }).collect()
            }
            (Base::Float, _) if to.is_triple() => vec![regs[0]; 3],
            _ => regs.to_vec(),
        }
    }

    /// Sum of products of two lists of floats, from the left.
    pub(super) fn dot(&mut self, a: &[Reg], b: &[Reg]) -> Reg {
        let mut products = Vec::new();
        for (&x, &y) in a.iter().zip(b) {
            products.push(self.b.binary(Binary::Mul, x, y));
        }
        let mut sum = products[0];
        for &product in &products[1..] {
            sum = self.b.binary(Binary::Add, sum, product);
        }
        sum
    }

    pub(super) fn unary(&mut self, op: UnaryOp, operand: &Expr) -> Vec<Reg> {
        let regs = self.expr_regs(operand);
        let base = operand.ty.base().unwrap_or(Base::Void);
        match (op, base) {
            (UnaryOp::Plus, _) => regs,
            (UnaryOp::Neg, Base::Closure) => {
                let minus = self.b.float(-1.0);
                vec![self.scaled(regs[0], [minus; 3])]
            }
            (UnaryOp::Neg, Base::Int) => vec![self.b.int_unary(IntUnary::Neg, regs[0])],
            (UnaryOp::Neg, _) => regs.into_iter().map(|reg| self.b.unary(Unary::Neg, reg)).collect(),
            (UnaryOp::BitNot, _) => vec![self.b.int_unary(IntUnary::BitNot, regs[0])],
            (UnaryOp::Not, Base::Int) => vec![self.b.int_unary(IntUnary::Not, regs[0])],
            (UnaryOp::Not, Base::Closure) => {
                if self.b.program.constant(regs[0]) == Some(Const::NoClosure) {
                    return vec![self.b.int(1)];
                }
                let dst = self.b.program.reg(Kind::Int, false);
                self.b.instr(Instr::ClosureAbsent(dst, regs[0]));
                vec![dst]
            }
            (UnaryOp::Not, Base::String) => {
                let empty = self.b.constant(Const::String(0));
                vec![self.b.int_binary(IntBinary::Eq, regs[0], empty)]
            }
            (UnaryOp::Not, _) => {
                let zero = self.b.float(0.0);
                let zeros = vec![zero; regs.len()];
                vec![self.all_equal(&regs, &zeros)]
            }
        }
    }

    /// 1 where all components are equal.
    fn all_equal(&mut self, a: &[Reg], b: &[Reg]) -> Reg {
        let equal = self.each(a, b, |l, a, b| l.b.compare(Compare::Eq, a, b));
        let mut all = equal[0];
        for &next in &equal[1..] {
            all = self.b.int_binary(IntBinary::And, all, next);
        }
        all
    }

    pub(super) fn scaled(&mut self, closure: Reg, weight: [Reg; 3]) -> Reg {
        if self.b.program.constant(closure) == Some(Const::NoClosure) {
            return closure;
        }
        let dst = self.b.program.reg(Kind::Closure, false);
        self.b.instr(Instr::ClosureScale(dst, closure, weight));
        dst
    }

    fn added(&mut self, a: Reg, b: Reg) -> Reg {
        match (self.b.program.constant(a), self.b.program.constant(b)) {
            (Some(Const::NoClosure), _) => b,
            (_, Some(Const::NoClosure)) => a,
            _ => {
                let dst = self.b.program.reg(Kind::Closure, false);
                self.b.instr(Instr::ClosureAdd(dst, a, b));
                dst
            }
        }
    }

    /// `a op b` on registers of the types given; `ty` is the type of the result.
    pub(super) fn binary(&mut self, op: BinaryOp, a: (&[Reg], &Type), b: (&[Reg], &Type), ty: &Type) -> Vec<Reg> {
        let base = |ty: &Type| ty.base().unwrap_or(Base::Void);
        let (x, y) = (base(a.1), base(b.1));
        match (x, y) {
            (Base::Closure, Base::Closure) => vec![self.added(a.0[0], b.0[0])],
            (Base::Closure, _) => {
                let weight = if b.0.len() == 3 { [b.0[0], b.0[1], b.0[2]] } else { [b.0[0]; 3] };
                vec![self.scaled(a.0[0], weight)]
            }
            (Base::Int, Base::Int) | (Base::String, Base::String) => {
                vec![self.b.int_binary(int_op(op), a.0[0], b.0[0])]
            }
            _ => self.float_binary(op, a.0, b.0, x, y, ty),
        }
    }

    fn float_binary(&mut self, op: BinaryOp, a: &[Reg], b: &[Reg], x: Base, y: Base, ty: &Type) -> Vec<Reg> {
        if let Some(compare) = compare_op(op) {
            return vec![self.comparison(op, compare, a, b, x, y)];
        }
        let matrix = Base::Matrix;
        let spread = |l: &mut Self, regs: &[Reg], base: Base| l.convert(regs, base, matrix);
        match (op, x, y) {
            (BinaryOp::Mul, Base::Matrix, Base::Matrix) => self.matrix_product(a, b),
            (BinaryOp::Div, _, Base::Matrix) => {
                let inverse = self.inverse(b);
                if x == matrix {
                    self.matrix_product(a, &inverse)
                } else {
                    self.each(a, &inverse, |l, a, b| l.b.binary(Binary::Mul, a, b))
                }
            }
            _ if ty.base() == Some(matrix) && matches!(op, BinaryOp::Add | BinaryOp::Sub) => {
                let (a, b) = (spread(self, a, x), spread(self, b, y));
                self.each(&a, &b, |l, a, b| l.b.binary(float_op(op), a, b))
            }
            _ => self.each(a, b, |l, a, b| l.b.binary(float_op(op), a, b)),
        }
    }

    fn comparison(&mut self, op: BinaryOp, compare: Compare, a: &[Reg], b: &[Reg], x: Base, y: Base) -> Reg {
        if a.len() == 1 && b.len() == 1 {
            return self.b.compare(compare, a[0], b[0]);
        }
        // A number compares to a matrix as that multiple of the identity, to a triple as three equal numbers.
        let wide = if x == Base::Matrix || y == Base::Matrix { Base::Matrix } else { Base::Color };
        let (a, b) = (self.convert(a, x, wide), self.convert(b, y, wide));
        let equal = self.all_equal(&a, &b);
        if op == BinaryOp::Eq { equal } else { self.b.int_unary(IntUnary::Not, equal) }
    }

    pub(super) fn matrix_product(&mut self, a: &[Reg], b: &[Reg]) -> Vec<Reg> {
        let mut out = Vec::with_capacity(16);
        for row in 0..4 {
            for column in 0..4 {
                let right: Vec<Reg> = (0..4).map(|k| b[4 * k + column]).collect();
                out.push(self.dot(&a[4 * row..4 * row + 4], &right));
            }
        }
        out
    }

    pub(super) fn inverse(&mut self, matrix: &[Reg]) -> Vec<Reg> {
        self.b.call(Routine::Smooth(Smooth::MatrixInverse), matrix.to_vec(), self.span)
    }

    /// `a && b`, `a || b`; the right side runs only where it decides, when running it elsewhere would be seen.
    pub(super) fn logic(&mut self, op: BinaryOp, a: &Expr, b: &Expr) -> Reg {
        let left = self.reg(a);
        let and = op == BinaryOp::And;
        let known = self.b.known_int(left).map(|known| known != 0);
        if let Some(known) = known.filter(|&known| known != and) {
            return self.b.int(known as i32);
        }
        let effects = self.assigned.of_expr(self.shader, b);
        if !effects.seen() && !effects.costly {
            let right = self.reg(b);
            return self.b.int_binary(if and { IntBinary::And } else { IntBinary::Or }, left, right);
        }
        let zero = self.b.int(0);
        let start = self.b.int_binary(IntBinary::Ne, left, zero);
        let result = self.b.copy(start, true);
        let test = if and { start } else { self.b.int_unary(IntUnary::Not, start) };
        self.region(effects.vars, |l| {
            l.b.open();
            let right = l.reg(b);
            let right = l.b.int_binary(IntBinary::Ne, right, zero);
            l.store(&Value::Regs(vec![result]), &Value::Regs(vec![right]));
            let block = l.b.close();
            l.b.push(Node::If(test, block, Block::new()));
        });
        self.fixed(result)
    }
}

fn int_op(op: BinaryOp) -> IntBinary {
    match op {
        BinaryOp::Add => IntBinary::Add,
        BinaryOp::Sub => IntBinary::Sub,
        BinaryOp::Mul => IntBinary::Mul,
        BinaryOp::Div => IntBinary::Div,
        BinaryOp::Mod => IntBinary::Mod,
        BinaryOp::Shl => IntBinary::Shl,
        BinaryOp::Shr => IntBinary::Shr,
        BinaryOp::Lt => IntBinary::Lt,
        BinaryOp::Le => IntBinary::Le,
        BinaryOp::Gt => IntBinary::Gt,
        BinaryOp::Ge => IntBinary::Ge,
        BinaryOp::Eq => IntBinary::Eq,
        BinaryOp::Ne => IntBinary::Ne,
        BinaryOp::BitAnd => IntBinary::BitAnd,
        BinaryOp::BitXor => IntBinary::BitXor,
        BinaryOp::BitOr => IntBinary::BitOr,
        BinaryOp::And => IntBinary::And,
        BinaryOp::Or => IntBinary::Or,
    }
}

fn float_op(op: BinaryOp) -> Binary {
    match op {
        BinaryOp::Add => Binary::Add,
        BinaryOp::Sub => Binary::Sub,
        BinaryOp::Mul => Binary::Mul,
        BinaryOp::Div => Binary::Div,
        // The checker lets no other operator reach floats.
        _ => Binary::Mod,
    }
}

fn compare_op(op: BinaryOp) -> Option<Compare> {
    Some(match op {
        BinaryOp::Lt => Compare::Lt,
        BinaryOp::Le => Compare::Le,
        BinaryOp::Gt => Compare::Gt,
        BinaryOp::Ge => Compare::Ge,
        BinaryOp::Eq => Compare::Eq,
        BinaryOp::Ne => Compare::Ne,
        _ => return None,
    })
}
