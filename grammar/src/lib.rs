//! Open Shading Language text to syntax tree.

pub mod ast;
pub mod diagnostic;
pub mod span;
mod token;
mod tree;
mod explain;

lalrpop_util::lalrpop_mod!(
    #[allow(clippy::all, missing_docs, unused, unreachable_pub, elided_lifetimes_in_paths)]
    osl
);

pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use span::Span;
