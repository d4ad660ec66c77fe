//! The kinds of lobes, and the one place that maps each to its model.

use super::sampling::event;
use crate::bsdf::fresnel::Term;
use crate::bsdf::sheen::shadowing::Shadowing;

/// Runs an expression with the type `$M` of a surface's model and a source `$source` of its constants.
/// Lobes of one direction have no lane loop and run nothing.
macro_rules! with_source {
    ($surfaces:expr, $surface:expr, |$M:ident, $source:ident| $body:expr) => {{
        use $crate::bsdf::sheen::shadowing::Shadowing;
        use $crate::bsdf::fresnel::{Conductor, Dielectric, Schlick, Term};
        use $crate::bsdf::microfacet::{Beckmann, Blinn, Ggx, Microfacet};
        use $crate::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, SERIES, Sheen, fibers::Fibers, normals::ByNormals};
        use $crate::bsdf::{ashikhmin_shirley, burley, eon, hair, lafortune, lambert, oren_nayar, phong, velvet, ward};
        use $crate::closure::kinds::{Facets, Kind};
        macro_rules! run {
            ($model:ty) => {{
                #[allow(unused)]
                type $M = $model;
                match $surface.params {
                    $crate::closure::surfaces::Values::Uniform(params) => {
                        let $source = $crate::closure::surfaces::same::<$M>(params);
                        $body
                    }
                    $crate::closure::surfaces::Values::Columns(offsets) => {
                        let $source = $crate::closure::surfaces::each(&$surfaces.data, offsets, $surfaces.lanes);
                        $body
                    }
                }
            }};
        }
        match $surface.kind {
            Kind::Lambert => run!(lambert::Lambert),
            Kind::Translucent => run!(lambert::Translucent),
            Kind::OrenNayar => run!(oren_nayar::OrenNayar),
            Kind::Velvet => run!(velvet::Velvet),
            Kind::Burley => run!(burley::Burley),
            Kind::Eon => run!(eon::Eon),
            Kind::Fibers => run!(Fibers),
            Kind::Hair { crossings: 0 } => run!(hair::Hair<0>),
            Kind::Hair { crossings: 1 } => run!(hair::Hair<1>),
            Kind::Hair { crossings: 2 } => run!(hair::Hair<2>),
            Kind::Hair { .. } => run!(hair::Hair<3>),
            Kind::Phong => run!(phong::Phong),
            Kind::Ward { bounded: false } => run!(ward::Ward<false>),
            Kind::Ward { bounded: true } => run!(ward::Ward<true>),
            Kind::Highlight => run!(ashikhmin_shirley::Highlight),
            Kind::UnderHighlight => run!(ashikhmin_shirley::Under),
            Kind::Lafortune => run!(lafortune::Lafortune),
            Kind::Sheen(Shadowing::Exact, true) => run!(Sheen<EXACT, true>),
            Kind::Sheen(Shadowing::Exact, false) => run!(Sheen<EXACT, false>),
            Kind::Sheen(Shadowing::Published, true) => run!(Sheen<PUBLISHED, true>),
            Kind::Sheen(Shadowing::Published, false) => run!(Sheen<PUBLISHED, false>),
            Kind::Sheen(Shadowing::Series, true) => run!(Sheen<SERIES, true>),
            Kind::Sheen(Shadowing::Series, false) => run!(Sheen<SERIES, false>),
            Kind::Sheen(Shadowing::Ashikhmin, _) => run!(Sheen<ASHIKHMIN, false>),
            Kind::SheenByNormals(Shadowing::Exact, true) => run!(ByNormals<EXACT, true>),
            Kind::SheenByNormals(Shadowing::Exact, false) => run!(ByNormals<EXACT, false>),
            Kind::SheenByNormals(Shadowing::Published, true) => run!(ByNormals<PUBLISHED, true>),
            Kind::SheenByNormals(Shadowing::Published, false) => run!(ByNormals<PUBLISHED, false>),
            Kind::SheenByNormals(Shadowing::Series, true) => run!(ByNormals<SERIES, true>),
            Kind::SheenByNormals(Shadowing::Series, false) => run!(ByNormals<SERIES, false>),
            Kind::SheenByNormals(Shadowing::Ashikhmin, _) => run!(ByNormals<ASHIKHMIN, false>),
            Kind::Microfacet { distribution, term, refract } => match (distribution, term, refract) {
                (Facets::Ggx, Term::Dielectric, false) => run!(Microfacet<Ggx, Dielectric, false>),
                (Facets::Ggx, Term::Dielectric, true) => run!(Microfacet<Ggx, Dielectric, true>),
                (Facets::Ggx, Term::Schlick, false) => run!(Microfacet<Ggx, Schlick, false>),
                (Facets::Ggx, Term::Schlick, true) => run!(Microfacet<Ggx, Schlick, true>),
                (Facets::Ggx, Term::Conductor, _) => run!(Microfacet<Ggx, Conductor, false>),
                (Facets::Beckmann, Term::Dielectric, false) => run!(Microfacet<Beckmann, Dielectric, false>),
                (Facets::Beckmann, Term::Dielectric, true) => run!(Microfacet<Beckmann, Dielectric, true>),
                (Facets::Beckmann, Term::Schlick, false) => run!(Microfacet<Beckmann, Schlick, false>),
                (Facets::Beckmann, Term::Schlick, true) => run!(Microfacet<Beckmann, Schlick, true>),
                (Facets::Beckmann, Term::Conductor, _) => run!(Microfacet<Beckmann, Conductor, false>),
                (Facets::Blinn, Term::Dielectric, false) => run!(Microfacet<Blinn, Dielectric, false>),
                (Facets::Blinn, Term::Dielectric, true) => run!(Microfacet<Blinn, Dielectric, true>),
                (Facets::Blinn, Term::Schlick, false) => run!(Microfacet<Blinn, Schlick, false>),
                (Facets::Blinn, Term::Schlick, true) => run!(Microfacet<Blinn, Schlick, true>),
                (Facets::Blinn, Term::Conductor, _) => run!(Microfacet<Blinn, Conductor, false>),
            },
            Kind::Reflection(_) | Kind::Refraction(_) | Kind::Transparent => {}
        }
    }};
}
pub(super) use with_source;

