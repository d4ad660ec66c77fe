//! Clear coats: a boundary lobe, and a medium under it.

use super::{Arguments, Cover, Leaf, LeafContext, Part, variants};
use crate::bsdf::fresnel::Term;
use crate::bsdf::microfacet::{Geometry, MIN_ALPHA, Sampling, method};
use crate::closure::kinds::{Facets, Kind};
use crate::closure::media::Coat;
use crate::closure::surfaces::{NONE, Request, Surfaces};
use crate::closure::tree::Floats;
use crate::math::columns::Column3;
use glam::Vec3;

/// `coat(base, N, roughness, eta, absorption, thickness)`.
pub(super) fn leaf(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let (tree, n) = (context.tree, surfaces.lanes);
    let (alpha, eta) = (arguments.float(2), arguments.float(3));
    let (absorption, thickness) = (arguments.triple(4), arguments.float(5));
    let frame = surfaces.frame(tree, arguments.triple(1), None, &context.seen);
    let mut leaf = Leaf { base: arguments.closure(0), ..Leaf::default() };
    let absorbs = |lane: usize| Vec3::from_array(absorption.map(|c| tree.float(c, lane)));
    let number = |lane: usize| {
        let all = [tree.float(alpha, lane), tree.float(eta, lane), tree.float(thickness, lane)];
        absorbs(lane).is_finite() && all.iter().all(|v| v.is_finite())
    };
    let broken = (0..n).any(|lane| !number(lane));
    let rough = Kind::Microfacet { distribution: Facets::Ggx, term: Term::Dielectric, refract: false };
    let usual = Floats::Uniform(method(Geometry::Smith, Sampling::Visible));
    // Codes: 1 smooth, 2 rough.
    let code = |lane| 1 + u32::from(tree.float(alpha, lane) >= MIN_ALPHA);
    for (code, gate) in variants(surfaces, &[], code, matches!(alpha, Floats::Varying(_))) {
        let (kind, params) = match code {
            1 => (Kind::Reflection(Term::Dielectric), &[eta][..]),
            _ => (rough, &[alpha, alpha, eta, usual][..]),
        };
        let gate = if broken { mark(surfaces, gate, number) } else { gate };
        // The viewer is always outside of a coat, so its eta is never inverted.
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate };
        leaf.parts.push(Part { surface: surfaces.push(tree, request), t: 0 });
    }
    // A coat that is dropped for its parameters takes nothing from its base, and none can add light.
    let optical = |lane: usize| match number(lane) {
        true => (absorbs(lane) * tree.float(thickness, lane)).clamp(Vec3::ZERO, Vec3::splat(1e30)),
        false => Vec3::ZERO,
    };
    let clear = (0..n).all(|lane| optical(lane) == Vec3::ZERO);
    let mut depth = Column3::zeros(if clear { 0 } else { n });
    for lane in 0..depth.len() {
        depth.set(lane, optical(lane));
    }
    let column = |of: Floats, missing: f32| -> Vec<f32> {
        (0..n).map(|lane| if number(lane) { tree.float(of, lane) } else { missing }).collect()
    };
    let widths = column(alpha, 0.0);
    let alpha = widths.iter().any(|&a| a >= MIN_ALPHA).then_some(widths);
    leaf.coat = Some(Coat { frame, eta: column(eta, 1.0), alpha, depth: (!clear).then_some(depth) });
    leaf.covers.push(Cover { surface: None, t: 0, rule: context.settings.layering, gate: NONE });
    leaf
}

/// A gate that is not a number in lanes whose parameters are none.
fn mark(surfaces: &mut Surfaces, gate: u32, number: impl Fn(usize) -> bool) -> u32 {
    let open: Vec<f32> =
        (0..surfaces.lanes).map(|lane| if gate == NONE { 1.0 } else { surfaces.column(gate)[lane] }).collect();
    surfaces.push_column(|lane| if number(lane) || open[lane] == 0.0 { open[lane] } else { f32::NAN })
}
