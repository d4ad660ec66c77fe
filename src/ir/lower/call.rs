//! Calls of user functions, expanded in place.
//!
//! Arguments are references: a parameter that the function writes, or that is a variable which the function may write by
//! another name, is another name for the caller's variable. What has no name of its own (an element, a component, a
//! value) is copied in, and out again when the function writes it.

use super::builtin::root_variable;
use super::operand::Given;
use super::state::{Frame, Lower, Name};
use super::value::Value;
use crate::check::typed::*;
use crate::ir::program::Node;
use crate::lang::types::Type;
use std::collections::BTreeSet;

impl Lower<'_> {
    /// Expands a call of a user function in place.
    pub(super) fn call(&mut self, id: FunctionId, args: &[Argument]) -> Value {
        let function = self.shader.functions[id.0 as usize].clone();
        let name = |arg: &Argument| match arg {
            Argument::In(expr) => self.name(expr),
            Argument::Out(place) => self.name_of(place),
        };
        let names: Vec<Option<Name>> = args.iter().map(name).collect();
        let written = self.written_by(id, args);
        let mut back = Vec::new();
        let given = self.given(args);
        for ((given, name), (arg, &(var, _))) in given.into_iter().zip(names).zip(args.iter().zip(&function.params)) {
            self.note_origin(arg, var);
            match (given, name) {
                (Given::Out(_), Some(name)) => {
                    self.aliases.insert(var, name);
                }
                (Given::In(_), Some(name)) if written.contains(&name.var) => {
                    self.aliases.insert(var, name);
                }
                (Given::In(value), _) => {
                    let value = self.stable(&value);
                    self.bind(var, value);
                }
                (Given::Out(target), None) => {
                    let value = self.load(&target);
                    let value = self.stable(&value);
                    // An array is handed over as it is, so nothing has to come back.
                    if !matches!(value, Value::Array { .. }) {
                        back.push((target, var));
                    }
                    self.bind(var, value);
                }
            }
        }
        let result = self.body(&function.body, &function.returns);
        for (target, var) in back {
            let value = self.variable(var);
            let value = self.stable(&value);
            self.write(&target, &value);
        }
        let declared = self.assigned.of_function(self.shader, id);
        self.forget(declared.declared.iter().copied());
        result
    }

    /// The variables that outlive a call and that it may write.
    fn written_by(&mut self, id: FunctionId, args: &[Argument]) -> Vec<VarId> {
        let effects = self.assigned.of_function(self.shader, id);
        let outer = effects.vars.difference(&effects.declared).copied();
        let places = args.iter().filter_map(|arg| match arg {
            Argument::Out(place) => Some(place.var),
            Argument::In(_) => None,
        });
        outer.chain(places).map(|var| self.resolve(var).var).collect()
    }

    /// Remembers what a parameter stands for, for those who ask what it is connected to.
    fn note_origin(&mut self, arg: &Argument, var: VarId) {
        let root = match arg {
            Argument::In(expr) => root_variable(expr),
            Argument::Out(place) => Some(place.var),
        };
        if let Some(root) = root {
            let origin = self.origin(root);
            self.stands_for.insert(var, origin);
        }
    }

    /// The statements of a function, and the value it returns.
    fn body(&mut self, body: &[Stmt], returns: &Type) -> Value {
        let effects = self.assigned.of_stmts(self.shader, body);
        let before_last = &body[..body.len().saturating_sub(1)];
        let early = self.assigned.of_stmts(self.shader, before_last).returns;
        let loops = std::mem::take(&mut self.loops);
        let result = if let (Some(Stmt::Return(value)), false) = (body.last(), early) {
            self.frames.push(Frame { scope: None, result: None });
            self.stmts(before_last);
            match value {
                Some(value) => self.returned(value, returns, &effects.declared),
                None => Value::Regs(Vec::new()),
            }
        } else if !effects.returns {
            self.frames.push(Frame { scope: None, result: None });
            self.stmts(body);
            self.zero(returns)
        } else {
            let scope = self.b.scope();
            let mut result = self.zero(returns);
            self.make_mutable(&mut result);
            self.frames.push(Frame { scope: Some(scope), result: Some(result.clone()) });
            self.region(effects.vars, |l| {
                l.b.open();
                l.stmts(body);
                let block = l.b.close();
                l.b.push(Node::Scope(scope, block));
            });
            result
        };
        self.frames.pop();
        self.loops = loops;
        self.stable(&result)
    }

    /// The value of the last `return`. Arrays that outlive the function are copied: the caller may change them before it
    /// reads the value.
    fn returned(&mut self, value: &Expr, returns: &Type, declared: &BTreeSet<VarId>) -> Value {
        let result = self.expr(value);
        let name = self.name(value);
        if name.is_some_and(|name| !declared.contains(&name.var)) { self.owned(&result, returns) } else { result }
    }
}
