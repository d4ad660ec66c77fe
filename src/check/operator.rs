//! Operators and assignments.

use super::context::Checker;
use super::convert::{equivalent, is_number, is_numeric};
use super::rank::score_type;
use super::typed::{Argument, Expr, ExprKind, FunctionId};
use crate::lang::types::{Base, Type};
use velour_grammar::ast::{self, BinaryOp, UnaryOp};
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    pub(super) fn check_unary(
        &mut self,
        op: UnaryOp,
        operand: &ast::Expr,
        expected: Option<&Type>,
        span: Span,
    ) -> Expr {
        let operand = self.check_expr(operand, if op == UnaryOp::Not { None } else { expected });
        if operand.is_error() {
            return operand;
        }
        let word = match op {
            UnaryOp::Neg => "neg",
            UnaryOp::Not => "not",
            UnaryOp::BitNot => "compl",
            UnaryOp::Plus => "",
        };
        if let Some(call) = self.operator_call(word, &[&operand], span) {
            return call;
        }
        let closure = operand.ty.base() == Some(Base::Closure);
        let ty = match op {
            UnaryOp::Neg | UnaryOp::Plus if closure || is_numeric(&operand.ty) => operand.ty.clone(),
            UnaryOp::BitNot if operand.ty == Type::INT => Type::INT,
            UnaryOp::Not if operand.ty.base().is_some_and(|b| b != Base::Void) => Type::INT,
            _ => {
                let message = format!("`{}` does not take {}", op.symbol(), operand.ty.named());
                self.error("E0502", span, message, ONLY_NUMBERS);
                return Expr::error(span);
            }
        };
        if op == UnaryOp::Plus {
            return operand;
        }
        Expr::new(ExprKind::Unary(op, Box::new(operand)), ty, span)
    }

    pub(super) fn check_binary(
        &mut self,
        op: BinaryOp,
        a: &ast::Expr,
        b: &ast::Expr,
        expected: Option<&Type>,
        span: Span,
    ) -> Expr {
        use BinaryOp::*;
        // An arithmetic operator hands the wish of its surroundings on; a comparison's result says nothing about it.
        let expected = if matches!(op, Add | Sub | Mul | Div | Mod) { expected } else { None };
        let expected = expected.filter(|ty| ty.base() != Some(Base::Closure));
        let (a, b) = (self.check_expr(a, expected), self.check_expr(b, expected));
        self.binary(op, a, b, span)
    }

    /// An operator applied to checked operands.
    pub(super) fn binary(&mut self, op: BinaryOp, a: Expr, b: Expr, span: Span) -> Expr {
        use BinaryOp::*;
        if a.is_error() || b.is_error() {
            return Expr::error(span);
        }
        if let Some(call) = self.operator_call(overload_word(op), &[&a, &b], span) {
            return call;
        }
        let Some(ty) = binary_type(op, &a.ty, &b.ty) else {
            let message = format!("`{}` does not take {} and {}", op.symbol(), a.ty.named(), b.ty.named());
            let mut diagnostic = Diagnostic::error("E0502", span, message);
            diagnostic = diagnostic.help(operator_help(op, &a.ty, &b.ty));
            self.report(diagnostic);
            return Expr::error(span);
        };
        if matches!(op, And | Or) {
            let (a, b) = (self.truth(a), self.truth(b));
            return Expr::new(ExprKind::Binary(op, Box::new(a), Box::new(b)), ty, span);
        }
        let (a, b) = self.harmonise(op, a, b, &ty);
        Expr::new(ExprKind::Binary(op, Box::new(a), Box::new(b)), ty, span)
    }

    /// Converts the operands to what the operator works on. A number beside a triple or matrix stays a number.
    fn harmonise(&mut self, op: BinaryOp, a: Expr, b: Expr, ty: &Type) -> (Expr, Expr) {
        let closure = |e: &Expr| e.ty.base() == Some(Base::Closure);
        if closure(&a) || closure(&b) {
            // `k * closure` is written `closure * k`.
            let (c, k) = if closure(&a) { (a, b) } else { (b, a) };
            let k = if is_number(&k.ty) { self.convert(k, &Type::FLOAT) } else { k };
            return (c, k);
        }
        let comparison = matches!(op, BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge);
        let equality = matches!(op, BinaryOp::Eq | BinaryOp::Ne);
        if comparison || (equality && is_number(&a.ty) && is_number(&b.ty)) || (is_number(ty) && !equality) {
            let to = if a.ty == Type::INT && b.ty == Type::INT { Type::INT } else { Type::FLOAT };
            return (self.convert(a, &to), self.convert(b, &to));
        }
        let spread = |c: &mut Self, e: Expr| if is_number(&e.ty) { c.convert(e, &Type::FLOAT) } else { e };
        (spread(self, a), spread(self, b))
    }

    /// A call of `__operator__word__` when the user declared one for these operands.
    fn operator_call(&mut self, word: &str, operands: &[&Expr], span: Span) -> Option<Expr> {
        if word.is_empty() {
            return None;
        }
        // Operators of the built-in types cannot be taken over.
        if operands.iter().all(|e| e.ty.structure().is_none()) {
            return None;
        }
        let name = format!("__operator__{word}__");
        let score = |id: &FunctionId| {
            let formals = &self.signatures[id.0 as usize].formals;
            let pairs = formals.iter().zip(operands).map(|((ty, output), e)| score_type(ty, &e.ty).filter(|_| !output));
            let sum = pairs.sum::<Option<u32>>().filter(|_| formals.len() == operands.len());
            sum.map(|sum| (sum, *id))
        };
        let found = self.functions_named(&name).iter().rev().filter_map(score).max_by_key(|(sum, _)| *sum);
        let (_, id) = found?;
        let signature = &self.signatures[id.0 as usize];
        let (returns, formals) = (signature.returns.clone(), signature.formals.clone());
        self.note_call(id, span);
        let args = operands.iter().zip(&formals).map(|(&e, (ty, _))| Argument::In(self.convert(e.clone(), ty)));
        let args = args.collect();
        Some(Expr::new(ExprKind::Call(id, args), returns, span))
    }

    pub(super) fn check_assign(&mut self, target: &ast::Expr, value: &ast::Expr, span: Span) -> Expr {
        let place = self.check_place(target);
        let mut ty = place.as_ref().map(|place| place.ty.clone()).unwrap_or(Type::VOID);
        let value = match &place {
            Some(_) => self.check_initial(value, &mut ty),
            None => self.check_expr(value, None),
        };
        match place {
            Some(place) if !value.is_error() => Expr::new(ExprKind::Assign(Box::new(place), Box::new(value)), ty, span),
            _ => Expr::error(span),
        }
    }

    pub(super) fn check_update(&mut self, op: BinaryOp, target: &ast::Expr, value: &ast::Expr, span: Span) -> Expr {
        let place = self.check_place(target);
        let expected = place.as_ref().map(|place| place.ty.clone());
        let value = self.check_expr(value, expected.as_ref());
        let Some(place) = place else { return Expr::error(span) };
        // The operator is checked as `target op value`, then its parts are taken out again. The target has been checked:
        // doing so again would double the work, and the messages, of every level of nested updates.
        let reading = place.reading(&self.variables[place.var.0 as usize].ty, target.span);
        let result = self.binary(op, reading, value, span);
        let ty = place.ty.clone();
        let both_numbers = is_number(&ty) && is_number(&result.ty);
        match result.kind {
            _ if result.is_error() => result,
            ExprKind::Binary(op, _, b) if result.ty == ty || equivalent(&result.ty, &ty) || both_numbers => {
                Expr::new(ExprKind::Update(op, Box::new(place), b), ty, span)
            }
            ExprKind::Call(..) if result.ty == ty => {
                Expr::new(ExprKind::Assign(Box::new(place), Box::new(result)), ty, span)
            }
            _ => {
                let message = format!("`{}=` would turn {} into {}", op.symbol(), ty.named(), result.ty.named());
                self.error("E0502", span, message, "store the result in a variable of its type");
                Expr::error(span)
            }
        }
    }

    pub(super) fn check_step(&mut self, increment: bool, prefix: bool, target: &ast::Expr, span: Span) -> Expr {
        let Some(place) = self.check_place(target) else { return Expr::error(span) };
        let ty = place.ty.clone();
        if !is_numeric(&ty) || ty.base() == Some(Base::Matrix) {
            let symbol = if increment { "++" } else { "--" };
            self.error("E0502", span, format!("`{symbol}` does not take {}", ty.named()), ONLY_NUMBERS);
            return Expr::error(span);
        }
        Expr::new(ExprKind::Step { place: Box::new(place), increment, prefix }, ty, span)
    }
}

