//! Statements.

use super::assigned::Effects;
use super::state::Lower;
use super::watch::operation;
use crate::check::typed::*;
use crate::ir::program::Node;
use velour_grammar::Span;

impl Lower<'_> {
    pub(super) fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            if self.b.is_full() {
                return;
            }
            self.stmt(stmt);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match stmt {
            Stmt::Expr(expr) => {
                self.expr(expr);
            }
            Stmt::Declare(var, init) => {
                let ty = self.shader.variables[var.0 as usize].ty.clone();
                let value = match init {
                    Some(init) => {
                        let value = self.expr(init);
                        let value = self.owned(&value, &ty);
                        self.watch(*var, &value, operation(init), init.span);
                        value
                    }
                    None => self.zero(&ty),
                };
                self.bind(*var, value);
            }
            Stmt::Block(body) => self.stmts(body),
            Stmt::If(condition, then, otherwise) => self.if_stmt(condition, then, otherwise),
            Stmt::Loop { init, condition, step, body, test_last, span } => {
                self.stmts(init);
                let tested = (condition.as_deref(), *test_last);
                self.loop_stmt(tested, step.as_deref(), body, *span);
            }
            Stmt::Break => {
                if let Some(&(scope, _)) = self.loops.last() {
                    self.b.push(Node::Leave(scope));
                }
            }
            Stmt::Continue => {
                if let Some(&(_, scope)) = self.loops.last() {
                    self.b.push(Node::Leave(scope));
                }
            }
            Stmt::Return(value) => self.return_stmt(value.as_ref()),
        }
    }

    fn effects(&mut self, stmts: &[Stmt], into: &mut Effects) {
        let effects = self.assigned.of_stmts(self.shader, stmts);
        into.vars.extend(effects.vars);
        into.returns |= effects.returns;
        into.exits |= effects.exits;
    }

    fn if_stmt(&mut self, condition: &Expr, then: &[Stmt], otherwise: &[Stmt]) {
        let condition = self.reg(condition);
        if let Some(known) = self.b.known_int(condition) {
            return self.stmts(if known != 0 { then } else { otherwise });
        }
        let condition = self.fixed(condition);
        let mut effects = Effects::default();
        self.effects(then, &mut effects);
        self.effects(otherwise, &mut effects);
        self.region(effects.vars, |l| {
            l.b.open();
            l.stmts(then);
            let then = l.b.close();
            l.b.open();
            l.stmts(otherwise);
            let otherwise = l.b.close();
            l.b.push(Node::If(condition, then, otherwise));
        });
    }

    fn loop_stmt(&mut self, tested: (Option<&Expr>, bool), step: Option<&Expr>, body: &[Stmt], span: Span) {
        let (condition, test_last) = tested;
        let mut effects = Effects::default();
        self.effects(body, &mut effects);
        for expr in condition.into_iter().chain(step) {
            effects.vars.extend(self.assigned.of_expr(self.shader, expr).vars);
        }
        let span = self.placed(span);
        let (leave, next) = (self.b.scope(), self.b.scope());
        self.region(effects.vars, |l| {
            l.loops.push((leave, next));
            l.b.open();
            l.b.open();
            if test_last {
                l.loop_body(body, next);
            }
            let test = match condition {
                Some(condition) => l.reg(condition),
                None => l.b.int(1),
            };
            let head = l.b.close();
            l.b.open();
            if !test_last {
                l.loop_body(body, next);
            }
            if let Some(step) = step {
                l.expr(step);
            }
            let body = l.b.close();
            l.b.push(Node::Loop { head, condition: test, body, span });
            let scope = l.b.close();
            l.b.push(Node::Scope(leave, scope));
            l.loops.pop();
        });
    }

    fn loop_body(&mut self, body: &[Stmt], next: crate::ir::program::ScopeId) {
        self.b.open();
        self.level += 1;
        self.stmts(body);
        self.level -= 1;
        let body = self.b.close();
        self.b.push(Node::Scope(next, body));
    }

    fn return_stmt(&mut self, value: Option<&Expr>) {
        let value = value.map(|value| self.expr(value));
        let Some(frame) = self.frames.last() else { return };
        let (scope, result) = (frame.scope, frame.result.clone());
        if let (Some(result), Some(value)) = (result, value) {
            self.store(&result, &value);
        }
        if let Some(scope) = scope {
            self.b.push(Node::Leave(scope));
        }
    }
}
