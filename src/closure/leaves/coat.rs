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
    let rough = Kind::Microfacet { distribution: Facets::Ggx, term: Term::Dielectric, refract: false };
    let usual = Floats::Uniform(method(Geometry::Smith, Sampling::Visible));
    // Codes: 1 smooth, 2 rough.
    let code = |lane| 1 + u32::from(tree.float(alpha, lane) >= MIN_ALPHA);
    for (code, gate) in variants(surfaces, &[], code, matches!(alpha, Floats::Varying(_))) {
        let (kind, params) = match code {
            1 => (Kind::Reflection(Term::Dielectric), &[eta][..]),
            _ => (rough, &[alpha, alpha, eta, usual][..]),
        };
        // The viewer is always outside of a coat, so its eta is never inverted.
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate };
        leaf.parts.push(Part { surface: surfaces.push(tree, request), t: 0 });
    }
    let optical = |lane: usize| {
        let depth = Vec3::from_array(absorption.map(|c| tree.float(c, lane))) * tree.float(thickness, lane);
        // A coat cannot add light, and one that is no number takes none.
        if depth.is_finite() { depth.max(Vec3::ZERO) } else { Vec3::ZERO }
    };
    let clear = (0..n).all(|lane| optical(lane) == Vec3::ZERO);
    let mut depth = Column3::zeros(if clear { 0 } else { n });
    for lane in 0..depth.len() {
        depth.set(lane, optical(lane));
    }
    let eta = (0..n).map(|lane| tree.float(eta, lane)).collect();
    leaf.coat = Some(Coat { frame, eta, depth: (!clear).then_some(depth) });
    leaf.covers.push(Cover { surface: None, t: 0, rule: context.settings.layering, gate: NONE });
    leaf
}
