//! Boundaries between media, smooth and rough: mirrors, glass, metals.

use super::{ClosureSpec, ETA, Model, NORMAL, ParamKind, ParamSpec, TANGENT, choice, param, spec};

const DISTRIBUTION: ParamSpec = choice(
    "distribution",
    &["ggx", "beckmann", "blinn", "default", "sharp", ""],
    "\"ggx\", \"beckmann\", \"blinn\" (one width) or \"default\" (ggx); \"sharp\" is smooth",
);
const GEOMETRY: ParamSpec = choice(
    "geometry",
    &["smith", "separable", "vgroove"],
    "shadowing: \"smith\" (default), \"separable\" or \"vgroove\"",
);
const SAMPLING: ParamSpec = choice(
    "sampling",
    &["visible", "normals"],
    "facets to sample: \"visible\" (default) ones, or all \"normals\" (to compare with)",
);
const ROUGHNESS_X: ParamSpec =
    param("roughness_x", ParamKind::Float, "width along U, 0..1; 0 is smooth").tried(&[0.3, 0.02, 0.1, 0.6, 1.0]);
const ROUGHNESS_Y: ParamSpec =
    param("roughness_y", ParamKind::Float, "width across U, 0..1").tried(&[0.3, 0.1, 0.8, 0.02, 1.0]);
const REFLECTION_TINT: ParamSpec =
    param("reflection_tint", ParamKind::Color, "color of what is reflected; black: nothing").tried(&[1.0, 0.5, 0.0]);
const TRANSMISSION_TINT: ParamSpec =
    param("transmission_tint", ParamKind::Color, "color of what passes; black: opaque").tried(&[1.0, 0.5, 0.0]);

const THICKNESS: ParamSpec = param("thinfilm_thickness", ParamKind::Float, "thickness of a film, nanometers")
    .left_out(0.0, "the colors of a thin film");
const FILM_IOR: ParamSpec =
    param("thinfilm_ior", ParamKind::Float, "index of refraction of the film; not modelled, as the film is not");
const ABSORPTION: ParamSpec = param("absorption", ParamKind::Color, "absorption inside, per unit of length")
    .left_out(0.0, "absorption inside the medium");
const DISPERSION: ParamSpec =
    param("dispersion", ParamKind::Float, "inverse Abbe number").left_out(0.0, "the colors of dispersion");

/// Boundaries between media.
pub(super) fn specs() -> Vec<ClosureSpec> {
    use super::ParamKind::*;
    let microfacet = [
        DISTRIBUTION,
        NORMAL,
        TANGENT,
        param("xalpha", Float, "width along U, 0..1; 0 is a mirror").tried(&[0.3, 0.02, 0.1, 0.6, 1.0]),
        param("yalpha", Float, "width across U, 0..1").tried(&[0.3, 0.1, 0.8, 0.02, 1.0]),
        ETA,
        param("refract", Int, "0 reflects, 1 refracts, 2 does both").tried(&[0.0, 1.0, 2.0]),
    ];
    let dielectric = [
        NORMAL,
        TANGENT,
        REFLECTION_TINT,
        TRANSMISSION_TINT,
        ROUGHNESS_X,
        ROUGHNESS_Y,
        param("ior", Float, "index of refraction inside over outside, > 0").tried(&[1.5, 1.0, 1.05, 2.5, 0.7]),
        DISTRIBUTION,
    ];
    let conductor = [
        NORMAL,
        TANGENT,
        ROUGHNESS_X,
        ROUGHNESS_Y,
        param("ior", Color, "index of refraction over that outside").tried(&[0.2, 1.0, 3.0]),
        param("extinction", Color, "extinction coefficient over the index outside").tried(&[3.9, 0.0, 1.0]),
        DISTRIBUTION,
    ];
    let schlick = [
        NORMAL,
        TANGENT,
        REFLECTION_TINT,
        TRANSMISSION_TINT,
        ROUGHNESS_X,
        ROUGHNESS_Y,
        param("f0", Color, "reflectance at normal incidence, 0..1; its mean gives the index of refraction")
            .tried(&[0.04, 0.0, 0.5, 1.0]),
        param("f90", Color, "reflectance at grazing incidence, 0..1").tried(&[1.0, 0.5]),
        param("exponent", Float, "how late reflectance rises, 5 for most materials, >= 0").tried(&[5.0, 0.0, 2.0]),
        DISTRIBUTION,
    ];
    vec![
        spec(
            "reflection",
            Model::Reflection,
            &[NORMAL, ETA],
            &[],
            "mirror with dielectric Fresnel; eta 0 reflects all",
        ),
        spec("refraction", Model::Refraction, &[NORMAL, ETA], &[], "smooth refraction with dielectric Fresnel"),
        spec(
            "microfacet",
            Model::Microfacet,
            &microfacet,
            &[GEOMETRY, SAMPLING],
            "rough dielectric reflection and refraction",
        ),
        spec(
            "dielectric_bsdf",
            Model::DielectricBsdf,
            &dielectric,
            &[GEOMETRY, SAMPLING, THICKNESS, FILM_IOR, ABSORPTION, DISPERSION],
            "boundary of glass, water and the like, rough or smooth, reflecting and refracting",
        ),
        spec(
            "conductor_bsdf",
            Model::ConductorBsdf,
            &conductor,
            &[GEOMETRY, SAMPLING, THICKNESS, FILM_IOR],
            "metal of a complex index of refraction, rough or smooth",
        ),
        spec(
            "generalized_schlick_bsdf",
            Model::GeneralizedSchlickBsdf,
            &schlick,
            &[GEOMETRY, SAMPLING, THICKNESS, FILM_IOR],
            "rough or smooth boundary whose reflectance runs from f0 to f90",
        ),
    ]
}
