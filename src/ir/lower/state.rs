//! The state of lowering one layer: what each variable stands for, and the regions in which lanes may part.

use super::assigned::Assigned;
use super::shared::Shared;
use super::value::Value;
use crate::check::typed::{Shader, VarId};
use crate::ir::build::Builder;
use crate::ir::program::{Reg, ScopeId};
use std::collections::HashMap;
use velour_grammar::Span;

/// Spans of layer `k` of a group start here times `k`; no text has as many tokens.
pub const SPANS_PER_LAYER: u32 = 1 << 23;

/// A variable while lowering: its value, and the depth of regions at which it may be bound anew.
#[derive(Clone, Debug)]
pub(super) struct Bound {
    pub(super) value: Value,
    pub(super) level: u32,
}

/// A variable, or a field of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    /// The variable, which has a value of its own.
    pub(super) var: VarId,
    /// The fields from the variable down.
    pub(super) fields: Vec<u32>,
}

/// Where a `return` goes.
pub(super) struct Frame {
    /// The scope to leave; `None` when the only return is the last statement.
    pub(super) scope: Option<ScopeId>,
    /// The registers the value is moved to.
    pub(super) result: Option<Value>,
}

/// The state of lowering one layer.
pub(super) struct Lower<'a> {
    pub(super) b: Builder,
    pub(super) shader: &'a Shader,
    /// The values of variables that have one of their own.
    pub(super) vars: Vec<Option<Bound>>,
    /// Parameters of functions that are other names for variables of the caller.
    pub(super) aliases: HashMap<VarId, Name>,
    /// The depth of regions.
    pub(super) level: u32,
    pub(super) frames: Vec<Frame>,
    /// Scopes to leave for `break` and `continue`.
    pub(super) loops: Vec<(ScopeId, ScopeId)>,
    /// Scope to leave for `exit()`.
    pub(super) exit: Option<ScopeId>,
    pub(super) assigned: Assigned,
    /// Which parameters of the layer are connected.
    pub(super) connected: Vec<VarId>,
    /// The variable of the caller that a parameter of a function stands for, to ask what it is connected to.
    pub(super) stands_for: HashMap<VarId, VarId>,
    /// Which of its parameters are read by later layers, or by the host.
    pub(super) read: Vec<VarId>,
    /// Which layer of the group this is.
    pub(super) layer: u32,
    /// What the layers of the group share.
    pub(super) shared: Shared<'a>,
    /// Parameters that get their value when they are first read.
    pub(super) waiting: Vec<VarId>,
    /// Those of them that must have their value before lanes part.
    pub(super) together: Vec<VarId>,
    pub(super) span: Span,
}

impl<'a> Lower<'a> {
    /// The state before a layer, which appends to what is built.
    pub(super) fn new(b: Builder, shader: &'a Shader, layer: u32, read: Vec<VarId>) -> Self {
        Lower {
            b,
            shader,
            vars: vec![None; shader.variables.len()],
            aliases: HashMap::new(),
            level: 0,
            frames: Vec::new(),
            loops: Vec::new(),
            exit: None,
            assigned: Assigned::default(),
            connected: Vec::new(),
            stands_for: HashMap::new(),
            read,
            layer,
            shared: Shared::default(),
            waiting: Vec::new(),
            together: Vec::new(),
            span: Span::NONE,
        }
    }

    /// Gives every variable in the list mutable registers, then runs `body` one region deeper.
    ///
    /// A global comes to life here at the latest: bound only inside, it would stand for the registers of the input, which
    /// an assignment would then write in place, behind the back of all who take an input for constant.
    pub(super) fn region<T>(&mut self, vars: impl IntoIterator<Item = VarId>, body: impl FnOnce(&mut Self) -> T) -> T {
        for var in vars {
            let name = self.resolve(var);
            if self.shader.variables[name.var.0 as usize].global.is_some() {
                self.variable(name.var);
            }
            if let Some(mut bound) = self.vars[name.var.0 as usize].take() {
                if let Some(part) = bound.value.part_mut(&name.fields) {
                    self.make_mutable(part);
                }
                self.vars[name.var.0 as usize] = Some(bound);
            }
        }
        self.level += 1;
        let result = body(self);
        self.level -= 1;
        result
    }

    pub(super) fn make_mutable(&mut self, value: &mut Value) {
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
    pub(super) fn bind(&mut self, var: VarId, value: Value) {
        let level = self.level;
        self.vars[var.0 as usize] = Some(Bound { value, level });
    }

    /// What a variable is a name for: itself, or what the caller gave.
    pub(super) fn resolve(&self, var: VarId) -> Name {
        self.aliases.get(&var).cloned().unwrap_or(Name { var, fields: Vec::new() })
    }

    /// Forgets variables that end here; left bound, a later region would keep their registers alive.
    pub(super) fn forget(&mut self, vars: impl IntoIterator<Item = VarId>) {
        for var in vars {
            self.vars[var.0 as usize] = None;
            self.aliases.remove(&var);
        }
    }

    /// A register that the code under it cannot change.
    pub(super) fn fixed(&mut self, reg: Reg) -> Reg {
        let mutable = self.b.program.regs[reg.0 as usize].mutable;
        if mutable { self.b.copy(reg, false) } else { reg }
    }

    /// The components of three lists, one after the other.
    pub(super) fn each(&mut self, a: &[Reg], b: &[Reg], mut op: impl FnMut(&mut Self, Reg, Reg) -> Reg) -> Vec<Reg> {
        let count = a.len().max(b.len());
        let pick = |list: &[Reg], i: usize| if list.len() == 1 { list[0] } else { list[i] };
        (0..count).map(|i| op(self, pick(a, i), pick(b, i))).collect()
    }

    /// Remembers where the text being lowered stands, for messages at run time.
    pub(super) fn at(&mut self, span: Span) {
        if span != Span::NONE {
            self.span = self.placed(span);
        }
    }

    /// A span of this layer's text as a span of the whole group.
    pub(super) fn placed(&self, span: Span) -> Span {
        if span == Span::NONE {
            return span;
        }
        let offset = self.layer * SPANS_PER_LAYER;
        Span { first: span.first.saturating_add(offset), last: span.last.saturating_add(offset) }
    }
}
