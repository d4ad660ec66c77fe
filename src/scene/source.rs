//! Where a scene's text comes from, and where the files that it names are looked for.

use super::error::{SceneError, SceneProblem};
use super::shipped::shipped_scene;
use crate::limits::SCENE_BYTES;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use velour_grammar::files::Access;

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
    /// Reads an argument: a file's name, that of a scene in the binary when there is no such file, or the XML itself when it begins with
    /// `<`.
    ///
    /// # Errors
    /// It cannot be read, or may not be.
    pub fn read(argument: &str, access: &Access) -> Result<Self, SceneError> {
        if argument.trim_start().starts_with('<') {
            return Ok(SceneSource { name: "<scene text>".into(), text: argument.to_owned(), folder: ".".into() });
        }
        let path = Path::new(argument);
        let unreadable = |error: std::io::Error| {
            SceneError::nowhere(SceneProblem::Unreadable { scene: argument.to_owned(), error: Arc::new(error) })
        };
        if let Some((file, text)) = shipped_scene(argument).filter(|_| !path.exists()) {
            return Ok(SceneSource { name: file.into(), text, folder: ".".into() });
        }
        let bytes = access.read(path, SCENE_BYTES).map_err(|error| unreadable(error.into()))?;
        let no_text = |_| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, "it is not UTF-8 text"));
        let text = String::from_utf8(bytes).map_err(no_text)?;
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
