//! A compiled shader: the typed shader, the text it came from, and the closures it may call.

use crate::check::typed;
use crate::closure::Library;
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
}
