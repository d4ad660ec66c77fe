//! A loaded scene, as data: what a renderer reads and a host may change.

use super::camera::Camera;
use super::error::Place;
use super::geometry::Geometry;
use super::group::GroupSpec;
use crate::exec;
use crate::texture::TextureFiles;
use std::sync::Arc;

/// What the scene's `<Option>`s ask for.
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
    /// Width and height in pixels that the `<Camera>` states with `res`; unlike the others, the command line wins over it.
    pub resolution: Option<[u32; 2]>,
}

/// A shader group, compiled, and what the scene says of it.
#[derive(Clone, Debug)]
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
    /// The surface group as it is written, for a host that compiles it again.
    pub surface_spec: Arc<GroupSpec>,
    /// The displacement group as it is written.
    pub displacement_spec: Option<Arc<GroupSpec>>,
}

/// What rays see that hit nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Background {
    /// Index of its material.
    pub material: u32,
    /// The least number of cells a side of the importance table; a renderer may take more, and 0 asks for no table.
    pub resolution: u32,
}

/// A scene, ready to be rendered. A copy costs little: it shares geometry and programs.
#[derive(Clone, Debug)]
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
    pub geometry: Arc<Geometry>,
    /// The background, if any.
    pub background: Option<Background>,
    /// What is odd but no mistake.
    pub warnings: Vec<String>,
    /// The textures that its shaders may name; none is read before a shader asks for it.
    pub textures: Arc<TextureFiles>,
}