const ONLY_NUMBERS: &str = "it takes numbers and triples";

/// The way out when an operator does not take its operands.
fn operator_help(op: BinaryOp, a: &Type, b: &Type) -> String {
    use BinaryOp::*;
    let closure = |ty: &Type| ty.base() == Some(Base::Closure);
    let both = |base| a.base() == Some(base) && b.base() == Some(base);
    match op {
        Mod => "`%` is for ints; use fmod() or mod() for floats".to_owned(),
        _ if both(Base::Closure) => "closures are added, and multiplied by a float or a color".to_owned(),
        _ if closure(a) || closure(b) => {
            "a closure goes with a float or a color by `*`, with a closure by `+`".to_owned()
        }
        _ if a.structure().is_some() || b.structure().is_some() => {
            format!("write a function `__operator__{}__` for them", overload_word(op))
        }
        Add if both(Base::String) => "use concat() to join strings".to_owned(),
        Lt | Le | Gt | Ge => "compare single numbers, or length() or luminance() of triples".to_owned(),
        _ => "cast one of them".to_owned(),
    }
}

/// The middle of the name that overloads an operator.
fn overload_word(op: BinaryOp) -> &'static str {
    use BinaryOp::*;
    match op {
        Add => "add",
        Sub => "sub",
        Mul => "mul",
        Div => "div",
        Mod => "mod",
        Shl => "shl",
        Shr => "shr",
        Lt => "lt",
        Le => "le",
        Gt => "gt",
        Ge => "ge",
        Eq => "eq",
        Ne => "neq",
        BitAnd => "bitand",
        BitXor => "xor",
        BitOr => "bitor",
        And | Or => "",
    }
}

