//! Types as text.

use crate::ast::{TypeName, TypeSpec};

/// Prints a type.
pub fn print_type(ty: &TypeSpec) -> String {
    let base = match &ty.base {
        TypeName::Int => "int",
        TypeName::Float => "float",
        TypeName::Color => "color",
        TypeName::Point => "point",
        TypeName::Vector => "vector",
        TypeName::Normal => "normal",
        TypeName::Matrix => "matrix",
        TypeName::String => "string",
        TypeName::Void => "void",
        TypeName::Struct(name) => name,
    };
    if ty.closure { format!("closure {base}") } else { base.to_string() }
}
