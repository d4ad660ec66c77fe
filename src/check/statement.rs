//! Statements.

use super::context::Checker;
use super::typed::{Expr, ExprKind, Place, Stmt};
use crate::lang::types::{Length, Type};
use velour_grammar::ast::{self, StmtKind, VarDecl};
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    /// Statements of one block; the caller opens the scope.
    pub fn check_block(&mut self, stmts: &[ast::Stmt]) -> Vec<Stmt> {
        let (mut out, outer) = (Vec::new(), std::mem::take(&mut self.hoisted));
        for stmt in stmts {
            let mut own = Vec::new();
            self.check_stmt(stmt, &mut own);
            out.append(&mut self.hoisted);
            out.append(&mut own);
        }
        self.hoisted = outer;
        out
    }

    /// The statement under a condition or a loop. It is no scope of its own unless it is a block, as in OSL: a variable that it declares
    /// lives on after it, and so is declared before.
    fn check_body(&mut self, stmt: &ast::Stmt) -> Vec<Stmt> {
        let mut out = Vec::new();
        stacker::maybe_grow(64 << 10, 1 << 20, || self.check_stmt(stmt, &mut out));
        if !matches!(stmt.kind, StmtKind::Declare(_)) {
            return out;
        }
        let mut assigned = Vec::new();
        for stmt in out {
            let Stmt::Declare(var, init) = stmt else { continue };
            self.hoisted.push(Stmt::Declare(var, None));
            if let Some(init) = init {
                let (ty, span) = (init.ty.clone(), init.span);
                let place = Place { var, path: Vec::new(), ty: ty.clone() };
                let assign = Expr::new(ExprKind::Assign(Box::new(place), Box::new(init)), ty, span);
                assigned.push(Stmt::Expr(assign));
            }
        }
        assigned
    }

    fn check_stmt(&mut self, stmt: &ast::Stmt, out: &mut Vec<Stmt>) {
        match &stmt.kind {
            StmtKind::Empty | StmtKind::Error => {}
            StmtKind::Expr(expr) => {
                let expr = self.check_expr(expr, None);
                out.push(Stmt::Expr(expr));
            }
            StmtKind::Declare(decls) => decls.iter().for_each(|decl| self.check_declaration(decl, out)),
            StmtKind::Function(decl) => self.declare_function(decl),
            StmtKind::Block(stmts) => {
                let body = self.scoped(|c| c.check_block(stmts));
                out.push(Stmt::Block(body));
            }
            StmtKind::If { condition, then, otherwise } => {
                let condition = self.check_condition(condition);
                let then = self.check_body(then);
                let otherwise = otherwise.as_ref().map(|stmt| self.check_body(stmt)).unwrap_or_default();
                out.push(Stmt::If(Box::new(condition), then, otherwise));
            }
            StmtKind::While { condition, body } => {
                let condition = Some(Box::new(self.check_condition(condition)));
                let body = self.check_loop_body(body);
                out.push(Stmt::Loop {
                    init: Vec::new(),
                    condition,
                    step: None,
                    body,
                    test_last: false,
                    span: stmt.span,
                });
            }
            StmtKind::DoWhile { body, condition } => {
                let body = self.check_loop_body(body);
                let condition = Some(Box::new(self.check_condition(condition)));
                out.push(Stmt::Loop {
                    init: Vec::new(),
                    condition,
                    step: None,
                    body,
                    test_last: true,
                    span: stmt.span,
                });
            }
            StmtKind::For { init, condition, step, body } => self.scoped(|c| {
                let mut first = Vec::new();
                c.check_stmt(init, &mut first);
                let condition = condition.as_ref().map(|condition| Box::new(c.check_condition(condition)));
                let step = step.as_ref().map(|step| Box::new(c.check_expr(step, None)));
                let body = c.check_loop_body(body);
                out.push(Stmt::Loop { init: first, condition, step, body, test_last: false, span: stmt.span });
            }),
            StmtKind::Break => self.check_jump(stmt.span, "break", Stmt::Break, out),
            StmtKind::Continue => self.check_jump(stmt.span, "continue", Stmt::Continue, out),
            StmtKind::Return(value) => self.check_return(stmt.span, value.as_deref(), out),
        }
    }

    fn check_loop_body(&mut self, body: &ast::Stmt) -> Vec<Stmt> {
        self.loops += 1;
        let body = self.check_body(body);
        self.loops -= 1;
        body
    }

    fn check_jump(&mut self, span: Span, word: &str, stmt: Stmt, out: &mut Vec<Stmt>) {
        if self.loops == 0 {
            self.error(
                "E0509",
                span,
                format!("`{word}` stands outside a loop"),
                "remove it; `return` leaves a function or the shader",
            );
        }
        out.push(stmt);
    }

    fn check_return(&mut self, span: Span, value: Option<&ast::Expr>, out: &mut Vec<Stmt>) {
        let expected = self.returns.clone();
        let value = match (value, expected) {
            (None, None) => None,
            (None, Some(ty)) if ty == Type::VOID => None,
            (None, Some(ty)) => {
                let diagnostic = Diagnostic::error("E0508", span, format!("this function returns {}", ty.named()));
                self.report(diagnostic.help("write `return value;`"));
                None
            }
            (Some(value), Some(mut ty)) if ty != Type::VOID => Some(self.check_initial(value, &mut ty)),
            (Some(value), _) => {
                self.check_expr(value, None);
                let diagnostic = Diagnostic::error("E0508", span, "nothing can be returned from here");
                self.report(diagnostic.help("write `return;`, or give the function a return type"));
                None
            }
        };
        out.push(Stmt::Return(value));
    }

    fn check_declaration(&mut self, decl: &VarDecl, out: &mut Vec<Stmt>) {
        let mut ty = self.type_of_value(&decl.name.name, &decl.ty, decl.array);
        let init = decl.init.as_ref().map(|init| self.check_initial(init, &mut ty));
        if ty.length == Length::Unsized {
            let diagnostic =
                Diagnostic::error("E0507", decl.name.span, format!("the array `{}` needs a length", decl.name.name));
            self.report(diagnostic.help("write the length in the brackets, or give an initialiser list"));
            ty.length = Length::Fixed(1);
        }
        let var = self.bind(&decl.name.name, ty, decl.name.span, true);
        out.push(Stmt::Declare(var, init));
    }

    /// A condition: any base type, turned into an int that is not zero when true.
    pub fn check_condition(&mut self, expr: &ast::Expr) -> Expr {
        if let ast::ExprKind::Assign(None, ..) = expr.kind {
            let diagnostic = Diagnostic::warning("W0512", expr.span, "an assignment is the condition");
            self.report(diagnostic.label("its new value is tested").help("compare with `==`"));
        }
        let expr = self.check_expr(expr, None);
        self.truth(expr)
    }
}
