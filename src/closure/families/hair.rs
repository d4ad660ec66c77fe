//! Hair and fur: one lobe for each number of crossings of the fiber.

use super::usual::NORMAL;
use crate::arguments;
use crate::bsdf::hair::Hair;
use crate::closure::arguments::{Color, Float, Normal, Vector};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::LeafMaker;
use crate::closure::lobe_kind::LobeKind;
use crate::closure::tree::Floats;
use crate::lang::closures::{Claim, ParamSpec, Waiver};

const ALONG: ParamSpec = ParamSpec::about("variance along the fiber, 0.001..1").tried(&[0.05, 0.001, 0.01, 0.3, 1.0]);
const AROUND: ParamSpec = ParamSpec::about("width around the fiber, 0.001..1").tried(&[0.3, 0.05, 1.0]);

arguments! {
    struct Chiang {
        N: Normal = NORMAL,
        curve_direction: Vector = ParamSpec::about("direction of the fiber; zero for any"),
        tint_R: Color = ParamSpec::about("color of what the fiber reflects"),
        tint_TT: Color = ParamSpec::about("color of what passes through it"),
        tint_TRT: Color = ParamSpec::about("color of what is reflected inside, once and more often"),
        ior: Float = ParamSpec::about("index of refraction of the fiber, 1.001..10").tried(&[1.55, 1.1, 2.5]),
        longitudual_roughness_R: Float = ALONG,
        longitudual_roughness_TT: Float = ALONG,
        longitudual_roughness_TRT: Float = ALONG,
        azimuthal_roughness_R: Float = AROUND,
        azimuthal_roughness_TT: Float = AROUND,
        azimuthal_roughness_TRT: Float = AROUND,
        cuticle_angle: Float = ParamSpec::about("tilt of the scales: 0.5 is none, 0 and 1 a right angle")
            .tried(&[0.5, 0.45, 0.55]),
        absorption_coefficient: Color = ParamSpec::about("absorption inside the fiber, per radius").tried(&[0.0, 0.3, 2.0]),
    }
}

pub(super) const WAIVERS: &[Waiver] = &[Waiver {
    claim: Claim::Reciprocity,
    only: None,
    why: "the viewer alone says where on its width the fiber is met",
}];

pub(super) fn chiang() -> ClosureDef {
    let doc =
        "a fiber of hair or fur (Chiang, Bitterli, Tappan and Burley 2016), seen as a cylinder along curve_direction";
    ClosureDef::new("chiang_hair_bsdf", doc, |a: Chiang, leaf| {
        let path = |tint: Color, along: Float, around: Float| Path { tint: tint.0, along: along.0, around: around.0 };
        // Paths of more crossings share the tint and the roughness of TRT.
        let trt = path(a.tint_TRT, a.longitudual_roughness_TRT, a.azimuthal_roughness_TRT);
        let fiber = Fiber {
            eta: a.ior.0,
            angle: a.cuticle_angle.0,
            absorption: a.absorption_coefficient.0,
            paths: [
                path(a.tint_R, a.longitudual_roughness_R, a.azimuthal_roughness_R),
                path(a.tint_TT, a.longitudual_roughness_TT, a.azimuthal_roughness_TT),
                trt,
                trt,
            ],
        };
        fiber.lobes(leaf, a.N, Some(a.curve_direction));
    })
    .without(WAIVERS)
}

/// Light that has met a fiber so often: its color and widths.
#[derive(Clone, Copy)]
struct Path {
    tint: [Floats; 3],
    along: Floats,
    around: Floats,
}

/// A fiber.
pub(super) struct Fiber {
    eta: Floats,
    angle: Floats,
    absorption: [Floats; 3],
    paths: [Path; 4],
}

impl Fiber {
    /// A white fiber of the same widths for all light, whose scales are not tilted.
    pub(super) fn plain(eta: Floats, along: Floats, around: Floats, absorption: [Floats; 3]) -> Self {
        let path = Path { tint: [Floats::Uniform(1.0); 3], along, around };
        Fiber { eta, angle: Floats::Uniform(0.5), absorption, paths: [path; 4] }
    }

    /// Adds its lobes; without a direction it lies along the tangent of the surface.
    pub(super) fn lobes(&self, leaf: &mut LeafMaker<'_>, normal: Normal, direction: Option<Vector>) {
        let frame = leaf.frame(normal, direction);
        let kinds = [
            LobeKind::of::<Hair<0>>(),
            LobeKind::of::<Hair<1>>(),
            LobeKind::of::<Hair<2>>(),
            LobeKind::of::<Hair<3>>(),
        ];
        for (kind, Path { tint: [tr, tg, tb], along, around }) in kinds.into_iter().zip(self.paths) {
            let [r, g, b] = self.absorption;
            leaf.lobe(kind, frame, &[self.eta, along, around, self.angle, r, g, b, tr, tg, tb]);
        }
    }
}
