//! Initial values: an expression or an initialiser list for a known type.

use super::context::Checker;
use super::typed::{Expr, ExprKind};
use crate::lang::types::{Base, Length, Type};
use velour_grammar::{Diagnostic, ast};

impl Checker<'_> {
    /// A value for a variable of type `ty`. An unsized array takes its length from the list.
    pub fn check_initial(&mut self, init: &ast::Expr, ty: &mut Type) -> Expr {
        let ast::ExprKind::InitList(items) = &init.kind else {
            let value = self.check_expr(init, Some(ty));
            if ty.length == Length::Unsized && value.ty.is_array() && value.ty.element == ty.element {
                ty.length = value.ty.length;
            }
            if ty.is_array() && !value.ty.is_array() {
                return self.single_as_array(value, ty);
            }
            return self.convert(value, ty);
        };
        if items.is_empty() && !self.in_params {
            let diagnostic =
                Diagnostic::error("E0506", init.span, "only the default of a shader parameter may be an empty list");
            self.report(diagnostic.help("write the values, or leave the variable without initialiser"));
            return Expr::error(init.span);
        }
        if ty.length == Length::Unsized {
            ty.length = Length::Fixed(items.len().max(1) as u32);
        }
        let mut parts = self.check_list(items, ty, init);
        if ty.base().is_some() {
            return parts.swap_remove(0);
        }
        Expr::new(ExprKind::Aggregate(parts), ty.clone(), init.span)
    }

    /// `float a[1] = 3` is a list of one.
    fn single_as_array(&mut self, value: Expr, ty: &mut Type) -> Expr {
        let span = value.span;
        if ty.length == Length::Unsized {
            ty.length = Length::Fixed(1);
        }
        let part = self.convert(value, &ty.element_type());
        Expr::new(ExprKind::Aggregate(vec![part]), ty.clone(), span)
    }

    fn check_list(&mut self, items: &[ast::Expr], ty: &Type, whole: &ast::Expr) -> Vec<Expr> {
        let wanted: Vec<Type> = match (ty.is_array(), ty.structure()) {
            (true, _) => vec![ty.element_type(); ty.count()],
            (false, Some(structure)) => structure.fields.iter().map(|(_, ty)| ty.clone()).collect(),
            (false, None) => return self.check_simple_list(items, ty, whole),
        };
        if items.len() > wanted.len() {
            let message = format!("{} values for {} of {} parts", items.len(), ty.named(), wanted.len());
            self.report(Diagnostic::error("E0506", whole.span, message).help("remove the last ones"));
        }
        let mut parts: Vec<Expr> = Vec::new();
        for (item, mut part) in items.iter().zip(wanted.iter().cloned()) {
            parts.push(self.check_initial(item, &mut part));
        }
        // Parts that are not given are zero.
        parts.extend(wanted.iter().skip(items.len()).map(|ty| Expr::new(zero(ty), ty.clone(), whole.span)));
        parts
    }

    /// A list for a triple or a number: the arguments of its constructor.
    fn check_simple_list(&mut self, items: &[ast::Expr], ty: &Type, whole: &ast::Expr) -> Vec<Expr> {
        let built = match ty.base() {
            Some(base) if base.is_triple() || base == Base::Matrix => self.construct(base, items, whole.span),
            Some(_) if items.len() == 1 => {
                let value = self.check_expr(&items[0], Some(ty));
                self.convert(value, ty)
            }
            _ => {
                self.error(
                    "E0506",
                    whole.span,
                    format!("a list of {} values is not {}", items.len(), ty.named()),
                    "give one value",
                );
                Expr::error(whole.span)
            }
        };
        vec![built]
    }
}

/// The zero of a type.
pub(super) fn zero(ty: &Type) -> ExprKind {
    if let (false, Some(structure)) = (ty.is_array(), ty.structure()) {
        let span = velour_grammar::Span::NONE;
        return ExprKind::Aggregate(
            structure.fields.iter().map(|(_, ty)| Expr::new(zero(ty), ty.clone(), span)).collect(),
        );
    }
    match ty.base() {
        Some(Base::Int) => ExprKind::Int(0),
        Some(Base::Float) => ExprKind::Float(0.0),
        Some(Base::String) => ExprKind::String(String::new()),
        Some(_) => {
            let zero = Expr::new(ExprKind::Int(0), Type::INT, velour_grammar::Span::NONE);
            ExprKind::Convert(Box::new(zero))
        }
        None => {
            let element = ty.element_type();
            let one = Expr::new(zero(&element), element, velour_grammar::Span::NONE);
            ExprKind::Aggregate(vec![one; ty.count()])
        }
    }
}
