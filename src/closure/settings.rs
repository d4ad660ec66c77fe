//! What a render may choose about closures when the shader does not: layering, shadowing, softening, albedo, sampling.

pub use crate::bsdf::sheen::albedo::SheenAlbedo;
pub use crate::bsdf::sheen::sampling::SheenSampling;
pub use crate::bsdf::sheen::shadowing::Shadowing;
use std::fmt;
use std::str::FromStr;

/// How the base of a layer is scaled. alpha(w) = 1 - t a(w) is what the layer lets through at direction w.
///
/// Light that leaves below the surface counts with |cos| of the top's normal: it crossed the same layer on its way out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Layering {
    /// min(alpha_i, alpha_o): the largest scale that is safe over every energy-preserving base, and reciprocal. The
    /// default; loses up to 13 % over white Lambert.
    #[default]
    Min,
    /// alpha_o: no loss at a fixed view over Lambert, not reciprocal; what OSL's and MaterialX's layer do.
    View,
    /// alpha_i alpha_o / (1 - t mean a): no loss over Lambert, reciprocal, gains up to 16 % over a mirror.
    Kelemen,
    /// Kelemen's scale for diffuse lobes of the base and the smaller alpha for all others, each by color: no loss over diffuse
    /// bases, reciprocal, gains over none. Costs more than `min` where layers of it lie in each other, or vary in roughness.
    Lossless,
}

impl Layering {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, Layering); 4] = [
        ("min", Layering::Min),
        ("view", Layering::View),
        ("kelemen", Layering::Kelemen),
        ("lossless", Layering::Lossless),
    ];
}

impl FromStr for Layering {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        found.map(|&(_, v)| v).ok_or_else(|| {
            format!("unknown layering rule \"{text}\"; choose \"min\", \"view\", \"kelemen\" or \"lossless\"")
        })
    }
}

impl fmt::Display for Layering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::ALL.iter().find(|(_, v)| v == self).map_or("", |(name, _)| name))
    }
}

/// Choices for all closures of a render; a keyword on a closure wins over them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How bases are scaled.
    pub layering: Layering,
    /// The shadowing term of sheens.
    pub shadowing: Shadowing,
    /// Whether the terminator of sheens is softened (eq. 4 of the paper).
    pub softening: bool,
    /// How the albedo of sheens is found. Kelemen's mean albedo always takes the default.
    pub sheen_albedo: SheenAlbedo,
    /// How sheen directions are sampled.
    pub sheen_sampling: SheenSampling,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            layering: Layering::Min,
            shadowing: Shadowing::Exact,
            softening: true,
            sheen_albedo: SheenAlbedo::Fit,
            sheen_sampling: SheenSampling::Proposal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_parse_and_print() {
        for (name, value) in Layering::ALL {
            assert_eq!((name.parse(), value.to_string().as_str()), (Ok(value), name));
        }
        for (name, value) in Shadowing::ALL {
            assert_eq!((name.parse(), value.to_string().as_str()), (Ok(value), name));
        }
        for (name, value) in SheenAlbedo::ALL {
            assert_eq!((name.parse(), value.to_string().as_str()), (Ok(value), name));
        }
        let message = "max".parse::<Layering>().unwrap_err();
        assert!(message.contains("\"min\"") && message.contains("\"kelemen\""));
    }
}
