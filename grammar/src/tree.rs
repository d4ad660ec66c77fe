//! What the grammar's actions call to build the tree: each takes the parts and works out the span.

use crate::ast::*;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::explain::{Failure, Recovery};
use crate::span::Span;

/// What the actions gather besides the tree they return.
#[derive(Default)]
pub struct Context {
    /// The items so far. They live here and not in the parser's result so that they survive a fatal error.
    pub items: Vec<Item>,
    /// The parse errors that were recovered from, in the order they were met.
    pub failures: Vec<Failure>,
    /// Messages about text that parses but means nothing.
    pub diagnostics: Diagnostics,
}

impl Context {
    /// Takes an item.
    pub fn item(&mut self, item: Option<Item>) {
        self.items.extend(item);
    }

    /// Notes a parse error whose text has been skipped.
    pub fn recovered(&mut self, recovery: Recovery<'_>) {
        self.failures.push(Failure::from(recovery));
    }

    /// A closure type. OSL has `closure color` only; any other is reported and read as that.
    pub fn closure(&mut self, base: TypeName, span: Span) -> TypeSpec {
        if base != TypeName::Color {
            self.diagnostics.push(
                Diagnostic::error("E0304", span, "only `closure color` is a closure type")
                    .label("not a closure type")
                    .help("write `closure color`"),
            );
        }
        TypeSpec {
            closure: true,
            base: TypeName::Color,
            span,
        }
    }
}

/// A name with its brackets and initialiser.
pub struct Declarator {
    /// The name.
    pub name: Ident,
    /// Its array brackets.
    pub array: ArrayLen,
    /// Its initialiser.
    pub init: Option<Expr>,
}

/// The span from one token to another.
pub fn span(first: u32, last: u32) -> Span {
    Span {
        first,
        last: last.max(first),
    }
}

/// An expression from one token to another.
pub fn expr(kind: ExprKind, first: u32, last: u32) -> Expr {
    Expr {
        kind,
        span: span(first, last),
    }
}

/// A statement from one token to another.
pub fn stmt(kind: StmtKind, first: u32, last: u32) -> Stmt {
    Stmt {
        kind,
        span: span(first, last),
    }
}

/// A function once its body is known.
pub fn function(head: FunctionDecl, body: Option<Vec<Stmt>>) -> FunctionDecl {
    FunctionDecl { body, ..head }
}

/// Metadata before and after the formals, as one list.
pub fn joined(before: Option<Vec<Metadata>>, after: Option<Vec<Metadata>>) -> Vec<Metadata> {
    let mut all = before.unwrap_or_default();
    all.extend(after.unwrap_or_default());
    all
}

/// A declaration statement.
pub fn declare(ty: TypeSpec, names: Vec<Declarator>) -> StmtKind {
    let declared = |d: Declarator| VarDecl {
        ty: ty.clone(),
        name: d.name,
        array: d.array,
        init: d.init,
    };
    StmtKind::Declare(names.into_iter().map(declared).collect())
}

/// An `if`.
pub fn branch(condition: Expr, then: Stmt, otherwise: Option<Stmt>) -> StmtKind {
    StmtKind::If {
        condition,
        then: Box::new(then),
        otherwise: otherwise.map(Box::new),
    }
}

/// A `for`.
pub fn for_loop(
    (init, condition, step): (Stmt, Option<Expr>, Option<Expr>),
    body: Stmt,
) -> StmtKind {
    StmtKind::For {
        init: Box::new(init),
        condition,
        step,
        body: Box::new(body),
    }
}

/// `a op b`
pub fn binary(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    let span = a.span.to(b.span);
    Expr {
        kind: ExprKind::Binary(op, Box::new(a), Box::new(b)),
        span,
    }
}

/// `a = b` and its kin.
pub fn assign(op: Option<BinaryOp>, target: Expr, value: Expr) -> Expr {
    let span = target.span.to(value.span);
    Expr {
        kind: ExprKind::Assign(op, Box::new(target), Box::new(value)),
        span,
    }
}

/// `op a`
pub fn unary(op: UnaryOp, operand: Expr, first: u32) -> Expr {
    let last = operand.span.last;
    expr(ExprKind::Unary(op, Box::new(operand)), first, last)
}

/// `(type) a`
pub fn cast(ty: TypeSpec, operand: Expr, first: u32) -> Expr {
    let last = operand.span.last;
    expr(ExprKind::Cast(ty, Box::new(operand)), first, last)
}

/// `++a` and `--a`
pub fn step_before(increment: bool, target: Expr, first: u32) -> Expr {
    let last = target.span.last;
    expr(
        ExprKind::Step {
            increment,
            prefix: true,
            target: Box::new(target),
        },
        first,
        last,
    )
}

/// `a++` and `a--`
pub fn step_after(increment: bool, target: Expr, last: u32) -> Expr {
    let first = target.span.first;
    expr(
        ExprKind::Step {
            increment,
            prefix: false,
            target: Box::new(target),
        },
        first,
        last,
    )
}

/// `c ? a : b`
pub fn ternary(condition: Expr, a: Expr, b: Expr) -> Expr {
    let span = condition.span.to(b.span);
    Expr {
        kind: ExprKind::Ternary(Box::new(condition), Box::new(a), Box::new(b)),
        span,
    }
}

/// `a, b, c`
pub fn comma(first: Expr, rest: Vec<Expr>) -> Expr {
    let span = rest.iter().fold(first.span, |span, e| span.to(e.span));
    let mut all = Vec::with_capacity(rest.len() + 1);
    all.push(first);
    all.extend(rest);
    Expr {
        kind: ExprKind::Comma(all),
        span,
    }
}

/// `a[i]`
pub fn index(base: Expr, index: Expr, last: u32) -> Expr {
    let first = base.span.first;
    expr(
        ExprKind::Index(Box::new(base), Box::new(index)),
        first,
        last,
    )
}

/// `a.name`
pub fn field(base: Expr, name: Ident) -> Expr {
    let span = base.span.to(name.span);
    Expr {
        kind: ExprKind::Field(Box::new(base), name),
        span,
    }
}

/// `(a)`: no node, but the span takes in the parentheses.
pub fn parenthesised(mut inner: Expr, first: u32, last: u32) -> Expr {
    inner.span = span(first, last);
    inner
}
