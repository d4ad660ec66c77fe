//! Expressions.

use super::Lower;
use super::value::Value;
use crate::check::typed::*;
use crate::ir::op::Input;
use crate::ir::program::*;
use crate::lang::closures::ClosureId;
use crate::lang::globals::Global;
use crate::lang::symbols::Symbol;
use crate::lang::types::{Base, Type};
use velour_grammar::ast::BinaryOp;

impl Lower<'_> {
    /// The registers of a single value.
    pub(super) fn expr_regs(&mut self, expr: &Expr) -> Vec<Reg> {
        let value = self.expr(expr);
        self.regs(&value)
    }

    /// The register of a value of one component.
    pub(super) fn reg(&mut self, expr: &Expr) -> Reg {
        self.expr_regs(expr)[0]
    }

    pub(super) fn expr(&mut self, expr: &Expr) -> Value {
        stacker::maybe_grow(128 << 10, 4 << 20, || self.expr_kind(expr))
    }

    fn expr_kind(&mut self, expr: &Expr) -> Value {
        self.at(expr.span);
        let single = |reg| Value::Regs(vec![reg]);
        match &expr.kind {
            ExprKind::Int(value) => single(self.b.int(*value)),
            ExprKind::Float(value) => single(self.b.float(*value)),
            ExprKind::String(text) => single(self.b.constant(Const::String(Symbol::new(text).0))),
            ExprKind::Var(var) => self.variable(*var),
            ExprKind::Convert(operand) => self.conversion(operand, &expr.ty),
            ExprKind::Unary(op, operand) => Value::Regs(self.unary(*op, operand)),
            ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => single(self.logic(*op, a, b)),
            ExprKind::Binary(op, a, b) => {
                let (left, right) = self.pair(a, b);
                Value::Regs(self.binary(*op, (&left, &a.ty), (&right, &b.ty), &expr.ty))
            }
            ExprKind::Ternary(c, a, b) => self.ternary(c, a, b, &expr.ty),
            ExprKind::Comma(items) => {
                let mut last = Value::Regs(Vec::new());
                for item in items {
                    last = self.expr(item);
                }
                last
            }
            ExprKind::Assign(place, value) => {
                let value = self.expr(value);
                let value = self.stable(&value);
                let target = self.target(place);
                self.write(&target, &value);
                value
            }
            ExprKind::Update(op, place, value) => self.update(*op, place, value),
            ExprKind::Step { place, increment, prefix } => self.step(place, *increment, *prefix),
            ExprKind::Call(id, args) => self.call(*id, args),
            ExprKind::Builtin(name, args) => self.builtin(name, args, expr),
            ExprKind::Closure(id, params, keywords) => single(self.closure(*id, params, keywords, expr)),
            ExprKind::Construct(parts) => Value::Regs(parts.iter().map(|part| self.reg(part)).collect()),
            ExprKind::ConstructIn(space, parts) => Value::Regs(self.construct_in(space, parts, expr)),
            ExprKind::SpaceToSpace(from, to) => {
                let (from, to) = (self.reg(from), self.reg(to));
                Value::Regs(self.space_matrix(from, to).0)
            }
            ExprKind::Aggregate(parts) => self.aggregate(parts, &expr.ty),
            ExprKind::Index(base, index) => self.index(base, index),
            ExprKind::MatrixElement(matrix, row, column) => {
                let regs = self.expr_regs(matrix);
                let (row, column) = (self.reg(row), self.reg(column));
                let index = self.matrix_index(row, column);
                single(self.known_or_picked(&regs, index))
            }
            ExprKind::Field(base, at) => match self.expr(base) {
                Value::Struct(mut fields) => fields.swap_remove(*at as usize),
                other => other,
            },
        }
    }

    /// Two operands; the first is kept from changes the second makes.
    pub(super) fn pair(&mut self, a: &Expr, b: &Expr) -> (Vec<Reg>, Vec<Reg>) {
        let mut left = self.expr_regs(a);
        if self.assigned.of_expr(self.shader, b).seen() {
            left = left.into_iter().map(|reg| self.fixed(reg)).collect();
        }
        (left, self.expr_regs(b))
    }

    fn conversion(&mut self, operand: &Expr, to: &Type) -> Value {
        let value = self.expr(operand);
        match (operand.ty.base(), to.base()) {
            (Some(from), Some(to)) => {
                let regs = self.regs(&value);
                Value::Regs(self.convert(&regs, from, to))
            }
            _ => value,
        }
    }

    fn update(&mut self, op: BinaryOp, place: &Place, value: &Expr) -> Value {
        let right = self.expr_regs(value);
        let target = self.target(place);
        let left = self.load(&target);
        let left = self.regs(&left);
        // An int beside a float is computed as floats and cut again.
        let number = |ty: &Type| ty.base().filter(|base| base.is_number());
        let (new, ty) = match (number(&place.ty), number(&value.ty)) {
            (Some(a), Some(b)) if a != b => {
                let (left, right) = (self.convert(&left, a, Base::Float), self.convert(&right, b, Base::Float));
                let float = Type::FLOAT;
                (self.binary(op, (&left, &float), (&right, &float), &float), float)
            }
            _ => (self.binary(op, (&left, &place.ty), (&right, &value.ty), &place.ty), place.ty.clone()),
        };
        let new = match (ty.base(), place.ty.base()) {
            (Some(from), Some(to)) => self.convert(&new, from, to),
            _ => new,
        };
        let new = Value::Regs(new);
        self.write(&target, &new);
        self.stable(&new)
    }

    fn step(&mut self, place: &Place, increment: bool, prefix: bool) -> Value {
        let target = self.target(place);
        let old = self.load(&target);
        let old = self.stable(&old);
        let regs = self.regs(&old);
        let (one, ty) = if place.ty.base() == Some(Base::Int) {
            (self.b.int(1), Type::INT)
        } else {
            (self.b.float(1.0), Type::FLOAT)
        };
        let op = if increment { BinaryOp::Add } else { BinaryOp::Sub };
        let new = self.binary(op, (&regs, &place.ty), (&[one], &ty), &place.ty);
        let new = Value::Regs(new);
        self.write(&target, &new);
        if prefix { new } else { old }
    }

    fn closure(&mut self, closure: ClosureId, params: &[Expr], keywords: &[(u32, Expr)], whole: &Expr) -> Reg {
        let params: Vec<Reg> = params.iter().flat_map(|param| self.expr_regs(param)).collect();
        let keywords = keywords.iter().map(|(at, value)| (*at, self.expr_regs(value))).collect();
        let dst = self.b.program.reg(Kind::Closure, false);
        self.b.instr(Instr::Leaf { dst, closure, params, keywords, span: self.placed(whole.span) });
        dst
    }

    fn aggregate(&mut self, parts: &[Expr], ty: &Type) -> Value {
        if !ty.is_array() {
            let fields = parts.iter().map(|part| {
                let value = self.expr(part);
                self.owned(&value, &part.ty)
            });
            return Value::Struct(fields.collect());
        }
        let array = self.allocate(ty, &[]);
        for (at, part) in parts.iter().enumerate() {
            let value = self.expr(part);
            let index = self.b.int(at as i32);
            let item = self.element(&array, index);
            self.store(&item, &value);
        }
        array
    }

    fn index(&mut self, base: &Expr, index: &Expr) -> Value {
        let value = self.expr(base);
        let index = self.reg(index);
        match (&value, base.ty.base()) {
            (Value::Array { .. } | Value::Struct(_), _) => self.element(&value, index),
            (_, Some(Base::Matrix)) => self.matrix_row(&value, index),
            _ => {
                let regs = self.regs(&value);
                Value::Regs(vec![self.known_or_picked(&regs, index)])
            }
        }
    }

    /// A row of a matrix as an array of four.
    fn matrix_row(&mut self, matrix: &Value, row: Reg) -> Value {
        let regs = self.regs(matrix);
        let array = self.allocate(&Type::FLOAT.array(crate::lang::types::Length::Fixed(4)), &[]);
        for column in 0..4 {
            let column = self.b.int(column);
            let at = self.matrix_index(row, column);
            let element = self.known_or_picked(&regs, at);
            let item = self.element(&array, column);
            self.store(&item, &Value::Regs(vec![element]));
        }
        array
    }

    pub(super) fn known_or_picked(&mut self, regs: &[Reg], index: Reg) -> Reg {
        match self.b.known_int(index) {
            Some(known) => regs[(known.max(0) as usize).min(regs.len() - 1)],
            None => self.pick(regs, index),
        }
    }

    /// The value of a shader global.
    pub(super) fn global(&mut self, global: Global) -> Value {
        if global == Global::Ci {
            return Value::Regs(vec![self.b.constant(Const::NoClosure)]);
        }
        let base = global.ty().base().unwrap_or(Base::Float);
        let component = |c| self.b.input(Input::Global(global, c as u8));
        Value::Regs((0..base.components()).map(component).collect())
    }

    fn ternary(&mut self, c: &Expr, a: &Expr, b: &Expr, ty: &Type) -> Value {
        let condition = self.reg(c);
        if let Some(known) = self.b.known_int(condition) {
            return self.expr(if known != 0 { a } else { b });
        }
        let condition = self.fixed(condition);
        let mut effects = self.assigned.of_expr(self.shader, a);
        let other = self.assigned.of_expr(self.shader, b);
        effects.vars.extend(other.vars.iter().copied());
        let simple = ty.base().is_some();
        if simple && !effects.seen() && !other.seen() && !effects.costly && !other.costly {
            let (a, b) = (self.expr_regs(a), self.expr_regs(b));
            return Value::Regs(self.each(&a, &b, |l, a, b| l.b.select(condition, a, b)));
        }
        let mut result = self.zero(ty);
        self.make_mutable(&mut result);
        self.region(effects.vars.into_iter().collect(), |l| {
            let mut side = |expr| {
                l.b.open();
                let value = l.expr(expr);
                l.store(&result, &value);
                l.b.close()
            };
            let (then, otherwise) = (side(a), side(b));
            l.b.push(Node::If(condition, then, otherwise));
        });
        self.stable(&result)
    }
}
