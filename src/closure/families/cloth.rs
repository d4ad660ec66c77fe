//! Cloth: sheens, alone and laid over other closures, layers of any two closures, and velvet to compare with.

use super::usual::NORMAL;
use crate::arguments;
use crate::bsdf::Choice;
use crate::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, SERIES, Sheen, fibers::Fibers, normals::ByNormals};
use crate::bsdf::velvet::{Form, Velvet, form_2000::Velvet2000};
use crate::closure::arguments::{Argument, Color, Float, Int, Nested, Normal, Word};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::{LeafMaker, LobeRequest, PartId};
use crate::closure::lobe_kind::LobeKind;
use crate::closure::settings::{Layering, Shadowing, SheenSampling};
use crate::closure::words::Words;
use crate::lang::closures::{Claim, ParamSpec, TopAlbedo, Waiver};

const ROUGHNESS: ParamSpec =
    ParamSpec::about("Charlie roughness r, clamped to 0.01..1").tried(&[0.25, 0.01, 0.06, 0.15, 0.5, 1.0]);
const LAYERING: ParamSpec =
    ParamSpec::about("how the base is scaled: \"min\" (default), \"view\", \"kelemen\" or \"lossless\"");
const SHADOWING: ParamSpec = ParamSpec::about(
    "shadowing term: \"exact\" (default), \"published\" (fit of the paper), \"ashikhmin\" (real-time visibility) or \"series\" (exact to 4e-6)",
);
const SAMPLING: ParamSpec = ParamSpec::about(
    "how directions are drawn: \"ltc\" (default, transformed cosines), \"uniform\", \"cosine\" or \"normals\" (half vector)",
);
const SOFTENING: ParamSpec =
    ParamSpec::about("1 (default) softens the terminator by eq. 4, 0 does not").tried(&[1.0, 0.0]);
const MODE: ParamSpec = ParamSpec::about(
    "0: Estevez and Kulla 2017 (the default); 1: a layer of fibers, Zeltner, Burley and Chiang 2022, which has no shadowing, softening or sampling to choose",
)
.tried(&[0.0, 1.0])
.numbered(0, 1, "0 is the sheen of Estevez and Kulla, and the default; 1 that of Zeltner, Burley and Chiang");

/// Promises that the lobe does not make in some of its variants.
const SHEEN_WAIVERS: &[Waiver] = &[SOFTENED, PUBLISHED_GAINS, ASHIKHMIN_GAINS, VIEW_LAYERING, KELEMEN];
const SHEEN_BSDF_WAIVERS: &[Waiver] = &[SOFTENED, PUBLISHED_GAINS, ASHIKHMIN_GAINS, FIBERS];
const LAYER_WAIVERS: &[Waiver] = &[VIEW_LAYERING, KELEMEN];

const SOFTENED: Waiver = Waiver {
    claim: Claim::Reciprocity,
    only: Some(("softening", "1")),
    why: "eq. 4 softens the side of the light only",
};
const PUBLISHED_GAINS: Waiver = Waiver {
    claim: Claim::Energy,
    only: Some(("shadowing", "published")),
    why: "the published fit of Lambda is too small at small roughness: without softening 1.011 at r = 0.06 and cosine 0.01, 1.50 at r = 1 and cosine 1e-6",
};
const ASHIKHMIN_GAINS: Waiver = Waiver {
    claim: Claim::Energy,
    only: Some(("shadowing", "ashikhmin")),
    why: "the real-time visibility does not belong to D: albedo up to 4.0 below r = 0.21",
};
const FIBERS: Waiver = Waiver {
    claim: Claim::Reciprocity,
    only: Some(("mode", "1")),
    why: "the shape and height of the lobe follow the viewer alone",
};
const KELEMEN: Waiver = Waiver {
    claim: Claim::Energy,
    only: Some(("layering", "kelemen")),
    why: "the rule is lossless over diffuse bases alone: up to 1.16 over a mirror",
};
const VIEW_LAYERING: Waiver = Waiver {
    claim: Claim::Reciprocity,
    only: Some(("layering", "view")),
    why: "the base is scaled by what the layer lets through to the viewer alone",
};

arguments! {
    struct SheenOver {
        base: Nested = ParamSpec::about("what lies under the sheen"),
        N: Normal = NORMAL,
        tint: Color = ParamSpec::about("color of the sheen; its largest component scales the albedo taken from the base"),
        roughness: Float = ROUGHNESS,
    }
    keywords {
        shadowing: Word<Shadowing> = SHADOWING,
        softening: Int = SOFTENING,
        layering: Word<Layering> = LAYERING,
        sampling: Word<SheenSampling> = SAMPLING,
    }
}

