//! Media that fill a body: accepted, and nothing where they neither absorb nor scatter.
//!
//! What fills volumes is not rendered: a medium that would be seen is left out, and the render says so.

use crate::arguments;
use crate::closure::arguments::{Color, Float, Int};
use crate::closure::definition::ClosureDef;
use crate::lang::closures::ParamSpec;

arguments! {
    struct Anisotropic {
        albedo: Color = ParamSpec::about("part of the light that is scattered where it is met, 0..1"),
        extinction: Color = ParamSpec::about("light that is met, 1/length; 0 is no medium"),
        anisotropy: Float = ParamSpec::about("mean cosine of scattering, -1..1"),
    }
}

arguments! {
    struct Medium {
        albedo: Color = ParamSpec::about("part of the light that is scattered where it is met, 0..1"),
        transmission_depth: Float = ParamSpec::about("the depth after which `transmission_color` is left"),
        transmission_color: Color = ParamSpec::about("what that depth lets through; 1 is no medium"),
        anisotropy: Float = ParamSpec::about("mean cosine of scattering, -1..1"),
        ior: Float = ParamSpec::about("index of refraction"),
        priority: Int = ParamSpec::about("which of two media counts where they overlap"),
    }
}

/// What a render says of a medium that would be seen.
const LEFT_OUT: &str = "fills a volume, which is not rendered: what it absorbs and scatters is left out";

pub(super) fn anisotropic() -> ClosureDef {
    let doc = "a medium that absorbs and scatters; left out of a render, which says so unless extinction is 0";
    let prepare = |a: Anisotropic, leaf: &mut crate::closure::leaf::LeafMaker<'_>| {
        leaf.leave_out(LEFT_OUT, |leaf, lane| leaf.triple(a.extinction.0, lane).max_element() > 0.0);
    };
    ClosureDef::new("anisotropic_vdf", doc, prepare).inert()
}

pub(super) fn medium() -> ClosureDef {
    let doc = "the medium of a clear or cloudy body; left out of a render, which says so unless all is transmitted";
    let prepare = |a: Medium, leaf: &mut crate::closure::leaf::LeafMaker<'_>| {
        // Light is met as often as makes the color what is left at the depth: never where that is white.
        leaf.leave_out(LEFT_OUT, |leaf, lane| leaf.triple(a.transmission_color.0, lane).min_element() < 1.0);
    };
    ClosureDef::new("medium_vdf", doc, prepare).inert()
}
