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
        let frame = leaf.frame(a.N, Some(a.curve_direction));
        let (r, tt, trt) = (
            (a.tint_R, a.longitudual_roughness_R, a.azimuthal_roughness_R),
            (a.tint_TT, a.longitudual_roughness_TT, a.azimuthal_roughness_TT),
            (a.tint_TRT, a.longitudual_roughness_TRT, a.azimuthal_roughness_TRT),
        );
        // Paths of more crossings share the tint and the roughness of TRT.
        let parts = [
            (LobeKind::of::<Hair<0>>(), r),
            (LobeKind::of::<Hair<1>>(), tt),
            (LobeKind::of::<Hair<2>>(), trt),
            (LobeKind::of::<Hair<3>>(), trt),
        ];
        for (kind, (tint, along, around)) in parts {
            let ([tr, tg, tb], [ar, ag, ab]) = (tint.0, a.absorption_coefficient.0);
            let params = [a.ior.0, along.0, around.0, a.cuticle_angle.0, ar, ag, ab, tr, tg, tb];
            leaf.lobe(kind, frame, &params);
        }
    })
    .without(WAIVERS)
}

/// A white fiber along the tangent of the surface, whose scales are not tilted.
pub(super) struct Fiber {
    pub eta: Floats,
    pub along: Floats,
    pub around: Floats,
    pub absorption: [Floats; 3],
}

impl Fiber {
    pub(super) fn lobes(&self, leaf: &mut LeafMaker<'_>, normal: Normal) {
        let frame = leaf.frame(normal, None);
        let kinds = [
            LobeKind::of::<Hair<0>>(),
            LobeKind::of::<Hair<1>>(),
            LobeKind::of::<Hair<2>>(),
            LobeKind::of::<Hair<3>>(),
        ];
        let ([r, g, b], one) = (self.absorption, Floats::Uniform(1.0));
        for kind in kinds {
            let params = [self.eta, self.along, self.around, Floats::Uniform(0.5), r, g, b, one, one, one];
            leaf.lobe(kind, frame, &params);
        }
    }
}
