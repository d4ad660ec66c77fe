//! The words and whole numbers that a shader compares something with: what its modes are chosen by.

use super::typed::{Expr, ExprKind, Shader, Stmt};
use velour_grammar::ast::BinaryOp;

/// What a shader compares with, each once, in the order of its text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compared {
    /// Words.
    pub strings: Vec<String>,
    /// Whole numbers.
    pub ints: Vec<i32>,
}

impl Compared {
    /// The literals that stand on a side of a comparison anywhere in a shader or in what it calls.
    pub fn of(shader: &Shader) -> Self {
        let mut out = Compared::default();
        shader.functions.iter().for_each(|function| out.statements(&function.body));
        out.statements(&shader.body);
        out
    }

    fn statements(&mut self, list: &[Stmt]) {
        for stmt in list {
            match stmt {
                Stmt::Expr(expr) | Stmt::Declare(_, Some(expr)) | Stmt::Return(Some(expr)) => self.expr(expr),
                Stmt::Block(body) => self.statements(body),
                Stmt::If(condition, then, otherwise) => {
                    self.expr(condition);
                    self.statements(then);
                    self.statements(otherwise);
                }
                Stmt::Loop { init, condition, step, body, .. } => {
                    self.statements(init);
                    condition.iter().chain(step).for_each(|expr| self.expr(expr));
                    self.statements(body);
                }
                Stmt::Declare(_, None) | Stmt::Return(None) | Stmt::Break | Stmt::Continue => {}
            }
        }
    }

    fn expr(&mut self, expr: &Expr) {
        if let ExprKind::Binary(op, a, b) = &expr.kind
            && matches!(op, BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge)
        {
            self.literal(a);
            self.literal(b);
        }
        expr.parts(&mut |part| self.expr(part));
    }

    fn literal(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::String(text) if !self.strings.contains(text) => self.strings.push(text.clone()),
            ExprKind::Int(value) if !self.ints.contains(value) => self.ints.push(*value),
            ExprKind::Convert(inner) => self.literal(inner),
            _ => {}
        }
    }
}
