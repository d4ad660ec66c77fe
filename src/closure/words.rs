//! Enums that a shader chooses from by a word.

use super::settings::{Layering, Shadowing, SheenSampling};
use crate::bsdf::microfacet::{Facets, Geometry, Sampling, Scattering};

/// An enum whose values have names in the language.
pub trait Words: Copy + PartialEq + Send + Sync + std::fmt::Debug + 'static {
    /// Every word with its value, the default first; several words may have one value.
    const ALL: &'static [(&'static str, Self)];

    /// The value of a word, if it is one.
    fn parse(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == word).map(|&(_, value)| value)
    }
}

impl Words for Layering {
    const ALL: &'static [(&'static str, Self)] = &Layering::ALL;
}

impl Words for Shadowing {
    const ALL: &'static [(&'static str, Self)] = &Shadowing::ALL;
}

impl Words for SheenSampling {
    const ALL: &'static [(&'static str, Self)] = &SheenSampling::ALL;
}

impl Words for Geometry {
    const ALL: &'static [(&'static str, Self)] = Geometry::ALL;
}

impl Words for Sampling {
    const ALL: &'static [(&'static str, Self)] = Sampling::ALL;
}

impl Words for Scattering {
    const ALL: &'static [(&'static str, Self)] = Scattering::ALL;
}

/// The distribution of facets; none is a smooth boundary.
impl Words for Option<Facets> {
    const ALL: &'static [(&'static str, Self)] = &[
        ("ggx", Some(Facets::Ggx)),
        ("beckmann", Some(Facets::Beckmann)),
        ("blinn", Some(Facets::Blinn)),
        ("default", Some(Facets::Ggx)),
        ("multi_ggx", Some(Facets::Ggx)),
        ("sharp", None),
        ("", Some(Facets::Ggx)),
    ];
}
