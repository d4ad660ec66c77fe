//! Values while lowering: which registers and arrays hold a typed value.

use crate::ir::program::{ArrayId, Const, Kind, Reg};
use crate::lang::types::Base;

/// Where the numbers of a typed value are.
#[derive(Clone, Debug)]
pub(super) enum Value {
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

/// The register kind of a base type.
pub(super) fn kind_of(base: Base) -> Kind {
    match base {
        Base::Int => Kind::Int,
        Base::String => Kind::String,
        Base::Closure => Kind::Closure,
        _ => Kind::Float,
    }
}

/// The zero of a register kind.
pub(super) fn zero_of(kind: Kind) -> Const {
    match kind {
        Kind::Float => Const::Float(0.0),
        Kind::Int => Const::Int(0),
        Kind::String => Const::String(0),
        Kind::Closure => Const::NoClosure,
    }
}

impl Value {
    /// The part that a way through fields leads to.
    pub(super) fn part(&self, fields: &[u32]) -> Option<&Value> {
        fields.iter().try_fold(self, |value, &at| match value {
            Value::Struct(parts) => parts.get(at as usize),
            Value::Regs(_) | Value::Array { .. } | Value::Item { .. } => None,
        })
    }

    /// The same, to be changed.
    pub(super) fn part_mut(&mut self, fields: &[u32]) -> Option<&mut Value> {
        fields.iter().try_fold(self, |value, &at| match value {
            Value::Struct(parts) => parts.get_mut(at as usize),
            Value::Regs(_) | Value::Array { .. } | Value::Item { .. } => None,
        })
    }

    /// How many elements an array has; 1 for what is none.
    pub(super) fn count(&self) -> usize {
        match self {
            Value::Array { dims, .. } => dims[0] as usize,
            Value::Struct(fields) => fields.first().map_or(1, Value::count),
            Value::Regs(_) | Value::Item { .. } => 1,
        }
    }
}
