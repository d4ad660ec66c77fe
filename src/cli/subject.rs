//! What a command renders: a scene, or a shader in the built-in scene, with values for parameters that go before its own.

use super::failure::Failure;
use crate::scene::{PREVIEW_LAYER, Scene, ShaderFiles, names_shader};
use std::path::{Path, PathBuf};

/// A scene or a shader, as an argument names it.
pub struct Subject<'a> {
    /// The argument: a file's name, a name of what is in the binary, or the text of a scene.
    pub argument: &'a str,
    /// Folders to look for shaders and meshes in, after that of the file.
    pub search: &'a [PathBuf],
}

impl Subject<'_> {
    /// Is it a shader, which the built-in scene shows?
    pub fn is_shader(&self) -> bool {
        names_shader(self.argument)
    }

    /// The path of a parameter that is called so on the command line.
    pub fn param(&self, name: &str) -> String {
        // The built-in scene has shaders of its own, whose parameters are not meant.
        let bare = self.is_shader() && own_name(name).is_none();
        if bare { format!("{PREVIEW_LAYER}.{name}") } else { name.to_owned() }
    }

    /// Loads it, by the parameters that `shaders` has been given, all of which must be there.
    pub fn load(&self, shaders: &ShaderFiles) -> Result<Scene, Failure> {
        let scene = match self.is_shader() {
            true => Scene::of_shader(Path::new(self.argument), self.search, shaders),
            false => Scene::load(self.argument, self.search, shaders),
        };
        let scene = scene.map_err(|error| match self.is_outside(shaders) {
            Some(root) => Failure::Usage(format!(
                "error: `{}` lies outside of the sandbox {}, where nothing is read",
                self.argument,
                root.display()
            )),
            None => Failure::of_scene(error),
        })?;
        match shaders.unused_params().first() {
            None => Ok(scene),
            Some((path, near)) => Err(self.no_param(path, near.as_deref())),
        }
    }

    /// The sandbox that the argument's own file is not in, if there is one.
    fn is_outside<'s>(&self, shaders: &'s ShaderFiles) -> Option<&'s Path> {
        let (access, path) = (&shaders.compiler.options.access, Path::new(self.argument));
        access.sandbox().filter(|_| path.is_file() && !access.covers(path))
    }

    fn no_param(&self, path: &str, near: Option<&str>) -> Failure {
        let strip = |path: &str| own_name(path).filter(|_| self.is_shader()).unwrap_or(path).to_owned();
        let what = if self.is_shader() { "the shader" } else { "no shader of the scene" };
        let has = if self.is_shader() { "has no parameter" } else { "has a parameter" };
        let help = match near {
            Some(near) => format!("did you mean `{}`?", strip(near)),
            None if self.is_shader() => "`velour info FILE.osl` lists its parameters".to_owned(),
            None => "a parameter is called NAME, LAYER.NAME, GROUP.NAME or GROUP.LAYER.NAME".to_owned(),
        };
        Failure::Usage(format!("error: {what} {has} `{}`\n  help: {help}", strip(path)))
    }
}

/// The name of a parameter of the shader that the built-in scene shows, if a path leads to one.
fn own_name(path: &str) -> Option<&str> {
    path.strip_prefix(PREVIEW_LAYER)?.strip_prefix('.')
}
