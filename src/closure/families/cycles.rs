//! The closures of Cycles (Blender) by their names, for shaders that its nodes are made of: each by the model that velour has for it, or
//! the nearest, which its documentation says.

use super::boundaries::{Term, Walls};
use super::hair::Fiber;
use super::usual::{NORMAL, TANGENT};
use crate::arguments;
use crate::bsdf::lambert::{Lambert, Translucent};
use crate::bsdf::microfacet::Facets;
use crate::closure::arguments::{Color, Float, Normal, Text, Vector, Word};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::LeafMaker;
use crate::closure::lobe_kind::LobeKind;
use crate::closure::tree::{Floats, Ints};
use crate::lang::closures::{Claim, ParamSpec, Waiver};

const WIDTH: ParamSpec = ParamSpec::about("width of the facets, 0..1; 0 is smooth").tried(&[0.3, 0.02, 0.6, 1.0]);
const UNUSED: ParamSpec = ParamSpec::about("not used");
const ETA: ParamSpec = ParamSpec::about("index of refraction beyond over before, > 0").tried(&[1.5, 1.05, 0.7]);
const ALL: Floats = Floats::Uniform(0.0);

const FACETS: &[Waiver] = &[
    Waiver {
        claim: Claim::Reciprocity,
        only: None,
        why: "where light passes, both halves are divided by what single scattering leaves toward the viewer alone",
    },
    Waiver {
        claim: Claim::Energy,
        only: None,
        why: "what single scattering leaves is known to 5e-3, the worst of it for stretched facets",
    },
];

/// All of them.
pub(super) fn all() -> Vec<ClosureDef> {
    vec![
        f82_tint(),
        multi_ggx_glass(),
        multi_ggx_aniso(),
        plain_facets("microfacet_ggx", Facets::Ggx),
        plain_facets("microfacet_beckmann", Facets::Beckmann),
        facets_refraction("microfacet_ggx_refraction", Facets::Ggx),
        facets_refraction("microfacet_beckmann_refraction", Facets::Beckmann),
        thin_glass(),
        thin_subsurface(),
        bssrdf(),
        hair_reflection(),
        hair_transmission(),
        hair_chiang(),
        hair_huang(),
        medium::<OneFloat>("henyey_greenstein"),
        medium::<TwoFloats>("fournier_forand"),
        medium::<TwoFloats>("draine"),
        medium::<Nothing>("rayleigh"),
        medium::<Nothing>("absorption"),
        ambient_occlusion(),
        ray_portal(),
    ]
}

arguments! {
    struct F82Tint {
        distribution: Word<Option<Facets>> = ParamSpec::about("\"ggx\", \"beckmann\" or \"default\" (ggx)"),
        N: Normal = NORMAL,
        T: Vector = TANGENT,
        ax: Float = WIDTH,
        ay: Float = WIDTH,
        f0: Color = ParamSpec::about("reflectance at normal incidence, 0..1").tried(&[0.8, 0.04, 1.0]),
        f82: Color = ParamSpec::about("tint near 82 degrees, not used"),
    }
}

fn f82_tint() -> ClosureDef {
    let doc =
        "metal whose reflectance rises from f0 to 1 as Schlick has it; the dip near 82 degrees is left out (Cycles)";
    ClosureDef::new("microfacet_f82_tint", doc, |a: F82Tint, leaf| {
        let ([r, g, b], one) = (a.f0.0, Floats::Uniform(1.0));
        let fresnel = [r, g, b, one, one, one, Floats::Uniform(5.0)];
        Walls::facets(Term::Schlick, a.distribution, (a.N, a.T), [a.ax.0, a.ay.0], &fresnel).lobes(leaf);
    })
    .without(FACETS)
}

/// Which halves a boundary has.
const REFLECT: Ints = Ints::Uniform(0);
const REFRACT: Ints = Ints::Uniform(1);
const BOTH: Ints = Ints::Uniform(2);

/// White facets of a dielectric along a normal and a tangent, of a width for each axis.
fn rough(facets: Facets, axes: (Normal, Vector, [Floats; 2]), eta: &[Floats], refract: Ints) -> Walls<'_> {
    let (normal, tangent, widths) = axes;
    let distribution = Word::Same(Some(Some(facets)));
    let mut walls = Walls::facets(Term::Dielectric, distribution, (normal, tangent), widths, eta);
    walls.refract = refract;
    walls
}

/// Facets alike all around.
fn round(normal: Normal, width: Float) -> (Normal, Vector, [Floats; 2]) {
    (normal, Vector(normal.0), [width.0; 2])
}

arguments! {
    struct MultiGlass {
        N: Normal = NORMAL,
        ag: Float = WIDTH,
        eta: Float = ETA,
        C: Color = UNUSED,
    }
}