pub(super) fn sheen() -> ClosureDef {
    let doc = "cloth sheen laid over any closure (Estevez and Kulla 2017)";
    ClosureDef::new("sheen", doc, |a: SheenOver, leaf| {
        let form = SheenForm {
            shadowing: a.shadowing,
            softening: a.softening,
            sampling: a.sampling,
            layering: a.layering,
            mode: None,
        };
        leaf.nest(a.base);
        for (part, rule) in form.lobes(leaf, a.N, a.tint, a.roughness) {
            leaf.cover(part, a.tint, rule);
        }
    })
    .top_albedo(TopAlbedo::Sheen)
    .without(SHEEN_WAIVERS)
}

arguments! {
    struct SheenAlone {
        N: Normal = NORMAL,
        albedo: Color = ParamSpec::about("color of the sheen"),
        roughness: Float = ROUGHNESS,
    }
    keywords {
        shadowing: Word<Shadowing> = SHADOWING,
        softening: Int = SOFTENING,
        mode: Int = MODE,
        sampling: Word<SheenSampling> = SAMPLING,
    }
}

pub(super) fn sheen_bsdf() -> ClosureDef {
    let doc = "the sheen lobe alone, to be laid over a base by layer()";
    ClosureDef::new("sheen_bsdf", doc, |a: SheenAlone, leaf| {
        let form = SheenForm {
            shadowing: a.shadowing,
            softening: a.softening,
            sampling: a.sampling,
            layering: None,
            mode: a.mode,
        };
        for (part, rule) in form.lobes(leaf, a.N, a.albedo, a.roughness) {
            leaf.cover(part, a.albedo, rule);
        }
    })
    .top_albedo(TopAlbedo::Sheen)
    .without(SHEEN_BSDF_WAIVERS)
}

arguments! {
    struct SheenOfCycles {
        N: Normal = NORMAL,
        roughness: Float = ROUGHNESS,
    }
}

/// `sheen(N, roughness)`, as Cycles has it.
pub(super) fn sheen_alone() -> ClosureDef {
    let doc = "the sheen lobe alone, white, as Cycles calls it: sheen_bsdf of color 1";
    ClosureDef::new("sheen", doc, |a: SheenOfCycles, leaf| {
        let form = SheenForm { shadowing: None, softening: None, sampling: None, layering: None, mode: None };
        let white = Color([crate::closure::tree::Floats::Uniform(1.0); 3]);
        for (part, rule) in form.lobes(leaf, a.N, white, a.roughness) {
            leaf.cover(part, white, rule);
        }
    })
    .top_albedo(TopAlbedo::Sheen)
    .without(&[Waiver { only: None, ..SOFTENED }])
    .formula("f = D G / (4 ci co), as sheen has it, white and over nothing", "Estevez and Kulla 2017")
}

/// What the keywords of a sheen choose.
struct SheenForm {
    shadowing: Option<Word<Shadowing>>,
    softening: Option<Int>,
    sampling: Option<Word<SheenSampling>>,
    layering: Option<Word<Layering>>,
    mode: Option<Int>,
}

/// The choices of a lane; positions in the lists of all values, so that they have an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SheenKey {
    fibers: bool,
    scheme: usize,
    soft: bool,
    term: usize,
    rule: usize,
}