/// The type of `a op b`, or nothing when the operator does not take them.
fn binary_type(op: BinaryOp, a: &Type, b: &Type) -> Option<Type> {
    use BinaryOp::*;
    let (x, y) = (a.base()?, b.base()?);
    let either = |base| x == base || y == base;
    if matches!(op, And | Or) {
        return (x != Base::Void && y != Base::Void).then_some(Type::INT);
    }
    if either(Base::Closure) {
        let factor = |base: Base| base.is_number() || base == Base::Color;
        let product = (x == Base::Closure && factor(y)) || (y == Base::Closure && factor(x));
        return ((op == Add && x == y) || (op == Mul && product)).then_some(Type::CLOSURE);
    }
    let mixed = (is_numeric(a) && y.is_number()) || (x.is_number() && is_numeric(b));
    match op {
        Add | Sub | Mul | Div => arithmetic_type(op, x, y, mixed),
        Mod | BitAnd | BitXor | BitOr | Shl | Shr => (x == Base::Int && y == Base::Int).then_some(Type::INT),
        Eq | Ne => (equivalent(a, b) || mixed).then_some(Type::INT),
        _ => (x.is_number() && y.is_number()).then_some(Type::INT),
    }
}

fn arithmetic_type(op: BinaryOp, x: Base, y: Base, mixed: bool) -> Option<Type> {
    use BinaryOp::*;
    let either = |base| x == base || y == base;
    if either(Base::String) || either(Base::Void) || (matches!(op, Add | Sub) && either(Base::Matrix)) {
        return None;
    }
    if x == y || (x.is_triple() && y.is_triple()) {
        // point - point is a vector, point + vector a point.
        return Some(Type::of(match op {
            Sub if x == Base::Point && y == Base::Point => Base::Vector,
            Add | Sub if either(Base::Point) => Base::Point,
            _ => x,
        }));
    }
    let rank = |base: Base| match base {
        Base::Int => 0,
        Base::Float => 1,
        _ => 2,
    };
    mixed.then(|| Type::of(if rank(x) >= rank(y) { x } else { y }))
}
