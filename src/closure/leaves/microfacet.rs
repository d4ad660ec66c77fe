//! Rough boundaries, which become smooth ones where their width is small.

use super::{Arguments, Leaf, LeafContext, Part, variants};
use crate::bsdf::microfacet::{MIN_ALPHA, MIN_ETA_DIFFERENCE};
use crate::closure::kinds::Kind;
use crate::closure::surfaces::{Request, Surfaces};
use crate::closure::tree::Floats;

/// `microfacet(distribution, N, U, xalpha, yalpha, eta, refract)`.
pub(super) fn leaf(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let tree = context.tree;
    let (distribution, refract) = (arguments.ints(0), arguments.ints(6));
    let (x, y, eta) = (arguments.float(3), arguments.float(4), arguments.float(5));
    let tangent = if x == y { None } else { Some(arguments.triple(2)) };
    let frame = surfaces.frame(tree, arguments.triple(1), tangent, &context.seen);
    let floats_vary = [x, y, eta].iter().any(|v| matches!(v, Floats::Varying(_)));
    let beckmann = |lane| arguments.text(distribution, lane) == "beckmann";
    let smooth = |lane| {
        let widest = tree.float(x, lane).max(tree.float(y, lane));
        widest < MIN_ALPHA || arguments.text(distribution, lane) == "sharp"
    };
    // Codes: 0 nothing, 1 GGX, 2 Beckmann, 3 smooth.
    let reflecting = |lane| match tree.int(refract, lane) {
        1 => 0,
        _ if smooth(lane) => 3,
        _ => 1 + u32::from(beckmann(lane)),
    };
    let refracting = |lane| match tree.int(refract, lane) {
        1 | 2 if tree.float(eta, lane) <= 0.0 => 0,
        1 | 2 if smooth(lane) || (tree.float(eta, lane) - 1.0).abs() < MIN_ETA_DIFFERENCE => 3,
        1 | 2 => 1 + u32::from(beckmann(lane)),
        _ => 0,
    };
    let columns = [Some(distribution), Some(refract)];
    let mut leaf = Leaf::default();
    for refract in [false, true] {
        let found = if refract {
            variants(surfaces, &columns, refracting, floats_vary)
        } else {
            variants(surfaces, &columns, reflecting, floats_vary)
        };
        for (code, gate) in found {
            let rough = [x, y, eta];
            let (kind, params, eta) = match (code, refract) {
                (3, false) => (Kind::Reflection, &rough[2..], 0),
                (3, true) => (Kind::Refraction, &rough[2..], 0),
                (code, refract) => (Kind::Microfacet { beckmann: code == 2, refract }, &rough[..], 2),
            };
            let request = Request { kind, closure: arguments.spec.name, frame, params, eta: Some(eta), gate };
            leaf.parts.push(Part { surface: surfaces.push(tree, request), t: 0 });
        }
    }
    leaf
}
