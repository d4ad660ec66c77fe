//! Places: finding, reading and writing the part of a variable that an assignment names.

use super::value::Value;
use super::{Bound, Lower};
use crate::check::typed::{Access, Place, VarId};
use crate::ir::op::IntBinary;
use crate::ir::program::{Instr, Reg};

/// A place with its indices computed.
pub struct Target {
    var: VarId,
    /// Fields from the variable down to the value, as long as no array has been indexed.
    fields: Vec<u32>,
    /// True once an array has been indexed: from there on the value is part of an array, not of a binding.
    indexed: bool,
    /// The value the way leads to.
    value: Value,
    /// A component of it.
    component: Option<Component>,
}

/// A component of a triple or matrix.
enum Component {
    Known(usize),
    Computed(Reg),
}

impl Lower<'_> {
    /// Walks to a place. Index expressions are evaluated once, here.
    pub(super) fn target(&mut self, place: &Place) -> Target {
        let value = self.variable(place.var);
        let mut target = Target { var: place.var, fields: Vec::new(), indexed: false, value, component: None };
        for access in &place.path {
            match access {
                Access::Field(at) => {
                    if let Value::Struct(fields) = &target.value {
                        target.value = fields[*at as usize].clone();
                    }
                    if !target.indexed {
                        target.fields.push(*at);
                    }
                }
                Access::Element(index) => {
                    let index = self.reg(index);
                    let index = self.fixed(index);
                    target.value = self.element(&target.value, index);
                    target.indexed = true;
                }
                Access::Component(index) => {
                    let index = self.reg(index);
                    target.component = Some(self.component(index, 3));
                }
                Access::Matrix(row, column) => {
                    let (row, column) = (self.reg(row), self.reg(column));
                    let index = self.matrix_index(row, column);
                    target.component = Some(self.component(index, 16));
                }
            }
        }
        target
    }

    /// `4 row + column`
    pub(super) fn matrix_index(&mut self, row: Reg, column: Reg) -> Reg {
        let four = self.b.int(4);
        let row = self.b.int_binary(IntBinary::Mul, row, four);
        self.b.int_binary(IntBinary::Add, row, column)
    }

    fn component(&mut self, index: Reg, count: usize) -> Component {
        match self.b.known_int(index) {
            Some(known) => Component::Known((known.max(0) as usize).min(count - 1)),
            None => Component::Computed(self.fixed(index)),
        }
    }

    /// The value of a variable; one that is read before it is set is zero.
    pub(super) fn variable(&mut self, var: VarId) -> Value {
        if let Some(bound) = &self.vars[var.0 as usize] {
            return bound.value.clone();
        }
        let variable = &self.shader.variables[var.0 as usize];
        let value = match variable.global {
            Some(global) => self.global(global),
            None => {
                let ty = variable.ty.clone();
                self.zero(&ty)
            }
        };
        // An unset variable is the same zero everywhere, so it may be bound as if at the outermost level.
        self.vars[var.0 as usize] = Some(Bound { value: value.clone(), level: 0 });
        value
    }

    /// Reads a target.
    pub(super) fn load(&mut self, target: &Target) -> Value {
        if matches!(target.value, Value::Array { .. } | Value::Struct(_)) {
            return target.value.clone();
        }
        let regs = self.regs(&target.value);
        match &target.component {
            None => Value::Regs(regs),
            Some(Component::Known(at)) => Value::Regs(vec![regs[*at]]),
            Some(Component::Computed(index)) => Value::Regs(vec![self.pick(&regs, *index)]),
        }
    }

    /// The component whose number is computed: a chain of choices.
    pub(super) fn pick(&mut self, regs: &[Reg], index: Reg) -> Reg {
        let mut chosen = regs[0];
        for (i, &reg) in regs.iter().enumerate().skip(1) {
            let number = self.b.int(i as i32);
            // The last component also stands for indices beyond it.
            let same = self.b.int_binary(IntBinary::Ge, index, number);
            chosen = self.b.select(same, reg, chosen);
        }
        chosen
    }

    /// Writes a target.
    pub(super) fn write(&mut self, target: &Target, value: &Value) {
        let Some(component) = &target.component else {
            return self.write_whole(target, value);
        };
        let source = self.regs(value);
        let old = self.regs(&target.value);
        let mut new = old.clone();
        match component {
            Component::Known(at) => new[*at] = source[0],
            Component::Computed(index) => {
                for (i, reg) in new.iter_mut().enumerate() {
                    let number = self.b.int(i as i32);
                    let same = self.b.int_binary(IntBinary::Eq, *index, number);
                    *reg = self.b.select(same, source[0], old[i]);
                }
            }
        }
        self.write_whole(target, &Value::Regs(new));
    }

    fn write_whole(&mut self, target: &Target, value: &Value) {
        if let Value::Item { id, index } = &target.value {
            let regs = self.regs(value);
            return self.store_item(*id, *index, &regs);
        }
        let rebind = self.vars[target.var.0 as usize].as_ref().is_some_and(|bound| bound.level == self.level);
        if !rebind || target.indexed {
            return self.store(&target.value, value);
        }
        let ready = self.rebound(&target.value, value);
        if let Some(bound) = &mut self.vars[target.var.0 as usize] {
            let mut slot = &mut bound.value;
            for &field in &target.fields {
                match slot {
                    Value::Struct(fields) => slot = &mut fields[field as usize],
                    _ => return,
                }
            }
            *slot = ready;
        }
    }

    /// What a variable is bound to after an assignment: the new registers, or the old arrays with new contents.
    fn rebound(&mut self, old: &Value, new: &Value) -> Value {
        match (old, new) {
            (Value::Struct(a), Value::Struct(b)) => {
                Value::Struct(a.iter().zip(b).map(|(a, b)| self.rebound(a, b)).collect())
            }
            (Value::Array { .. }, _) => {
                self.copy_elements(old, new);
                old.clone()
            }
            (Value::Item { id, index }, _) => {
                let regs = self.regs(new);
                self.store_item(*id, *index, &regs);
                old.clone()
            }
            _ => self.stable(new),
        }
    }

    /// Moves a value into mutable registers and arrays, in the active lanes.
    pub(super) fn store(&mut self, to: &Value, from: &Value) {
        match (to, from) {
            (Value::Struct(a), Value::Struct(b)) => a.iter().zip(b).for_each(|(a, b)| self.store(a, b)),
            (Value::Array { .. }, _) => self.copy_elements(to, from),
            (Value::Item { id, index }, _) => {
                let regs = self.regs(from);
                self.store_item(*id, *index, &regs);
            }
            (Value::Regs(to), _) => {
                let from = self.regs(from);
                // All are read before the first is written: `c = color(c.z, c.x, c.y)` permutes.
                let steady: Vec<Reg> = from.into_iter().map(|reg| self.fixed(reg)).collect();
                for (&dst, src) in to.iter().zip(steady) {
                    if dst != src {
                        self.b.instr(Instr::Move { dst, src, masked: true });
                    }
                }
            }
            _ => {}
        }
    }
}
