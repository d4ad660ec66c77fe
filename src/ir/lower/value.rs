//! Values while lowering: which registers and arrays hold a typed value, and reading, writing and copying them.

use super::Lower;
use crate::ir::op::{Binary, IntBinary};
use crate::ir::program::*;
use crate::lang::types::{Base, Element, Type};
use velour_grammar::Span;

/// Where the numbers of a typed value are.
#[derive(Clone, Debug)]
pub enum Value {
    /// A single value of a base type: a register a component.
    Regs(Vec<Reg>),
    /// An array of base values. The dimensions are the ones left to index, outermost first; an array of structs whose
    /// field is an array has two.
    Array {
        /// The array.
        id: ArrayId,
        /// The first element of the view.
        start: Option<Reg>,
        /// Lengths, outermost first.
        dims: Vec<u32>,
    },
    /// One element of an array, not yet read.
    Item {
        /// The array.
        id: ArrayId,
        /// The element.
        index: Reg,
    },
    /// The fields of a struct, or of an array of structs.
    Struct(Vec<Value>),
}

/// Spans of layer `k` of a group start here times `k`; no text has as many tokens.
pub const SPANS_PER_LAYER: u32 = 1 << 23;

/// The register kind of a base type.
pub fn kind_of(base: Base) -> Kind {
    match base {
        Base::Int => Kind::Int,
        Base::String => Kind::String,
        Base::Closure => Kind::Closure,
        _ => Kind::Float,
    }
}

/// The zero of a register kind.
pub fn zero_of(kind: Kind) -> Const {
    match kind {
        Kind::Float => Const::Float(0.0),
        Kind::Int => Const::Int(0),
        Kind::String => Const::String(0),
        Kind::Closure => Const::NoClosure,
    }
}

impl Value {
    /// How many elements an array has; 1 for what is none.
    pub fn count(&self) -> usize {
        match self {
            Value::Array { dims, .. } => dims[0] as usize,
            Value::Struct(fields) => fields.first().map_or(1, Value::count),
            Value::Regs(_) | Value::Item { .. } => 1,
        }
    }
}

impl Lower<'_> {
    /// A zero value of a type; arrays are new ones, filled with zero.
    pub fn zero(&mut self, ty: &Type) -> Value {
        let value = self.allocate(ty, &[]);
        self.clear(&value);
        value
    }

    /// Room for a value: zero constants for single values, new arrays for arrays.
    pub fn allocate(&mut self, ty: &Type, outer: &[u32]) -> Value {
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
    pub fn regs(&mut self, value: &Value) -> Vec<Reg> {
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

    pub fn store_item(&mut self, array: ArrayId, index: Reg, regs: &[Reg]) {
        for (component, &src) in regs.iter().enumerate() {
            let (component, span) = (component as u32, self.span);
            self.b.instr(Instr::ArraySet { array, component, index, src, masked: true, span });
        }
    }

    /// The element of an array (or of every field of an array of structs).
    pub fn element(&mut self, value: &Value, index: Reg) -> Value {
        match value {
            Value::Struct(fields) => Value::Struct(fields.iter().map(|field| self.element(field, index)).collect()),
            Value::Array { id, start, dims } => {
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
    pub fn elements(&mut self, value: &Value) -> Vec<Value> {
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
    pub fn stable(&mut self, value: &Value) -> Value {
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
    pub fn owned(&mut self, value: &Value, ty: &Type) -> Value {
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
    pub fn copy_elements(&mut self, to: &Value, from: &Value) {
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

    /// Converts the registers of a single value from one base type to another.
    pub fn convert(&mut self, regs: &[Reg], from: Base, to: Base) -> Vec<Reg> {
        match (from, to) {
            _ if from == to || (from.is_triple() && to.is_triple()) => regs.to_vec(),
            (Base::Int, Base::Float) => vec![self.b.int_to_float(regs[0])],
            (Base::Float, Base::Int) => vec![self.b.float_to_int(regs[0])],
            (_, Base::Closure) if from != Base::Closure => vec![self.b.constant(Const::NoClosure)],
            (Base::Int, _) => {
                let float = self.b.int_to_float(regs[0]);
                self.convert(&[float], Base::Float, to)
            }
            (Base::Float, Base::Matrix) => {
                let zero = self.b.float(0.0);
                (0..16).map(|i| if i % 5 == 0 { regs[0] } else { zero }).collect()
            }
            (Base::Float, _) if to.is_triple() => vec![regs[0]; 3],
            _ => regs.to_vec(),
        }
    }

    /// Sum of products of two lists of floats, from the left.
    pub fn dot(&mut self, a: &[Reg], b: &[Reg]) -> Reg {
        let mut products = Vec::new();
        for (&x, &y) in a.iter().zip(b) {
            products.push(self.b.binary(Binary::Mul, x, y));
        }
        let mut sum = products[0];
        for &product in &products[1..] {
            sum = self.b.binary(Binary::Add, sum, product);
        }
        sum
    }

    /// Remembers where the text being lowered stands, for messages at run time.
    pub fn at(&mut self, span: Span) {
        if span != Span::NONE {
            self.span = self.placed(span);
        }
    }

    /// A span of this layer's text as a span of the whole group.
    pub fn placed(&self, span: Span) -> Span {
        if span == Span::NONE {
            return span;
        }
        let offset = self.layer * SPANS_PER_LAYER;
        Span { first: span.first.saturating_add(offset), last: span.last.saturating_add(offset) }
    }
}
