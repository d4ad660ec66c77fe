//! Diffuse reflection and transmission, and what stands in for scattering below the surface.

use super::usual::NORMAL;
use crate::arguments;
use crate::bsdf::lambert::{Lambert, Translucent};
use crate::bsdf::{burley, eon, oren_nayar};
use crate::closure::arguments::{Argument, Color, Float, Int, Normal};
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::{LeafMaker, LobeRequest};
use crate::closure::lobe_kind::LobeKind;
use crate::lang::closures::{Claim, ParamSpec, Waiver};

const ALBEDO: ParamSpec = ParamSpec::about("color of the reflection, 0..1");

/// Adds a lobe without parameters about a normal.
fn plain(leaf: &mut LeafMaker<'_>, kind: LobeKind, normal: Normal) {
    let frame = leaf.frame(normal, None);
    leaf.lobe(kind, frame, &[]);
}

arguments! {
    struct Plain {
        N: Normal = NORMAL,
    }
}

pub(super) fn diffuse() -> ClosureDef {
    let prepare = |a: Plain, leaf: &mut LeafMaker<'_>| plain(leaf, LobeKind::of::<Lambert>(), a.N);
    ClosureDef::new("diffuse", "Lambert's reflection", prepare).lossless()
}

pub(super) fn translucent() -> ClosureDef {
    let prepare = |a: Plain, leaf: &mut LeafMaker<'_>| plain(leaf, LobeKind::of::<Translucent>(), a.N);
    ClosureDef::new("translucent", "Lambert's transmission", prepare).lossless()
}

arguments! {
    struct OrenNayar {
        N: Normal = NORMAL,
        sigma: Float = ParamSpec::about("standard deviation of the facet slope, radians, >= 0")
            .tried(&[0.3, 0.0, 0.1, 0.7, 1.5]),
    }
}

pub(super) fn oren_nayar() -> ClosureDef {
    let doc = "rough diffuse reflection of Oren and Nayar 1994";
    ClosureDef::new("oren_nayar", doc, |a: OrenNayar, leaf| {
        let frame = leaf.frame(a.N, None);
        leaf.lobe(LobeKind::of::<oren_nayar::OrenNayar>(), frame, &[a.sigma.0]);
    })
}

arguments! {
    struct OrenNayarDiffuse {
        N: Normal = NORMAL,
        albedo: Color = ALBEDO.tried(&[1.0, 0.5]),
        roughness: Float = ParamSpec::about("standard deviation of the facet slope, radians, 0..1")
            .tried(&[0.3, 0.0, 0.1, 0.7, 1.0]),
    }
    keywords {
        energy_compensation: Int = ParamSpec::about(
            "0: Oren and Nayar 1994 (the default); 1: Portsmouth, Kutz and Hill 2025, which loses no light",
        )
        .tried(&[0.0, 1.0]),
    }
}

pub(super) fn oren_nayar_diffuse() -> ClosureDef {
    ClosureDef::new("oren_nayar_diffuse_bsdf", "rough diffuse reflection", |a: OrenNayarDiffuse, leaf| {
        leaf.tint(a.albedo);
        let frame = leaf.frame(a.N, None);
        let [r, g, b] = a.albedo.0;
        let compensated =
            |leaf: &LeafMaker<'_>, lane| Some(a.energy_compensation.is_some_and(|c| leaf.int(c.0, lane) != 0));
        for (compensated, gate) in leaf.variants(a.energy_compensation.varies(), compensated) {
            let (kind, params) = match compensated {
                true => (LobeKind::of::<eon::Eon>(), &[a.roughness.0, r, g, b][..]),
                false => (LobeKind::of::<oren_nayar::OrenNayar>(), &[a.roughness.0][..]),
            };
            leaf.add(LobeRequest { gate, ..LobeRequest::new(kind, frame, params) });
        }
    })
}

arguments! {
    struct Burley {
        N: Normal = NORMAL,
        albedo: Color = ALBEDO,
        roughness: Float = ParamSpec::about("0 (smooth) to 1").tried(&[0.5, 0.0, 0.2, 0.8, 1.0]),
    }
}

const BURLEY_WAIVERS: &[Waiver] = &[Waiver {
    claim: Claim::Energy,
    only: None,
    why: "rises toward grazing when rougher than 0.4: albedo up to 1.558 at roughness 1 and cosine 0",
}];

pub(super) fn burley() -> ClosureDef {
    ClosureDef::new("burley_diffuse_bsdf", "rough diffuse reflection of Burley 2012", |a: Burley, leaf| {
        leaf.tint(a.albedo);
        let frame = leaf.frame(a.N, None);
        leaf.lobe(LobeKind::of::<burley::Burley>(), frame, &[a.roughness.0]);
    })
    .without(BURLEY_WAIVERS)
}

arguments! {
    struct TranslucentColor {
        N: Normal = NORMAL,
        albedo: Color = ParamSpec::about("color of the transmission, 0..1"),
    }
}

pub(super) fn translucent_bsdf() -> ClosureDef {
    ClosureDef::new("translucent_bsdf", "Lambert's transmission", |a: TranslucentColor, leaf| {
        leaf.tint(a.albedo);
        plain(leaf, LobeKind::of::<Translucent>(), a.N);
    })
    .lossless()
}

arguments! {
    struct Subsurface {
        eta: Float = ParamSpec::about("index of refraction, not used"),
        g: Float = ParamSpec::about("mean cosine of scattering, not used"),
        mfp: Color = ParamSpec::about("mean free path, not used"),
        albedo: Color = ParamSpec::about("color of the diffuse reflection"),
    }
}

pub(super) fn subsurface() -> ClosureDef {
    let doc = "stands in for scattering below the surface by Lambert's reflection of `albedo` about the geometric normal: right far from edges of a flat, even medium; no light bleeds sideways";
    ClosureDef::new("subsurface", doc, |a: Subsurface, leaf| {
        leaf.tint(a.albedo);
        let frame = leaf.geometric_frame();
        leaf.lobe(LobeKind::of::<Lambert>(), frame, &[]);
    })
    .lossless()
}

arguments! {
    struct SubsurfaceColor {
        N: Normal = NORMAL,
        albedo: Color = ALBEDO,
        radius: Color = ParamSpec::about("mean free path, not used"),
        anisotropy: Float = ParamSpec::about("mean cosine of scattering, not used"),
    }
}

pub(super) fn subsurface_bssrdf() -> ClosureDef {
    let doc = "stands in for scattering below the surface by Lambert's reflection of `albedo`: right far from edges of a flat, even medium; no light bleeds sideways";
    ClosureDef::new("subsurface_bssrdf", doc, |a: SubsurfaceColor, leaf| {
        leaf.tint(a.albedo);
        plain(leaf, LobeKind::of::<Lambert>(), a.N);
    })
    .lossless()
}