/// The scattering models a lobe can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Lambert's reflection.
    Lambert,
    /// Lambert's transmission.
    Translucent,
    /// Rough diffuse reflection.
    OrenNayar,
    /// Ashikhmin's velvet.
    Velvet,
    /// Burley's diffuse reflection.
    Burley,
    /// Rough diffuse reflection that loses no light.
    Eon,
    /// Sheen of a layer of fibers.
    Fibers,
    /// One lobe of hair.
    Hair {
        /// How often light crosses the fiber; 3 stands for all longer paths.
        crossings: u8,
    },
    /// Phong's highlight.
    Phong,
    /// Ward's highlight.
    Ward {
        /// The form of bounded energy.
        bounded: bool,
    },
    /// The highlight of Ashikhmin and Shirley.
    Highlight,
    /// The diffuse light under it.
    UnderHighlight,
    /// A generalised cosine lobe.
    Lafortune,
    /// Sheen with its shadowing term, softened or not.
    Sheen(Shadowing, bool),
    /// The same, sampled by its half vector.
    SheenByNormals(Shadowing, bool),
    /// Rough boundary.
    Microfacet {
        /// The distribution of facets.
        distribution: Facets,
        /// The Fresnel term.
        term: Term,
        /// The refracting half, otherwise the reflecting one.
        refract: bool,
    },
    /// Smooth mirror.
    Reflection(Term),
    /// Smooth refraction.
    Refraction(Term),
    /// Straight through.
    Transparent,
}

/// The distributions of facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facets {
    /// Trowbridge and Reitz.
    Ggx,
    /// Beckmann.
    Beckmann,
    /// Blinn.
    Blinn,
}

impl Kind {
    /// True for lobes of one direction, which have no density.
    pub fn is_delta(self) -> bool {
        matches!(self, Kind::Reflection(_) | Kind::Refraction(_) | Kind::Transparent)
    }

    /// True for lobes that scatter light about evenly, whatever the directions: what a coat throws back at them comes out
    /// in the end. Sheens, and the light under a highlight, prefer directions, and take the rule that is safe for all.
    pub fn is_diffuse(self) -> bool {
        matches!(self, Kind::Lambert | Kind::Translucent | Kind::OrenNayar | Kind::Burley | Kind::Eon)
    }

    /// What sampling it counts as.
    pub fn event(self) -> u8 {
        match self {
            Kind::Reflection(_) => event::DELTA_REFLECT,
            Kind::Refraction(_) => event::DELTA_REFRACT,
            Kind::Transparent => event::STRAIGHT,
            Kind::Microfacet { .. }
            | Kind::Phong
            | Kind::Ward { .. }
            | Kind::Highlight
            | Kind::Lafortune
            | Kind::Hair { .. } => event::GLOSSY,
            _ => event::DIFFUSE,
        }
    }
}
