//! Builtin functions, each written out as operations on single numbers or as one routine.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind, VarId};
use crate::ir::op::*;
use crate::ir::program::*;
use crate::lang::types::Base;
use velour_grammar::Span;

impl Lower<'_> {
    /// A call of a builtin.
    pub(super) fn builtin(&mut self, name: &'static str, args: &[Argument], call: &Expr) -> Value {
        match name {
            "printf" | "fprintf" | "error" | "warning" | "format" => return self.text_call(name, args, call.span),
            "sincos" | "getmatrix" | "getattribute" | "regex_search" | "regex_match" | "split" => {
                return self.writing_call(name, args, call);
            }
            "arraylength" => {
                let len = self.length_of(&args[0]) as i32;
                return Value::Regs(vec![self.b.int(len)]);
            }
            "isconnected" | "isconstant" => return self.known_about(name, &args[0]),
            "exit" => {
                if let Some(scope) = self.exit {
                    self.b.push(Node::Leave(scope));
                }
                return Value::Regs(Vec::new());
            }
            "spline" | "splineinverse" => return self.spline(name, args, call),
            "bump" | "displace" => return self.move_surface(name, args, call),
            _ => {}
        }
        if let Some(answer) = self.texture_call(name, args, call) {
            return answer;
        }
        if let Some(answer) = self.asking_call(name, args, call) {
            return answer;
        }
        if let Some(noise) = self.noise_call(name, args, call) {
            return noise;
        }
        let values = self.arguments(args);
        let regs: Vec<&[Reg]> = values.iter().map(Vec::as_slice).collect();
        self.at(call.span);
        Value::Regs(self.plain(name, &regs, args, call))
    }

    /// Functions whose arguments are only read.
    fn plain(&mut self, name: &str, a: &[&[Reg]], args: &[Argument], call: &Expr) -> Vec<Reg> {
        let int = call.ty.base() == Some(Base::Int);
        if let Some(op) = unary_named(name).filter(|_| !int && a.len() == 1) {
            return a[0].iter().map(|&reg| self.b.unary(op, reg)).collect();
        }
        if let Some(op) = binary_named(name).filter(|_| !int) {
            return self.each(a[0], a[1], |l, x, y| l.b.binary(op, x, y));
        }
        match name {
            "abs" | "fabs" => vec![self.b.int_unary(IntUnary::Abs, a[0][0])],
            "min" => vec![self.b.int_binary(IntBinary::Min, a[0][0], a[1][0])],
            "max" => vec![self.b.int_binary(IntBinary::Max, a[0][0], a[1][0])],
            "mix" => self.mix(a[0], a[1], a[2]),
            "select" => self.select_call(a, args),
            "smoothstep" => vec![self.smoothstep(a[0][0], a[1][0], a[2][0])],
            "isnan" => vec![self.b.test(Test::Nan, a[0][0])],
            "isinf" => vec![self.b.test(Test::Inf, a[0][0])],
            "isfinite" => vec![self.b.test(Test::Finite, a[0][0])],
            "cross" => self.cross(a[0], a[1]),
            "dot" => vec![self.dot(a[0], a[1])],
            "length" => vec![self.length(a[0])],
            "distance" => {
                let between = self.each(a[0], a[1], |l, x, y| l.b.binary(Binary::Sub, x, y));
                vec![self.length(&between)]
            }
            "normalize" => self.normalize(a[0]),
            "luminance" => {
                let weights = self.shared.options.working_space.luminance_weights().map(|w| self.b.float(w));
                vec![self.dot(a[0], &weights)]
            }
            "transform" => self.transform_call(a, args),
            "determinant" => self.routine(Routine::Smooth(Smooth::Determinant), a),
            "transpose" => (0..16).map(|i| a[0][4 * (i % 4) + i / 4]).collect(),
            "Dx" => a[0].iter().map(|&reg| self.b.derivative(reg, false)).collect(),
            "Dy" => a[0].iter().map(|&reg| self.b.derivative(reg, true)).collect(),
            // There is no third direction on a surface.
            "Dz" => vec![self.b.float(0.0); a[0].len()],
            "filterwidth" => a[0].iter().map(|&reg| self.filterwidth(reg)).collect(),
            "area" => vec![self.area(a[0])],
            "calculatenormal" => self.calculate_normal(a[0]),
            "surfacearea" => vec![self.b.input(Input::SurfaceArea)],
            "backfacing" => vec![self.b.input(Input::Backfacing)],
            _ => self.routine_call(name, a, args),
        }
    }

    /// Functions that are one routine.
    fn routine_call(&mut self, name: &str, a: &[&[Reg]], args: &[Argument]) -> Vec<Reg> {
        let routine = match (name, args.first().and_then(|arg| arg.ty().base())) {
            ("blackbody", _) => Routine::Smooth(Smooth::Blackbody),
            ("wavelength_color", _) => Routine::Smooth(Smooth::WavelengthColor),
            ("transformc", _) => Routine::Smooth(Smooth::TransformColor),
            ("transformu", _) if a.len() == 2 => {
                let common = self.symbol("common");
                return self.routine(Routine::Smooth(Smooth::TransformUnit), &[&[common], a[0], a[1]]);
            }
            ("transformu", _) => Routine::Smooth(Smooth::TransformUnit),
            ("hash", Some(Base::Int)) => Routine::HashInt,
            ("hash", Some(Base::String)) => Routine::HashString,
            ("hash", _) => Routine::HashFloats(a.iter().map(|regs| regs.len() as u32).sum()),
            ("strlen", _) => Routine::Strlen,
            ("getchar", _) => Routine::GetChar,
            ("startswith", _) => Routine::StartsWith,
            ("endswith", _) => Routine::EndsWith,
            ("substr", _) => Routine::Substr,
            ("concat", _) => Routine::Concat,
            ("stof", _) => Routine::Stof,
            ("stoi", _) => Routine::Stoi,
            ("raytype", _) => Routine::RayType,
            // The checker lets no other name pass, and a test compiles every builtin that there is.
            (other, _) => unreachable!("the builtin `{other}` has no routine"),
        };
        self.routine(routine, a)
    }

    fn routine(&mut self, routine: Routine, a: &[&[Reg]]) -> Vec<Reg> {
        self.b.call(routine, a.concat(), self.span)
    }

    pub(super) fn symbol(&mut self, text: &str) -> Reg {
        self.b.constant(Const::String(crate::lang::symbols::Symbol::new(text).0))
    }

    fn mix(&mut self, x: &[Reg], y: &[Reg], a: &[Reg]) -> Vec<Reg> {
        let one = self.b.float(1.0);
        let rest: Vec<Reg> = a.iter().map(|&a| self.b.binary(Binary::Sub, one, a)).collect();
        let left = self.each(x, &rest, |l, x, r| l.b.binary(Binary::Mul, x, r));
        let right = self.each(y, a, |l, y, a| l.b.binary(Binary::Mul, y, a));
        self.each(&left, &right, |l, x, y| l.b.binary(Binary::Add, x, y))
    }

    /// `select(x, y, cond)`: y where cond is not zero.
    fn select_call(&mut self, a: &[&[Reg]], args: &[Argument]) -> Vec<Reg> {
        let int = args[2].ty().base() == Some(Base::Int);
        let zero = self.b.float(0.0);
        let test = |l: &mut Self, &c: &Reg| if int { c } else { l.b.compare(Compare::Ne, c, zero) };
        let conditions: Vec<Reg> = a[2].iter().map(|c| test(self, c)).collect();
        let pick = |i: usize| conditions[if conditions.len() == 1 { 0 } else { i }];
        (0..a[0].len()).map(|i| self.b.select(pick(i), a[1][i], a[0][i])).collect()
    }

    /// 0 below the first edge, 1 from the second on, `3t² - 2t³` between.
    fn smoothstep(&mut self, edge0: Reg, edge1: Reg, x: Reg) -> Reg {
        let (zero, one) = (self.b.float(0.0), self.b.float(1.0));
        let (two, three) = (self.b.float(2.0), self.b.float(3.0));
        let run = self.b.binary(Binary::Sub, x, edge0);
        let width = self.b.binary(Binary::Sub, edge1, edge0);
        let t = self.b.binary(Binary::Div, run, width);
        let twice = self.b.binary(Binary::Mul, two, t);
        let factor = self.b.binary(Binary::Sub, three, twice);
        let square = self.b.binary(Binary::Mul, t, t);
        let inside = self.b.binary(Binary::Mul, factor, square);
        let above = self.b.compare(Compare::Ge, x, edge1);
        let upper = self.b.select(above, one, inside);
        let below = self.b.compare(Compare::Lt, x, edge0);
        self.b.select(below, zero, upper)
    }

    pub(super) fn cross(&mut self, a: &[Reg], b: &[Reg]) -> Vec<Reg> {
        let component = |l: &mut Self, i: usize, j: usize| {
            let x = l.b.binary(Binary::Mul, a[i], b[j]);
            let y = l.b.binary(Binary::Mul, a[j], b[i]);
            l.b.binary(Binary::Sub, x, y)
        };
        vec![component(self, 1, 2), component(self, 2, 0), component(self, 0, 1)]
    }

    pub(super) fn length(&mut self, v: &[Reg]) -> Reg {
        let square = self.dot(v, v);
        self.b.unary(Unary::Sqrt, square)
    }

    pub(super) fn normalize(&mut self, v: &[Reg]) -> Vec<Reg> {
        let length = self.length(v);
        v.iter().map(|&c| self.b.binary(Binary::Div, c, length)).collect()
    }

    fn filterwidth(&mut self, reg: Reg) -> Reg {
        let (x, y) = (self.b.derivative(reg, false), self.b.derivative(reg, true));
        self.length(&[x, y])
    }

    fn area(&mut self, p: &[Reg]) -> Reg {
        let normal = self.calculate_normal(p);
        self.length(&normal)
    }

    pub(super) fn calculate_normal(&mut self, p: &[Reg]) -> Vec<Reg> {
        let dx: Vec<Reg> = p.iter().map(|&reg| self.b.derivative(reg, false)).collect();
        let dy: Vec<Reg> = p.iter().map(|&reg| self.b.derivative(reg, true)).collect();
        self.cross(&dx, &dy)
    }

    /// How many elements an array argument has; the type alone does not say it inside functions that take any length.
    fn length_of(&mut self, arg: &Argument) -> usize {
        let value = match arg {
            Argument::In(expr) => self.expr(expr),
            Argument::Out(place) => {
                let target = self.target(place, Span::NONE);
                self.load(&target)
            }
        };
        value.count()
    }

    /// Is a parameter connected; is a value known before the shader runs?
    fn known_about(&mut self, name: &str, arg: &Argument) -> Value {
        let known = match arg {
            Argument::In(expr) if name == "isconnected" => match root_variable(expr).map(|var| self.origin(var)) {
                // 1 for a parameter that is fed, 2 for one that is read, 3 for both.
                Some(var) => self.connected.contains(&var) as i32 + 2 * self.read.contains(&var) as i32,
                None => 0,
            },
            Argument::In(expr) => {
                let regs = self.expr_regs(expr);
                (!regs.is_empty() && regs.iter().all(|&reg| self.b.program.constant(reg).is_some())) as i32
            }
            Argument::Out(_) => 0,
        };
        Value::Regs(vec![self.b.int(known)])
    }

    /// The variable outside all functions that a variable stands for.
    pub(super) fn origin(&self, var: VarId) -> VarId {
        self.stands_for.get(&var).copied().unwrap_or(var)
    }

    fn spline(&mut self, name: &str, args: &[Argument], call: &Expr) -> Value {
        let exprs: Vec<&Expr> = args.iter().filter_map(Argument::read).collect();
        let values = self.operands(&exprs);
        let Some((array, numbers)) = values.split_last() else { return Value::Regs(Vec::new()) };
        let numbers: Vec<Reg> = numbers.iter().flat_map(|value| self.regs(value)).collect();
        let knots: Vec<Vec<Reg>> = self.elements(array).iter().map(|knot| self.regs(knot)).collect();
        let count = numbers.get(2).copied().unwrap_or_else(|| self.b.int(knots.len() as i32));
        let components = call.ty.base().map_or(1, Base::floats);
        let mut out = Vec::new();
        for c in 0..components {
            let src: Vec<Reg> =
                [numbers[0], numbers[1], count].into_iter().chain(knots.iter().map(|knot| knot[c])).collect();
            let count = knots.len() as u32;
            let function = if name == "spline" { Smooth::Spline(count) } else { Smooth::SplineInverse(count) };
            out.push(self.b.call(Routine::Smooth(function), src, self.span)[0]);
        }
        Value::Regs(out)
    }
}

