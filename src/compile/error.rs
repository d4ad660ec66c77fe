//! Why there is no shader, or no group.

use std::fmt;
use velour_grammar::{Diagnostics, Format, Sources};

/// Why a shader could not be made.
#[derive(Debug)]
pub enum CompileError {
    /// Its text is wrong.
    Text {
        /// All messages.
        diagnostics: Diagnostics,
        /// The text they refer to.
        sources: Sources,
    },
    /// Its file could not be read.
    File {
        /// The file.
        name: String,
        /// Why.
        error: std::io::Error,
    },
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CompileError::Text { diagnostics, sources } => {
                f.write_str(sources.render(diagnostics, Format::Full, false).trim_end())
            }
            CompileError::File { name, error } => write!(f, "{name}: error: {error}"),
        }
    }
}

impl std::error::Error for CompileError {}

/// Why a group could not be made: what is wrong with a parameter or a connection.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupError {
    /// What is wrong.
    pub message: String,
    /// The way out.
    pub help: String,
    /// What is wrong, by the names it was given with; a host that knows where those were written can name the place.
    pub subject: GroupSubject,
}

/// What a [`GroupError`] is about.
#[derive(Clone, Debug, PartialEq)]
pub enum GroupSubject {
    /// A parameter of a layer.
    Param {
        /// The layer.
        layer: String,
        /// The parameter as given.
        name: String,
    },
    /// A layer as a whole.
    Layer(String),
}

impl fmt::Display for GroupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}\n  help: {}", self.message, self.help)
    }
}

impl std::error::Error for GroupError {}
