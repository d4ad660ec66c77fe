//! What the grammar's actions call to build the tree: each takes the parts and works out the span.

// The grammar hands over boxes, as all large symbols of the parser are boxed.
#![allow(clippy::boxed_local, clippy::vec_box)]

use crate::ast::*;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::explain::{Failure, Recovery};
use crate::names::{Name, NameMap};
use crate::span::Span;

/// What the actions gather besides the tree they return.
#[derive(Default)]
pub(crate) struct Context<'s> {
    /// The names so far.
    names: NameMap<&'s str, Name>,
    /// The items so far. They live here and not in the parser's result so that they survive a fatal error.
    pub items: Vec<Item>,
    /// The parse errors that were recovered from, in the order they were met.
    pub failures: Vec<Failure>,
    /// Messages about text that parses but means nothing.
    pub diagnostics: Diagnostics,
}

impl<'s> Context<'s> {
    /// A name, which all its places share.
    pub(crate) fn name(&mut self, text: &'s str) -> Name {
        self.names.entry(text).or_insert_with(|| Name::from(text)).clone()
    }

    /// Notes a parse error whose text has been skipped.
    pub(crate) fn recovered(&mut self, recovery: Recovery<'_>) {
        self.failures.push(Failure::from(recovery));
    }

    /// A closure type. OSL has `closure color` only; any other is reported and read as that.
    pub(crate) fn closure(&mut self, base: TypeName, span: Span) -> TypeSpec {
        if base != TypeName::Color {
            self.diagnostics.push(
                Diagnostic::error("E0304", span, "only `closure color` is a closure type")
                    .label("not a closure type")
                    .help("write `closure color`"),
            );
        }
        TypeSpec { closure: true, base: TypeName::Color, span }
    }
}

/// The span from one token to another.
pub(crate) fn span(first: u32, last: u32) -> Span {
    Span { first, last: last.max(first) }
}

/// What stands between the parentheses of a `for`.
pub(crate) struct ForHead {
    /// The first part.
    pub init: Box<Stmt>,
    /// The second part.
    pub condition: Option<Box<Expr>>,
    /// The third part.
    pub step: Option<Box<Expr>>,
}

/// The elements without their boxes.
pub(crate) fn unboxed<T>(list: Vec<Box<T>>) -> Vec<T> {
    list.into_iter().map(|element| *element).collect()
}

/// An expression from one token to another.
pub(crate) fn expr(kind: ExprKind, first: u32, last: u32) -> Box<Expr> {
    Box::new(Expr { kind, span: span(first, last) })
}

/// A statement from one token to another.
pub(crate) fn stmt(kind: StmtKind, first: u32, last: u32) -> Box<Stmt> {
    Box::new(Stmt { kind, span: span(first, last) })
}

/// A function once its body is known.
pub(crate) fn function(mut head: Box<FunctionDecl>, body: Option<Vec<Stmt>>) -> FunctionDecl {
    head.body = body;
    *head
}

/// A formal parameter.
pub(crate) fn param(output: bool, ty: TypeSpec, d: VarDecl, metadata: Vec<Metadata>) -> Box<Param> {
    Box::new(Param { output, ty, name: d.name, array: d.array, default: d.init, metadata })
}

/// Metadata before and after the formals, as one list.
pub(crate) fn joined(before: Option<Vec<Metadata>>, after: Option<Vec<Metadata>>) -> Vec<Metadata> {
    let mut all = before.unwrap_or_default();
    all.extend(after.unwrap_or_default());
    all
}

/// A name with its brackets and initialiser, of a type that is known later.
pub(crate) fn declarator(name: Ident, array: ArrayLen, init: Option<Box<Expr>>) -> Box<VarDecl> {
    let ty = TypeSpec { closure: false, base: TypeName::Void, span: Span::NONE };
    Box::new(VarDecl { ty, name, array, init })
}

/// A declaration statement.
pub(crate) fn declare(ty: TypeSpec, mut names: Vec<VarDecl>) -> StmtKind {
    if let Some((last, others)) = names.split_last_mut() {
        others.iter_mut().for_each(|name| name.ty = ty.clone());
        last.ty = ty;
    }
    StmtKind::Declare(names)
}

/// An `if`.
pub(crate) fn branch(condition: Box<Expr>, then: Box<Stmt>, otherwise: Option<Box<Stmt>>) -> StmtKind {
    StmtKind::If { condition, then, otherwise }
}

