//! A chart of the sphere of directions: a rectangle that is wide where scattering changes fast, near the horizon.

use glam::Vec3;

/// A place on the chart: 1 - the cube root of the cosine (0..2), and azimuth from the viewer's opposite (-pi..pi).
pub type Place = [f64; 2];

/// Maps the sphere around the z axis to a rectangle and back.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    cos: f64,
    sin: f64,
    /// Where the viewer's cosine lies, 0..1.
    pub(super) viewer: f64,
}

impl Chart {
    /// The chart of a viewer, whose mirror direction lies in the middle and not on the seam.
    pub fn new(wo: Vec3) -> Self {
        let (x, y) = (f64::from(wo.x), f64::from(wo.y));
        let length = x.hypot(y);
        let (cos, sin) = if length > 1e-12 { (-x / length, -y / length) } else { (1.0, 0.0) };
        Chart { cos, sin, viewer: Self::up(wo) }
    }

    /// 1 - the cube root of |z|. Near the poles the small components say it more precisely than the large one does.
    fn up(w: Vec3) -> f64 {
        let (x, y, z) = (f64::from(w.x), f64::from(w.y), f64::from(w.z).abs());
        if z < 0.5 { 1.0 - z.cbrt() } else { from_pole((x * x + y * y) / (1.0 + z)) }
    }

    /// Where a unit direction lies.
    pub fn place(&self, w: Vec3) -> Place {
        let (x, y) = (f64::from(w.x), f64::from(w.y));
        let up = Self::up(w);
        let across = if w.z >= 0.0 { up } else { 2.0 - up };
        [across, (y * self.cos - x * self.sin).atan2(x * self.cos + y * self.sin)]
    }

    /// The unit direction of a place.
    pub fn direction(&self, [across, phi]: Place) -> Vec3 {
        let up = across.min(2.0 - across);
        let versed = up * (3.0 - up * (3.0 - up));
        let sin = (versed * (2.0 - versed)).max(0.0).sqrt();
        let (x, y) = (sin * phi.cos(), sin * phi.sin());
        let z = (1.0 - across).powi(3);
        Vec3::new((x * self.cos - y * self.sin) as f32, (x * self.sin + y * self.cos) as f32, z as f32)
    }

    /// Solid angle over area of the chart.
    pub(super) fn density([across, _]: Place) -> f64 {
        3.0 * (1.0 - across) * (1.0 - across)
    }
}

/// 1 - the cube root of 1 - x, which keeps its digits near 0.
fn from_pole(x: f64) -> f64 {
    -((-x).ln_1p() / 3.0).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_invert() {
        let chart = Chart::new(Vec3::new(0.3, -0.4, 0.866));
        for w in [Vec3::new(1e-4, 2e-4, 1.0), Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.48, 0.64, -0.6)] {
            let w = w.normalize();
            assert!((chart.direction(chart.place(w)) - w).length() < 1e-6, "{w}");
        }
        assert!((chart.place(Vec3::new(-0.3, 0.4, 0.866))[1]).abs() < 1e-6);
    }
}
