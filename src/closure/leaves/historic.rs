//! Highlights of the literature.

use super::{Arguments, Leaf, LeafContext, Part, variants};
use crate::closure::kinds::Kind;
use crate::closure::surfaces::{NONE, Request, Surfaces};
use smallvec::smallvec;

/// `ward(N, T, ax, ay)`.
pub(super) fn ward(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let bounded = arguments.keyword("bounded");
    let code = |lane| 1 + u32::from(bounded.is_some_and(|c| context.tree.int(c, lane) != 0));
    let params = [arguments.float(2), arguments.float(3)];
    let tangent = if params[0] == params[1] { None } else { Some(arguments.triple(1)) };
    let frame = surfaces.frame(context.tree, arguments.triple(0), tangent, &context.seen);
    let mut leaf = Leaf::default();
    for (code, gate) in variants(surfaces, &[bounded], code, false) {
        let kind = Kind::Ward { bounded: code == 2 };
        let request = Request { kind, closure: arguments.spec.name, frame, params: &params, eta: None, gate };
        leaf.parts.push(Part { surface: surfaces.push(context.tree, request), t: 0 });
    }
    leaf
}

/// `ashikhmin_shirley(N, U, exponent_x, exponent_y, specular, diffuse)`.
pub(super) fn ashikhmin_shirley(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let (x, y) = (arguments.float(2), arguments.float(3));
    let ([sr, sg, sb], [dr, dg, db]) = (arguments.triple(4), arguments.triple(5));
    let tangent = if x == y { None } else { Some(arguments.triple(1)) };
    let frame = surfaces.frame(context.tree, arguments.triple(0), tangent, &context.seen);
    let parts = [(Kind::Highlight, &[x, y, sr, sg, sb][..]), (Kind::UnderHighlight, &[sr, sg, sb, dr, dg, db])];
    let part = |(kind, params)| {
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate: NONE };
        Part { surface: surfaces.push(context.tree, request), t: 0 }
    };
    Leaf { parts: parts.map(part).into_iter().collect(), ..Leaf::default() }
}

/// `lafortune(N, U, coefficients, exponent)`.
pub(super) fn lafortune(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let [x, y, z] = arguments.triple(2);
    let frame = surfaces.frame(context.tree, arguments.triple(0), Some(arguments.triple(1)), &context.seen);
    let params = &[x, y, z, arguments.float(3)];
    let request = Request { kind: Kind::Lafortune, closure: arguments.spec.name, frame, params, eta: None, gate: NONE };
    Leaf { parts: smallvec![Part { surface: surfaces.push(context.tree, request), t: 0 }], ..Leaf::default() }
}
