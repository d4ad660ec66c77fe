//! Camera rays: a pinhole, as testrender's, with the footprint of a pixel.

use crate::lanes;
use crate::math::columns::Column3;
use crate::math::elementary::tan;
use crate::scene::Camera;
use glam::Vec3;

/// A camera set up for an image size.
#[derive(Clone, Copy, Debug)]
pub struct RayCamera {
    eye: Vec3,
    direction: Vec3,
    across: Vec3,
    upward: Vec3,
    inverse_width: f32,
    inverse_height: f32,
    pixel_solid_angle: f32,
}

impl RayCamera {
    /// Sets `camera` up for an image of `width` x `height` pixels.
    pub fn new(camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let k = tan(camera.fov.to_radians() * 0.5);
        let across = camera.direction.cross(camera.up).normalize() * (k * width as f32 / height as f32);
        // As in testrender, k is the whole height of the film at distance 1, so a picture spans tan(fov/2), not twice
        // that. Scenes written for it are framed this way.
        let upward = across.cross(camera.direction).normalize() * k;
        let (inverse_width, inverse_height) = (1.0 / width as f32, 1.0 / height as f32);
        let pixel_solid_angle = inverse_width * inverse_height * across.length() * upward.length();
        RayCamera {
            eye: camera.eye,
            direction: camera.direction,
            across,
            upward,
            inverse_width,
            inverse_height,
            pixel_solid_angle,
        }
    }

    /// Where every ray begins.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The unit direction through a point of the image, in pixels from the upper left.
    #[inline(always)]
    pub fn direction(&self, x: f32, y: f32) -> Vec3 {
        let right = self.across * (x * self.inverse_width - 0.5);
        let up = self.upward * (0.5 - y * self.inverse_height);
        (right + up + self.direction).normalize()
    }

    /// How much the width of a pixel's cone grows with distance, for a ray of `direction`.
    #[inline]
    pub fn spread(&self, direction: Vec3) -> f32 {
        let cos = self.direction.dot(direction);
        (self.pixel_solid_angle * cos).max(0.0).sqrt() * cos
    }
}

lanes! {
    /// Directions through the points (`x`, `y`) + `inside` of the image, a lane each.
    pub fn directions(camera: &RayCamera, x: f32, y: f32, inside: [&[f32]; 2], out: &mut Column3) {
        let [inside_x, inside_y] = inside;
        let n = out.x.len();
        let (inside_x, inside_y) = (&inside_x[..n], &inside_y[..n]);
        let (out_x, out_y, out_z) = (&mut out.x[..n], &mut out.y[..n], &mut out.z[..n]);
        for i in 0..n {
            let direction = camera.direction(x + inside_x[i], y + inside_y[i]);
            (out_x[i], out_y[i], out_z[i]) = (direction.x, direction.y, direction.z);
        }
    }
}
