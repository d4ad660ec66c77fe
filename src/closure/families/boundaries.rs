//! Boundaries between media, smooth and rough: mirrors, glass, metals. Where their width is small, rough ones are smooth.

use super::usual::{NORMAL, TANGENT};
use crate::arguments;
use crate::bsdf::fresnel::{Conductor, Dielectric, Fresnel, Schlick, eta_of_reflectance};
use crate::bsdf::microfacet::{
    Beckmann, Between, Blinn, Facets, Geometry, Ggx, MIN_ALPHA, MIN_ETA_DIFFERENCE, Method, Microfacet, Sampling,
    Scattering, between,
};
use crate::bsdf::specular::{Reflected, Refracted};
use crate::bsdf::{Choice, MAX_PARAMS, limited};
use crate::closure::arguments::{Argument, Color, Float, Int, Normal, Vector, Word, floats_vary};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::{FrameId, Gate, LeafMaker, LobeRequest};
use crate::closure::lobe_kind::LobeKind;
use crate::closure::tree::{Floats, Ints};
use crate::lang::closures::{Claim, ParamSpec, TopAlbedo, Waiver};
use smallvec::{SmallVec, smallvec};

const ETA: ParamSpec =
    ParamSpec::about("index of refraction beyond over before, > 0: a shader gives its inverse where `backfacing()`")
        .tried(&[1.5, 1.05, 0.7, 2.5, 0.0]);
const DISTRIBUTION: ParamSpec =
    ParamSpec::about("\"ggx\", \"beckmann\", \"blinn\" (one width) or \"default\" (ggx); \"sharp\" is smooth");
const GEOMETRY: ParamSpec = ParamSpec::about("shadowing: \"smith\" (default), \"separable\" or \"vgroove\"");
const SAMPLING: ParamSpec =
    ParamSpec::about("facets to sample: \"visible\" (default) ones, or all \"normals\" (to compare with)");
const SCATTERING: ParamSpec = ParamSpec::about(
    "light between facets: \"multiple\" (default), or \"single\", which loses what facets send to facets",
);
const SCATTERING_OF_OSL: ParamSpec = ParamSpec::about(
    "light between facets: \"single\" (default), which loses what facets send to facets, or \"multiple\"",
);
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

const SHARED: &[Waiver] = &[
    Waiver {
        claim: Claim::Reciprocity,
        only: Some(("scattering", "multiple")),
        why: "where light passes, both halves are divided by what single scattering leaves toward the viewer alone",
    },
    Waiver {
        claim: Claim::Energy,
        only: Some(("scattering", "multiple")),
        why: "what single scattering leaves is known to 2e-3 for Smith's shadowing and equal widths, to 2e-2 for grooves and where f90 is not 1",
    },
];

/// Facets of a smaller width lose less than a thousandth of the light on the mean.
const LOSSLESS: f32 = 0.02;

const WHITE: Color = Color([Floats::Uniform(1.0); 3]);

arguments! {
    struct Smooth {
        N: Normal = NORMAL,
        eta: Float = ETA,
    }
}

