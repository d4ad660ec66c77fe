//! The closures of MaterialX that are neither boundaries nor sheen.

use super::{Claim, ClosureSpec, Model, NORMAL, ParamKind, ParamSpec, Waiver, param, spec};

const ALBEDO: ParamSpec = param("albedo", ParamKind::Color, "color of the reflection, 0..1");
const ROUGHNESS: ParamSpec = param("roughness", ParamKind::Float, "0 (smooth) to 1").tried(&[0.5, 0.0, 0.2, 0.8, 1.0]);

const BURLEY_WAIVERS: &[Waiver] = &[Waiver {
    claim: Claim::Energy,
    only: None,
    why: "rises toward grazing when rougher than 0.4: albedo up to 1.558 at roughness 1 and cosine 0",
}];

/// The closures of MaterialX that are neither boundaries nor sheen.
pub(super) fn specs() -> Vec<ClosureSpec> {
    use super::ParamKind::*;
    vec![
        spec(
            "oren_nayar_diffuse_bsdf",
            Model::OrenNayarDiffuse,
            &[
                NORMAL,
                ALBEDO.tried(&[1.0, 0.5]),
                param("roughness", Float, "standard deviation of the facet slope, radians, 0..1").tried(&[0.3, 0.0, 0.1, 0.7, 1.0]),
            ],
            &[param(
                "energy_compensation",
                Int,
                "0: Oren and Nayar 1994 (the default); 1: Portsmouth, Kutz and Hill 2025, which loses no light",
            )
            .tried(&[0.0, 1.0])],
            "rough diffuse reflection",
        ),
        spec(
            "burley_diffuse_bsdf",
            Model::BurleyDiffuse,
            &[NORMAL, ALBEDO, ROUGHNESS],
            &[],
            "rough diffuse reflection of Burley 2012",
        )
        .without(BURLEY_WAIVERS),
        spec(
            "translucent_bsdf",
            Model::Translucent,
            &[NORMAL, param("albedo", Color, "color of the transmission, 0..1")],
            &[],
            "Lambert's transmission",
        )
        .lossless(),
        spec("transparent_bsdf", Model::Transparent, &[], &[], "lets light pass straight through").lossless(),
        spec(
            "subsurface_bssrdf",
            Model::Diffuse,
            &[
                NORMAL,
                ALBEDO,
                param("radius", Color, "mean free path, not used"),
                param("anisotropy", Float, "mean cosine of scattering, not used"),
            ],
            &[],
            "stands in for scattering below the surface by Lambert's reflection of `albedo`: right far from edges of a flat, even medium; no light bleeds sideways",
        )
        .lossless(),
        hair(),
        spec(
            "uniform_edf",
            Model::Emission,
            &[param("emittance", Color, "radiance in every direction")],
            &[],
            "emits the same radiance in every direction, both sides of the normal's hemisphere",
        ),
    ]
}

const HAIR_WAIVERS: &[Waiver] = &[Waiver {
    claim: Claim::Reciprocity,
    only: None,
    why: "the viewer alone says where on its width the fiber is met",
}];

/// Hair, whose scales and crossings need a parameter each.
fn hair() -> ClosureSpec {
    use super::ParamKind::*;
    let along = |name| param(name, Float, "variance along the fiber, 0.001..1").tried(&[0.05, 0.001, 0.01, 0.3, 1.0]);
    let around = |name| param(name, Float, "width around the fiber, 0.001..1").tried(&[0.3, 0.05, 1.0]);
    spec(
        "chiang_hair_bsdf",
        Model::Hair,
        &[
            NORMAL,
            param("curve_direction", Vector, "direction of the fiber; zero for any"),
            param("tint_R", Color, "color of what the fiber reflects"),
            param("tint_TT", Color, "color of what passes through it"),
            param("tint_TRT", Color, "color of what is reflected inside, once and more often"),
            param("ior", Float, "index of refraction of the fiber, 1.001..10").tried(&[1.55, 1.1, 2.5]),
            along("longitudual_roughness_R"),
            along("longitudual_roughness_TT"),
            along("longitudual_roughness_TRT"),
            around("azimuthal_roughness_R"),
            around("azimuthal_roughness_TT"),
            around("azimuthal_roughness_TRT"),
            param("cuticle_angle", Float, "tilt of the scales: 0.5 is none, 0 and 1 a right angle")
                .tried(&[0.5, 0.45, 0.55]),
            param("absorption_coefficient", Color, "absorption inside the fiber, per radius").tried(&[0.0, 0.3, 2.0]),
        ],
        &[],
        "a fiber of hair or fur (Chiang, Bitterli, Tappan and Burley 2016), seen as a cylinder along curve_direction",
    )
    .without(HAIR_WAIVERS)
}
