//! Choices of a rough boundary: the distribution of its facets, how they shadow each other, how directions are drawn.

use crate::bsdf::Choice;

/// The distributions of facets, where a type would not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Facets {
    /// Trowbridge and Reitz.
    Ggx,
    /// Beckmann.
    Beckmann,
    /// Blinn.
    Blinn,
}

impl Facets {
    /// How many there are.
    pub const COUNT: usize = 3;
}

/// How facets shadow each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Geometry {
    /// Smith, masking and shadowing correlated by height (Heitz 2014, eq. 99).
    #[default]
    Smith,
    /// Smith, the product of masking and shadowing (Smith 1967; Walter et al. 2007, eq. 23).
    Separable,
    /// V-shaped grooves (Torrance and Sparrow 1967; Blinn 1977): min(1, 2 (n.m)(n.o)/(o.m), 2 (n.m)(n.i)/(o.m)).
    /// Refraction has |n.i| / |i.m| in the last place: still at most the masking of the viewer, so both halves of a facet
    /// share the light that reaches it, which the Smith term beside it would break by up to 29 %.
    VGroove,
}

/// How directions are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sampling {
    /// Reflection at a facet that the viewer sees, of GGX of the same widths.
    #[default]
    Visible,
    /// Reflection at any facet, with density D cos (the half-vector sampling of Blinn's and Walter's models).
    Normals,
}

impl Geometry {
    /// The part of a facet that neither direction's neighbours hide, in double precision, for integration: from both Lambdas,
    /// both cosines to the normal, and the facet's cosines to the viewer and to the normal.
    pub(super) fn part(self, [lambda_o, lambda_i]: [f64; 2], [cos_o, cos_i]: [f64; 2], om: f64, mz: f64) -> f64 {
        match self {
            Geometry::Smith => 1.0 / (1.0 + lambda_o + lambda_i),
            Geometry::Separable => 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i)),
            Geometry::VGroove => (2.0 * mz * cos_o.min(cos_i) / om.max(1e-20)).min(1.0),
        }
    }

    /// That of a choice, which counts them fastest.
    #[inline(always)]
    pub(super) fn numbered(number: u8) -> Geometry {
        match number % 3 {
            0 => Geometry::Smith,
            1 => Geometry::Separable,
            _ => Geometry::VGroove,
        }
    }

    /// All of them, by the word that chooses them.
    pub const ALL: &[(&str, Geometry)] =
        &[("smith", Geometry::Smith), ("separable", Geometry::Separable), ("vgroove", Geometry::VGroove)];
}

impl Sampling {
    /// All of them, by the word that chooses them.
    pub const ALL: &[(&str, Sampling)] = &[("visible", Sampling::Visible), ("normals", Sampling::Normals)];
}

/// How often facets are met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scattering {
    /// Once: rough facets lose what they send to other facets.
    #[default]
    Single,
    /// Any number of times: nothing is lost.
    Multiple,
}

impl Scattering {
    /// Both, by the word that chooses them.
    pub const ALL: &[(&str, Scattering)] = &[("multiple", Scattering::Multiple), ("single", Scattering::Single)];
}

/// What a boundary has chosen beside its distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Method {
    /// How its facets shadow each other.
    pub geometry: Geometry,
    /// How its directions are drawn.
    pub sampling: Sampling,
    /// How often its facets are met.
    pub scattering: Scattering,
}

impl From<Method> for Choice {
    fn from(method: Method) -> Self {
        Choice(method.geometry as u8 + 3 * method.sampling as u8 + 6 * method.scattering as u8)
    }
}

impl From<Choice> for Method {
    #[inline(always)]
    fn from(Choice(number): Choice) -> Self {
        let geometry = Geometry::numbered(number);
        let sampling = if number % 6 < 3 { Sampling::Visible } else { Sampling::Normals };
        Method { geometry, sampling, scattering: if number < 6 { Scattering::Single } else { Scattering::Multiple } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_carry_every_method() {
        for &(_, geometry) in Geometry::ALL {
            for &(_, sampling) in Sampling::ALL {
                for &(_, scattering) in Scattering::ALL {
                    let method = Method { geometry, sampling, scattering };
                    assert_eq!(Method::from(Choice::from(method)), method);
                }
            }
        }
        assert_eq!(Choice::from(Method::default()), Choice::default());
    }
}
