//! Places: finding, reading and writing the part of a variable that an assignment names.

use super::state::{Bound, Lower, Name};
use super::value::Value;
use crate::check::typed::{Access, Expr, Place, VarId};
use crate::ir::op::IntBinary;
use crate::ir::program::Reg;
use velour_grammar::Span;

/// A place with its indices computed.
pub(super) struct Target {
    /// The variable, and the fields from there down to the value, as long as no array has been indexed.
    name: Name,
    /// The element of an array that the way leads to; what is no element is looked up by its name.
    element: Option<Value>,
    /// A component of the value.
    component: Option<Component>,
}

/// A component of a triple or matrix.
enum Component {
    Known(usize),
    Computed(Reg),
}

/// The index expressions on the way to a place, in order.
pub(super) fn indices(place: &Place) -> Vec<&Expr> {
    let of = |access| match access {
        &Access::Field(_) => [None, None],
        Access::Element(index) | Access::Component(index) => [Some(index), None],
        Access::Matrix(row, column) => [Some(row), Some(column)],
    };
    place.path.iter().flat_map(of).flatten().collect()
}

impl Lower<'_> {
    /// Walks to a place. Index expressions are evaluated once, here.
    pub(super) fn target(&mut self, place: &Place, span: Span) -> Target {
        let mut values = self.operands(&indices(place)).into_iter();
        self.at(span);
        self.target_at(place, &mut values)
    }

    /// A variable as a whole.
    pub(super) fn variable_target(&self, var: VarId) -> Target {
        Target { name: self.resolve(var), element: None, component: None }
    }

    /// Walks to a place by indices that have been computed.
    pub(super) fn target_at(&mut self, place: &Place, indices: &mut impl Iterator<Item = Value>) -> Target {
        let mut target = Target { name: self.resolve(place.var), element: None, component: None };
        for access in &place.path {
            match access {
                Access::Field(at) => match &mut target.element {
                    None => target.name.fields.push(*at),
                    Some(element) => *element = element.part(&[*at]).unwrap_or(element).clone(),
                },
                Access::Element(_) => {
                    let index = self.next_index(indices);
                    let whole = self.whole(&target);
                    target.element = Some(self.element(&whole, index));
                }
                Access::Component(_) => {
                    let index = self.next_index(indices);
                    let index = self.clamped(index, 3, true);
                    target.component = Some(self.component(index));
                }
                Access::Matrix(..) => {
                    let (row, column) = (self.next_index(indices), self.next_index(indices));
                    let index = self.matrix_index(row, column, true);
                    target.component = Some(self.component(index));
                }
            }
        }
        target
    }

    pub(super) fn next_index(&mut self, indices: &mut impl Iterator<Item = Value>) -> Reg {
        let value = indices.next().unwrap_or(Value::Regs(Vec::new()));
        match self.regs(&value).first() {
            Some(&reg) => self.fixed(reg),
            None => self.b.int(0),
        }
    }

    /// An index kept inside `0..len`; one that is outside is reported when it is used.
    pub(super) fn clamped(&mut self, index: Reg, len: u32, written: bool) -> Reg {
        match self.b.known_int(index) {
            Some(known) if (0..len as i32).contains(&known) => index,
            _ => self.b.clamped(index, len, written, self.span),
        }
    }

    /// `4 row + column`
    pub(super) fn matrix_index(&mut self, row: Reg, column: Reg, written: bool) -> Reg {
        let (row, column) = (self.clamped(row, 4, written), self.clamped(column, 4, written));
        let four = self.b.int(4);
        let row = self.b.int_binary(IntBinary::Mul, row, four);
        self.b.int_binary(IntBinary::Add, row, column)
    }

    fn component(&mut self, index: Reg) -> Component {
        match self.b.known_int(index) {
            Some(known) => Component::Known(known as usize),
            None => Component::Computed(index),
        }
    }

    /// The value of a variable; one that is read before it is set is zero.
    pub(super) fn variable(&mut self, var: VarId) -> Value {
        let name = self.resolve(var);
        self.named(&name)
    }

    /// The value that a name stands for at this moment.
    pub(super) fn named(&mut self, name: &Name) -> Value {
        if self.vars[name.var.0 as usize].is_none() {
            self.pull(name.var);
        }
        if self.vars[name.var.0 as usize].is_none() {
            let variable = &self.shader.variables[name.var.0 as usize];
            let value = match variable.global {
                Some(global) => self.global(global),
                None => {
                    let ty = variable.ty.clone();
                    self.zero(&ty)
                }
            };
            // An unset variable is the same zero everywhere, so it may be bound as if at the outermost level.
            self.vars[name.var.0 as usize] = Some(Bound { value, level: 0 });
        }
        let bound = self.vars[name.var.0 as usize].as_ref();
        bound.and_then(|bound| bound.value.part(&name.fields)).cloned().unwrap_or(Value::Regs(Vec::new()))
    }

    /// The value that a target is, or is a component of.
    fn whole(&mut self, target: &Target) -> Value {
        match &target.element {
            Some(element) => element.clone(),
            None => self.named(&target.name),
        }
    }

    /// Reads a target.
    pub(super) fn load(&mut self, target: &Target) -> Value {
        let whole = self.whole(target);
        if matches!(whole, Value::Array { .. } | Value::Struct(_)) {
            return whole;
        }
        let regs = self.regs(&whole);
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
        let whole = self.whole(target);
        let old = self.regs(&whole);
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
        if let Some(element) = &target.element {
            return self.store(element, value);
        }
        let old = self.named(&target.name);
        let at = target.name.var.0 as usize;
        if self.vars[at].as_ref().is_none_or(|bound| bound.level != self.level) {
            return self.store(&old, value);
        }
        let new = self.rebound(&old, value);
        if let Some(bound) = &mut self.vars[at]
            && let Some(slot) = bound.value.part_mut(&target.name.fields)
        {
            *slot = new;
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
}
