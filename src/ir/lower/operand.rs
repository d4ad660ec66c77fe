//! Operands: what an operation works on, and when it is read.
//!
//! An operand that is a variable, or a field of one, is a reference: it is read when the operation runs, after the effects
//! of all operands. Anything else is a value, taken where it stands. So an expression means the same wherever it stands,
//! whether variables are bound or moved there.
//!
//! Decision (2026-11-29): operands are references, because OSL's are: `x + (x = 2)` is 4 and `color(x, x = .25, x)` is grey
//! .25 in renderers that users compare with; instead of values from left to right, as C++ has it since 2017.

use super::place::{Target, indices};
use super::state::{Lower, Name};
use super::value::Value;
use crate::check::typed::{Access, Argument, Expr, ExprKind, Place};
use crate::ir::program::Reg;
use crate::lang::types::Base;
use velour_grammar::Span;

/// An operand whose effects have run.
enum Operand {
    /// Read when the operation runs.
    Named(Name),
    /// Taken already.
    Taken(Value),
}

/// An argument of a call, ready to be used.
pub(super) enum Given {
    /// It is read only.
    In(Value),
    /// It is written, too.
    Out(Target),
}

/// What an operand is before its conversion, which belongs to the operation, and the conversion.
fn bare(expr: &Expr) -> (&Expr, Option<(Base, Base)>) {
    if let ExprKind::Convert(inner) = &expr.kind
        && let (Some(from), Some(to)) = (inner.ty.base(), expr.ty.base())
    {
        return (inner, Some((from, to)));
    }
    (expr, None)
}

