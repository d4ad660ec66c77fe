//! Storage: reading, writing and copying values.

use super::state::Lower;
use super::value::{Value, kind_of, zero_of};
use crate::ir::op::IntBinary;
use crate::ir::program::{ArrayId, Instr, Reg};
use crate::lang::types::{Element, Type};

impl Lower<'_> {
    /// A zero value of a type; arrays are new ones, filled with zero.
    pub(super) fn zero(&mut self, ty: &Type) -> Value {
        let value = self.allocate(ty, &[]);
        self.clear(&value);
        value
    }

    /// Room for a value: zero constants for single values, new arrays for arrays.
    pub(super) fn allocate(&mut self, ty: &Type, outer: &[u32]) -> Value {
        let mut dims = outer.to_vec();
        if ty.is_array() {
            dims.push(ty.count() as u32);
        }
        match &ty.element {
            Element::Struct(s) => Value::Struct(s.fields.iter().map(|(_, ty)| self.allocate(ty, &dims)).collect()),
            Element::Base(base) if dims.is_empty() => {
                let zero = self.b.constant(zero_of(kind_of(*base)));
                Value::Regs(vec![zero; base.components()])
            }
            Element::Base(base) => {
                let len = dims.iter().product();
                let id = self.b.array(kind_of(*base), len, base.components() as u32);
                Value::Array { id, start: None, dims }
            }
        }
    }

    /// Stores zero in every array of a fresh value.
    fn clear(&mut self, value: &Value) {
        match value {
            Value::Struct(fields) => fields.iter().for_each(|field| self.clear(field)),
            Value::Array { id, .. } => {
                let info = self.b.program.arrays[id.0 as usize];
                let zero = self.b.constant(zero_of(info.kind));
                for element in 0..info.len {
                    let index = self.b.int(element as i32);
                    self.store_item(*id, index, &vec![zero; info.components as usize]);
                }
            }
            Value::Regs(_) | Value::Item { .. } => {}
        }
    }

    /// The registers of a single value; an array element is read.
    pub(super) fn regs(&mut self, value: &Value) -> Vec<Reg> {
        match value {
            Value::Regs(regs) => regs.clone(),
            Value::Item { id, index } => {
                let info = self.b.program.arrays[id.0 as usize];
                let load = |component| {
                    let dst = self.b.program.reg(info.kind, false);
                    let (array, index, span) = (*id, *index, self.span);
                    self.b.instr(Instr::ArrayGet { dst, array, component, index, span });
                    dst
                };
                (0..info.components).map(load).collect()
            }
            Value::Array { .. } | Value::Struct(_) => Vec::new(),
        }
    }

    pub(super) fn store_item(&mut self, array: ArrayId, index: Reg, regs: &[Reg]) {
        for (component, &src) in regs.iter().enumerate() {
            let (component, span) = (component as u32, self.span);
            self.b.instr(Instr::ArraySet { array, component, index, src, masked: true, span });
        }
    }

    /// The element of an array (or of every field of an array of structs).
    pub(super) fn element(&mut self, value: &Value, index: Reg) -> Value {
        match value {
            Value::Struct(fields) => Value::Struct(fields.iter().map(|field| self.element(field, index)).collect()),
            Value::Array { id, start, dims } => {
                // An access checks the element of the whole array that it reads, not which row that is in.
                let part = dims.len() > 1 || start.is_some();
                let index = if part { self.clamped(index, dims[0], false) } else { index };
                let stride: u32 = dims[1..].iter().product();
                let stride = self.b.int(stride as i32);
                let mut at = self.b.int_binary(IntBinary::Mul, index, stride);
                if let Some(start) = start {
                    at = self.b.int_binary(IntBinary::Add, *start, at);
                }
                match dims.len() {
                    1 => Value::Item { id: *id, index: at },
                    _ => Value::Array { id: *id, start: Some(at), dims: dims[1..].to_vec() },
                }
            }
            other => other.clone(),
        }
    }

    /// The elements of a one-dimensional array view, as values not yet read.
    pub(super) fn elements(&mut self, value: &Value) -> Vec<Value> {
        let count = match value {
            Value::Array { dims, .. } => dims[0],
            _ => 0,
        };
        let item = |at| {
            let index = self.b.int(at as i32);
            self.element(value, index)
        };
        (0..count).map(item).collect()
    }

    /// The same value in registers that no later assignment changes. Arrays stay where they are.
    pub(super) fn stable(&mut self, value: &Value) -> Value {
        match value {
            Value::Struct(fields) => Value::Struct(fields.iter().map(|field| self.stable(field)).collect()),
            Value::Array { .. } => value.clone(),
            Value::Regs(_) | Value::Item { .. } => {
                let regs = self.regs(value);
                let keep = |reg: Reg| {
                    let mutable = self.b.program.regs[reg.0 as usize].mutable;
                    if mutable { self.b.copy(reg, false) } else { reg }
                };
                Value::Regs(regs.into_iter().map(keep).collect())
            }
        }
    }

    /// A copy that a new variable may own: stable registers and new arrays.
    pub(super) fn owned(&mut self, value: &Value, ty: &Type) -> Value {
        if !ty.is_array() && ty.structure().is_none() {
            return self.stable(value);
        }
        let new = self.allocate(ty, &[]);
        self.copy_into(&new, value)
    }

    /// Copies array contents into freshly allocated ones; gives the new value with registers replaced.
    fn copy_into(&mut self, to: &Value, from: &Value) -> Value {
        match (to, from) {
            (Value::Struct(a), Value::Struct(b)) => {
                Value::Struct(a.iter().zip(b).map(|(a, b)| self.copy_into(a, b)).collect())
            }
            (Value::Array { .. }, _) => {
                if from.count() < to.count() {
                    self.clear(to);
                }
                self.copy_elements(to, from);
                to.clone()
            }
            _ => self.stable(from),
        }
    }

    /// Copies the elements of one array view to another; the shorter one sets the count.
    pub(super) fn copy_elements(&mut self, to: &Value, from: &Value) {
        for (a, b) in self.elements(to).into_iter().zip(self.elements(from)) {
            match a {
                Value::Item { id, index } => {
                    let regs = self.regs(&b);
                    self.store_item(id, index, &regs);
                }
                nested => self.copy_elements(&nested, &b),
            }
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
