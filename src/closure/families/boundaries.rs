//! Boundaries between media, smooth and rough: mirrors, glass, metals. Where their width is small, rough ones are smooth.

use super::usual::{NORMAL, TANGENT};
use crate::arguments;
use crate::bsdf::fresnel::{Conductor, Dielectric, Fresnel, Schlick, eta_of_reflectance};
use crate::bsdf::microfacet::{
    Beckmann, Blinn, Facets, Geometry, Ggx, MIN_ALPHA, MIN_ETA_DIFFERENCE, Method, Microfacet, Sampling,
};
use crate::bsdf::specular::{Reflected, Refracted};
use crate::bsdf::{Choice, limited};
use crate::closure::arguments::{Argument, Color, Float, Int, Normal, Vector, Word, floats_vary};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::{LeafMaker, LobeRequest};
use crate::closure::lobe_kind::LobeKind;
use crate::closure::tree::{Floats, Ints};
use crate::lang::closures::{ParamSpec, TopAlbedo};

const ETA: ParamSpec =
    ParamSpec::about("index of refraction inside over outside, > 0").tried(&[1.5, 1.05, 0.7, 2.5, 0.0]);
const DISTRIBUTION: ParamSpec =
    ParamSpec::about("\"ggx\", \"beckmann\", \"blinn\" (one width) or \"default\" (ggx); \"sharp\" is smooth");
const GEOMETRY: ParamSpec = ParamSpec::about("shadowing: \"smith\" (default), \"separable\" or \"vgroove\"");
const SAMPLING: ParamSpec =
    ParamSpec::about("facets to sample: \"visible\" (default) ones, or all \"normals\" (to compare with)");
const ROUGHNESS_X: ParamSpec = ParamSpec::about("width along U, 0..1; 0 is smooth").tried(&[0.3, 0.02, 0.1, 0.6, 1.0]);
const ROUGHNESS_Y: ParamSpec = ParamSpec::about("width across U, 0..1").tried(&[0.3, 0.1, 0.8, 0.02, 1.0]);
const REFLECTION_TINT: ParamSpec =
    ParamSpec::about("color of what is reflected; black: nothing").tried(&[1.0, 0.5, 0.0]);
const TRANSMISSION_TINT: ParamSpec = ParamSpec::about("color of what passes; black: opaque").tried(&[1.0, 0.5, 0.0]);
const THICKNESS: ParamSpec =
    ParamSpec::about("thickness of a film, nanometers").left_out(0.0, "the colors of a thin film");
const FILM_IOR: ParamSpec = ParamSpec::about("index of refraction of the film; not modelled, as the film is not");
const ABSORPTION: ParamSpec =
    ParamSpec::about("absorption inside, per unit of length").left_out(0.0, "absorption inside the medium");
const DISPERSION: ParamSpec = ParamSpec::about("inverse Abbe number").left_out(0.0, "the colors of dispersion");

const WHITE: Color = Color([Floats::Uniform(1.0); 3]);

arguments! {
    struct Smooth {
        N: Normal = NORMAL,
        eta: Float = ETA,
    }
}

fn smooth(name: &'static str, doc: &'static str, kind: LobeKind) -> ClosureDef {
    ClosureDef::new(name, doc, move |a: Smooth, leaf| {
        let frame = leaf.frame(a.N, None);
        leaf.add(LobeRequest { eta: Some(0), ..LobeRequest::new(kind, frame, &[a.eta.0]) });
    })
}

pub(super) fn reflection() -> ClosureDef {
    let doc = "mirror with dielectric Fresnel; eta 0 reflects all";
    smooth("reflection", doc, LobeKind::single::<Reflected<Dielectric>>())
}

pub(super) fn refraction() -> ClosureDef {
    smooth("refraction", "smooth refraction with dielectric Fresnel", LobeKind::single::<Refracted<Dielectric>>())
}

