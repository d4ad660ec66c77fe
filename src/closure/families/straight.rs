//! Light that passes straight on.

use crate::arguments;
use crate::closure::definition::ClosureDef;

arguments! {
    struct Nothing {}
}

pub(super) fn transparent(name: &'static str) -> ClosureDef {
    let straight = |_: Nothing, leaf: &mut crate::closure::leaf::LeafMaker<'_>| {
        leaf.straight();
    };
    ClosureDef::new(name, "lets light pass straight through", straight).lossless().passing()
}