/// The variable an expression is, or is a field of.
pub(super) fn root_variable(expr: &Expr) -> Option<VarId> {
    let mut expr = expr;
    loop {
        match &expr.kind {
            ExprKind::Var(var) => return Some(*var),
            ExprKind::Field(base, _) => expr = base,
            _ => return None,
        }
    }
}

fn unary_named(name: &str) -> Option<Unary> {
    Some(match name {
        "sqrt" => Unary::Sqrt,
        "inversesqrt" => Unary::InverseSqrt,
        "cbrt" => Unary::Cbrt,
        "exp" => Unary::Exp,
        "exp2" => Unary::Exp2,
        "expm1" => Unary::Expm1,
        "log" => Unary::Log,
        "log2" => Unary::Log2,
        "log10" => Unary::Log10,
        "logb" => Unary::Logb,
        "sin" => Unary::Sin,
        "cos" => Unary::Cos,
        "tan" => Unary::Tan,
        "asin" => Unary::Asin,
        "acos" => Unary::Acos,
        "atan" => Unary::Atan,
        "sinh" => Unary::Sinh,
        "cosh" => Unary::Cosh,
        "tanh" => Unary::Tanh,
        "erf" => Unary::Erf,
        "erfc" => Unary::Erfc,
        "floor" => Unary::Floor,
        "ceil" => Unary::Ceil,
        "round" => Unary::Round,
        "trunc" => Unary::Trunc,
        "sign" => Unary::Sign,
        "abs" | "fabs" => Unary::Abs,
        _ => return None,
    })
}

fn binary_named(name: &str) -> Option<Binary> {
    Some(match name {
        "pow" => Binary::Pow,
        "fmod" => Binary::Mod,
        "atan2" => Binary::Atan2,
        "min" => Binary::Min,
        "max" => Binary::Max,
        "step" => Binary::Step,
        _ => return None,
    })
}