fn smooth(name: &'static str, doc: &'static str, kind: LobeKind) -> ClosureDef {
    ClosureDef::new(name, doc, move |a: Smooth, leaf| {
        let frame = leaf.mirror_frame(a.N, None);
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
        scattering: Word<Scattering> = SCATTERING_OF_OSL,
    }
}

pub(super) fn microfacet() -> ClosureDef {
    let doc = "rough dielectric reflection and refraction";
    ClosureDef::new("microfacet", doc, |a: Plain, leaf| {
        Walls {
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
            scattering: (a.scattering, Scattering::Single),
            two_sided: false,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
    .without(SHARED)
}

arguments! {
    struct DielectricBsdf {
        N: Normal = NORMAL,
        U: Vector = TANGENT,
        reflection_tint: Color = REFLECTION_TINT,
        transmission_tint: Color = TRANSMISSION_TINT,
        roughness_x: Float = ROUGHNESS_X,
        roughness_y: Float = ROUGHNESS_Y,
        ior: Float = ParamSpec::about("index of refraction inside over outside, > 0; inverted where the viewer is inside")
            .tried(&[1.5, 1.0, 1.05, 2.5, 0.7]),
        distribution: Word<Option<Facets>> = DISTRIBUTION,
    }
    keywords {
        geometry: Word<Geometry> = GEOMETRY,
        sampling: Word<Sampling> = SAMPLING,
        scattering: Word<Scattering> = SCATTERING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
        absorption: Color = ABSORPTION,
        dispersion: Float = DISPERSION,
    }
}

pub(super) fn dielectric() -> ClosureDef {
    let doc = "boundary of glass, water and the like, rough or smooth, reflecting and refracting";
    ClosureDef::new("dielectric_bsdf", doc, |a: DielectricBsdf, leaf| {
        Walls {
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
            scattering: (a.scattering, Scattering::Multiple),
            two_sided: true,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
    .without(SHARED)
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
        scattering: Word<Scattering> = SCATTERING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
    }
}

pub(super) fn conductor() -> ClosureDef {
    let doc = "metal of a complex index of refraction, rough or smooth";
    ClosureDef::new("conductor_bsdf", doc, |a: ConductorBsdf, leaf| {
        let ([nr, ng, nb], [kr, kg, kb]) = (a.ior.0, a.extinction.0);
        Walls {
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
            scattering: (a.scattering, Scattering::Multiple),
            two_sided: false,
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
        scattering: Word<Scattering> = SCATTERING,
        thinfilm_thickness: Float = THICKNESS,
        thinfilm_ior: Float = FILM_IOR,
    }
}

pub(super) fn generalized_schlick() -> ClosureDef {
    let doc = "rough or smooth boundary whose reflectance runs from f0 to f90";
    ClosureDef::new("generalized_schlick_bsdf", doc, |a: GeneralizedSchlick, leaf| {
        let ([r0, g0, b0], [r90, g90, b90]) = (a.f0.0, a.f90.0);
        Walls {
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
            scattering: (a.scattering, Scattering::Multiple),
            two_sided: true,
        }
        .lobes(leaf);
    })
    .top_albedo(TopAlbedo::Facets)
    .without(SHARED)
}

/// The Fresnel terms of boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Term {
    Dielectric,
    Conductor,
    Schlick,
}

/// What the rough boundaries have in common.
pub(super) struct Walls<'a> {
    term: Term,
    distribution: Word<Option<Facets>>,
    normal: Normal,
    tangent: Vector,
    widths: [Floats; 2],
    /// Parameters of the Fresnel term, without the side that Schlick's has at the end.
    fresnel: &'a [Floats],
    /// Colors of the reflecting and the transmitting half; black switches one off.
    pub(super) tints: [Color; 2],
    /// Which halves there are: 0 reflects, 1 refracts, 2 does both.
    pub(super) refract: Ints,
    geometry: Option<Word<Geometry>>,
    sampling: Option<Word<Sampling>>,
    /// How often facets are met, and what stands where the keyword does not say.
    scattering: (Option<Word<Scattering>>, Scattering),
    /// Does the index know an inside, or does the shader turn it?
    two_sided: bool,
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

impl Walls<'_> {
    /// White facets that reflect, with all the light between them.
    pub(super) fn facets<'a>(
        term: Term,
        distribution: Word<Option<Facets>>,
        (normal, tangent): (Normal, Vector),
        widths: [Floats; 2],
        fresnel: &'a [Floats],
    ) -> Walls<'a> {
        Walls {
            term,
            distribution,
            normal,
            tangent,
            widths,
            fresnel,
            tints: [WHITE; 2],
            refract: Ints::Uniform(0),
            geometry: None,
            sampling: None,
            scattering: (None, Scattering::Multiple),
            two_sided: false,
        }
    }

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
                scattering: leaf.word(&self.scattering.0, lane).unwrap_or(self.scattering.1),
            },
            None => Method::default(),
        };
        let opaque = self.term == Term::Schlick && !transmits;
        there.then_some(Style { method, facets, opaque })
    }

    fn varies(&self) -> bool {
        let words = self.distribution.varies()
            || self.geometry.varies()
            || self.sampling.varies()
            || self.scattering.0.varies();
        let floats = floats_vary(&self.widths) || floats_vary(self.fresnel) || self.tints.iter().any(Argument::varies);
        words || floats || matches!(self.refract, Ints::Varying(_))
    }

    pub(super) fn lobes(&self, leaf: &mut LeafMaker<'_>) {
        let [x, y] = self.widths;
        let frame = leaf.mirror_frame(self.normal, if x == y { None } else { Some(self.tangent) });
        let key = |leaf: &LeafMaker<'_>, lane| {
            let halves = [Half::Reflecting, Half::Transmitting].map(|half| self.style(leaf, half, lane));
            (halves != [None; 2]).then_some(halves)
        };
        for (halves, gate) in leaf.variants(self.varies(), key) {
            let rough = |style: &Option<Style>| style.is_some_and(|style| style.facets.is_some());
            let passing = if halves.iter().all(rough) { self.passed_share() } else { 0.0 };
            let transmits = halves[Half::Transmitting as usize].is_some();
            for (half, style) in [Half::Reflecting, Half::Transmitting].into_iter().zip(halves) {
                let Some(mut style) = style else { continue };
                let multiple = style.method.scattering == Scattering::Multiple && self.loses();
                // Where nothing passes, light between facets is a lobe of its own; otherwise the halves make up for it.
                let between = style.facets.filter(|_| multiple && !transmits);
                style.method.scattering = if multiple && transmits { Scattering::Multiple } else { Scattering::Single };
                self.lobe(leaf, frame, half, (style, gate), passing);
                if let Some(facets) = between {
                    self.between(leaf, frame, facets, (style, gate));
                }
            }
        }
    }

    /// Can facets of these widths lose a thousandth of the light?
    fn loses(&self) -> bool {
        let Floats::Uniform(x) = self.widths[0] else { return true };
        let Floats::Uniform(y) = self.widths[1] else { return true };
        !(x < LOSSLESS && y < LOSSLESS)
    }

    /// Adds what facets reflect more than once.
    fn between(&self, leaf: &mut LeafMaker<'_>, frame: FrameId, facets: Facets, (style, gate): (Style, Gate)) {
        let kind = match self.term {
            Term::Dielectric => LobeKind::of::<Between<Dielectric>>(),
            Term::Conductor => LobeKind::of::<Between<Conductor>>(),
            Term::Schlick => LobeKind::of::<Between<Schlick>>(),
        };
        let [x, y] = self.widths;
        let mut params: SmallVec<[Floats; MAX_PARAMS]> = smallvec![x, y];
        params.extend_from_slice(self.fresnel);
        if self.term == Term::Schlick {
            params.push(Floats::Uniform(1.0));
        }
        let (choice, tint) =
            (between::choice(facets, style.method.geometry), Some(self.tints[Half::Reflecting as usize]));
        let (eta, two_sided) = ((self.term == Term::Dielectric).then_some(2), self.two_sided);
        leaf.add(LobeRequest { choice, eta, two_sided, gate, tint, ..LobeRequest::new(kind, frame, &params) });
    }

    /// How much passed light counts against reflected light: by the tints, where they are the same in all lanes.
    fn passed_share(&self) -> f32 {
        let mean = |tint: &Color| match tint.0 {
            [Floats::Uniform(r), Floats::Uniform(g), Floats::Uniform(b)] => Some(r.abs() + g.abs() + b.abs()),
            _ => None,
        };
        let [reflected, passed] = self.tints.each_ref().map(mean);
        let ratio = passed.zip(reflected).map_or(1.0, |(passed, reflected)| passed / reflected);
        if ratio.is_finite() { ratio.clamp(1e-2, 1e2) } else { 1.0 }
    }

    /// Adds one half; what passes at a facet counts `passing` of what is reflected where both halves are sampled as one.
    fn lobe(&self, leaf: &mut LeafMaker<'_>, frame: FrameId, half: Half, (style, gate): (Style, Gate), passing: f32) {
        let [x, y] = self.widths;
        let mut params: SmallVec<[Floats; MAX_PARAMS]> = smallvec![x, y];
        params.extend_from_slice(self.fresnel);
        let mut eta = match self.term {
            Term::Dielectric => Some(2),
            Term::Conductor => None,
            Term::Schlick => {
                params.push(Floats::Uniform(if style.opaque { 1.0 } else { 2.0 }));
                Some(params.len() - 1)
            }
        };
        params.push(Floats::Uniform(passing));
        let mut params = params.as_slice();
        if style.facets.is_none() {
            // A smooth boundary has no widths, and no facets to choose at.
            (params, eta) = (&params[2..params.len() - 1], eta.map(|k| k - 2));
        }
        let kind = kind(style.facets, self.term, half);
        let (choice, tint) = (Choice::from(style.method), Some(self.tints[half as usize]));
        let (two_sided, paired) = (self.two_sided, passing > 0.0 && half == Half::Transmitting);
        let lobe = LobeRequest::new(kind, frame, params);
        leaf.add(LobeRequest { choice, eta, two_sided, gate, tint, paired, ..lobe });
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
