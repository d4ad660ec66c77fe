//! What a distribution of microfacets must answer, and the widths that all of them share.

use super::geometry::Facets;
use crate::bsdf::{limited, select};
use glam::Vec3;

/// Below this width in both directions a boundary counts as smooth.
pub const MIN_ALPHA: f32 = 1e-3;

/// Widths of a distribution along the local x and y axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widths {
    /// Width along x.
    pub x: f32,
    /// Width along y.
    pub y: f32,
}

impl Widths {
    /// The part of what facets lose that is given back: all where both widths are equal, and nine tenths where one is twice the other or
    /// more, because their loss is estimated from round ones and no direction may gain.
    #[inline(always)]
    pub fn given_back(self) -> f32 {
        let ratio = self.x.max(self.y) / self.x.min(self.y);
        1.0 - 0.1 * (ratio - 1.0).min(1.0)
    }

    /// The width that the facets have in the azimuth of a direction.
    #[inline(always)]
    pub fn toward(self, w: Vec3) -> f32 {
        let (x, y) = (self.x * w.x, self.y * w.y);
        // Toward the normal no azimuth counts more than another.
        let width = (x * x + y * y + self.x * self.y * (w.z * w.z)).sqrt();
        limited(select(self.x == self.y, self.x, width), MIN_ALPHA, 1.0)
    }
}

/// A distribution of microfacets over a flat surface, with the Smith shadowing that belongs to it.
pub trait Distribution: Copy + 'static {
    /// Its name where a type would not do.
    const FACETS: Facets;
    /// Makes the constants; widths are in 1e-3..1.
    fn new(widths: Widths) -> Self;
    /// The widths in force, which are not those given where a model has only one.
    fn widths(&self) -> Widths;
    /// Density of facets over solid angle, 1/sr, for a unit m; its projected area is 1. Zero at and below the horizon.
    fn d(&self, m: Vec3) -> f32;
    /// Smith's Lambda of a unit direction, >= 0 and finite; its side is ignored.
    fn lambda(&self, v: Vec3) -> f32;
    /// A unit micronormal with density D cos for two numbers in [0, 1); m.z >= 0.
    fn sample_normal(&self, u: f32, v: f32) -> Vec3;
}

/// The unit normal of slopes that point along an azimuth.
#[inline(always)]
pub(super) fn normal_of_slope(w: Widths, r2: f32, (cos, sin): (f32, f32)) -> Vec3 {
    let r = r2.max(0.0).sqrt();
    let (x, y) = (w.x * r * cos, w.y * r * sin);
    let scale = 1.0 / (1.0 + x * x + y * y).sqrt();
    Vec3::new(x * scale, y * scale, scale)
}
