//! What the user has named, and how it is compiled.

use crate::compile::Compiler;
use crate::scene::names_shader;
use std::path::{Path, PathBuf};

/// What the user has named, and how it is compiled.
#[derive(Clone, Debug)]
pub struct Source {
    /// A scene's file, or a shader's.
    pub argument: String,
    /// Folders to look for shaders and meshes in, after the scene's own.
    pub search: Vec<PathBuf>,
    /// The compiler.
    pub compiler: Compiler,
    /// A value for a parameter that a shader does not have is an error.
    pub strict: bool,
}

impl Source {
    /// Is it a shader without a scene?
    pub fn is_shader(&self) -> bool {
        names_shader(&self.argument)
    }

    /// The file that was named.
    pub fn path(&self) -> &Path {
        Path::new(&self.argument)
    }
}
