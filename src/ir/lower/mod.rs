//! Typed shaders to a program: the layers of a group one after the other, functions expanded in place.
//!
//! A variable is a name for registers. Where every lane that matters runs the same code, an assignment just binds the
//! name to the registers of the new value and costs nothing. Inside a *region* (a branch, a loop, a body that lanes can
//! leave early) lanes may differ, so on entry every variable assigned in it gets mutable registers of its own, and
//! assignments there become masked moves.

mod assigned;
mod builtin;
mod expr;
mod group;
mod noise;
mod operator;
mod place;
mod statement;
mod text;
pub mod value;

pub use group::{Binding, Layer, LowerOptions, lower};

use super::build::Builder;
use super::program::{Reg, ScopeId};
use crate::check::typed::{Shader, VarId};
use assigned::Assigned;
use std::collections::HashMap;
use value::Value;
use velour_grammar::Span;

/// A variable while lowering: its value, and the depth of regions at which it may be bound anew.
#[derive(Clone, Debug)]
struct Bound {
    value: Value,
    level: u32,
}

/// Where a `return` goes.
struct Frame {
    /// The scope to leave; `None` when the only return is the last statement.
    scope: Option<ScopeId>,
    /// The registers the value is moved to.
    result: Option<Value>,
}

/// The state of lowering one layer.
struct Lower<'a> {
    b: Builder,
    shader: &'a Shader,
    vars: Vec<Option<Bound>>,
    level: u32,
    frames: Vec<Frame>,
    /// Scopes to leave for `break` and `continue`.
    loops: Vec<(ScopeId, ScopeId)>,
    /// Scope to leave for `exit()`.
    exit: Option<ScopeId>,
    assigned: Assigned,
    /// Which parameters of the layer are connected.
    connected: Vec<VarId>,
    /// The variable of the caller that a parameter of a function stands for, to ask what it is connected to.
    stands_for: HashMap<VarId, VarId>,
    /// Which of its parameters are read by later layers, or by the host.
    read: Vec<VarId>,
    /// Which layer of the group this is.
    layer: u32,
    span: Span,
}

impl Lower<'_> {
    /// Gives every variable in the list mutable registers, then runs `body` one region deeper.
    ///
    /// A global comes to life here at the latest: bound only inside, it would stand for the registers of the input, which
    /// an assignment would then write in place, behind the back of all who take an input for constant.
    fn region<T>(&mut self, vars: Vec<VarId>, body: impl FnOnce(&mut Self) -> T) -> T {
        for var in vars {
            if self.shader.variables[var.0 as usize].global.is_some() {
                self.variable(var);
            }
            if let Some(mut bound) = self.vars[var.0 as usize].take() {
                self.make_mutable(&mut bound.value);
                self.vars[var.0 as usize] = Some(bound);
            }
        }
        self.level += 1;
        let result = body(self);
        self.level -= 1;
        result
    }

    fn make_mutable(&mut self, value: &mut Value) {
        match value {
            Value::Regs(regs) => regs.iter_mut().for_each(|reg| {
                if !self.b.program.regs[reg.0 as usize].mutable {
                    *reg = self.b.copy(*reg, true);
                }
            }),
            Value::Struct(fields) => fields.iter_mut().for_each(|field| self.make_mutable(field)),
            Value::Array { .. } | Value::Item { .. } => {}
        }
    }

    /// Binds a variable that comes to life here.
    fn bind(&mut self, var: VarId, value: Value) {
        let level = self.level;
        self.vars[var.0 as usize] = Some(Bound { value, level });
    }

    /// The components of three lists, one after the other.
    fn each(&mut self, a: &[Reg], b: &[Reg], mut op: impl FnMut(&mut Self, Reg, Reg) -> Reg) -> Vec<Reg> {
        let count = a.len().max(b.len());
        let pick = |list: &[Reg], i: usize| if list.len() == 1 { list[0] } else { list[i] };
        (0..count).map(|i| op(self, pick(a, i), pick(b, i))).collect()
    }
}