arguments! {
    struct Plain {
        distribution: Word<Option<Facets>> = DISTRIBUTION,
        N: Normal = NORMAL,
        U: Vector = TANGENT,
        xalpha: Float = ParamSpec::about("width along U, 0..1; 0 is a mirror").tried(&[0.3, 0.02, 0.1, 0.6, 1.0]),
        yalpha: Float = ParamSpec::about("width across U, 0..1").tried(&[0.3, 0.1, 0.8, 0.02, 1.0]),
        eta: Float = ETA,
        refract: Int = ParamSpec::about("0 reflects, 1 refracts, 2 does both").tried(&[0.0, 1.0, 2.0]),
    }
    keywords {
        geometry: Word<Geometry> = GEOMETRY,
        sampling: Word<Sampling> = SAMPLING,
    }
}

pub(super) fn microfacet() -> ClosureDef {
    let doc = "rough dielectric reflection and refraction";
    ClosureDef::new("microfacet", doc, |a: Plain, leaf| {
        Boundary {
            term: Term::Dielectric,
            distribution: a.distribution,
            normal: a.N,
            tangent: a.U,
            widths: [a.xalpha.0, a.yalpha.0],
            fresnel: &[a.eta.0],
            tints: [WHITE; 2],
            refract: a.refract.0,
            geometry: a.geometry,
            sampling: a.sampling,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
}

arguments! {
    struct DielectricBsdf {
        N: Normal = NORMAL,
        U: Vector = TANGENT,
        reflection_tint: Color = REFLECTION_TINT,
        transmission_tint: Color = TRANSMISSION_TINT,
        roughness_x: Float = ROUGHNESS_X,
        roughness_y: Float = ROUGHNESS_Y,
        ior: Float = ParamSpec::about("index of refraction inside over outside, > 0").tried(&[1.5, 1.0, 1.05, 2.5, 0.7]),
        distribution: Word<Option<Facets>> = DISTRIBUTION,
    }
    keywords {
        geometry: Word<Geometry> = GEOMETRY,
        sampling: Word<Sampling> = SAMPLING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
        absorption: Color = ABSORPTION,
        dispersion: Float = DISPERSION,
    }
}

pub(super) fn dielectric() -> ClosureDef {
    let doc = "boundary of glass, water and the like, rough or smooth, reflecting and refracting";
    ClosureDef::new("dielectric_bsdf", doc, |a: DielectricBsdf, leaf| {
        Boundary {
            term: Term::Dielectric,
            distribution: a.distribution,
            normal: a.N,
            tangent: a.U,
            widths: [a.roughness_x.0, a.roughness_y.0],
            fresnel: &[a.ior.0],
            tints: [a.reflection_tint, a.transmission_tint],
            refract: Ints::Uniform(2),
            geometry: a.geometry,
            sampling: a.sampling,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
}

arguments! {
    struct ConductorBsdf {
        N: Normal = NORMAL,
        U: Vector = TANGENT,
        roughness_x: Float = ROUGHNESS_X,
        roughness_y: Float = ROUGHNESS_Y,
        ior: Color = ParamSpec::about("index of refraction over that outside").tried(&[0.2, 1.0, 3.0]),
        extinction: Color = ParamSpec::about("extinction coefficient over the index outside").tried(&[3.9, 0.0, 1.0]),
        distribution: Word<Option<Facets>> = DISTRIBUTION,
    }
    keywords {
        geometry: Word<Geometry> = GEOMETRY,
        sampling: Word<Sampling> = SAMPLING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
    }
}

pub(super) fn conductor() -> ClosureDef {
    let doc = "metal of a complex index of refraction, rough or smooth";
    ClosureDef::new("conductor_bsdf", doc, |a: ConductorBsdf, leaf| {
        let ([nr, ng, nb], [kr, kg, kb]) = (a.ior.0, a.extinction.0);
        Boundary {
            term: Term::Conductor,
            distribution: a.distribution,
            normal: a.N,
            tangent: a.U,
            widths: [a.roughness_x.0, a.roughness_y.0],
            fresnel: &[nr, ng, nb, kr, kg, kb],
            tints: [WHITE; 2],
            refract: Ints::Uniform(0),
            geometry: a.geometry,
            sampling: a.sampling,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
}

arguments! {
    struct GeneralizedSchlick {
        N: Normal = NORMAL,
        U: Vector = TANGENT,
        reflection_tint: Color = REFLECTION_TINT,
        transmission_tint: Color = TRANSMISSION_TINT,
        roughness_x: Float = ROUGHNESS_X,
        roughness_y: Float = ROUGHNESS_Y,
        f0: Color = ParamSpec::about("reflectance at normal incidence, 0..1; its mean gives the index of refraction")
            .tried(&[0.04, 0.0, 0.5, 1.0]),
        f90: Color = ParamSpec::about("reflectance at grazing incidence, 0..1").tried(&[1.0, 0.5]),
        exponent: Float = ParamSpec::about("how late reflectance rises, 5 for most materials, >= 0").tried(&[5.0, 0.0, 2.0]),
        distribution: Word<Option<Facets>> = DISTRIBUTION,
    }
    keywords {
        geometry: Word<Geometry> = GEOMETRY,
        sampling: Word<Sampling> = SAMPLING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
    }
}

pub(super) fn generalized_schlick() -> ClosureDef {
    let doc = "rough or smooth boundary whose reflectance runs from f0 to f90";
    ClosureDef::new("generalized_schlick_bsdf", doc, |a: GeneralizedSchlick, leaf| {
        let ([r0, g0, b0], [r90, g90, b90]) = (a.f0.0, a.f90.0);
        Boundary {
            term: Term::Schlick,
            distribution: a.distribution,
            normal: a.N,
            tangent: a.U,
            widths: [a.roughness_x.0, a.roughness_y.0],
            fresnel: &[r0, g0, b0, r90, g90, b90, a.exponent.0],
            tints: [a.reflection_tint, a.transmission_tint],
            refract: Ints::Uniform(2),
            geometry: a.geometry,
            sampling: a.sampling,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
}

/// The Fresnel terms of boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Term {
    Dielectric,
    Conductor,
    Schlick,
}

/// What the rough boundaries have in common.
struct Boundary<'a> {
    term: Term,
    distribution: Word<Option<Facets>>,
    normal: Normal,
    tangent: Vector,
    widths: [Floats; 2],
    /// Parameters of the Fresnel term, without the side that Schlick's has at the end.
    fresnel: &'a [Floats],
    /// Colors of the reflecting and the transmitting half; black switches one off.
    tints: [Color; 2],
    /// Which halves there are: 0 reflects, 1 refracts, 2 does both.
    refract: Ints,
    geometry: Option<Word<Geometry>>,
    sampling: Option<Word<Sampling>>,
}

/// What may differ between lanes and decides about the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Style {
    method: Method,
    /// None is smooth.
    facets: Option<Facets>,
    /// Nothing passes, so both sides look alike.
    opaque: bool,
}

/// The two halves of a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    Reflecting,
    Transmitting,
}

impl Boundary<'_> {
    fn black(&self, leaf: &LeafMaker<'_>, half: Half, lane: usize) -> bool {
        self.tints[half as usize].0.iter().all(|&c| leaf.float(c, lane) == 0.0)
    }

    /// The index of refraction of a lane, from outside; 0 lets nothing through.
    fn eta(&self, leaf: &LeafMaker<'_>, lane: usize) -> f32 {
        let at = |k: usize| leaf.float(self.fresnel[k], lane);
        match self.term {
            Term::Dielectric => at(0),
            Term::Conductor => 0.0,
            Term::Schlick => {
                let part = |k: usize| limited(at(k), 0.0, 1.0);
                eta_of_reflectance((part(0) + part(1) + part(2)) * (1.0 / 3.0))
            }
        }
    }

    /// The style of a lane's half, where it has that half.
    fn style(&self, leaf: &LeafMaker<'_>, half: Half, lane: usize) -> Option<Style> {
        let (refract, eta) = (leaf.int(self.refract, lane), self.eta(leaf, lane));
        let transmits = refract >= 1 && eta > 0.0 && !self.black(leaf, Half::Transmitting, lane);
        let (there, straight) = match half {
            Half::Reflecting => (refract != 1 && !self.black(leaf, half, lane), false),
            Half::Transmitting => (transmits, (eta - 1.0).abs() < MIN_ETA_DIFFERENCE),
        };
        let widest = leaf.float(self.widths[0], lane).max(leaf.float(self.widths[1], lane));
        let facets = self.distribution.at(leaf.tree(), lane).unwrap_or(Some(Facets::Ggx));
        let facets = facets.filter(|_| widest.is_nan() || widest >= MIN_ALPHA).filter(|_| !straight);
        let method = match facets {
            Some(_) => Method {
                geometry: leaf.word(&self.geometry, lane).unwrap_or_default(),
                sampling: leaf.word(&self.sampling, lane).unwrap_or_default(),
            },
            None => Method::default(),
        };
        let opaque = self.term == Term::Schlick && !transmits;
        there.then_some(Style { method, facets, opaque })
    }

    fn varies(&self) -> bool {
        let words = self.distribution.varies() || self.geometry.varies() || self.sampling.varies();
        let floats = floats_vary(&self.widths) || floats_vary(self.fresnel) || self.tints.iter().any(Argument::varies);
        words || floats || matches!(self.refract, Ints::Varying(_))
    }

    fn lobes(&self, leaf: &mut LeafMaker<'_>) {
        let [x, y] = self.widths;
        let frame = leaf.frame(self.normal, if x == y { None } else { Some(self.tangent) });
        for half in [Half::Reflecting, Half::Transmitting] {
            for (style, gate) in leaf.variants(self.varies(), |leaf, lane| self.style(leaf, half, lane)) {
                let mut params = vec![x, y];
                params.extend_from_slice(self.fresnel);
                let mut eta = match self.term {
                    Term::Dielectric => Some(2),
                    Term::Conductor => None,
                    Term::Schlick => {
                        params.push(Floats::Uniform(if style.opaque { 1.0 } else { 2.0 }));
                        Some(params.len() - 1)
                    }
                };
                let mut params = params.as_slice();
                if style.facets.is_none() {
                    // A smooth boundary has no widths.
                    (params, eta) = (&params[2..], eta.map(|k| k - 2));
                }
                let kind = kind(style.facets, self.term, half);
                let (choice, tint) = (Choice::from(style.method), Some(self.tints[half as usize]));
                leaf.add(LobeRequest { choice, eta, gate, tint, ..LobeRequest::new(kind, frame, params) });
            }
        }
    }
}

/// The kind of one half of a boundary.
fn kind(facets: Option<Facets>, term: Term, half: Half) -> LobeKind {
    match term {
        Term::Dielectric => kind_of::<Dielectric>(facets, half),
        Term::Conductor => kind_of::<Conductor>(facets, half),
        Term::Schlick => kind_of::<Schlick>(facets, half),
    }
}

fn kind_of<F: Fresnel>(facets: Option<Facets>, half: Half) -> LobeKind {
    match (facets, half) {
        (None, Half::Reflecting) => LobeKind::single::<Reflected<F>>(),
        (None, Half::Transmitting) => LobeKind::single::<Refracted<F>>(),
        (Some(Facets::Ggx), Half::Reflecting) => LobeKind::of::<Microfacet<Ggx, F, false>>(),
        (Some(Facets::Ggx), Half::Transmitting) => LobeKind::of::<Microfacet<Ggx, F, true>>(),
        (Some(Facets::Beckmann), Half::Reflecting) => LobeKind::of::<Microfacet<Beckmann, F, false>>(),
        (Some(Facets::Beckmann), Half::Transmitting) => LobeKind::of::<Microfacet<Beckmann, F, true>>(),
        (Some(Facets::Blinn), Half::Reflecting) => LobeKind::of::<Microfacet<Blinn, F, false>>(),
        (Some(Facets::Blinn), Half::Transmitting) => LobeKind::of::<Microfacet<Blinn, F, true>>(),
    }
}
