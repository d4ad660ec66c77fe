//! Open Shading Language text to syntax tree.

pub mod ast;
pub mod diagnostic;
pub mod span;

pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use span::Span;
