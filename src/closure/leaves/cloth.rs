//! Sheens and layers.

use super::{Arguments, Cover, Leaf, LeafContext, Part, variants};
use crate::closure::flatten::rule_of;
use crate::closure::kinds::Kind;
use crate::closure::settings::{Layering, Settings, Shadowing, SheenSampling};
use crate::closure::surfaces::{NONE, Request, Surfaces};
use crate::closure::tree::{Floats, Ints};

fn rule_at(arguments: &Arguments, column: Option<Ints>, lane: usize, settings: Settings) -> Layering {
    column.map_or(settings.layering, |c| rule_of(arguments.text(c, lane), settings.layering))
}

/// How many shadowing terms there are.
const TERMS: u32 = Shadowing::ALL.len() as u32;
/// The code of the sheen of fibers, after those of all shadowing terms, softened or not, drawn in all ways.
const FIBERS: u32 = TERMS * 2 * SheenSampling::ALL.len() as u32;

fn rule_code(rule: Layering) -> u32 {
    Layering::ALL.iter().position(|(_, r)| *r == rule).unwrap_or(0) as u32
}

/// `layer(top, base)`.
pub(super) fn layer(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let keyword = arguments.keyword("layering");
    let code = |lane| 1 + rule_code(rule_at(arguments, keyword, lane, context.settings));
    let covers = variants(surfaces, &[keyword], code, false).into_iter();
    let cover =
        |(code, gate): (u32, u32)| Cover { surface: None, t: 0, rule: Layering::ALL[code as usize - 1].1, gate };
    Leaf {
        covers: covers.map(cover).collect(),
        top: arguments.closure(0),
        base: arguments.closure(1),
        ..Leaf::default()
    }
}

/// The kind that a code of [`sheen`] stands for, and how its directions are drawn.
fn kind_of(code: u32) -> (Kind, SheenSampling) {
    if code == FIBERS {
        return (Kind::Fibers, SheenSampling::Proposal);
    }
    let (term, soft) = (Shadowing::ALL[(code % TERMS) as usize].1, code / TERMS % 2 == 1);
    match SheenSampling::ALL[(code / (2 * TERMS)) as usize].1 {
        SheenSampling::Normals => (Kind::SheenByNormals(term, soft), SheenSampling::Normals),
        scheme => (Kind::Sheen(term, soft), scheme),
    }
}

/// `sheen(base, N, tint, roughness)` with `first` 1, `sheen_bsdf(N, albedo, roughness)` with `first` 0.
pub(super) fn sheen(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments, first: usize) -> Leaf {
    let (tree, settings) = (context.tree, context.settings);
    let (shadowing, softening, layering) =
        (arguments.keyword("shadowing"), arguments.keyword("softening"), arguments.keyword("layering"));
    let (sampling, mode) = (arguments.keyword("sampling"), arguments.keyword("mode"));
    let code = |lane| {
        let term =
            shadowing.map_or(settings.shadowing, |c| arguments.text(c, lane).parse().unwrap_or(settings.shadowing));
        let soft = softening.map_or(settings.softening, |c| tree.int(c, lane) != 0);
        let term = Shadowing::ALL.iter().position(|(_, t)| *t == term).unwrap_or(0) as u32;
        let scheme = sampling
            .map_or(settings.sheen_sampling, |c| arguments.text(c, lane).parse().unwrap_or(settings.sheen_sampling));
        let scheme = SheenSampling::ALL.iter().position(|(_, s)| *s == scheme).unwrap_or(0) as u32;
        let fibers = mode.is_some_and(|c| tree.int(c, lane) == 1);
        let kind = if fibers { FIBERS } else { term + TERMS * (u32::from(soft) + 2 * scheme) };
        1 + rule_code(rule_at(arguments, layering, lane, settings)) + 3 * kind
    };
    let tint = arguments.triple(first + 1);
    let frame = surfaces.frame(tree, arguments.triple(first), None, &context.seen);
    let mut leaf = Leaf { tint: Some(tint), ..Leaf::default() };
    if first == 1 {
        leaf.base = arguments.closure(0);
    }
    for (code, gate) in variants(surfaces, &[shadowing, softening, layering, sampling, mode], code, false) {
        let code = code - 1;
        let (kind, scheme) = kind_of(code / 3);
        let [share, plain] = scheme.params().map(Floats::Uniform);
        let params = [arguments.float(first + 2), share, plain];
        let count = if kind == Kind::Fibers { 1 } else { 3 };
        let params = &params[..count];
        let request = Request { kind, closure: arguments.spec.name, frame, params, eta: None, gate };
        let surface = surfaces.push(tree, request);
        let made = surfaces.list[surface as usize];
        let t = match tint {
            [Floats::Uniform(x), Floats::Uniform(y), Floats::Uniform(z)] if made.gate == NONE => {
                let largest = x.max(y).max(z).max(0.0);
                surfaces.push_constant(if largest.is_finite() { largest } else { 0.0 })
            }
            _ => {
                // A sheen that is dropped for its parameters takes nothing from its base.
                let exists: Vec<bool> = (0..surfaces.lanes).map(|lane| surfaces.gate(&made, lane) > 0.0).collect();
                surfaces.push_column(|lane| {
                    let largest = tint.iter().map(|&c| tree.float(c, lane)).fold(0.0, f32::max);
                    if exists[lane] && largest.is_finite() { largest } else { 0.0 }
                })
            }
        };
        leaf.parts.push(Part { surface, t });
        leaf.covers.push(Cover { surface: Some(surface), t, rule: Layering::ALL[(code % 3) as usize].1, gate });
    }
    leaf
}
