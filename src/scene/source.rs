//! Where a scene's text comes from, and where the files that it names are looked for.

use super::error::{SceneError, SceneProblem};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub struct SceneSource {
    /// The name shown in messages.
    pub name: Arc<str>,
    /// The XML.
    pub text: String,
    /// The folder beside which shaders and meshes are looked for first.
    pub folder: PathBuf,
}

impl SceneSource {
    /// Reads an argument: a file's name, or the XML itself when it begins with `<`.
    pub fn read(argument: &str) -> Result<Self, SceneError> {
        if argument.trim_start().starts_with('<') {
            return Ok(SceneSource { name: "<scene text>".into(), text: argument.to_owned(), folder: ".".into() });
        }
        let path = Path::new(argument);
        let text = std::fs::read_to_string(path).map_err(|error| {
            SceneError::nowhere(SceneProblem::Unreadable { scene: argument.to_owned(), error: Arc::new(error) })
        })?;
        let folder = match path.parent() {
            Some(parent) if parent != Path::new("") => parent.to_owned(),
            _ => ".".into(),
        };
        Ok(SceneSource { name: argument.into(), text, folder })
    }
}

/// A file of a folder, without the dot that stands for the working folder.
pub(super) fn within(folder: &Path, name: &str) -> PathBuf {
    if folder == Path::new(".") { PathBuf::from(name) } else { folder.join(name) }
}
