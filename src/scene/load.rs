//! A loaded scene, and how a file (or the text itself) becomes one.

use super::build::Builder;
use super::error::{Place, SceneError};
use super::geometry::Geometry;
use super::group::GroupCompiler;
use super::xml;
use crate::exec;
use glam::Vec3;
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
        let text = std::fs::read_to_string(path)
            .map_err(|e| SceneError::nowhere(format!("cannot read the scene `{argument}`: {e}")))?;
        let folder = match path.parent() {
            Some(parent) if parent != Path::new("") => parent.to_owned(),
            _ => ".".into(),
        };
        Ok(SceneSource { name: argument.into(), text, folder })
    }
}

/// The camera as the scene gives it: a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it is.
    pub eye: Vec3,
    /// Where it looks, of unit length.
    pub direction: Vec3,
    /// Which way is up; not parallel to `direction`.
    pub up: Vec3,
    /// The vertical field of view in degrees.
    pub fov: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera { eye: Vec3::ZERO, direction: Vec3::NEG_Z, up: Vec3::Y, fov: 90.0 }
    }
}

/// What the scene's `<Option>`s ask for; they win over the command line, as in testrender.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The most bounces of a path.
    pub max_bounces: Option<u32>,
    /// From which bounce on a path may end early.
    pub rr_depth: Option<u32>,
    /// The square root of the samples a pixel.
    pub aa: Option<u32>,
    /// Samples go through the pixel's centre.
    pub no_jitter: Option<bool>,
    /// Shows a shader global in place of the picture: 1 Ng, 2 N, 3 dPdu, 4 dPdv, 5 uv.
    pub show_globals: Option<u32>,
}

/// A shader group, compiled, and what the scene says of it.
pub struct Material {
    /// Its name.
    pub name: String,
    /// The group that shades the surface.
    pub surface: exec::Group,
    /// The group that moves the surface, if any.
    pub displacement: Option<exec::Group>,
    /// True when the scene asks for its primitives to be sampled as lights.
    pub is_light: bool,
    /// Where it is written.
    pub place: Place,
}

/// What rays see that hit nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Background {
    /// Index of its material.
    pub material: u32,
    /// Side of the importance table; 0 asks for none.
    pub resolution: u32,
}

/// A scene, ready to be rendered.
pub struct Scene {
    /// Its name.
    pub name: String,
    /// The camera.
    pub camera: Camera,
    /// The options.
    pub options: Options,
    /// The materials, in the order of the scene.
    pub materials: Vec<Material>,
    /// The geometry.
    pub geometry: Geometry,
    /// The background, if any.
    pub background: Option<Background>,
    /// What is odd but no mistake.
    pub warnings: Vec<String>,
}

/// A file of a folder, without the dot that stands for the working folder.
pub(super) fn within(folder: &Path, name: &str) -> PathBuf {
    if folder == Path::new(".") { PathBuf::from(name) } else { folder.join(name) }
}

impl Scene {
    /// Loads the scene that `argument` names or is; `search` lists folders to look in after the scene's own.
    pub fn load(argument: &str, search: &[PathBuf], compiler: &dyn GroupCompiler) -> Result<Scene, SceneError> {
        Self::from_source(&SceneSource::read(argument)?, search, compiler)
    }

    /// Loads a scene that is already in memory.
    pub fn from_source(
        source: &SceneSource,
        search: &[PathBuf],
        compiler: &dyn GroupCompiler,
    ) -> Result<Scene, SceneError> {
        let document = xml::parse(&source.text, &source.name)?;
        let root = xml::Element { node: document.root_element(), file: source.name.clone() };
        if root.tag() != "World" {
            return Err(SceneError::at(root.place(), format!("the scene's root is <{}>", root.tag()))
                .with_help("a scene is one <World> element"));
        }
        let mut folders = vec![source.folder.clone()];
        folders.extend(search.iter().cloned());
        let mut builder = Builder::new(source.name.to_string(), folders, compiler);
        for element in root.only_children()? {
            builder.element(&element)?;
        }
        builder.finish(root.place())
    }
}
