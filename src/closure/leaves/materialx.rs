//! The rough diffuse reflection of MaterialX, in its two forms.

use super::{Arguments, Leaf, LeafContext, Part, variants};
use crate::closure::kinds::Kind;
use crate::closure::surfaces::{Request, Surfaces};

/// `oren_nayar_diffuse_bsdf(N, albedo, roughness)`.
pub(super) fn oren_nayar(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let compensated = arguments.keyword("energy_compensation");
    let code = |lane| 1 + u32::from(compensated.is_some_and(|c| context.tree.int(c, lane) != 0));
    let tint = arguments.triple(1);
    let all = [arguments.float(2), tint[0], tint[1], tint[2]];
    let frame = surfaces.frame(context.tree, arguments.triple(0), None, &context.seen);
    let mut leaf = Leaf { tint: Some(tint), ..Leaf::default() };
    for (code, gate) in variants(surfaces, &[compensated], code, false) {
        let (kind, params) = if code == 2 { (Kind::Eon, &all[..]) } else { (Kind::OrenNayar, &all[..1]) };
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate };
        leaf.parts.push(Part { surface: surfaces.push(context.tree, request), t: 0 });
    }
    leaf
}
