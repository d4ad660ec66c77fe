//! Hair: one surface for each number of crossings of the fiber.

use super::{Arguments, Leaf, LeafContext, Part};
use crate::closure::kinds::Kind;
use crate::closure::surfaces::{NONE, Request, Surfaces};

/// `chiang_hair_bsdf(N, curve_direction, tints, ior, roughnesses, cuticle_angle, absorption_coefficient)`.
pub(super) fn leaf(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let frame = surfaces.frame(context.tree, arguments.triple(0), Some(arguments.triple(1)), &context.seen);
    let (ior, cuticle, [ar, ag, ab]) = (arguments.float(5), arguments.float(12), arguments.triple(13));
    let part = |crossings: u8| {
        // Paths of more crossings share the tint and the roughness of TRT.
        let own = crossings.min(2) as usize;
        let [tr, tg, tb] = arguments.triple(2 + own);
        let (v, s) = (arguments.float(6 + own), arguments.float(9 + own));
        let params = &[ior, v, s, cuticle, ar, ag, ab, tr, tg, tb];
        let kind = Kind::Hair { crossings };
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate: NONE };
        Part { surface: surfaces.push(context.tree, request), t: 0 }
    };
    Leaf { parts: [0, 1, 2, 3].map(part).into(), ..Leaf::default() }
}
