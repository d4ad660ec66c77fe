//! Which type converts to which, and the conversions written out.

use super::context::Checker;
use super::typed::{Expr, ExprKind};
use crate::lang::types::{Base, Length, Type};
use velour_grammar::Diagnostic;
use velour_grammar::ast::UnaryOp;

/// True for types that hold the same numbers: equal ones, and any two triples.
pub(super) fn equivalent(a: &Type, b: &Type) -> bool {
    a == b || matches!((a.base(), b.base()), (Some(a), Some(b)) if a.is_triple() && b.is_triple())
}

/// True for int, float, triples and matrix.
pub(super) fn is_numeric(ty: &Type) -> bool {
    ty.base().is_some_and(|base| base.is_number() || base.is_triple() || base == Base::Matrix)
}

/// True for int and float.
pub(super) fn is_number(ty: &Type) -> bool {
    ty.base().is_some_and(Base::is_number)
}

/// True when a value of type `from` may stand where `to` is wanted, without a cast.
pub(super) fn assignable(to: &Type, from: &Type) -> bool {
    if equivalent(to, from) {
        return true;
    }
    match (to.base(), from.base()) {
        (Some(Base::Int), Some(Base::Float)) => false,
        (Some(_), Some(_)) => is_numeric(to) && is_number(from),
        _ => to.is_array() && to.element == from.element && to.length == Length::Unsized && from.is_array(),
    }
}

/// The way out when a value is of the wrong type.
fn mismatch_help(to: &Type, from: &Type) -> &'static str {
    match (to.base(), from.base()) {
        (Some(Base::String), Some(base)) if base.is_number() => "format(\"%g\", value) makes a string of a number",
        (Some(base), Some(Base::String)) if base.is_number() => "stof() and stoi() read a number from a string",
        (Some(Base::Float | Base::Int), Some(base)) if base.is_triple() => "take one component, for example `[0]`",
        (None, _) if to.structure().is_some() => "a struct is made by its name, `Name(…)`, or by a list `{ … }`",
        (None, _) => "an array is made by a list `{ … }`",
        (_, None) => "name one of its elements or fields",
        _ => "build it from numbers with its constructor",
    }
}

impl Checker<'_> {
    /// The expression as type `to`, or a message and a stand-in.
    pub fn convert(&mut self, expr: Expr, to: &Type) -> Expr {
        if expr.is_error() || *to == Type::VOID || expr.ty == *to {
            return expr;
        }
        let span = expr.span;
        let null = matches!(expr.kind, ExprKind::Int(0)) || matches!(expr.kind, ExprKind::Float(zero) if zero == 0.0);
        if null && to.base() == Some(Base::Closure) {
            return Expr::new(ExprKind::Convert(Box::new(expr)), to.clone(), span);
        }
        let narrowing = to.base() == Some(Base::Int) && expr.ty.base() == Some(Base::Float);
        if narrowing {
            let diagnostic = Diagnostic::warning("W0501", span, "a float is cut to an int here");
            self.report(diagnostic.help("write `(int)` in front of it when that is meant"));
        } else if to.is_array() && to.element == expr.ty.element && expr.ty.is_array() {
            // The shorter of the two sets how many elements are copied.
            return expr;
        } else if !assignable(to, &expr.ty) {
            return self.mismatch(&expr, to);
        }
        Expr::new(ExprKind::Convert(Box::new(expr)), to.clone(), span)
    }

    pub fn mismatch(&mut self, expr: &Expr, to: &Type) -> Expr {
        let message = format!("{} is needed here, this is {}", to.named(), expr.ty.named());
        let mut diagnostic = Diagnostic::error("E0501", expr.span, message);
        if to.base() == Some(Base::Closure) {
            diagnostic = diagnostic.help("multiply it by a closure, for example `emission()`");
        } else if expr.ty.base() == Some(Base::Closure) {
            diagnostic = diagnostic.help("a closure is not a color: only `Ci` and other closures can hold it");
        } else {
            diagnostic = diagnostic.help(mismatch_help(to, &expr.ty));
        }
        self.report(diagnostic);
        Expr::error(expr.span)
    }

    /// The expression as a truth value: an int that is not zero when true.
    pub fn truth(&mut self, expr: Expr) -> Expr {
        match expr.ty.base() {
            Some(Base::Int) => expr,
            _ if expr.is_error() => expr,
            Some(Base::Void) | None => {
                let message = format!("{} is neither true nor false", expr.ty.named());
                self.error("E0501", expr.span, message, "compare it, or a part of it, with something");
                Expr::error(expr.span)
            }
            Some(_) => {
                let span = expr.span;
                let not = Expr::new(ExprKind::Unary(UnaryOp::Not, Box::new(expr)), Type::INT, span);
                Expr::new(ExprKind::Unary(UnaryOp::Not, Box::new(not)), Type::INT, span)
            }
        }
    }
}
