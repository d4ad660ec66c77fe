//! Dropping an expression without recursion, so that a long chain of operators cannot overflow a stack.

use crate::ast::{Expr, ExprKind};

impl Drop for Expr {
    fn drop(&mut self) {
        if is_flat(&self.kind) {
            return;
        }
        let mut pending = Vec::new();
        take_children(&mut self.kind, &mut pending);
        while let Some(mut expr) = pending.pop() {
            take_children(&mut expr.kind, &mut pending);
        }
    }
}

fn is_leaf(expr: &Expr) -> bool {
    matches!(
        expr.kind,
        ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_) | ExprKind::Name(_) | ExprKind::Error
    )
}

/// True when the children have no children, so that plain dropping is fine.
fn is_flat(kind: &ExprKind) -> bool {
    match kind {
        ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_) | ExprKind::Name(_) | ExprKind::Error => true,
        ExprKind::Unary(_, a) | ExprKind::Cast(_, a) | ExprKind::Field(a, _) => is_leaf(a),
        ExprKind::Step { target, .. } => is_leaf(target),
        ExprKind::Binary(_, a, b) | ExprKind::Assign(_, a, b) | ExprKind::Index(a, b) => is_leaf(a) && is_leaf(b),
        ExprKind::Ternary(a, b, c) => is_leaf(a) && is_leaf(b) && is_leaf(c),
        ExprKind::Comma(list) | ExprKind::Construct(_, list) | ExprKind::Call(_, list) | ExprKind::InitList(list) => {
            list.iter().all(is_leaf)
        }
    }
}

/// Moves the children out, leaving empty nodes behind.
fn take_children(kind: &mut ExprKind, out: &mut Vec<Expr>) {
    let mut take = |expr: &mut Expr| {
        let kind = std::mem::replace(&mut expr.kind, ExprKind::Error);
        out.push(Expr { kind, span: expr.span });
    };
    match kind {
        ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_) | ExprKind::Name(_) | ExprKind::Error => {}
        ExprKind::Unary(_, a) | ExprKind::Cast(_, a) | ExprKind::Field(a, _) => take(a),
        ExprKind::Step { target, .. } => take(target),
        ExprKind::Binary(_, a, b) | ExprKind::Assign(_, a, b) | ExprKind::Index(a, b) => {
            take(a);
            take(b);
        }
        ExprKind::Ternary(a, b, c) => {
            take(a);
            take(b);
            take(c);
        }
        ExprKind::Comma(list) | ExprKind::Construct(_, list) | ExprKind::Call(_, list) | ExprKind::InitList(list) => {
            out.append(list);
        }
    }
}
