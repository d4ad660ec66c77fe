//! The closures that OSL has had from the start.

use super::{ClosureSpec, Model, NORMAL, param, spec};

/// The closures that OSL has had from the start.
pub(super) fn specs() -> Vec<ClosureSpec> {
    use super::ParamKind::*;
    vec![
        spec(
            "emission",
            Model::Emission,
            &[],
            &[],
            "emits its weight as radiance, both sides of the normal's hemisphere",
        ),
        spec("background", Model::Background, &[], &[], "radiance of the sky"),
        spec("diffuse", Model::Diffuse, &[NORMAL], &[], "Lambert's reflection").lossless(),
        spec(
            "oren_nayar",
            Model::OrenNayar,
            &[
                NORMAL,
                param("sigma", Float, "standard deviation of the facet slope, radians, >= 0")
                    .tried(&[0.3, 0.0, 0.1, 0.7, 1.5]),
            ],
            &[],
            "rough diffuse reflection of Oren and Nayar 1994",
        ),
        spec(
            "ashikhmin_velvet",
            Model::Velvet,
            &[
                NORMAL,
                param("sigma", Float, "width of the inverted Gaussian, clamped to 0.06..1")
                    .tried(&[0.3, 0.06, 0.15, 0.6, 1.0]),
            ],
            &[],
            "velvet of Ashikhmin and Premoze 2007, to compare sheen with",
        ),
        spec("translucent", Model::Translucent, &[NORMAL], &[], "Lambert's transmission").lossless(),
        spec("transparent", Model::Transparent, &[], &[], "lets light pass straight through").lossless(),
        spec("holdout", Model::Holdout, &[], &[], "a hole in the alpha channel"),
        spec(
            "debug",
            Model::Debug,
            &[param("tag", String, "name of the output")],
            &[],
            "a tagged value; scatters nothing",
        ),
    ]
}
