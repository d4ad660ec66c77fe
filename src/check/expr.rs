//! Expressions: names, indices, fields, casts and constructors.

use super::context::{Checker, Symbol};
use super::convert::{assignable, equivalent, is_number};
use super::notes::Meaning;
use super::typed::{Expr, ExprKind};
use crate::lang::nearest::nearest;
use crate::lang::types::{Base, Length, Type};
use velour_grammar::ast::{self, ArrayLen, Ident, TypeSpec};
use velour_grammar::names::Name;
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    /// Checks an expression. `expected` is the type the surroundings want; it only chooses between overloads.
    pub fn check_expr(&mut self, expr: &ast::Expr, expected: Option<&Type>) -> Expr {
        stacker::maybe_grow(128 << 10, 4 << 20, || self.check_kind(expr, expected))
    }

    fn check_kind(&mut self, expr: &ast::Expr, expected: Option<&Type>) -> Expr {
        let span = expr.span;
        match &expr.kind {
            ast::ExprKind::Int(value) => Expr::new(ExprKind::Int(*value), Type::INT, span),
            ast::ExprKind::Float(value) => Expr::new(ExprKind::Float(*value), Type::FLOAT, span),
            ast::ExprKind::String(value) => Expr::new(ExprKind::String(value.clone()), Type::STRING, span),
            ast::ExprKind::Name(name) => self.check_name(name, span),
            ast::ExprKind::Unary(op, operand) => self.check_unary(*op, operand, expected, span),
            ast::ExprKind::Binary(op, a, b) => self.check_binary(*op, a, b, expected, span),
            ast::ExprKind::Assign(None, target, value) => self.check_assign(target, value, span),
            ast::ExprKind::Assign(Some(op), target, value) => self.check_update(*op, target, value, span),
            ast::ExprKind::Step { increment, prefix, target } => self.check_step(*increment, *prefix, target, span),
            ast::ExprKind::Ternary(c, a, b) => self.check_ternary(c, a, b, expected, span),
            ast::ExprKind::Comma(items) => {
                let last = items.len().saturating_sub(1);
                let check = |(i, item)| self.check_expr(item, if i == last { expected } else { None });
                let items: Vec<Expr> = items.iter().enumerate().map(check).collect();
                let ty = items.last().map_or(Type::VOID, |item| item.ty.clone());
                Expr::new(ExprKind::Comma(items), ty, span)
            }
            ast::ExprKind::Cast(spec, operand) => self.check_cast(spec, operand, span),
            ast::ExprKind::Construct(spec, args) => self.check_construct(spec, args, span),
            ast::ExprKind::Call(name, args) => self.check_call(name, args, expected, span),
            ast::ExprKind::Index(base, index) => self.check_index(base, index, span),
            ast::ExprKind::Field(base, field) => self.check_field(base, field, span),
            ast::ExprKind::InitList(_) => match expected.cloned() {
                Some(mut ty) => self.check_initial(expr, &mut ty),
                None => {
                    self.error(
                        "E0506",
                        span,
                        "an initialiser list needs a variable or a parameter to fill",
                        "declare a variable with this value",
                    );
                    Expr::error(span)
                }
            },
            ast::ExprKind::Error => Expr::error(span),
        }
    }

    fn check_name(&mut self, name: &Name, span: Span) -> Expr {
        match self.lookup(name) {
            Some(Symbol::Var(var)) => {
                let var = *var;
                self.note(span, name, Meaning::Variable(var), false);
                if self.variables[var.0 as usize].ty == Type::VOID {
                    // Its declaration is wrong, which has been said.
                    return Expr::error(span);
                }
                Expr::new(ExprKind::Var(var), self.variables[var.0 as usize].ty.clone(), span)
            }
            Some(_) => {
                self.error(
                    "E0403",
                    span,
                    format!("`{name}` is not a variable"),
                    "a function is called with parentheses; a struct makes a value by `Name(…)`",
                );
                Expr::error(span)
            }
            None => {
                let diagnostic = Diagnostic::error("E0403", span, format!("`{name}` is not declared"));
                let names: Vec<&str> = self.scopes.iter().flat_map(|scope| scope.keys().map(Name::as_str)).collect();
                let help = nearest(name, &names).map(|near| format!("did you mean `{near}`?"));
                let help = help.unwrap_or_else(|| format!("declare it, for example `float {name} = 0;`"));
                self.report(diagnostic.help(help));
                Expr::error(span)
            }
        }
    }

    fn check_ternary(
        &mut self,
        c: &ast::Expr,
        a: &ast::Expr,
        b: &ast::Expr,
        expected: Option<&Type>,
        span: Span,
    ) -> Expr {
        let c = self.check_condition(c);
        let (a, b) = (self.check_expr(a, expected), self.check_expr(b, expected));
        if c.is_error() || a.is_error() || b.is_error() {
            return Expr::error(span);
        }
        let ty = if equivalent(&a.ty, &b.ty) || assignable(&a.ty, &b.ty) {
            a.ty.clone()
        } else if assignable(&b.ty, &a.ty) {
            b.ty.clone()
        } else if a.ty.base() == Some(Base::Closure) || b.ty.base() == Some(Base::Closure) {
            Type::CLOSURE
        } else {
            let message = format!("the two sides of `?:` are {} and {}", a.ty.named(), b.ty.named());
            self.report(Diagnostic::error("E0502", span, message).help("cast one of them"));
            return Expr::error(span);
        };
        let (a, b) = (self.convert(a, &ty), self.convert(b, &ty));
        Expr::new(ExprKind::Ternary(Box::new(c), Box::new(a), Box::new(b)), ty, span)
    }

    fn check_cast(&mut self, spec: &TypeSpec, operand: &ast::Expr, span: Span) -> Expr {
        let to = self.resolve_type(spec, ArrayLen::Single);
        let operand = self.check_expr(operand, Some(&to));
        if operand.is_error() || operand.ty == to {
            return operand;
        }
        let cut = to.base() == Some(Base::Int) && operand.ty.base() == Some(Base::Float);
        if cut || assignable(&to, &operand.ty) {
            return Expr::new(ExprKind::Convert(Box::new(operand)), to, span);
        }
        self.error("E0501", span, format!("{} cannot be cast to {}", operand.ty.named(), to.named()), "numbers cast to triples and matrices, triples to triples; stof() and format() go between numbers and strings");
        Expr::error(span)
    }

    fn check_construct(&mut self, spec: &TypeSpec, args: &[ast::Expr], span: Span) -> Expr {
        let ty = self.resolve_type(spec, ArrayLen::Single);
        match ty.base() {
            Some(base @ (Base::Int | Base::Float | Base::String)) if args.len() == 1 => {
                let value = self.check_expr(&args[0], Some(&ty));
                let cut = base == Base::Int && is_number(&value.ty);
                if value.is_error() || value.ty == ty {
                    return value;
                }
                if cut || assignable(&ty, &value.ty) {
                    return Expr::new(ExprKind::Convert(Box::new(value)), ty, span);
                }
                self.mismatch(&value, &ty)
            }
            Some(base) if base.is_triple() || base == Base::Matrix => self.construct(base, args, span),
            _ => {
                self.error(
                    "E0510",
                    span,
                    format!("{} cannot be made of {} values like this", ty.named(), args.len()),
                    "give one value",
                );
                Expr::error(span)
            }
        }
    }

    /// A triple or matrix from constructor arguments.
    pub fn construct(&mut self, base: Base, args: &[ast::Expr], span: Span) -> Expr {
        let ty = Type::of(base);
        let expected = if args.len() == 1 { ty.clone() } else { Type::FLOAT };
        let mut values: Vec<Expr> = args.iter().map(|arg| self.check_expr(arg, Some(&expected))).collect();
        if values.iter().any(Expr::is_error) {
            return Expr::error(span);
        }
        let count = base.floats();
        let space = values.first().is_some_and(|value| value.ty == Type::STRING);
        let numbers = values.iter().skip(space as usize).all(|value| is_number(&value.ty));
        let fits = |n: usize| n == count || (n == 1 && base == Base::Matrix);
        if !space && values.len() == 1 && assignable(&ty, &values[0].ty) {
            let value = values.swap_remove(0);
            if value.ty == ty {
                return value;
            }
            return Expr::new(ExprKind::Convert(Box::new(value)), ty, span);
        }
        if base == Base::Matrix && values.len() == 2 && space && values[1].ty == Type::STRING {
            let to = Box::new(values.swap_remove(1));
            return Expr::new(ExprKind::SpaceToSpace(Box::new(values.swap_remove(0)), to), ty, span);
        }
        if numbers && fits(values.len() - (space && !values.is_empty()) as usize) {
            let first = space.then(|| values.remove(0));
            let parts: Vec<Expr> = values.into_iter().map(|value| self.convert(value, &Type::FLOAT)).collect();
            let kind = match first {
                Some(space) => ExprKind::ConstructIn(Box::new(space), parts),
                None => ExprKind::Construct(parts),
            };
            return Expr::new(kind, ty, span);
        }
        let given: Vec<String> = values.iter().map(|value| value.ty.to_string()).collect();
        let diagnostic = Diagnostic::error("E0510", span, format!("{ty}({}) cannot be constructed", given.join(", ")));
        self.report(
            diagnostic.help(format!("{} takes one value, {count} floats, or a space name and those", ty.named())),
        );
        Expr::error(span)
    }

    fn check_index(&mut self, base: &ast::Expr, index: &ast::Expr, span: Span) -> Expr {
        let base = self.check_expr(base, None);
        let index = self.check_expr(index, Some(&Type::INT));
        if base.is_error() || index.is_error() {
            return Expr::error(span);
        }
        let index = self.index_value(index, &base.ty);
        if let ExprKind::Index(matrix, row) = &base.kind
            && matrix.ty.base() == Some(Base::Matrix)
        {
            let kind = ExprKind::MatrixElement(matrix.clone(), row.clone(), Box::new(index));
            return Expr::new(kind, Type::FLOAT, span);
        }
        let ty = match base.ty.base() {
            None if base.ty.is_array() => base.ty.element_type(),
            Some(b) if b.is_triple() => Type::FLOAT,
            // A row of a matrix; a second index makes it an element.
            Some(Base::Matrix) => Type::FLOAT.array(Length::Fixed(4)),
            _ => {
                self.error(
                    "E0504",
                    span,
                    format!("{} has no elements", base.ty.named()),
                    "only arrays, triples and matrices have elements",
                );
                return Expr::error(span);
            }
        };
        Expr::new(ExprKind::Index(Box::new(base), Box::new(index)), ty, span)
    }

    /// The index as an int, checked against the bounds when it is a literal.
    pub fn index_value(&mut self, index: Expr, of: &Type) -> Expr {
        let bound = match of.base() {
            Some(Base::Matrix) => 4,
            Some(base) if base.is_triple() => 3,
            _ => of.count(),
        };
        if let ExprKind::Int(value) = index.kind
            && bound > 0
            && (value < 0 || value as usize >= bound)
        {
            let message = format!("index {value} is outside 0..{}", bound - 1);
            let diagnostic = Diagnostic::warning("W0503", index.span, message);
            self.report(diagnostic.help("at run time the nearest element stands for it"));
        }
        self.convert(index, &Type::INT)
    }

    fn check_field(&mut self, base: &ast::Expr, field: &Ident, span: Span) -> Expr {
        let base = self.check_expr(base, None);
        if base.is_error() {
            return base;
        }
        if let Some(component) = component(&base.ty, &field.name) {
            let index = Expr::new(ExprKind::Int(component), Type::INT, field.span);
            return Expr::new(ExprKind::Index(Box::new(base), Box::new(index)), Type::FLOAT, span);
        }
        match self.field_of(&base.ty, field) {
            Some((at, ty)) => Expr::new(ExprKind::Field(Box::new(base), at), ty, span),
            None => Expr::error(span),
        }
    }

    /// Position and type of a struct's field, or a message.
    pub fn field_of(&mut self, ty: &Type, field: &Ident) -> Option<(u32, Type)> {
        let structure = ty.structure().filter(|_| !ty.is_array()).cloned();
        let found = structure.as_ref().and_then(|s| s.fields.iter().position(|(name, _)| *name == field.name));
        if let (Some(structure), Some(at)) = (&structure, found) {
            if let Some(number) = self.notes.as_ref().and_then(|notes| notes.number_of(structure)) {
                self.note(field.span, &field.name, Meaning::Field(number, at as u32), false);
            }
            return Some((at as u32, structure.fields[at].1.clone()));
        }
        let mut diagnostic =
            Diagnostic::error("E0505", field.span, format!("{} has no field `{}`", ty.named(), field.name));
        if let Some(base) = ty.base().filter(|base| base.is_triple()) {
            let names = if base == Base::Color { "r, g and b" } else { "x, y and z" };
            diagnostic = diagnostic.help(format!("its components are {names}"));
        } else if let Some(structure) = structure {
            let names: Vec<&str> = structure.fields.iter().map(|(name, _)| name.as_str()).collect();
            diagnostic = diagnostic.help(format!("its fields are {}", names.join(", ")));
        } else {
            diagnostic = diagnostic.help("only structs have fields and only triples have named components");
        }
        self.report(diagnostic);
        None
    }
}

/// The component a name stands for: `.r .g .b` of a color, `.x .y .z` of the other triples.
pub(super) fn component(ty: &Type, name: &str) -> Option<i32> {
    let names = match ty.base()? {
        Base::Color => ["r", "g", "b"],
        base if base.is_triple() => ["x", "y", "z"],
        _ => return None,
    };
    names.iter().position(|n| *n == name).map(|at| at as i32)
}
