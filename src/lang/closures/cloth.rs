//! Sheen, layers and coats: the closures that nest others.

use super::{Claim, ClosureSpec, Model, NORMAL, ParamKind, ParamSpec, Waiver, choice, param, spec};

const SHEEN_ROUGHNESS: ParamSpec = param("roughness", ParamKind::Float, "Charlie roughness r, clamped to 0.01..1")
    .tried(&[0.25, 0.06, 0.15, 0.5, 1.0]);
const LAYERING: ParamSpec = choice(
    "layering",
    &["min", "view", "kelemen"],
    "how the base is scaled: \"min\" (default), \"view\" or \"kelemen\"",
);
const SHADOWING: ParamSpec = choice(
    "shadowing",
    &["exact", "published", "ashikhmin", "series"],
    "shadowing term: \"exact\" (default), \"published\" (fit of the paper), \"ashikhmin\" (real-time visibility) or \"series\" (exact to 4e-6)",
);
const SAMPLING: ParamSpec = choice(
    "sampling",
    &["ltc", "uniform", "cosine", "normals"],
    "how directions are drawn: \"ltc\" (default, a transformed cosine), \"uniform\", \"cosine\" or \"normals\" (half vector)",
);
const SOFTENING: ParamSpec =
    param("softening", ParamKind::Int, "1 (default) softens the terminator by eq. 4, 0 does not").tried(&[1.0, 0.0]);
const MODE: ParamSpec = param(
    "mode",
    ParamKind::Int,
    "0: Estevez and Kulla 2017 (the default); 1: a layer of fibers, Zeltner, Burley and Chiang 2022, which has no shadowing, softening or sampling to choose",
)
.tried(&[0.0, 1.0]);

/// Promises that the lobe does not make in some of its variants.
const SHEEN_WAIVERS: &[Waiver] = &[SOFTENED, PUBLISHED, ASHIKHMIN, VIEW_LAYERING, KELEMEN];
const SHEEN_BSDF_WAIVERS: &[Waiver] = &[SOFTENED, PUBLISHED, ASHIKHMIN, FIBERS];
const LAYER_WAIVERS: &[Waiver] = &[VIEW_LAYERING, KELEMEN];

const SOFTENED: Waiver = Waiver {
    claim: Claim::Reciprocity,
    only: Some(("softening", "1")),
    why: "eq. 4 softens the side of the light only",
};
const PUBLISHED: Waiver = Waiver {
    claim: Claim::Energy,
    only: Some(("shadowing", "published")),
    why: "the published fit of Lambda is too small at small roughness: without softening 1.011 at r = 0.06 and cosine 0.01, 1.50 at r = 1 and cosine 1e-6",
};
const ASHIKHMIN: Waiver = Waiver {
    claim: Claim::Energy,
    only: Some(("shadowing", "ashikhmin")),
    why: "the real-time visibility does not belong to D: albedo up to 1.7 below r = 0.21",
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

/// Sheen, and the layering it needs.
pub(super) fn specs() -> Vec<ClosureSpec> {
    use super::ParamKind::*;
    let sheen_tint =
        param("tint", Color, "color of the sheen; its largest component scales the albedo taken from the base");
    vec![
        spec(
            "sheen",
            Model::Sheen,
            &[param("base", Closure, "what lies under the sheen"), NORMAL, sheen_tint, SHEEN_ROUGHNESS],
            &[SHADOWING, SOFTENING, LAYERING, SAMPLING],
            "cloth sheen laid over any closure (Estevez and Kulla 2017)",
        )
        .without(SHEEN_WAIVERS),
        spec(
            "sheen_bsdf",
            Model::SheenBsdf,
            &[NORMAL, param("albedo", Color, "color of the sheen"), SHEEN_ROUGHNESS],
            &[SHADOWING, SOFTENING, MODE, SAMPLING],
            "the sheen lobe alone, to be laid over a base by layer()",
        )
        .without(SHEEN_BSDF_WAIVERS),
        spec(
            "layer",
            Model::Layer,
            &[param("top", Closure, "the layer on top"), param("base", Closure, "what lies under it")],
            &[LAYERING],
            "lays one closure over another by albedo scaling",
        )
        .without(LAYER_WAIVERS),
        coat(),
    ]
}

/// The layer of Weidlich and Wilkie.
fn coat() -> ClosureSpec {
    use super::ParamKind::*;
    let params = [
        param("base", Closure, "what lies under the coat"),
        NORMAL,
        param("roughness", Float, "GGX width of the boundary, 0..1; 0 is smooth").tried(&[0.0, 0.05, 0.2, 0.5, 1.0]),
        param(
            "eta",
            Float,
            "index of refraction of the coat over what is outside; 1 and above for a coat in air, 0 is a mirror",
        )
        .tried(&[1.5, 1.0, 1.33, 2.0, 3.0, 0.7]),
        param("absorption", Color, "absorption coefficient of the coat, 1/length, >= 0").tried(&[0.0, 1.0]),
        param("thickness", Float, "thickness of the coat, length, >= 0").tried(&[0.1, 1.0]),
    ];
    spec(
        "coat",
        Model::Coat,
        &params,
        &[],
        "a clear or tinted dielectric coat over any closure (Weidlich and Wilkie 2007)",
    )
}
