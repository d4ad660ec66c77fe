//! Fresnel reflection: how much a smooth boundary reflects, as one trait with three models, and the refracted direction.
//!
//! A model gives a number, the same for every wavelength ([`Dielectric`]), or a color ([`Conductor`], [`Schlick`]); only those
//! that say [`Fresnel::COLORED`] make a lobe compute three.

pub mod conductor;
pub mod dielectric;
pub mod schlick;

pub(crate) use super::limited;
pub use conductor::{Conductor, conductor};
pub use dielectric::{Dielectric, dielectric, refracted};
pub use schlick::{Schlick, eta_of_reflectance};

use super::Params;
use glam::Vec3;

/// What a term that rises as Schlick's is made of, of a color its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// The part reflected at normal incidence.
    pub f0: f32,
    /// The part reflected at grazing incidence and beyond the critical angle.
    pub f90: f32,
    /// The exponent of its rise, >= 0.
    pub exponent: f32,
}

/// What a boundary reflects at each angle.
pub trait Fresnel: Copy + 'static {
    /// How many parameters it reads.
    const PARAMS: usize;
    /// True when the three components of [`Fresnel::color`] differ.
    const COLORED: bool;
    /// Makes the constants from the parameters that begin at index `from`.
    fn prepare(params: Params, from: usize) -> Self;
    /// Transmitted over incident index, > 0 when light passes.
    fn eta(&self) -> f32;
    /// What it is made of if it rises as Schlick's.
    #[inline(always)]
    fn ends(&self) -> Option<Ends> {
        None
    }
    /// The reflected part at this cosine of incidence (its sign is ignored), 0..1 in each component.
    fn color(&self, cos: f32) -> Vec3;
    /// The reflected part where the components are equal, otherwise the largest one.
    #[inline(always)]
    fn largest(&self, cos: f32) -> f32 {
        let c = self.color(cos);
        c.x.max(c.y).max(c.z)
    }
    /// The mean component.
    #[inline(always)]
    fn mean(&self, cos: f32) -> f32 {
        let c = self.color(cos);
        (c.x + c.y + c.z) * (1.0 / 3.0)
    }
    /// The largest component of what is not reflected.
    #[inline(always)]
    fn passed(&self, cos: f32) -> f32 {
        let c = self.color(cos);
        1.0 - c.x.min(c.y).min(c.z)
    }
}