fn multi_ggx_glass() -> ClosureDef {
    let doc = "rough glass that loses no light between its facets; its color is the closure's weight (Cycles)";
    ClosureDef::new("microfacet_multi_ggx_glass", doc, |a: MultiGlass, leaf| {
        rough(Facets::Ggx, round(a.N, a.ag), &[a.eta.0], BOTH).lobes(leaf);
    })
    .without(FACETS)
}

arguments! {
    struct MultiAniso {
        N: Normal = NORMAL,
        T: Vector = TANGENT,
        ax: Float = WIDTH,
        ay: Float = WIDTH,
        C: Color = UNUSED,
    }
}

fn multi_ggx_aniso() -> ClosureDef {
    let doc = "rough mirror that loses no light between its facets; its color is the closure's weight (Cycles)";
    ClosureDef::new("microfacet_multi_ggx_aniso", doc, |a: MultiAniso, leaf| {
        rough(Facets::Ggx, (a.N, a.T, [a.ax.0, a.ay.0]), &[ALL], REFLECT).lobes(leaf);
    })
    .without(FACETS)
}

arguments! {
    struct PlainFacets {
        N: Normal = NORMAL,
        ag: Float = WIDTH,
    }
}

fn plain_facets(name: &'static str, facets: Facets) -> ClosureDef {
    let doc = "rough mirror, as early versions of Cycles had it";
    ClosureDef::new(name, doc, move |a: PlainFacets, leaf| {
        rough(facets, round(a.N, a.ag), &[ALL], REFLECT).lobes(leaf);
    })
    .without(FACETS)
}

arguments! {
    struct FacetsRefraction {
        N: Normal = NORMAL,
        ag: Float = WIDTH,
        eta: Float = ETA,
    }
}

fn facets_refraction(name: &'static str, facets: Facets) -> ClosureDef {
    let doc = "rough refraction, as early versions of Cycles had it";
    ClosureDef::new(name, doc, move |a: FacetsRefraction, leaf| {
        rough(facets, round(a.N, a.ag), &[a.eta.0], REFRACT).lobes(leaf);
    })
    .without(FACETS)
}

arguments! {
    struct ThinGlass {
        N: Normal = NORMAL,
        T: Vector = TANGENT,
        reflection: Color = ParamSpec::about("color of what is reflected").tried(&[1.0, 0.5]),
        transmission: Color = ParamSpec::about("color of what passes").tried(&[1.0, 0.5]),
        ior: Float = ETA,
        roughness: Float = WIDTH,
        thinfilm_thickness: Float = UNUSED,
        thinfilm_ior: Float = UNUSED,
    }
}

fn thin_glass() -> ClosureDef {
    let doc = "a sheet of glass, by one boundary: light that passes is bent once and not back (Cycles)";
    ClosureDef::new("thin_glass", doc, |a: ThinGlass, leaf| {
        let eta = [a.ior.0];
        let mut walls = rough(Facets::Ggx, (a.N, a.T, [a.roughness.0; 2]), &eta, BOTH);
        walls.tints = [a.reflection, a.transmission];
        walls.lobes(leaf);
    })
    .without(FACETS)
}

arguments! {
    struct ThinSubsurface {
        N: Normal = NORMAL,
        T: Vector = TANGENT,
        C: Color = ParamSpec::about("color, 0..1"),
        anisotropy: Float = UNUSED,
        roughness: Float = UNUSED,
    }
}

fn thin_subsurface() -> ClosureDef {
    let doc = "a thin sheet that scatters inside, by Lambert's transmission of its color (Cycles)";
    ClosureDef::new("thin_subsurface", doc, |a: ThinSubsurface, leaf| {
        leaf.tint(a.C);
        diffuse(leaf, a.N, LobeKind::of::<Translucent>());
    })
}

arguments! {
    struct Bssrdf {
        method: Text = UNUSED,
        N: Normal = NORMAL,
        radius: Vector = UNUSED,
        albedo: Color = UNUSED,
    }
}

fn bssrdf() -> ClosureDef {
    let doc = "stands in for scattering below the surface by Lambert's reflection; its color is the closure's weight (Cycles)";
    ClosureDef::new("bssrdf", doc, |a: Bssrdf, leaf| diffuse(leaf, a.N, LobeKind::of::<Lambert>()))
}

fn diffuse(leaf: &mut LeafMaker<'_>, normal: Normal, kind: LobeKind) {
    let frame = leaf.frame(normal, None);
    leaf.lobe(kind, frame, &[]);
}

