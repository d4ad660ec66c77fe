//! Places: the left sides of assignments and the arguments of output parameters.

use super::context::{Checker, Symbol};
use super::expr::component;
use super::notes::Meaning;
use super::typed::{Access, Expr, ExprKind, Place};
use crate::lang::types::{Base, Type};
use velour_grammar::{Diagnostic, ast};

impl Checker<'_> {
    /// The place an expression names, or a message when it names none that may be written.
    pub fn check_place(&mut self, expr: &ast::Expr) -> Option<Place> {
        let place = self.place(expr)?;
        if self.writable[place.var.0 as usize] {
            return Some(place);
        }
        let variable = &self.variables[place.var.0 as usize];
        let (name, declared, global) = (variable.name.clone(), variable.span, variable.global.is_some());
        let diagnostic = if global {
            let message = format!("`{name}` is assigned, a global that shaders usually only read");
            Diagnostic::warning("W0509", expr.span, message)
                .help("the value holds to the end of the shader; a variable says what is meant")
        } else {
            let message = format!("`{name}` is assigned and not marked `output`");
            Diagnostic::warning("W0509", expr.span, message)
                .also(declared, "declared here")
                .help("the caller does not see the new value; mark it `output`, or copy it")
        };
        self.report(diagnostic);
        Some(place)
    }

    fn place(&mut self, expr: &ast::Expr) -> Option<Place> {
        match &expr.kind {
            ast::ExprKind::Name(name) => match self.lookup(name) {
                Some(Symbol::Var(var)) => {
                    let var = *var;
                    self.note(expr.span, name, Meaning::Variable(var), false);
                    let ty = self.variables[var.0 as usize].ty.clone();
                    // Without a type, its declaration is wrong, which has been said.
                    (ty != Type::VOID).then_some(Place { var, path: Vec::new(), ty })
                }
                _ => {
                    self.check_expr(expr, None);
                    None
                }
            },
            ast::ExprKind::Index(base, index) => self.place_index(base, index, expr),
            ast::ExprKind::Field(base, field) => {
                let mut place = self.place(base)?;
                if let Some(at) = component(&place.ty, &field.name) {
                    let at = Expr::new(ExprKind::Int(at), Type::INT, field.span);
                    place.path.push(Access::Component(at));
                    place.ty = Type::FLOAT;
                    return Some(place);
                }
                let (at, ty) = self.field_of(&place.ty, field)?;
                place.path.push(Access::Field(at));
                place.ty = ty;
                Some(place)
            }
            _ => {
                let diagnostic = Diagnostic::error("E0503", expr.span, "this is a value, not a variable");
                self.report(diagnostic.help("store it in a variable first"));
                None
            }
        }
    }

    fn place_index(&mut self, base: &ast::Expr, index: &ast::Expr, whole: &ast::Expr) -> Option<Place> {
        // `m[i][j]` is one step: a matrix has no rows of its own.
        let place = match &base.kind {
            ast::ExprKind::Index(inner, row) => {
                let inner = self.place(inner)?;
                if inner.ty.base() == Some(Base::Matrix) {
                    let row = self.check_expr(row, Some(&Type::INT));
                    let column = self.check_expr(index, Some(&Type::INT));
                    let (row, column) = (self.index_value(row, &inner.ty), self.index_value(column, &inner.ty));
                    let path = inner.path.into_iter().chain([Access::Matrix(row, column)]).collect();
                    return Some(Place { var: inner.var, path, ty: Type::FLOAT });
                }
                self.place_element(inner, row, base)?
            }
            _ => self.place(base)?,
        };
        self.place_element(place, index, whole)
    }

    /// The element of a place that has been found already.
    fn place_element(&mut self, mut place: Place, index: &ast::Expr, whole: &ast::Expr) -> Option<Place> {
        let index = self.check_expr(index, Some(&Type::INT));
        let index = self.index_value(index, &place.ty);
        match place.ty.base() {
            None if place.ty.is_array() => {
                place.ty = place.ty.element_type();
                place.path.push(Access::Element(index));
                Some(place)
            }
            Some(base) if base.is_triple() => {
                place.ty = Type::FLOAT;
                place.path.push(Access::Component(index));
                Some(place)
            }
            _ => {
                self.error(
                    "E0504",
                    whole.span,
                    format!("{} has no elements that can be assigned", place.ty.named()),
                    "only arrays, triples and matrices have elements",
                );
                None
            }
        }
    }
}
