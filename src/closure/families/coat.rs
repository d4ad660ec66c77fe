//! The clear coat of Weidlich and Wilkie: a boundary over any closure, and an absorbing inside.

use super::usual::NORMAL;
use crate::arguments;
use crate::bsdf::fresnel::Dielectric;
use crate::bsdf::microfacet::{Ggx, MIN_ALPHA, Microfacet};
use crate::bsdf::specular::Reflected;
use crate::closure::arguments::{Color, Float, Int, Nested, Normal, floats_vary};
use crate::closure::coats::Coating;
use crate::closure::definition::ClosureDef;
use crate::closure::leaf::{LeafMaker, LobeRequest};
use crate::closure::lobe_kind::LobeKind;
use crate::closure::tree::Floats;
use crate::lang::closures::{ParamSpec, TopAlbedo};
use crate::math::columns::Column3;
use glam::Vec3;

arguments! {
    struct Coat {
        base: Nested = ParamSpec::about("what lies under the coat"),
        N: Normal = NORMAL,
        roughness: Float = ParamSpec::about("GGX width of the boundary, 0..1; 0 is smooth")
            .tried(&[0.0, 0.05, 0.2, 0.5, 1.0]),
        eta: Float = ParamSpec::about(
            "index of refraction of the coat over what is outside; 1 and above for a coat in air, 0 is a mirror",
        )
        .tried(&[1.5, 1.0, 1.33, 2.0, 3.0, 0.7]),
        absorption: Color = ParamSpec::about("absorption coefficient of the coat, 1/length, >= 0").tried(&[0.0, 1.0]),
        thickness: Float = ParamSpec::about("thickness of the coat, length, >= 0").tried(&[0.1, 1.0]),
    }
    keywords {
        darkening: Int = ParamSpec::about(
            "1 (default): light that the boundary throws back at a diffuse base is scattered again, which darkens all but white; 0: the formula of the paper",
        )
        .tried(&[1.0, 0.0]),
    }
}

pub(super) fn coat() -> ClosureDef {
    let doc = "a clear or tinted dielectric coat over any closure (Weidlich and Wilkie 2007), which darkens what is diffuse under it";
    ClosureDef::new("coat", doc, prepare).top_albedo(TopAlbedo::Boundary)
}

fn prepare(a: Coat, leaf: &mut LeafMaker<'_>) {
    let (tree, lanes) = (leaf.tree(), leaf.lanes());
    let (alpha, eta, thickness) = (a.roughness.0, a.eta.0, a.thickness.0);
    let absorbs = |lane: usize| Vec3::from_array(a.absorption.0.map(|c| tree.float(c, lane)));
    let number = |lane: usize| {
        let all = [tree.float(alpha, lane), tree.float(eta, lane), tree.float(thickness, lane)];
        absorbs(lane).is_finite() && all.iter().all(|v| v.is_finite())
    };
    let frame = leaf.mirror_frame(a.N, None);
    leaf.nest(a.base);
    let broken = (0..lanes).any(|lane| !number(lane));
    let rough = |leaf: &LeafMaker<'_>, lane| Some(leaf.float(alpha, lane) >= MIN_ALPHA);
    for (rough, gate) in leaf.variants(floats_vary(&[alpha]), rough) {
        let (kind, params) = match rough {
            true => (LobeKind::of::<Microfacet<Ggx, Dielectric, false>>(), &[alpha, alpha, eta][..]),
            false => (LobeKind::single::<Reflected<Dielectric>>(), &[eta][..]),
        };
        let gate = if broken { leaf.closed_unless(gate, number) } else { gate };
        // The viewer is always outside of a coat, so its eta is never inverted.
        leaf.add(LobeRequest { gate, ..LobeRequest::new(kind, frame, params) });
    }
    // A coat that is dropped for its parameters takes nothing from its base, and none can add light.
    let optical = |lane: usize| match number(lane) {
        true => (absorbs(lane) * tree.float(thickness, lane)).clamp(Vec3::ZERO, Vec3::splat(1e30)),
        false => Vec3::ZERO,
    };
    let clear = (0..lanes).all(|lane| optical(lane) == Vec3::ZERO);
    let mut depth = Column3::zeros(if clear { 0 } else { lanes });
    for lane in 0..depth.len() {
        depth.set(lane, optical(lane));
    }
    let column = |of: Floats, missing: f32| -> Vec<f32> {
        (0..lanes).map(|lane| if number(lane) { tree.float(of, lane) } else { missing }).collect()
    };
    let widths = column(alpha, 0.0);
    let alpha = widths.iter().any(|&a| a >= MIN_ALPHA).then_some(widths);
    let frame = LeafMaker::frame_index(frame);
    let darkens = (0..lanes).map(|lane| a.darkening.is_none_or(|word| tree.int(word.0, lane) != 0)).collect();
    leaf.coat(Coating { frame, eta: column(eta, 1.0), alpha, depth: (!clear).then_some(depth), darkens });
}
