//! The rules of differentiation, one an operation, written as instructions.

use super::{Slope, Writer};
use crate::ir::op::*;
use crate::ir::program::*;

impl Writer<'_> {
    /// The derivative of `op` at `a`, where `y` holds `op a`.
    pub(super) fn unary_factor(&mut self, op: Unary, a: Reg, y: Reg) -> Reg {
        let one = self.constant(1.0);
        match op {
            Unary::Neg => self.constant(-1.0),
            Unary::Abs => self.un(Unary::Sign, a),
            Unary::Sqrt => {
                let half = self.constant(0.5);
                self.bin(Binary::Div, half, y)
            }
            Unary::InverseSqrt => {
                let (square, half) = (self.bin(Binary::Mul, y, y), self.constant(-0.5));
                let cube = self.bin(Binary::Mul, square, y);
                self.bin(Binary::Mul, half, cube)
            }
            Unary::Cbrt => {
                let (square, third) = (self.bin(Binary::Mul, y, y), self.constant(1.0 / 3.0));
                self.bin(Binary::Div, third, square)
            }
            Unary::Exp => y,
            Unary::Exp2 => self.scaled(y, std::f32::consts::LN_2),
            Unary::Expm1 => self.bin(Binary::Add, y, one),
            Unary::Log => self.bin(Binary::Div, one, a),
            Unary::Log2 | Unary::Log10 => {
                let log_of_base = if op == Unary::Log2 { std::f32::consts::LN_2 } else { std::f32::consts::LN_10 };
                let scale = self.constant(1.0 / log_of_base);
                self.bin(Binary::Div, scale, a)
            }
            Unary::Sin => self.un(Unary::Cos, a),
            Unary::Cos => {
                let sine = self.un(Unary::Sin, a);
                self.un(Unary::Neg, sine)
            }
            Unary::Tan => {
                let square = self.bin(Binary::Mul, y, y);
                self.bin(Binary::Add, one, square)
            }
            Unary::Sinh => self.un(Unary::Cosh, a),
            Unary::Cosh => self.un(Unary::Sinh, a),
            Unary::Tanh => {
                let square = self.bin(Binary::Mul, y, y);
                self.bin(Binary::Sub, one, square)
            }
            Unary::Erf | Unary::Erfc => self.error_function_factor(op, a),
            Unary::Asin | Unary::Acos | Unary::Atan => self.arc_factor(op, a),
            Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Sign | Unary::Logb => self.zero(),
        }
    }

    fn scaled(&mut self, a: Reg, factor: f32) -> Reg {
        let factor = self.constant(factor);
        self.bin(Binary::Mul, a, factor)
    }

    /// `±2/√π exp(-a²)`
    fn error_function_factor(&mut self, op: Unary, a: Reg) -> Reg {
        let square = self.bin(Binary::Mul, a, a);
        let minus = self.un(Unary::Neg, square);
        let bell = self.un(Unary::Exp, minus);
        let sign = if op == Unary::Erf { 1.0 } else { -1.0 };
        self.scaled(bell, sign * std::f32::consts::FRAC_2_SQRT_PI)
    }

    /// `asin`, `acos`: ±1/√(1-a²); `atan`: 1/(1+a²). At the ends of the domain the derivative counts as zero.
    fn arc_factor(&mut self, op: Unary, a: Reg) -> Reg {
        let one = self.constant(1.0);
        let square = self.bin(Binary::Mul, a, a);
        if op == Unary::Atan {
            let sum = self.bin(Binary::Add, one, square);
            return self.bin(Binary::Div, one, sum);
        }
        let rest = self.bin(Binary::Sub, one, square);
        let root = self.un(Unary::InverseSqrt, rest);
        if op == Unary::Acos { self.un(Unary::Neg, root) } else { root }
    }

    pub(super) fn binary_slope(&mut self, op: Binary, y: Reg, a: Reg, b: Reg) -> Slope {
        let (da, db) = (self.slope(a), self.slope(b));
        if da == [None, None] && db == [None, None] {
            return [None, None];
        }
        match op {
            Binary::Min | Binary::Max => {
                // Of equal operands OSL takes the derivative of the first for min, of the second for max.
                let test = self.program.reg(Kind::Int, false);
                if op == Binary::Min {
                    self.emit(Instr::Compare(Compare::Lt, test, b, a));
                    self.choose(test, b, a)
                } else {
                    self.emit(Instr::Compare(Compare::Gt, test, a, b));
                    self.choose(test, a, b)
                }
            }
            // The derivative of the remainder is taken as that of the dividend, as OSL does.
            Binary::Mod => da,
            Binary::Pow => self.pow_slope(y, a, b, da, db),
            Binary::Step => [None, None],
            Binary::Add | Binary::Sub | Binary::Mul | Binary::Div | Binary::Atan2 => {
                let mut out = [None; 2];
                for (i, slot) in out.iter_mut().enumerate() {
                    *slot = self.linear_slope(op, y, a, b, da[i], db[i]);
                }
                out
            }
        }
    }

    fn linear_slope(&mut self, op: Binary, y: Reg, a: Reg, b: Reg, da: Option<Reg>, db: Option<Reg>) -> Option<Reg> {
        let negative = |w: &mut Self, slope: Option<Reg>| slope.map(|slope| w.un(Unary::Neg, slope));
        match op {
            Binary::Add => self.add(da, db),
            Binary::Sub => {
                let minus = negative(self, db);
                self.add(da, minus)
            }
            Binary::Mul => {
                let (left, right) = (self.mul(da, b), self.mul(db, a));
                self.add(left, right)
            }
            Binary::Div => {
                // (da - y db) / b
                let product = self.mul(db, y);
                let minus = negative(self, product);
                let sum = self.add(da, minus);
                sum.map(|sum| self.bin(Binary::Div, sum, b))
            }
            Binary::Atan2 => {
                // atan2(a, b): (b da - a db) / (a² + b²)
                let (left, right) = (self.mul(da, b), self.mul(db, a));
                let minus = negative(self, right);
                let sum = self.add(left, minus);
                let (aa, bb) = (self.bin(Binary::Mul, a, a), self.bin(Binary::Mul, b, b));
                let square = self.bin(Binary::Add, aa, bb);
                sum.map(|sum| self.bin(Binary::Div, sum, square))
            }
            Binary::Mod | Binary::Pow | Binary::Min | Binary::Max | Binary::Step => None,
        }
    }

    /// `b a^(b-1) da + a^b ln a db`
    fn pow_slope(&mut self, y: Reg, a: Reg, b: Reg, da: Slope, db: Slope) -> Slope {
        let one = self.constant(1.0);
        let less = self.bin(Binary::Sub, b, one);
        let power = self.bin(Binary::Pow, a, less);
        let by_a = self.bin(Binary::Mul, b, power);
        let by_b = if db == [None, None] {
            one
        } else {
            // A base that is not positive has no logarithm; its derivative counts as zero.
            let (log, zero) = (self.un(Unary::Log, a), self.zero());
            let product = self.bin(Binary::Mul, y, log);
            let (positive, safe) = (self.program.reg(Kind::Int, false), self.program.reg(Kind::Float, false));
            self.emit(Instr::Compare(Compare::Gt, positive, a, zero));
            self.emit(Instr::Select(safe, positive, product, zero));
            safe
        };
        let mut out = [None; 2];
        for i in 0..2 {
            let (left, right) = (self.mul(da[i], by_a), self.mul(db[i], by_b));
            out[i] = self.add(left, right);
        }
        out
    }
}
