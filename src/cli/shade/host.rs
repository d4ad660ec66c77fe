//! What the shaders of `velour shade` may ask for: the spaces, attributes and userdata of OSL's testshade.

use super::group::param;
use super::options::Options;
use crate::cli::failure::Failure;
use crate::exec::{Attribute, AttributeAnswer, AttributeRequest, Host, Points, TraceRequest};
use crate::ops::matrix::{IDENTITY, Matrix, inverse, multiply};
use crate::render::camera_attributes;
use crate::scene::{ParamValue, Values};
use crate::texture::{Texture, TextureError, TextureFiles};
use std::collections::HashMap;
use std::sync::Arc;
use velour_grammar::files::Access;

/// Spaces and values around the patch.
#[derive(Debug)]
pub struct PatchHost {
    res: [u32; 2],
    attributes: HashMap<String, Attribute>,
    userdata: Vec<ParamValue>,
    textures: TextureFiles,
}

/// The planes between which the camera sees.
const CLIP: [f32; 2] = [0.1, 1000.0];

impl PatchHost {
    /// The host of a command line.
    ///
    /// # Errors
    /// A value of `--userdata` that cannot be read.
    pub fn new(options: &Options, access: Access) -> Result<Self, Failure> {
        let mut attributes = camera_attributes(options.res, 90.0, CLIP, [0.0, 1.0]);
        // OSL's tests ask for it.
        attributes.insert("options.blahblah".to_owned(), Attribute::Floats(vec![std::f32::consts::PI]));
        let userdata: Result<Vec<ParamValue>, Failure> = options.userdata.iter().map(param).collect();
        Ok(PatchHost {
            res: options.res,
            attributes,
            userdata: userdata?,
            textures: TextureFiles::new(options.path.clone()).with_access(access),
        })
    }
}

impl PatchHost {
    /// The matrix from common to what the camera sees.
    fn space_of_common(&self, name: &str) -> Option<Matrix> {
        let ndc = || multiply(&screen(), &multiply(&scaled(0.5, 0.5, 1.0), &moved(0.5, 0.5, 0.0)));
        Some(match name {
            "screen" => screen(),
            "NDC" => ndc(),
            "raster" => multiply(&ndc(), &scaled(self.res[0] as f32, self.res[1] as f32, 1.0)),
            _ => return None,
        })
    }
}

/// A turn about z, then nothing else.
fn turned(quarters: f32) -> Matrix {
    let (s, c) = (crate::math::elementary::sin(quarters), crate::math::elementary::cos(quarters));
    [c, s, 0.0, 0.0, -s, c, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
}

fn moved(x: f32, y: f32, z: f32) -> Matrix {
    let mut m = IDENTITY;
    m[12..15].copy_from_slice(&[x, y, z]);
    m
}

fn scaled(x: f32, y: f32, z: f32) -> Matrix {
    let mut m = IDENTITY;
    (m[0], m[5], m[10]) = (x, y, z);
    m
}

/// A perspective of 90 degrees: what is at the near plane has depth 0, at the far one 1.
fn screen() -> Matrix {
    let [near, far] = CLIP;
    let mut m = IDENTITY;
    (m[10], m[11], m[14], m[15]) = (far / (far - near), 1.0, -far * near / (far - near), 0.0);
    m
}

impl Host for PatchHost {
    fn space(&self, name: &str, _points: &Points) -> Option<Matrix> {
        let quarter = std::f32::consts::FRAC_PI_4;
        Some(match name {
            "" | "common" | "world" | "camera" => IDENTITY,
            "shader" => multiply(&turned(quarter), &moved(1.0, 0.0, 0.0)),
            "object" => multiply(&turned(2.0 * quarter), &moved(0.0, 1.0, 0.0)),
            "myspace" => scaled(1.0, 2.0, 1.0),
            "screen" | "NDC" | "raster" => inverse(&self.space_of_common(name)?),
            _ => return None,
        })
    }

    /// What rays meet is made up as OSL's testshade makes it up, so that the same shaders say the same.
    fn trace(&self, asked: &TraceRequest<'_>) -> Vec<bool> {
        let hit = |(&lane, ray): (&usize, &[f32; 8])| {
            let along = ray[0] * ray[3] + ray[1] * ray[4] + ray[2] * ray[5];
            asked.points.u[lane] / along > 0.5
        };
        asked.lanes.iter().zip(asked.rays).map(hit).collect()
    }

    fn message(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        for &lane in answer.lanes() {
            match asked.name {
                "hit" => answer.ints(lane, &[i32::from(asked.points.u[lane] > 0.5)]),
                "hitdist" if asked.points.u[lane] > 0.5 => answer.floats(lane, &[0.5]),
                _ => {}
            }
        }
    }

    fn texture(&self, name: &str) -> Result<Arc<Texture>, String> {
        self.textures.get(name).map_err(|error| match error {
            // In the words of OpenImageIO.
            TextureError::NotFound { name, .. } => format!("Could not open file: {name}: No such file or directory"),
            other => other.to_string(),
        })
    }

    fn read_text(&self, name: &str) -> Result<String, String> {
        self.textures.text(name)
    }

    /// Those of OSL's testshade that have a label.
    fn prints_label(&self, closure: &str) -> bool {
        matches!(closure, "diffuse" | "phong")
    }

    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        let named =
            if asked.object.is_empty() { asked.name.to_owned() } else { format!("{}.{}", asked.object, asked.name) };
        if let Some(value) = self.attributes.get(&named).or_else(|| self.attributes.get(asked.name)) {
            return answer.all(value);
        }
        if !asked.object.is_empty() {
            return;
        }
        let points = asked.points;
        for &lane in answer.lanes() {
            let [u, v] = [(&points.u, &points.dudx, &points.dudy), (&points.v, &points.dvdx, &points.dvdy)]
                .map(|(value, dx, dy)| [value[lane], dx[lane], dy[lane]]);
            let p = points.p.get(lane);
            let value = match asked.name {
                "s" => Some(u),
                "t" => Some(v),
                "red" if p.x > 0.5 => Some(u),
                "green" if p.x < 0.5 => Some(v),
                "blue" if (p.y * 12.0) as i32 % 2 == 0 => Some([1.0 - u[0], -u[1], -u[2]]),
                _ => None,
            };
            if let Some([value, dx, dy]) = value {
                answer.floats(lane, &[value]);
                answer.slopes(lane, &[dx], &[dy]);
            }
            match asked.name {
                "face_idx" => answer.ints(lane, &[(4.0 * u[0]) as i32]),
                "shading:index" => answer.ints(lane, &[points.index[lane]]),
                _ => {}
            }
        }
        if let Some(value) = self.userdata.iter().find(|value| value.name == asked.name) {
            answer.all(&match &value.values {
                Values::Ints(values) => Attribute::Ints(values.clone()),
                Values::Floats(values) => Attribute::Floats(values.clone()),
                Values::Strings(values) => Attribute::Strings(values.clone()),
            });
        }
    }
}
