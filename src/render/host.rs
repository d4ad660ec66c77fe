//! What shaders may ask of the renderer beside their points: the camera's space and a few attributes.

use super::settings::Settings;
use crate::exec::{Attribute, PlainHost};
use crate::ops::matrix::Matrix;
use crate::scene::Camera;
use glam::Vec3;

/// The version of the language, as `OSL_VERSION` gives it.
const LANGUAGE_VERSION: i32 = 11600;
/// The clipping planes that testrender reports; nothing is clipped.
const CLIP: [f32; 2] = [0.1, 1000.0];

/// The host for a scene seen by `camera`.
///
/// Differs from OSL: testrender's camera space is the world's; here it is the camera's, with x to the right, y up, z
/// forward and the eye at the origin. `fov` is the scene's own number, not the angle that the picture spans.
pub fn host(camera: &Camera, settings: &Settings) -> PlainHost {
    let mut host = PlainHost::default();
    host.spaces.insert("camera".to_owned(), camera_to_common(camera));
    let aspect = settings.width as f32 / settings.height as f32;
    let attributes = [
        ("osl:version", Attribute::Ints(vec![LANGUAGE_VERSION])),
        ("camera:resolution", Attribute::Ints(vec![settings.width as i32, settings.height as i32])),
        ("camera:projection", Attribute::Strings(vec!["perspective".to_owned()])),
        ("camera:pixelaspect", Attribute::Floats(vec![1.0])),
        ("camera:screen_window", Attribute::Floats(vec![-aspect, -1.0, aspect, 1.0])),
        ("camera:fov", Attribute::Floats(vec![camera.fov])),
        ("camera:clip", Attribute::Floats(CLIP.to_vec())),
        ("camera:clip_near", Attribute::Floats(vec![CLIP[0]])),
        ("camera:clip_far", Attribute::Floats(vec![CLIP[1]])),
        ("camera:shutter", Attribute::Floats(vec![0.0, 0.0])),
        ("camera:shutter_open", Attribute::Floats(vec![0.0])),
        ("camera:shutter_close", Attribute::Floats(vec![0.0])),
    ];
    host.attributes.extend(attributes.map(|(name, value)| (name.to_owned(), value)));
    host
}

/// Rows are the axes and the origin of camera space, in the world.
fn camera_to_common(camera: &Camera) -> Matrix {
    let forward = camera.direction;
    let right = forward.cross(camera.up).normalize_or(Vec3::X);
    let up = right.cross(forward);
    let row = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
    let rows = [row(right, 0.0), row(up, 0.0), row(forward, 0.0), row(camera.eye, 1.0)];
    std::array::from_fn(|i| rows[i / 4][i % 4])
}
