//! The one error of the scene room, and the place it points to.

use std::fmt;
use std::sync::Arc;

/// A place in a text file; lines and columns count from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file's name as the user would write it.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// What is wrong with a scene, where, and what would help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// Where, when a file is to blame.
    pub place: Option<Place>,
    /// One clause that says what is wrong.
    pub message: String,
    /// One clause that says what to do, when it is known.
    pub help: Option<String>,
}

impl SceneError {
    /// An error at a place.
    pub fn at(place: Place, message: impl Into<String>) -> Self {
        SceneError { place: Some(place), message: message.into(), help: None }
    }

    /// An error that no file is to blame for.
    pub fn nowhere(message: impl Into<String>) -> Self {
        SceneError { place: None, message: message.into(), help: None }
    }

    /// The same error with a line of help.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The same error, at `place` unless it has one of its own.
    pub fn or_at(mut self, place: &Place) -> Self {
        self.place.get_or_insert_with(|| place.clone());
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        write!(f, "error: {}", self.message)?;
        if let Some(help) = &self.help {
            write!(f, "\n  help: {help}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}