/// A `for`.
pub(crate) fn for_loop(head: Box<ForHead>, body: Box<Stmt>) -> StmtKind {
    let ForHead { init, condition, step } = *head;
    StmtKind::For { init, condition, step, body }
}

/// Operands and the binary operators between them, of which those are joined that nothing to come can part.
pub(crate) struct Chain {
    /// What waits for the operand after it, each binding tighter than the one before.
    waiting: Vec<(Box<Expr>, BinaryOp)>,
    /// The last operand.
    last: Box<Expr>,
}

impl Chain {
    /// A single operand.
    pub(crate) fn of(operand: Box<Expr>) -> Self {
        Chain { waiting: Vec::new(), last: operand }
    }

    /// One more operand: operators are joined from the left, the tighter ones first.
    pub(crate) fn then(mut self, op: BinaryOp, operand: Box<Expr>) -> Self {
        let before = joined_to(&mut self.waiting, self.last, op.tightness());
        self.waiting.push((before, op));
        Chain { waiting: self.waiting, last: operand }
    }

    /// The whole.
    pub(crate) fn expr(mut self) -> Box<Expr> {
        joined_to(&mut self.waiting, self.last, 0)
    }
}

/// An operand with what waits for it and binds at least so tightly.
fn joined_to(waiting: &mut Vec<(Box<Expr>, BinaryOp)>, mut last: Box<Expr>, least: u8) -> Box<Expr> {
    while let Some((a, op)) = waiting.pop_if(|(_, op)| op.tightness() >= least) {
        last = binary(op, a, last);
    }
    last
}

/// `a op b`
fn binary(op: BinaryOp, a: Box<Expr>, b: Box<Expr>) -> Box<Expr> {
    let span = a.span.to(b.span);
    Box::new(Expr { kind: ExprKind::Binary(op, a, b), span })
}

/// `a = b` and its kin.
pub(crate) fn assign(op: Option<BinaryOp>, target: Box<Expr>, value: Box<Expr>) -> Box<Expr> {
    let span = target.span.to(value.span);
    Box::new(Expr { kind: ExprKind::Assign(op, target, value), span })
}

/// `op a`
pub(crate) fn unary(op: UnaryOp, operand: Box<Expr>, first: u32) -> Box<Expr> {
    let last = operand.span.last;
    expr(ExprKind::Unary(op, operand), first, last)
}

/// `(type) a`
pub(crate) fn cast(ty: TypeSpec, operand: Box<Expr>, first: u32) -> Box<Expr> {
    let last = operand.span.last;
    expr(ExprKind::Cast(Box::new(ty), operand), first, last)
}

/// `++a` and `--a`
pub(crate) fn step_before(increment: bool, target: Box<Expr>, first: u32) -> Box<Expr> {
    let last = target.span.last;
    expr(ExprKind::Step { increment, prefix: true, target }, first, last)
}

/// `a++` and `a--`
pub(crate) fn step_after(increment: bool, target: Box<Expr>, last: u32) -> Box<Expr> {
    let first = target.span.first;
    expr(ExprKind::Step { increment, prefix: false, target }, first, last)
}

/// `c ? a : b`
pub(crate) fn ternary(condition: Box<Expr>, a: Box<Expr>, b: Box<Expr>) -> Box<Expr> {
    let span = condition.span.to(b.span);
    Box::new(Expr { kind: ExprKind::Ternary(condition, a, b), span })
}

/// `a, b, c`
pub(crate) fn comma(first: Box<Expr>, rest: Vec<Box<Expr>>) -> Box<Expr> {
    let span = rest.iter().fold(first.span, |span, e| span.to(e.span));
    let mut all = Vec::with_capacity(rest.len() + 1);
    all.push(*first);
    all.extend(rest.into_iter().map(|e| *e));
    Box::new(Expr { kind: ExprKind::Comma(all), span })
}

/// `a[i]`
pub(crate) fn index(base: Box<Expr>, index: Box<Expr>, last: u32) -> Box<Expr> {
    let first = base.span.first;
    expr(ExprKind::Index(base, index), first, last)
}

/// `a.name`
pub(crate) fn field(base: Box<Expr>, name: Ident) -> Box<Expr> {
    let span = base.span.to(name.span);
    Box::new(Expr { kind: ExprKind::Field(base, name), span })
}

/// `(a)`: no node, but the span takes in the parentheses.
pub(crate) fn parenthesised(mut inner: Box<Expr>, first: u32, last: u32) -> Box<Expr> {
    inner.span = span(first, last);
    inner
}
