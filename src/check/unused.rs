//! What works and is odd: variables and parameters that nothing reads, or nothing writes. Asked for by `-Wall`.

use super::typed::{Argument, Expr, ExprKind, Place, Shader, Stmt, VarId};
use std::collections::HashSet;
use velour_grammar::{Diagnostic, Diagnostics};

/// Warnings of unused variables, in the order in which those were declared.
pub fn unused(shader: &Shader) -> Diagnostics {
    let mut uses = Uses::default();
    for param in &shader.params {
        uses.given.insert(param.var);
        param.default.iter().for_each(|default| uses.expr(default));
    }
    for function in &shader.functions {
        // Callers give them, and may want what the function leaves in them.
        uses.given.extend(function.params.iter().map(|(var, _)| *var));
        uses.outputs.extend(function.params.iter().map(|(var, _)| *var));
        uses.stmts(&function.body);
    }
    uses.stmts(&shader.body);
    uses.outputs.extend(shader.params.iter().filter(|param| param.output).map(|param| param.var));
    let mut out = Diagnostics::default();
    for (at, variable) in shader.variables.iter().enumerate().filter(|(_, variable)| variable.global.is_none()) {
        let (var, name, span) = (VarId(at as u32), &variable.name, variable.span);
        let [read, written] = [&uses.read, &uses.written].map(|set| set.contains(&var));
        let given = uses.given.contains(&var);
        if !read && !uses.outputs.contains(&var) {
            let what = if given { "parameter" } else { "variable" };
            let message = format!("the {what} `{name}` is never read");
            out.push(Diagnostic::warning("W0507", span, message).label("declared here").help("take it out, or use it"));
        } else if !written && !given {
            let message = format!("the variable `{name}` is read and never written");
            out.push(Diagnostic::warning("W0508", span, message).label("declared here").help("give it a value"));
        }
    }
    out
}

#[derive(Default)]
struct Uses {
    read: HashSet<VarId>,
    written: HashSet<VarId>,
    /// Parameters.
    given: HashSet<VarId>,
    /// What others may read afterwards.
    outputs: HashSet<VarId>,
}

impl Uses {
    fn stmts(&mut self, stmts: &[Stmt]) {
        stmts.iter().for_each(|stmt| self.stmt(stmt));
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match stmt {
            Stmt::Expr(expr) => self.effect(expr),
            Stmt::Return(value) => value.iter().for_each(|value| self.expr(value)),
            Stmt::Declare(var, value) => {
                if let Some(value) = value {
                    self.written.insert(*var);
                    self.expr(value);
                }
            }
            Stmt::Block(body) => self.stmts(body),
            Stmt::If(condition, yes, no) => {
                self.expr(condition);
                self.stmts(yes);
                self.stmts(no);
            }
            Stmt::Loop { init, condition, step, body, .. } => {
                self.stmts(init);
                condition.iter().for_each(|condition| self.expr(condition));
                step.iter().for_each(|step| self.effect(step));
                self.stmts(body);
            }
            Stmt::Break | Stmt::Continue => {}
        }
    }

    /// An expression whose value nobody takes: what it changes is not read by that.
    fn effect(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Assign(place, _) | ExprKind::Update(_, place, _) | ExprKind::Step { place, .. } => {
                self.written.insert(place.var);
                expr.parts(&mut |part| self.expr(part));
            }
            ExprKind::Comma(parts) => parts.iter().for_each(|part| self.effect(part)),
            _ => self.expr(expr),
        }
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Var(var) => {
                self.read.insert(*var);
            }
            // Here the value is taken, so the variable is read too.
            ExprKind::Assign(place, _) | ExprKind::Update(_, place, _) | ExprKind::Step { place, .. } => {
                self.both(place)
            }
            ExprKind::Call(_, args) | ExprKind::Builtin(_, args) => args.iter().for_each(|arg| self.argument(arg)),
            _ => {}
        }
        expr.parts(&mut |part| self.expr(part));
    }

    fn both(&mut self, place: &Place) {
        self.written.insert(place.var);
        self.read.insert(place.var);
    }

    /// What a function writes to may also be read by it.
    fn argument(&mut self, arg: &Argument) {
        if let Argument::Out(place) = arg {
            self.both(place);
        }
    }
}