arguments! {
    struct HairHalf {
        N: Normal = NORMAL,
        roughnessu: Float = WIDTH,
        roughnessv: Float = WIDTH,
        T: Vector = ParamSpec::about("direction of the fiber"),
        offset: Float = UNUSED,
    }
}

fn hair_reflection() -> ClosureDef {
    let doc = "what hair reflects, by rough facets along and across the fiber (Cycles)";
    ClosureDef::new("hair_reflection", doc, |a: HairHalf, leaf| {
        let widths = [a.roughnessu.0, a.roughnessv.0];
        rough(Facets::Ggx, (a.N, a.T, widths), &[ALL], REFLECT).lobes(leaf);
    })
    .without(FACETS)
}

fn hair_transmission() -> ClosureDef {
    let doc = "what passes through hair, by Lambert's transmission (Cycles)";
    ClosureDef::new("hair_transmission", doc, |a: HairHalf, leaf| diffuse(leaf, a.N, LobeKind::of::<Translucent>()))
}

arguments! {
    struct HairChiang {
        N: Normal = NORMAL,
        sigma: Color = ParamSpec::about("absorption inside the fiber, per radius").tried(&[0.0, 0.3, 2.0]),
        roughnessu: Float = ParamSpec::about("taken as the variance along the fiber").tried(&[0.05, 0.3]),
        roughnessv: Float = ParamSpec::about("width around the fiber").tried(&[0.3, 0.05]),
        coat: Float = UNUSED,
        alpha: Float = UNUSED,
        eta: Float = ParamSpec::about("index of refraction of the fiber").tried(&[1.55, 1.1]),
    }
}

fn hair_chiang() -> ClosureDef {
    let doc = "a fiber of hair (Chiang et al. 2016) without coat and tilt of its scales (Cycles)";
    ClosureDef::new("hair_chiang", doc, |a: HairChiang, leaf| {
        Fiber::plain(a.eta.0, a.roughnessu.0, a.roughnessv.0, a.sigma.0).lobes(leaf, a.N, None);
    })
    .without(super::hair::WAIVERS)
}

arguments! {
    struct HairHuang {
        N: Normal = NORMAL,
        sigma: Color = ParamSpec::about("absorption inside the fiber, per radius").tried(&[0.0, 0.3, 2.0]),
        roughness: Float = ParamSpec::about("taken for both widths of the fiber").tried(&[0.3, 0.05]),
        tilt: Float = UNUSED,
        eta: Float = ParamSpec::about("index of refraction of the fiber").tried(&[1.55, 1.1]),
        aspect_ratio: Float = UNUSED,
        r_lobe: Float = UNUSED,
        tt_lobe: Float = UNUSED,
        trt_lobe: Float = UNUSED,
    }
}

fn hair_huang() -> ClosureDef {
    let doc = "a fiber of hair, by the model of Chiang et al. 2016 instead of that of Huang et al. 2022 (Cycles)";
    ClosureDef::new("hair_huang", doc, |a: HairHuang, leaf| {
        let width = a.roughness.0;
        Fiber::plain(a.eta.0, width, width, a.sigma.0).lobes(leaf, a.N, None);
    })
    .without(super::hair::WAIVERS)
}

arguments! {
    struct Nothing {}
}

arguments! {
    struct OneFloat {
        g: Float = ParamSpec::about("mean cosine of scattering, -1..1"),
    }
}

arguments! {
    struct TwoFloats {
        first: Float = ParamSpec::about("first parameter of the phase function"),
        second: Float = ParamSpec::about("second parameter of the phase function"),
    }
}

/// A phase function of a medium, which is not rendered.
fn medium<A: crate::closure::ReadArguments>(name: &'static str) -> ClosureDef {
    let doc = "what fills a volume; left out of a render, which says so (Cycles)";
    ClosureDef::new(name, doc, move |_: A, leaf| {
        leaf.leave_out("fills a volume, which is not rendered", |_, _| true);
    })
    .inert()
}

fn ambient_occlusion() -> ClosureDef {
    ClosureDef::new(
        "ambient_occlusion",
        "light of a free sky; left out of a render, which says so (Cycles)",
        |_: Nothing, leaf| {
            leaf.leave_out("asks how open the surroundings are, which is not rendered apart from light", |_, _| true);
        },
    )
    .inert()
}

arguments! {
    struct Portal {
        position: Vector = ParamSpec::about("where the ray goes on"),
        direction: Vector = ParamSpec::about("where it goes from there"),
    }
}

fn ray_portal() -> ClosureDef {
    ClosureDef::new(
        "ray_portal_bsdf",
        "sends rays on elsewhere; left out of a render, which says so (Cycles)",
        |_: Portal, leaf| {
            leaf.leave_out("sends rays to another place, which is not rendered", |_, _| true);
        },
    )
    .inert()
}