/// The place of a value in the list of all.
fn place<T: PartialEq>(all: &[(&'static str, T)], value: T) -> usize {
    all.iter().position(|(_, known)| *known == value).unwrap_or(0)
}

impl SheenForm {
    fn varies(&self) -> bool {
        let words = self.shadowing.varies() || self.sampling.varies() || self.layering.varies();
        words || self.softening.varies() || self.mode.varies()
    }

    fn key(&self, leaf: &LeafMaker<'_>, lane: usize) -> SheenKey {
        let settings = leaf.settings();
        let rule = leaf.word(&self.layering, lane).unwrap_or(settings.layering);
        let fibers = self.mode.is_some_and(|mode| leaf.int(mode.0, lane) == 1);
        let rule = place(&Layering::ALL, rule);
        if fibers {
            return SheenKey { fibers, scheme: 0, soft: false, term: 0, rule };
        }
        let term = leaf.word(&self.shadowing, lane).unwrap_or(settings.shadowing);
        let soft = self.softening.map_or(settings.softening, |c| leaf.int(c.0, lane) != 0);
        let scheme = leaf.word(&self.sampling, lane).unwrap_or(settings.sheen_sampling);
        SheenKey { fibers, scheme: place(&SheenSampling::ALL, scheme), soft, term: place(&Shadowing::ALL, term), rule }
    }

    /// Adds the lobes of all variants, each with the rule that it covers a base by.
    fn lobes(
        &self,
        leaf: &mut LeafMaker<'_>,
        normal: Normal,
        tint: Color,
        roughness: Float,
    ) -> Vec<(PartId, Layering)> {
        leaf.tint(tint);
        let frame = leaf.frame(normal, None);
        let variants = leaf.variants(self.varies(), |leaf, lane| Some(self.key(leaf, lane)));
        let add = |(key, gate): (SheenKey, _)| {
            let scheme = SheenSampling::ALL[key.scheme].1;
            let kind = match key.fibers {
                true => LobeKind::of::<Fibers>(),
                false => sheen_kind(Shadowing::ALL[key.term].1, key.soft, scheme),
            };
            let choice = Choice::from(scheme);
            let params = [roughness.0];
            let lobe = LobeRequest { gate, choice, ..LobeRequest::new(kind, frame, &params) };
            (leaf.add(lobe), Layering::ALL[key.rule].1)
        };
        variants.into_iter().map(add).collect()
    }
}

/// The model of a sheen.
fn sheen_kind(term: Shadowing, soft: bool, scheme: SheenSampling) -> LobeKind {
    match scheme {
        SheenSampling::Normals => match (term, soft) {
            (Shadowing::Exact, true) => LobeKind::of::<ByNormals<EXACT, true>>(),
            (Shadowing::Exact, false) => LobeKind::of::<ByNormals<EXACT, false>>(),
            (Shadowing::Published, true) => LobeKind::of::<ByNormals<PUBLISHED, true>>(),
            (Shadowing::Published, false) => LobeKind::of::<ByNormals<PUBLISHED, false>>(),
            (Shadowing::Series, true) => LobeKind::of::<ByNormals<SERIES, true>>(),
            (Shadowing::Series, false) => LobeKind::of::<ByNormals<SERIES, false>>(),
            (Shadowing::Ashikhmin, _) => LobeKind::of::<ByNormals<ASHIKHMIN, false>>(),
        },
        SheenSampling::Proposal | SheenSampling::Uniform | SheenSampling::Cosine => match (term, soft) {
            (Shadowing::Exact, true) => LobeKind::of::<Sheen<EXACT, true>>(),
            (Shadowing::Exact, false) => LobeKind::of::<Sheen<EXACT, false>>(),
            (Shadowing::Published, true) => LobeKind::of::<Sheen<PUBLISHED, true>>(),
            (Shadowing::Published, false) => LobeKind::of::<Sheen<PUBLISHED, false>>(),
            (Shadowing::Series, true) => LobeKind::of::<Sheen<SERIES, true>>(),
            (Shadowing::Series, false) => LobeKind::of::<Sheen<SERIES, false>>(),
            (Shadowing::Ashikhmin, _) => LobeKind::of::<Sheen<ASHIKHMIN, false>>(),
        },
    }
}

arguments! {
    struct Layer {
        top: Nested = ParamSpec::about("the layer on top"),
        base: Nested = ParamSpec::about("what lies under it"),
    }
    keywords {
        layering: Word<Layering> = LAYERING,
    }
}

pub(super) fn layer() -> ClosureDef {
    ClosureDef::new("layer", "lays one closure over another by albedo scaling", |a: Layer, leaf| {
        let rule = |leaf: &LeafMaker<'_>, lane: usize| {
            let rule = leaf.word(&a.layering, lane).unwrap_or(leaf.settings().layering);
            Some(place(&Layering::ALL, rule))
        };
        leaf.nest(a.base);
        for (rule, gate) in leaf.variants(a.layering.varies(), rule) {
            leaf.cover_by(a.top, Layering::ALL[rule].1, gate);
        }
    })
    .without(LAYER_WAIVERS)
}

arguments! {
    struct AshikhminVelvet {
        N: Normal = NORMAL,
        sigma: Float = ParamSpec::about("width of the inverted Gaussian, clamped to 0.06..1")
            .tried(&[0.3, 0.06, 0.15, 0.6, 1.0]),
    }
    keywords {
        form: Word<Form> = ParamSpec::about(
            "\"2000\" (default): no light along the normal, grooves that hide each other; \"2007\": with a constant part, nothing hidden",
        ),
    }
}

impl Words for Form {
    const ALL: &'static [(&'static str, Self)] = Form::ALL;
}

pub(super) fn ashikhmin_velvet() -> ClosureDef {
    let doc = "velvet of Ashikhmin, Premoze and Shirley 2000, to compare sheen with, or in its form of 2007";
    ClosureDef::new("ashikhmin_velvet", doc, |a: AshikhminVelvet, leaf| {
        let frame = leaf.frame(a.N, None);
        let form = |leaf: &LeafMaker<'_>, lane: usize| Some(leaf.word(&a.form, lane).unwrap_or_default());
        for (form, gate) in leaf.variants(a.form.varies(), form) {
            let kind = match form {
                Form::Of2000 => LobeKind::of::<Velvet2000>(),
                Form::Of2007 => LobeKind::of::<Velvet>(),
            };
            leaf.add(LobeRequest { gate, ..LobeRequest::new(kind, frame, &[a.sigma.0]) });
        }
    })
}
