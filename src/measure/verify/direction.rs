//! A direction of view, as a cosine and an azimuth.

use glam::Vec3;

/// A direction of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Cosine to the normal.
    pub cos: f64,
    /// Azimuth from u, radians.
    pub azimuth: f64,
}

impl View {
    /// The unit direction to the viewer.
    pub fn wo(&self) -> Vec3 {
        let sin = ((1.0 - self.cos) * (1.0 + self.cos)).max(0.0).sqrt();
        Vec3::new((sin * self.azimuth.cos()) as f32, (sin * self.azimuth.sin()) as f32, self.cos as f32)
    }
}
