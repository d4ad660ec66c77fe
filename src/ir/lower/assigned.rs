//! Which variables a piece of code assigns, and whether it has effects: what must be known before lanes part.

use crate::check::typed::*;
use crate::lang::globals::Global;
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

/// What a piece of code does besides computing a value.
#[derive(Clone, Debug, Default)]
pub(super) struct Effects {
    /// Variables it assigns, in functions it calls too but for their own.
    pub(super) vars: BTreeSet<VarId>,
    /// Variables it declares, but for those of called functions; they end with it.
    pub(super) declared: BTreeSet<VarId>,
    /// True when it prints, reports, or changes what is answered later.
    pub(super) prints: bool,
    /// True when it can call `exit()`.
    pub(super) exits: bool,
    /// True when it returns from the body it stands in.
    pub(super) returns: bool,
    /// True when it traces rays.
    pub(super) traces: bool,
    /// True when it can call `error()`.
    pub(super) errors: bool,
    /// True when it is worth skipping in lanes that do not need it.
    pub(super) costly: bool,
}

/// Computes effects, remembering those of functions.
#[derive(Default)]
pub(super) struct Assigned {
    functions: HashMap<FunctionId, Rc<Effects>>,
}

impl Effects {
    /// True when running the code in a lane that does not need it would be seen.
    pub(super) fn seen(&self) -> bool {
        !self.vars.is_empty() || self.prints || self.exits
    }
}

impl Assigned {
    /// Effects of statements.
    pub(super) fn of_stmts(&mut self, shader: &Shader, stmts: &[Stmt]) -> Effects {
        let mut effects = Effects::default();
        self.stmts(shader, stmts, &mut effects);
        effects
    }

    /// Effects of an expression.
    pub(super) fn of_expr(&mut self, shader: &Shader, expr: &Expr) -> Effects {
        let mut effects = Effects::default();
        self.expr(shader, expr, &mut effects);
        effects
    }

    /// Effects of a function's body; its own return stays inside it.
    pub(super) fn of_function(&mut self, shader: &Shader, id: FunctionId) -> Rc<Effects> {
        if let Some(known) = self.functions.get(&id) {
            return known.clone();
        }
        let mut effects = self.of_stmts(shader, &shader.functions[id.0 as usize].body);
        effects.returns = false;
        effects.declared.extend(shader.functions[id.0 as usize].params.iter().map(|param| param.0));
        let effects = Rc::new(effects);
        self.functions.insert(id, effects.clone());
        effects
    }

    fn stmts(&mut self, shader: &Shader, stmts: &[Stmt], out: &mut Effects) {
        for stmt in stmts {
            match stmt {
                Stmt::Expr(expr) => self.expr(shader, expr, out),
                Stmt::Declare(var, init) => {
                    out.vars.insert(*var);
                    out.declared.insert(*var);
                    init.iter().for_each(|init| self.expr(shader, init, out));
                }
                Stmt::Block(body) => self.stmts(shader, body, out),
                Stmt::If(condition, then, otherwise) => {
                    self.expr(shader, condition, out);
                    self.stmts(shader, then, out);
                    self.stmts(shader, otherwise, out);
                }
                Stmt::Loop { init, condition, step, body, .. } => {
                    self.stmts(shader, init, out);
                    condition.iter().chain(step).for_each(|expr| self.expr(shader, expr, out));
                    self.stmts(shader, body, out);
                }
                Stmt::Break | Stmt::Continue => {}
                Stmt::Return(value) => {
                    out.returns = true;
                    value.iter().for_each(|value| self.expr(shader, value, out));
                }
            }
        }
    }

    fn place(&mut self, shader: &Shader, place: &Place, out: &mut Effects) {
        out.vars.insert(place.var);
        for access in &place.path {
            match access {
                Access::Element(index) | Access::Component(index) => self.expr(shader, index, out),
                Access::Matrix(row, column) => {
                    self.expr(shader, row, out);
                    self.expr(shader, column, out);
                }
                Access::Field(_) => {}
            }
        }
    }

    fn args(&mut self, shader: &Shader, args: &[Argument], out: &mut Effects) {
        for arg in args {
            match arg {
                Argument::In(expr) => self.expr(shader, expr, out),
                Argument::Out(place) => self.place(shader, place, out),
            }
        }
    }

    fn expr(&mut self, shader: &Shader, expr: &Expr, out: &mut Effects) {
        stacker::maybe_grow(64 << 10, 1 << 20, || self.expr_kind(shader, expr, out));
    }

    fn expr_kind(&mut self, shader: &Shader, expr: &Expr, out: &mut Effects) {
        use ExprKind::*;
        match &expr.kind {
            Int(_) | Float(_) | String(_) | Var(_) => {}
            Convert(a) | Unary(_, a) | Field(a, _) => self.expr(shader, a, out),
            Binary(_, a, b) | Index(a, b) | SpaceToSpace(a, b) => {
                self.expr(shader, a, out);
                self.expr(shader, b, out);
            }
            Ternary(a, b, c) | MatrixElement(a, b, c) => {
                [a, b, c].into_iter().for_each(|e| self.expr(shader, e, out));
            }
            Comma(list) | Construct(list) | Aggregate(list) => list.iter().for_each(|e| self.expr(shader, e, out)),
            ConstructIn(space, list) => {
                self.expr(shader, space, out);
                list.iter().for_each(|e| self.expr(shader, e, out));
            }
            Assign(place, value) | Update(_, place, value) => {
                self.place(shader, place, out);
                self.expr(shader, value, out);
            }
            Step { place, .. } => self.place(shader, place, out),
            Call(id, args) => {
                out.costly = true;
                self.args(shader, args, out);
                let callee = self.of_function(shader, *id);
                // What the function declares ends with it, so that chains of calls do not gather it.
                out.vars.extend(callee.vars.difference(&callee.declared));
                out.prints |= callee.prints;
                out.traces |= callee.traces;
                out.errors |= callee.errors;
                out.exits |= callee.exits;
            }
            Builtin(name, args) => {
                out.prints |= matches!(*name, "printf" | "fprintf" | "error" | "warning");
                out.prints |=
                    matches!(*name, "setmessage" | "getmessage" | "random" | "trace") || name.starts_with("dict_");
                if matches!(*name, "bump" | "displace") {
                    let moved = |v: &Variable| matches!(v.global, Some(Global::P | Global::N));
                    let moved = shader.variables.iter().enumerate().filter(|(_, variable)| moved(variable));
                    out.vars.extend(moved.map(|(at, _)| VarId(at as u32)));
                }
                out.exits |= *name == "exit";
                out.traces |= *name == "trace";
                out.errors |= *name == "error";
                out.costly |= name.contains("noise") || matches!(*name, "pow" | "spline" | "format" | "transform");
                self.args(shader, args, out);
            }
            Closure(_, params, keywords) => {
                out.costly = true;
                params.iter().chain(keywords.iter().map(|k| &k.1)).for_each(|e| self.expr(shader, e, out));
            }
        }
    }
}
