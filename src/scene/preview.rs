//! The scene that a shader alone is shown in: a ball with a groove and a draped cloth, on paper, under lamps.

use super::compiler::ShaderFiles;
use super::error::{SceneError, SceneProblem};
use super::scene::Scene;
use super::shipped::{is_shipped_scene, is_shipped_shader};
use super::source::SceneSource;
use crate::compile::Shader;
use crate::lang::types::{Base, Length, Type};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use velour_grammar::ast::ShaderKind;

/// The scene, with places for the layers of the groups.
const SCENE: &str = include_str!("../../shaders/preview/scene.xml");

/// The layer of the shader that is shown, by which its parameters are set: `material.roughness`.
pub const PREVIEW_LAYER: &str = "material";

impl Scene {
    /// The built-in scene with the shader of `file`, or of that name, on its ball and its cloth, which are the materials `ball` and
    /// `cloth`; `search` lists folders to look in after the file's own.
    ///
    /// A shader that gives `Ci` no closure is shown by its first output: a closure as it is, a color or a number as that of a matte
    /// surface. A displacement shader moves matte surfaces.
    ///
    /// # Errors
    /// The shader is not found, or wrong.
    pub fn of_shader(file: &Path, search: &[PathBuf], compiler: &ShaderFiles) -> Result<Scene, SceneError> {
        let source = SceneSource::of_shader(file, search, compiler)?;
        let mut scene = Scene::from_source(&source, search, compiler)?;
        scene.name = file.display().to_string();
        Ok(scene)
    }
}

impl SceneSource {
    /// The text of the scene that [`Scene::of_shader`] shows; it depends on what the shader puts out.
    ///
    /// # Errors
    /// The shader is not found, or wrong.
    pub fn of_shader(file: &Path, search: &[PathBuf], compiler: &ShaderFiles) -> Result<SceneSource, SceneError> {
        let folder = file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
        let mut folders = vec![folder.to_owned()];
        folders.extend(search.iter().cloned());
        let shader = match compiler.named(&name, &folders) {
            Some(Ok(shader)) => shader,
            Some(Err(error)) => {
                let problem = SceneProblem::Shader { shader: name.into(), error: Arc::new(error) };
                return Err(SceneError::nowhere(problem));
            }
            None => {
                let help = compiler.help_to_find(&name, &folders);
                return Err(SceneError::nowhere(SceneProblem::ShaderNotFound { shader: name.into() }).with_help(help));
            }
        };
        let text = scene_text(&name, &shader);
        Ok(SceneSource { name: "<built-in scene>".into(), text, folder: folder.to_owned() })
    }
}

/// Does an argument name a shader, which the built-in scene shows, and no scene?
pub fn names_shader(argument: &str) -> bool {
    let path = Path::new(argument);
    match path.extension() {
        _ if argument.trim_start().starts_with('<') => false,
        Some(extension) => extension == "osl" || extension == "oso",
        // A scene goes before a shader of its name.
        None => is_shipped_shader(argument) && !is_shipped_scene(argument) && !path.exists(),
    }
}

/// The scene's text with the shader in it.
fn scene_text(name: &str, shader: &Shader) -> String {
    let layer = format!(r#"<Shader name="{}" layer="{PREVIEW_LAYER}"/>"#, escaped(name));
    let matte = r#"<Shader name="velour:matte" layer="matte"/>"#;
    if shader.typed.kind == ShaderKind::Displacement {
        return SCENE.replace("@surface@", matte).replace("@displacement@", &layer);
    }
    let surface = match shown_output(shader) {
        None => layer,
        Some((output, input)) => format!(
            r#"{layer}<Shader name="velour:shown" layer="shown"/><ConnectShaders srclayer="{PREVIEW_LAYER}" srcparam="{output}" dstlayer="shown" dstparam="{input}"/>"#
        ),
    };
    SCENE.replace("@surface@", &surface).replace("@displacement@", "")
}

/// The output that stands for `Ci` where the shader leaves that empty, and what it is connected to.
fn shown_output(shader: &Shader) -> Option<(&str, &'static str)> {
    if shader.group().build().is_ok_and(|group| group.closures().next().is_some()) {
        return None;
    }
    let first = |fits: fn(Base) -> bool| {
        let single = |ty: &Type| ty.length == Length::Single && ty.base().is_some_and(fits);
        let mut outputs = shader.typed.declared().filter(|(param, _)| param.output);
        outputs.find(|(_, variable)| single(&variable.ty)).map(|(_, variable)| variable.name.as_str())
    };
    let closure = first(|base| base == Base::Closure).map(|name| (name, "bsdf"));
    let color = || first(|base| base == Base::Color).map(|name| (name, "Cs"));
    let number = || first(|base| base == Base::Float).map(|name| (name, "value"));
    closure.or_else(color).or_else(number)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
