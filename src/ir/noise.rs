//! The noise functions of a program: their kinds and shapes.

/// The kinds of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoiseKind {
    /// Perlin's gradient noise, -1..1.
    Perlin,
    /// The same, 0..1.
    UPerlin,
    /// Simplex noise, -1..1.
    Simplex,
    /// The same, 0..1.
    USimplex,
    /// One random number a unit cell.
    Cell,
    /// One random number a point.
    Hash,
    /// Gabor noise, nearly always in -1..1. Its direction, bandwidth, impulses and anisotropy follow the coordinates and periods.
    Gabor,
}

impl NoiseKind {
    /// All kinds.
    pub const ALL: &[NoiseKind] = {
        use NoiseKind::*;
        &[Perlin, UPerlin, Simplex, USimplex, Cell, Hash, Gabor]
    };

    /// The names that `noise` and `pnoise` know it by.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            NoiseKind::Perlin => &["perlin", "snoise"],
            NoiseKind::UPerlin => &["uperlin", "noise"],
            NoiseKind::Simplex => &["simplex"],
            NoiseKind::USimplex => &["usimplex"],
            NoiseKind::Cell => &["cell"],
            NoiseKind::Hash => &["hash"],
            NoiseKind::Gabor => &["gabor"],
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<NoiseKind> {
        NoiseKind::ALL.iter().copied().find(|kind| kind.names().contains(&name))
    }

    /// Does it change smoothly, so that it has a gradient?
    pub fn has_gradient(self) -> bool {
        match self {
            NoiseKind::Perlin | NoiseKind::UPerlin | NoiseKind::Simplex | NoiseKind::USimplex | NoiseKind::Gabor => {
                true
            }
            NoiseKind::Cell | NoiseKind::Hash => false,
        }
    }

    /// Is there a periodic form of it?
    pub fn repeats(self) -> bool {
        !matches!(self, NoiseKind::Simplex | NoiseKind::USimplex)
    }
}

/// A noise function: its kind, its shape, and whether it repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Noise {
    /// The kind.
    pub kind: NoiseKind,
    /// How many coordinates it takes: 1 to 4. Periods, when it repeats, follow the coordinates.
    pub dims: u8,
    /// How many numbers it gives: 1 or 3.
    pub outputs: u8,
    /// True when it repeats.
    pub periodic: bool,
    /// True when the partial derivatives follow the values, coordinate by coordinate.
    pub gradient: bool,
    /// True when the change of up to three coordinates along x, then along y, follows all else that it reads: Gabor noise is filtered.
    pub filtered: bool,
}

impl Noise {
    /// Is there such a noise? Not every number of coordinates and results has one.
    pub fn exists(self) -> bool {
        let shape = (1..=4).contains(&self.dims) && matches!(self.outputs, 1 | 3);
        shape
            && (!self.filtered || self.kind == NoiseKind::Gabor)
            && (!self.periodic || self.kind.repeats())
            && (!self.gradient || self.kind.has_gradient())
    }

    /// How many registers it reads: coordinates, then periods, of Gabor noise its options and what it is filtered over.
    pub fn reads(self) -> u32 {
        let options = if self.kind == NoiseKind::Gabor { 6 } else { 0 };
        let pixel = if self.filtered { 2 * u32::from(self.dims.min(3)) } else { 0 };
        u32::from(self.dims) * if self.periodic { 2 } else { 1 } + options + pixel
    }

    /// How many registers it writes: values, then partial derivatives.
    pub fn writes(self) -> u32 {
        u32::from(self.outputs) * if self.gradient { 1 + u32::from(self.dims) } else { 1 }
    }
}
