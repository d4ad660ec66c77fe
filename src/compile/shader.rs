//! A compiled shader: the typed shader, the text it came from, and the closures it may call.

use crate::check::typed;
use crate::closure::Library;
use crate::lang::path::root;
use std::sync::Arc;
use velour_grammar::Sources;

/// A compiled shader, ready to be put into a group. Cloning it is cheap.
#[derive(Clone, Debug)]
pub struct Shader {
    /// The typed shader.
    pub typed: Arc<typed::Shader>,
    /// Where its text came from.
    pub sources: Sources,
    pub(super) closures: Arc<Library>,
}

impl Shader {
    /// The name it was declared with.
    pub fn name(&self) -> &str {
        &self.typed.name
    }

    /// The names of its parameters, in the order of the text.
    pub fn params(&self) -> impl Iterator<Item = &str> {
        self.typed.declared().map(|(_, variable)| variable.name.as_str())
    }

    /// Does it have the parameter that a path, such as `name`, `name.field` or `name[2]`, leads into?
    pub fn has(&self, path: &str) -> bool {
        self.typed.param(root(path)).is_some()
    }
}
