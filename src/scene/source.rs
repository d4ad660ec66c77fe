//! Where a scene's text comes from, and where the files that it names are looked for.

use super::error::{SceneError, SceneProblem};
use super::shipped::{SHIPPED, SHIPPED_SCENES, shipped_scene};
use crate::lang::nearest::nearest;
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
            let help = help_with(path);
            SceneError::nowhere(SceneProblem::Unreadable { scene: argument.to_owned(), error: Arc::new(error) })
                .with_help(help)
        };
        if let Some((file, text)) = shipped_scene(argument).filter(|_| !path.exists()) {
            return Ok(SceneSource { name: file.into(), text, folder: ".".into() });
        }
        if is_mesh(path) {
            return Err(unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, "it is a mesh")));
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

fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"))
}

/// What may help who names no scene.
fn help_with(path: &Path) -> String {
    if is_mesh(path) {
        return "a mesh goes into a scene, as <Model filename=\"…\"/>".to_owned();
    }
    let stem = |(file, _): (&'static str, &str)| file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    let scenes: Vec<&str> = SHIPPED_SCENES.into_iter().map(stem).collect();
    let known: Vec<&str> = scenes.iter().copied().chain(SHIPPED.into_iter().map(stem)).collect();
    match nearest(&path.to_string_lossy(), &known) {
        Some(near) => format!("did you mean `{near}`?"),
        None if path.extension().is_none() => format!("the binary has the scenes {}", scenes.join(", ")),
        None => "a scene is a file of XML, such as `velour new` writes".to_owned(),
    }
}

/// A file of a folder, without the dot that stands for the working folder.
pub(super) fn within(folder: &Path, name: &str) -> PathBuf {
    if folder == Path::new(".") { PathBuf::from(name) } else { folder.join(name) }
}
