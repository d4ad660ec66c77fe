//! The words and whole numbers that a shader compares something with: what its modes are chosen by.

use super::typed::{Access, Argument, Expr, ExprKind, Place, Shader, Stmt};
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
        match &expr.kind {
            ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_) | ExprKind::Var(_) => {}
            ExprKind::Step { place, .. } => self.place(place),
            ExprKind::Convert(a) | ExprKind::Unary(_, a) | ExprKind::Field(a, _) => self.expr(a),
            ExprKind::Assign(place, a) | ExprKind::Update(_, place, a) => {
                self.place(place);
                self.expr(a);
            }
            ExprKind::Binary(op, a, b) => {
                let compares = matches!(
                    op,
                    BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge
                );
                if compares {
                    self.literal(a);
                    self.literal(b);
                }
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Index(a, b) | ExprKind::SpaceToSpace(a, b) => [a, b].into_iter().for_each(|e| self.expr(e)),
            ExprKind::Ternary(a, b, c) | ExprKind::MatrixElement(a, b, c) => {
                [a, b, c].into_iter().for_each(|e| self.expr(e));
            }
            ExprKind::Comma(list) | ExprKind::Construct(list) | ExprKind::Aggregate(list) => {
                list.iter().for_each(|e| self.expr(e));
            }
            ExprKind::ConstructIn(space, list) => {
                self.expr(space);
                list.iter().for_each(|e| self.expr(e));
            }
            ExprKind::Call(_, arguments) | ExprKind::Builtin(_, arguments) => {
                for argument in arguments {
                    match argument {
                        Argument::In(expr) => self.expr(expr),
                        Argument::Out(place) => self.place(place),
                    }
                }
            }
            ExprKind::Closure(_, params, keywords) => {
                params.iter().chain(keywords.iter().map(|(_, value)| value)).for_each(|e| self.expr(e));
            }
        }
    }

    fn place(&mut self, place: &Place) {
        for access in &place.path {
            match access {
                Access::Field(_) => {}
                Access::Element(a) | Access::Component(a) => self.expr(a),
                Access::Matrix(a, b) => [a, b].into_iter().for_each(|e| self.expr(e)),
            }
        }
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
