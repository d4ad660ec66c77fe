//! Closures without lobes: light that is sent out, holes, and values with a tag.

use crate::arguments;
use crate::closure::arguments::{Color, Text};
use crate::closure::definition::ClosureDef;
use crate::lang::closures::ParamSpec;

arguments! {
    /// The arguments of closures that take none.
    struct Nothing {}
}

arguments! {
    struct Uniform {
        emittance: Color = ParamSpec::about("radiance in every direction"),
    }
}

arguments! {
    struct Debug {
        tag: Text = ParamSpec::about("name of the output"),
    }
}

pub(super) fn emission() -> ClosureDef {
    let doc = "emits its weight as radiance, both sides of the normal's hemisphere";
    ClosureDef::new("emission", doc, |_: Nothing, _| {}).emitting()
}

pub(super) fn background() -> ClosureDef {
    ClosureDef::new("background", "radiance of the sky", |_: Nothing, _| {}).emitting()
}

pub(super) fn uniform_edf() -> ClosureDef {
    let doc = "emits the same radiance in every direction, both sides of the normal's hemisphere";
    ClosureDef::new("uniform_edf", doc, |a: Uniform, leaf| leaf.tint(a.emittance)).emitting()
}

pub(super) fn holdout() -> ClosureDef {
    ClosureDef::new("holdout", "a hole in the alpha channel", |_: Nothing, _| {}).holding_out()
}

pub(super) fn debug() -> ClosureDef {
    ClosureDef::new("debug", "a tagged value; scatters nothing", |_: Debug, _| {}).inert()
}
