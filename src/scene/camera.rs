//! The camera as a scene gives it, and what keeps one from making a picture.

use glam::Vec3;
use std::fmt;

/// The camera as the scene gives it: a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it is.
    pub eye: Vec3,
    /// Where it looks, of unit length.
    pub direction: Vec3,
    /// Which way is up; not parallel to `direction`.
    pub up: Vec3,
    /// In degrees; the film is tan(fov / 2) high in all at distance 1, as in testrender, so that a picture shows about half of the angle.
    pub fov: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera { eye: Vec3::ZERO, direction: Vec3::NEG_Z, up: Vec3::Y, fov: 90.0 }
    }
}

/// What keeps a camera from making a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CameraFlaw {
    /// The eye is nowhere: a coordinate is not a finite number.
    Eye,
    /// It looks nowhere: the direction is not of unit length.
    Direction,
    /// `up` has no length, or is parallel to where the camera looks.
    Up,
    /// The field of view is no angle above 0 and below 180 degrees.
    Angle,
    /// The field of view is so small that all pixels would look in one direction.
    TooNarrow,
}

impl CameraFlaw {
    /// What is wrong, in one clause.
    pub fn message(self) -> &'static str {
        match self {
            CameraFlaw::Eye => "the camera's eye is nowhere",
            CameraFlaw::Direction => "the camera looks nowhere",
            CameraFlaw::Up => "the camera's `up` is parallel to where it looks",
            CameraFlaw::Angle => "the camera's `fov` is no angle between 0 and 180 degrees",
            CameraFlaw::TooNarrow => "the camera's `fov` is so small that all pixels look in one direction",
        }
    }

    /// What helps, in one clause.
    pub fn help(self) -> &'static str {
        match self {
            CameraFlaw::Eye => "`eye` must be three finite numbers",
            CameraFlaw::Direction => "`dir`, or `look_at` minus `eye`, must have a length",
            CameraFlaw::Up => "turn `up` aside, for example to 0,0,1",
            CameraFlaw::Angle => "90 is wide, 30 is narrow",
            CameraFlaw::TooNarrow => "give at least 0.00001 degrees, and move `eye` nearer to what is far away",
        }
    }
}

impl fmt::Display for CameraFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.message(), self.help())
    }
}

impl std::error::Error for CameraFlaw {}

impl Camera {
    /// The least field of view in degrees: below it, the directions of a picture's two edges differ by less than the
    /// last bit of a single.
    pub const LEAST_FOV: f32 = 1e-5;

    /// The first thing that keeps this camera from making a picture, if any.
    pub fn flaw(&self) -> Option<CameraFlaw> {
        if !self.eye.is_finite() {
            Some(CameraFlaw::Eye)
        } else if !self.direction.is_normalized() {
            Some(CameraFlaw::Direction)
        } else if !self.up.is_finite() || self.direction.cross(self.up).length() <= 1e-6 * self.up.length() {
            Some(CameraFlaw::Up)
        } else if !(self.fov > 0.0 && self.fov < 180.0) {
            Some(CameraFlaw::Angle)
        } else if self.fov < Self::LEAST_FOV {
            Some(CameraFlaw::TooNarrow)
        } else {
            None
        }
    }
}
