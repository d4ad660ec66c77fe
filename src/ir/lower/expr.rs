//! Expressions.

use super::state::Lower;
use super::value::Value;
use super::watch::{binary, operation};
use crate::check::typed::*;
use crate::ir::op::Input;
use crate::ir::program::*;
use crate::lang::closures::ClosureId;
use crate::lang::globals::Global;
use crate::lang::symbols::Symbol;
use crate::lang::types::{Base, Type};
use velour_grammar::Span;
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
                let regs = self.bare_regs(&[a, b]);
                Value::Regs(self.binary(*op, (&regs[0], &a.ty), (&regs[1], &b.ty), &expr.ty))
            }
            ExprKind::Ternary(c, a, b) => self.ternary(c, a, b, &expr.ty),
            ExprKind::Comma(items) => {
                let mut last = Value::Regs(Vec::new());
                for item in items {
                    last = self.expr(item);
                }
                last
            }
            ExprKind::Assign(place, source) => {
                let (value, target) = self.with_place(source, place, expr.span);
                let value = self.stable(&value);
                self.write(&target, &value);
                self.watch(place.var, &value, operation(source), expr.span);
                value
            }
            ExprKind::Update(op, place, value) => self.update(*op, place, value, expr.span),
            ExprKind::Step { place, increment, prefix } => self.step(place, *increment, *prefix, expr.span),
            ExprKind::Call(id, args) => self.call(*id, args),
            ExprKind::Builtin(name, args) => self.builtin(name, args, expr),
            ExprKind::Closure(id, params, keywords) => single(self.closure(*id, params, keywords, expr)),
            ExprKind::Construct(parts) => {
                let parts: Vec<&Expr> = parts.iter().collect();
                Value::Regs(self.operand_regs(&parts).concat())
            }
            ExprKind::ConstructIn(space, parts) => Value::Regs(self.construct_in(space, parts, expr)),
            ExprKind::SpaceToSpace(from, to) => {
                let names = self.operand_regs(&[from, to]);
                Value::Regs(self.space_matrix(names[0][0], names[1][0]).0)
            }
            ExprKind::Aggregate(parts) => self.aggregate(parts, &expr.ty),
            ExprKind::Index(..) | ExprKind::MatrixElement(..) | ExprKind::Field(..) => self.access(expr),
        }
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

    fn update(&mut self, op: BinaryOp, place: &Place, value: &Expr, span: Span) -> Value {
        let (right, target) = self.with_place(value, place, span);
        let right = self.regs(&right);
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
        self.watch(place.var, &new, binary(op), span);
        self.stable(&new)
    }

    fn step(&mut self, place: &Place, increment: bool, prefix: bool, span: Span) -> Value {
        let target = self.target(place, span);
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
        let exprs: Vec<&Expr> = params.iter().chain(keywords.iter().map(|keyword| &keyword.1)).collect();
        let mut regs = self.operand_regs(&exprs);
        let named = regs.split_off(params.len());
        let params = regs.concat();
        let keywords = keywords.iter().map(|keyword| keyword.0).zip(named).collect();
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

    /// A field, element or component, with all that is indexed on the way to it.
    fn access(&mut self, expr: &Expr) -> Value {
        let (mut way, mut root) = (Vec::new(), expr);
        let mut exprs = Vec::new();
        loop {
            match &root.kind {
                ExprKind::Index(base, index) => {
                    exprs.push(&**index);
                    way.push(root);
                    root = base;
                }
                ExprKind::MatrixElement(base, row, column) => {
                    exprs.extend([&**column, &**row]);
                    way.push(root);
                    root = base;
                }
                ExprKind::Field(base, _) => {
                    way.push(root);
                    root = base;
                }
                _ => break,
            }
        }
        exprs.push(root);
        exprs.reverse();
        let mut values = self.operands(&exprs).into_iter();
        self.at(expr.span);
        let mut value = values.next().unwrap_or(Value::Regs(Vec::new()));
        for step in way.into_iter().rev() {
            value = self.step_into(value, step, &mut values);
        }
        value
    }

    /// One step of an access, by indices that have been computed.
    fn step_into(&mut self, value: Value, step: &Expr, indices: &mut impl Iterator<Item = Value>) -> Value {
        match &step.kind {
            ExprKind::Field(_, at) => value.part(&[*at]).cloned().unwrap_or(value),
            ExprKind::MatrixElement(..) => {
                let (row, column) = (self.next_index(indices), self.next_index(indices));
                let regs = self.regs(&value);
                let index = self.matrix_index(row, column, false);
                Value::Regs(vec![self.known_or_picked(&regs, index)])
            }
            _ => {
                let index = self.next_index(indices);
                let matrix = |base: &Expr| base.ty.base() == Some(Base::Matrix);
                match (&value, &step.kind) {
                    (Value::Array { .. } | Value::Struct(_), _) => self.element(&value, index),
                    (_, ExprKind::Index(base, _)) if matrix(base) => self.matrix_row(&value, index),
                    _ => {
                        let regs = self.regs(&value);
                        let index = self.clamped(index, regs.len() as u32, false);
                        Value::Regs(vec![self.known_or_picked(&regs, index)])
                    }
                }
            }
        }
    }

    /// A row of a matrix as an array of four.
    fn matrix_row(&mut self, matrix: &Value, row: Reg) -> Value {
        let regs = self.regs(matrix);
        let array = self.allocate(&Type::FLOAT.array(crate::lang::types::Length::Fixed(4)), &[]);
        for column in 0..4 {
            let column = self.b.int(column);
            let at = self.matrix_index(row, column, false);
            let element = self.known_or_picked(&regs, at);
            let item = self.element(&array, column);
            self.store(&item, &Value::Regs(vec![element]));
        }
        array
    }

    pub(super) fn known_or_picked(&mut self, regs: &[Reg], index: Reg) -> Reg {
        match self.b.known_int(index) {
            Some(known) => regs[known as usize],
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
        effects.vars.extend(&other.vars);
        let simple = ty.base().is_some();
        if simple && !effects.seen() && !other.seen() && !effects.costly && !other.costly {
            let (a, b) = (self.expr_regs(a), self.expr_regs(b));
            return Value::Regs(self.each(&a, &b, |l, a, b| l.b.select(condition, a, b)));
        }
        let mut result = self.zero(ty);
        self.make_mutable(&mut result);
        self.region(effects.vars, |l| {
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
