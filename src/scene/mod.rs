//! Scenes: testrender's XML, shader groups as text, meshes, and the geometry that a renderer walks over.
//!
//! [`Scene::load`] takes a file name, or the XML text itself, and a [`GroupCompiler`] that turns each [`GroupSpec`]
//! into something that can be run. Everything a user can get wrong ends here, as one [`SceneError`] with a place.
//!
//! Decision (2026-11-30): all layers of a displacement group that assign `P` run, in order, because `P` is what such a layer puts out; instead
//! of the last one alone, as OSL's `lazyglobals` would have it, which takes no account of what a layer moves.

mod build;
mod camera;
mod compiler;
mod error;
mod extent;
mod flakes;
mod geometry;
mod group;
mod group_xml;
mod load;
mod mesh;
mod obj;
mod overrides;
mod placement;
mod places;
mod preview;
// The data of the room, which is called as the room is.
#[allow(clippy::module_inception)]
mod scene;
mod shipped;
mod source;
mod spec;
mod weave;
mod xml;

pub use camera::{Camera, CameraFlaw};
pub use compiler::{ShaderFiles, find_shader};
pub use error::{MeshFlaw, Place, SceneError, SceneProblem};
pub use geometry::{Geometry, Object, Primitive, Shape};
pub use group::{Connection, GroupCompiler, GroupSpec, Hints, Layer, ParamType, ParamValue, Usage, Values};
pub use obj::{Attribute as MeshAttribute, LineFlaw};
pub use places::Places;
pub use preview::{PREVIEW_LAYER, names_shader};
pub use scene::{Background, Material, Options, Scene};
pub use shipped::{SHIPPED, SHIPPED_SCENES, is_shipped_shader, shipped_shader};
pub use source::SceneSource;
pub use spec::{Statements, parse_group};
