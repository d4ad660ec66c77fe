//! Text to shader group, in one place: parse, check, lower, optimize.
//!
//! [`Compiler`] holds what all shaders share: include folders, macros, the standard header, the closures. It gives
//! [`Shader`]s; a [`GroupBuilder`] binds their parameters, joins layers and makes a [`crate::exec::Group`] to shade with.

mod builder;
mod compiler;
mod error;
mod fit;
mod recipe;
mod shader;
mod writing;

pub use builder::GroupBuilder;
pub use compiler::{Checked, Compiler, STDOSL, compile};
pub use error::{CompileError, GroupError, GroupProblem, GroupSubject};
pub use recipe::Recipe;
pub use shader::Shader;