impl Lower<'_> {
    /// The name of a place without indices.
    pub(super) fn name_of(&self, place: &Place) -> Option<Name> {
        let mut name = self.resolve(place.var);
        for access in &place.path {
            match access {
                Access::Field(at) => name.fields.push(*at),
                Access::Element(_) | Access::Component(_) | Access::Matrix(..) => return None,
            }
        }
        Some(name)
    }

    /// The variable, or field of one, that an expression is once its effects have run.
    pub(super) fn name(&self, expr: &Expr) -> Option<Name> {
        match &expr.kind {
            ExprKind::Var(var) => Some(self.resolve(*var)),
            ExprKind::Field(base, at) => {
                let mut name = self.name(base)?;
                name.fields.push(*at);
                Some(name)
            }
            ExprKind::Comma(items) => self.name(items.last()?),
            ExprKind::Assign(place, _) | ExprKind::Update(_, place, _) | ExprKind::Step { place, prefix: true, .. } => {
                self.name_of(place)
            }
            // A triple as another kind of triple is the same three numbers.
            ExprKind::Convert(inner) if inner.ty.base()?.is_triple() && expr.ty.base()?.is_triple() => self.name(inner),
            _ => None,
        }
    }

    /// Runs the effects of operands in order and reads all of them after the last. A value that a later operand might
    /// change is copied in between.
    pub(super) fn operands(&mut self, exprs: &[&Expr]) -> Vec<Value> {
        let Some((last, others)) = exprs.split_last() else { return Vec::new() };
        // The effects of the first operand concern no other; not asking for them keeps long sums linear.
        let changing = exprs.iter().skip(1).rposition(|expr| self.changes(expr)).map_or(0, |at| at + 1);
        let mut operands = Vec::new();
        for (at, expr) in others.iter().enumerate() {
            operands.push(self.operand(expr, at < changing));
        }
        operands.push(self.operand(last, false));
        operands.into_iter().map(|operand| self.read(operand)).collect()
    }

    /// The registers of operands of single values.
    pub(super) fn operand_regs(&mut self, exprs: &[&Expr]) -> Vec<Vec<Reg>> {
        let values = self.operands(exprs);
        values.iter().map(|value| self.regs(value)).collect()
    }

    /// Operands of an operator, whose conversions are part of it.
    pub(super) fn bare_regs(&mut self, exprs: &[&Expr]) -> Vec<Vec<Reg>> {
        let parts: Vec<_> = exprs.iter().map(|expr| bare(expr)).collect();
        let inner: Vec<&Expr> = parts.iter().map(|part| part.0).collect();
        let regs = self.operand_regs(&inner);
        let converted = regs.into_iter().zip(parts).map(|(regs, (_, conversion))| match conversion {
            Some((from, to)) => self.convert(&regs, from, to),
            None => regs,
        });
        converted.collect()
    }

    /// A value and the place that an assignment gives it to; the conversion of the value is part of the assignment.
    pub(super) fn with_place(&mut self, value: &Expr, place: &Place, span: Span) -> (Value, Target) {
        let (inner, conversion) = bare(value);
        let exprs: Vec<&Expr> = [inner].into_iter().chain(indices(place)).collect();
        let mut values = self.operands(&exprs).into_iter();
        let mut value = values.next().unwrap_or(Value::Regs(Vec::new()));
        if let Some((from, to)) = conversion {
            let regs = self.regs(&value);
            value = Value::Regs(self.convert(&regs, from, to));
        }
        self.at(span);
        let target = self.target_at(place, &mut values);
        (value, target)
    }

    /// Does running an expression change a variable that outlives it?
    fn changes(&mut self, expr: &Expr) -> bool {
        // Most operands are plain, and asking for their effects would walk them.
        !matches!(expr.kind, ExprKind::Var(_) | ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_))
            && !self.assigned.of_expr(self.shader, expr).vars.is_empty()
    }

    fn operand(&mut self, expr: &Expr, changed: bool) -> Operand {
        let Some(name) = self.name(expr) else {
            let value = self.expr(expr);
            return Operand::Taken(if changed { self.owned(&value, &expr.ty) } else { self.taken(value) });
        };
        self.effects_of_name(expr);
        Operand::Named(name)
    }

    /// An element of an array is read where it stands.
    fn taken(&mut self, value: Value) -> Value {
        match value {
            Value::Item { .. } => Value::Regs(self.regs(&value)),
            Value::Struct(fields) => Value::Struct(fields.into_iter().map(|field| self.taken(field)).collect()),
            Value::Regs(_) | Value::Array { .. } => value,
        }
    }

    /// Runs what an expression with a name does besides naming a variable.
    fn effects_of_name(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Var(_) => {}
            ExprKind::Field(inner, _) | ExprKind::Convert(inner) => self.effects_of_name(inner),
            ExprKind::Comma(items) => {
                let Some((last, others)) = items.split_last() else { return };
                for item in others {
                    self.expr(item);
                }
                self.effects_of_name(last);
            }
            _ => {
                self.expr(expr);
            }
        }
    }

    fn read(&mut self, operand: Operand) -> Value {
        match operand {
            Operand::Named(name) => self.named(&name),
            Operand::Taken(value) => value,
        }
    }

    /// Runs the arguments of a call in order: what is read only as operands, what is written up to its place.
    pub(super) fn given(&mut self, args: &[Argument]) -> Vec<Given> {
        let mut exprs = Vec::new();
        for arg in args {
            match arg {
                Argument::In(expr) => exprs.push(expr),
                Argument::Out(place) => exprs.extend(indices(place)),
            }
        }
        let mut values = self.operands(&exprs).into_iter();
        let mut given = Vec::new();
        for arg in args {
            given.push(match arg {
                Argument::In(_) => Given::In(values.next().unwrap_or(Value::Regs(Vec::new()))),
                Argument::Out(place) => Given::Out(self.target_at(place, &mut values)),
            });
        }
        given
    }

    /// The registers of the arguments that are read only.
    pub(super) fn arguments(&mut self, args: &[Argument]) -> Vec<Vec<Reg>> {
        let exprs: Vec<&Expr> = args.iter().filter_map(Argument::read).collect();
        self.operand_regs(&exprs)
    }
}
