//! Sheen, and the layering it needs.

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
    &["exact", "published", "ashikhmin"],
    "shadowing term: \"exact\" (default), \"published\" (fit of the paper) or \"ashikhmin\" (real-time visibility)",
);
const SOFTENING: ParamSpec =
    param("softening", ParamKind::Int, "1 (default) softens the terminator by eq. 4, 0 does not").tried(&[1.0, 0.0]);
const MODE: ParamSpec = param("mode", ParamKind::Int, "0: this model (the default); other values are not run");

/// Promises that the lobe does not make in some of its variants; the figures are maxima over r 0.06..1 and cosines from 1e-4.
const SHEEN_WAIVERS: &[Waiver] = &[
    Waiver {
        claim: Claim::Reciprocity,
        only: Some(("softening", "1")),
        why: "eq. 4 softens the side of the light only",
    },
    Waiver {
        claim: Claim::Energy,
        only: Some(("shadowing", "published")),
        why: "the published fit of Lambda falls below the true one at small roughness",
    },
    Waiver {
        claim: Claim::Energy,
        only: Some(("shadowing", "ashikhmin")),
        why: "the real-time visibility does not belong to D: albedo up to 1.7 below r = 0.21",
    },
    VIEW_LAYERING,
];
const LAYER_WAIVERS: &[Waiver] = &[VIEW_LAYERING];

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
            &[SHADOWING, SOFTENING, LAYERING],
            "cloth sheen laid over any closure (Estevez and Kulla 2017)",
        )
        .without(SHEEN_WAIVERS),
        spec(
            "sheen_bsdf",
            Model::SheenBsdf,
            &[NORMAL, param("albedo", Color, "color of the sheen"), SHEEN_ROUGHNESS],
            &[SHADOWING, SOFTENING, MODE],
            "the sheen lobe alone, to be laid over a base by layer()",
        )
        .without(SHEEN_WAIVERS),
        spec(
            "layer",
            Model::Layer,
            &[param("top", Closure, "the layer on top"), param("base", Closure, "what lies under it")],
            &[LAYERING],
            "lays one closure over another by albedo scaling",
        )
        .without(LAYER_WAIVERS),
    ]
}
