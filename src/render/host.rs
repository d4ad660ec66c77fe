//! What shaders may ask of the renderer beside their points: the camera's space and a few attributes.

use super::accel::{Accel, Ray};
use super::settings::Settings;
use super::stop::Stop;
use crate::exec::{Attribute, AttributeAnswer, AttributeRequest, Host, PlainHost, Points, TraceRequest};
use crate::math::elementary::tan;
use crate::ops::matrix::{IDENTITY, Matrix, inverse, multiply};
use crate::scene::Camera;
use crate::texture::{Texture, TextureFiles};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// The version of the language, as `OSL_VERSION` gives it.
const LANGUAGE_VERSION: i32 = 11600;
/// The clipping planes that testrender reports; nothing is clipped.
const CLIP: [f32; 2] = [0.1, 1000.0];

/// The host for a scene seen by `camera`.
///
/// Differs from OSL: testrender's camera space is the world's; here it is the camera's, with x to the right, y up, z
/// forward and the eye at the origin. `fov` is the scene's own number, not the angle that the picture spans.
///
/// "screen" is what the camera sees, -1..1 upward, wider by the picture's aspect; "NDC" 0..1 to the right and down, "raster" the same in
/// pixels; their z is 0 at the near plane and 1 at the far one. Without an `accel`, rays of shaders meet nothing.
pub fn host(
    camera: &Camera,
    settings: &Settings,
    textures: &Arc<TextureFiles>,
    accel: Option<Arc<Accel>>,
) -> RenderHost {
    let mut host = PlainHost::default();
    let to_common = camera_to_common(camera);
    let size = settings.whole_frame().size;
    let [width, height] = size.map(|side| side as f32);
    let screen = multiply(&inverse(&to_common), &projection(camera));
    let ndc = multiply(&screen, &scaled_and_moved([0.5 * height / width, -0.5], [0.5, 0.5]));
    let raster = multiply(&ndc, &scaled_and_moved([width, height], [0.0; 2]));
    let spaces =
        [("camera", to_common), ("screen", inverse(&screen)), ("NDC", inverse(&ndc)), ("raster", inverse(&raster))];
    host.spaces.extend(spaces.map(|(name, matrix)| (name.to_owned(), matrix)));
    let attributes = camera_attributes(size, camera.fov, CLIP, [0.0; 2]);
    host.attributes.extend(attributes);
    RenderHost { plain: host, textures: textures.clone(), accel, stop: None }
}

/// What shaders of a scene may ask for: tables of spaces and attributes, what each point carries, and the scene's textures.
pub struct RenderHost {
    plain: PlainHost,
    textures: Arc<TextureFiles>,
    accel: Option<Arc<Accel>>,
    stop: Option<Arc<Stop>>,
}

impl RenderHost {
    /// The same, which gives up when `stop` says so.
    pub fn until(self, stop: &Arc<Stop>) -> Self {
        RenderHost { stop: Some(stop.clone()), ..self }
    }
}

impl Host for RenderHost {
    fn gives_up(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.cuts())
    }

    fn space(&self, name: &str, points: &Points) -> Option<Matrix> {
        self.plain.space(name, points)
    }

    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        let points = asked.points;
        let carried = match asked.name {
            "s" => Some((&points.u, &points.dudx, &points.dudy)),
            "t" => Some((&points.v, &points.dvdx, &points.dvdy)),
            _ => None,
        };
        let Some((value, dx, dy)) = carried.filter(|_| asked.object.is_empty()) else {
            return self.plain.attribute(asked, answer);
        };
        for &lane in answer.lanes() {
            answer.floats(lane, &[value[lane]]);
            answer.slopes(lane, &[dx[lane]], &[dy[lane]]);
        }
    }

    /// Rays that shaders send out meet what is in the way, from a little off the surface on, which they would else meet themselves.
    fn trace(&self, asked: &TraceRequest<'_>) -> Vec<bool> {
        let Some(accel) = &self.accel else { return vec![false; asked.rays.len()] };
        let ray = |ray: &[f32; 8]| {
            let (from, along) = (Vec3::new(ray[0], ray[1], ray[2]), Vec3::new(ray[3], ray[4], ray[5]));
            let (length, size) = (along.length(), from.abs().max_element().max(1.0));
            let least = (ray[6] * length).max(1e-4 * size);
            let direction = along / length;
            Ray { reach: ray[7] * length - least, ..Ray::new(from + least * direction, direction) }
        };
        let (rays, mut met): (Vec<Ray>, Vec<bool>) = (asked.rays.iter().map(ray).collect(), Vec::new());
        accel.any(&rays, &mut met);
        met
    }

    fn texture(&self, name: &str) -> Result<Arc<Texture>, String> {
        self.textures.get(name).map_err(|error| error.to_string())
    }

    fn read_text(&self, name: &str) -> Result<String, String> {
        self.textures.text(name)
    }
}

/// What every renderer answers of its camera: a picture of so many pixels, the angle in degrees, what is between two planes, and
/// when the shutter opens and closes.
pub fn camera_attributes(res: [u32; 2], fov: f32, clip: [f32; 2], shutter: [f32; 2]) -> HashMap<String, Attribute> {
    let aspect = res[0] as f32 / res[1] as f32;
    let attributes = [
        ("osl:version", Attribute::Ints(vec![LANGUAGE_VERSION])),
        ("camera:resolution", Attribute::Ints(res.iter().map(|&side| side as i32).collect())),
        ("camera:projection", Attribute::Strings(vec!["perspective".to_owned()])),
        ("camera:pixelaspect", Attribute::Floats(vec![1.0])),
        ("camera:screen_window", Attribute::Floats(vec![-aspect, -1.0, aspect, 1.0])),
        ("camera:fov", Attribute::Floats(vec![fov])),
        ("camera:clip", Attribute::Floats(clip.to_vec())),
        ("camera:clip_near", Attribute::Floats(vec![clip[0]])),
        ("camera:clip_far", Attribute::Floats(vec![clip[1]])),
        ("camera:shutter", Attribute::Floats(shutter.to_vec())),
        ("camera:shutter_open", Attribute::Floats(vec![shutter[0]])),
        ("camera:shutter_close", Attribute::Floats(vec![shutter[1]])),
    ];
    attributes.map(|(name, value)| (name.to_owned(), value)).into()
}

/// What the camera sees at a depth divided by it, and the depth between the planes.
fn projection(camera: &Camera) -> Matrix {
    let ([near, far], k) = (CLIP, 2.0 / tan(camera.fov.to_radians() * 0.5));
    let depth = far / (far - near);
    [k, 0.0, 0.0, 0.0, 0.0, k, 0.0, 0.0, 0.0, 0.0, depth, 1.0, 0.0, 0.0, -depth * near, 0.0]
}

fn scaled_and_moved([x, y]: [f32; 2], [right, down]: [f32; 2]) -> Matrix {
    let mut m = IDENTITY;
    (m[0], m[5], m[12], m[13]) = (x, y, right, down);
    m
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
