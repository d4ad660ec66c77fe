//! How a file, or the text itself, becomes a scene.

use super::build::Builder;
use super::error::{SceneError, SceneProblem};
use super::group::GroupCompiler;
use super::scene::Scene;
use super::source::SceneSource;
use super::xml;
use crate::limits::SCENE_BYTES;
use std::path::PathBuf;

impl Scene {
    /// Loads the scene that `argument` names or is; `search` lists folders to look in after the scene's own.
    pub fn load(argument: &str, search: &[PathBuf], compiler: &dyn GroupCompiler) -> Result<Scene, SceneError> {
        Self::from_source(&SceneSource::read(argument, &compiler.access())?, search, compiler)
    }

    /// Loads a scene that is already in memory.
    pub fn from_source(
        source: &SceneSource,
        search: &[PathBuf],
        compiler: &dyn GroupCompiler,
    ) -> Result<Scene, SceneError> {
        if source.text.len() as u64 > SCENE_BYTES {
            let problem = SceneProblem::NotXml { reason: format!("it is longer than {} MB", SCENE_BYTES >> 20) };
            return Err(SceneError::nowhere(problem));
        }
        let document = xml::parse(&source.text, &source.name)?;
        let root = xml::Element::root(&document, &source.name);
        if root.tag() != "World" {
            return Err(SceneError::at(root.place(), SceneProblem::NotAWorld { tag: root.tag().to_owned() })
                .with_help("a scene is one <World> element"));
        }
        let mut folders = vec![source.folder.clone()];
        folders.extend(search.iter().cloned());
        let mut builder = Builder::new(source.name.to_string(), folders, compiler);
        for element in root.children() {
            builder.announce(&element)?;
        }
        for element in root.only_children()? {
            builder.element(&element)?;
        }
        builder.finish(root.place())
    }
}
