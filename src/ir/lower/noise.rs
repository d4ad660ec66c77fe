//! Noise calls, and transformations between named spaces.

use super::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr};
use crate::ir::op::{Binary, IntBinary, Noise, NoiseKind, PrintTo, Routine, Smooth, TextArg, TextFormat, Unary};
use crate::ir::program::{Node, Reg};
use crate::lang::symbols::Symbol;
use crate::lang::types::Base;

impl Lower<'_> {
    /// A call of a noise function, or nothing when it is none.
    pub(super) fn noise_call(&mut self, name: &str, args: &[Argument], call: &Expr) -> Option<Value> {
        let periodic = matches!(name, "pnoise" | "psnoise");
        let named = matches!(name, "noise" | "pnoise") && args[0].ty().base() == Some(Base::String);
        let kind = match name {
            "noise" | "pnoise" => NoiseKind::UPerlin,
            "snoise" | "psnoise" => NoiseKind::Perlin,
            "cellnoise" => NoiseKind::Cell,
            "hashnoise" => NoiseKind::Hash,
            _ => return None,
        };
        let outputs = call.ty.base().map_or(1, Base::floats) as u8;
        let noise = |dims: usize| Noise { kind, dims: dims as u8, outputs, periodic, gradient: false };
        let coordinates =
            args.iter().skip(named as usize).take_while(|arg| arg.ty().base() != Some(Base::String)).count();
        let values = self.arguments(&args[..named as usize + coordinates]);
        let src: Vec<Reg> = values[named as usize..].concat();
        let noise = noise(src.len() / (1 + periodic as usize));
        self.at(call.span);
        if named {
            let name = values[0][0];
            return Some(Value::Regs(self.named_noise(name, noise, &src)));
        }
        Some(Value::Regs(self.noise(noise, &src)))
    }

    fn noise(&mut self, mut noise: Noise, src: &[Reg]) -> Vec<Reg> {
        let dims = noise.dims as usize;
        let mut src = src.to_vec();
        if noise.periodic && matches!(noise.kind, NoiseKind::Cell | NoiseKind::Hash) {
            // What looks at whole cells repeats when its coordinates do.
            src = (0..dims).map(|i| self.wrapped(src[i], src[dims + i])).collect();
            noise.periodic = false;
        }
        self.b.call(Routine::Noise(noise), src, self.span)
    }

    /// A coordinate brought into `0..period`; periods are whole numbers from 1 on.
    fn wrapped(&mut self, x: Reg, period: Reg) -> Reg {
        let one = self.b.float(1.0);
        let whole = self.b.unary(Unary::Floor, period);
        let period = self.b.binary(Binary::Max, whole, one);
        let quotient = self.b.binary(Binary::Div, x, period);
        let rounds = self.b.unary(Unary::Floor, quotient);
        let offset = self.b.binary(Binary::Mul, period, rounds);
        self.b.binary(Binary::Sub, x, offset)
    }

    /// Noise whose kind is a string: known here, or compared with every name when it runs.
    fn named_noise(&mut self, name: Reg, mut noise: Noise, src: &[Reg]) -> Vec<Reg> {
        if let Some(known) = self.b.known_int(name)
            && let Some(kind) =
                NoiseKind::from_name(Symbol(known).text()).filter(|kind| !noise.periodic || kind.repeats())
        {
            noise.kind = kind;
            return self.noise(noise, src);
        }
        let (name, zero) = (self.fixed(name), self.b.float(0.0));
        let src: Vec<Reg> = src.iter().map(|&reg| self.fixed(reg)).collect();
        let result: Vec<Reg> = (0..noise.outputs).map(|_| self.b.copy(zero, true)).collect();
        self.noise_choice(name, noise, &src, &result, NoiseKind::ALL);
        result.into_iter().map(|reg| self.fixed(reg)).collect()
    }

    fn noise_choice(&mut self, name: Reg, mut noise: Noise, src: &[Reg], result: &[Reg], kinds: &[NoiseKind]) {
        let Some((&kind, others)) = kinds.split_first() else {
            let text = "there is no noise \"%s\"".to_owned();
            let format = TextFormat { text, args: vec![TextArg::Strings(1)] };
            self.b.call(Routine::Print(PrintTo::Error, format), vec![name], self.span);
            return;
        };
        if noise.periodic && !kind.repeats() {
            return self.noise_choice(name, noise, src, result, others);
        }
        let mut test = self.b.int(0);
        for text in kind.names() {
            let text = self.symbol(text);
            let same = self.b.int_binary(IntBinary::Eq, name, text);
            test = self.b.int_binary(IntBinary::Or, test, same);
        }
        self.b.open();
        noise.kind = kind;
        let value = self.noise(noise, src);
        self.store(&Value::Regs(result.to_vec()), &Value::Regs(value));
        let then = self.b.close();
        self.b.open();
        self.noise_choice(name, noise, src, result, others);
        let otherwise = self.b.close();
        self.b.push(Node::If(test, then, otherwise));
    }

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
        if self.b.known_float(w) == Some(1.0) {
            return vec![x, y, z];
        }
        [x, y, z].into_iter().map(|c| self.b.binary(Binary::Div, c, w)).collect()
    }

    /// `point("space", x, y, z)`, `color("hsv", …)`, `matrix("space", …)`
    pub(super) fn construct_in(&mut self, space: &Expr, parts: &[Expr], whole: &Expr) -> Vec<Reg> {
        let space = self.reg(space);
        let mut regs: Vec<Reg> = parts.iter().map(|part| self.reg(part)).collect();
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
