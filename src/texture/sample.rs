//! What a look-up is told and what it gives.

use super::wrap::Wrap;

/// How texels are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The nearest one.
    Closest,
    /// Bilinear.
    Linear,
    /// Bicubic, by uniform B-splines.
    Cubic,
    /// Bicubic in the finest level and in those that are magnified, else bilinear.
    #[default]
    Smart,
}

impl Interpolation {
    /// The one of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "closest" => Interpolation::Closest,
            "linear" | "bilinear" => Interpolation::Linear,
            "cubic" | "bicubic" => Interpolation::Cubic,
            "smartcubic" | "smartbicubic" => Interpolation::Smart,
            _ => return None,
        })
    }
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct Lookup {
    /// What it is outside, along s and t; the file's own where that is nothing.
    pub wrap: [Option<Wrap>; 2],
    /// How texels are joined.
    pub interpolation: Interpolation,
    /// Factors of the ellipse along s and t.
    pub width: [f32; 2],
    /// What is added to the ellipse, in units of s and t.
    pub blur: [f32; 2],
    /// The first channel that is wanted.
    pub first: u32,
    /// What channels are that there are not.
    pub fill: f32,
}

impl Default for Lookup {
    fn default() -> Self {
        let interpolation = Interpolation::default();
        Lookup { wrap: [None; 2], interpolation, width: [1.0; 2], blur: [0.0; 2], first: 0, fill: 0.0 }
    }
}

/// Four channels and how they change along s and t.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The channels.
    pub value: [f32; 4],
    /// Their change a unit of s.
    pub ds: [f32; 4],
    /// Their change a unit of t.
    pub dt: [f32; 4],
}
