//! Leaves: from a closure of the tree to surfaces, by its model; the only place that knows what each closure stands for.
//!
//! What may differ between lanes although the lane loops need it fixed (distribution, refract, keyword strings, a width so small
//! that the boundary is smooth) splits a leaf into parts, each with a gate that is 1 in its lanes.

use super::flatten::rule_of;
use super::settings::{Layering, Settings, Shadowing};
use super::surfaces::{Kind, NONE, Request, Surfaces};
use super::tree::{Floats, Ints, Node, NodeId, Param, Tree};
use crate::bsdf::microfacet::{MIN_ALPHA, MIN_ETA_DIFFERENCE};
use crate::lang::closures::{ClosureSpec, Model};
use crate::lang::symbols::Symbol;
use crate::math::columns::Column3;

/// A surface of a leaf, with the column of its coverage t when it lies on top of something.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The surface.
    pub surface: u32,
    /// Offset of its t.
    pub t: u32,
}

/// How a leaf covers what it nests: one entry a variant.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// The covering surface; none for `layer`, whose top is a tree.
    pub surface: Option<u32>,
    /// Offset of the coverage t.
    pub t: u32,
    /// The rule of scaling.
    pub rule: Layering,
    /// Offset of the lanes it applies to, or [`NONE`].
    pub gate: u32,
}

/// A leaf made ready.
#[derive(Clone, Debug, Default)]
pub struct Leaf {
    /// Its surfaces.
    pub parts: Vec<Part>,
    /// How it covers its base.
    pub covers: Vec<Cover>,
    /// A color that its weight is multiplied with.
    pub tint: Option<[Floats; 3]>,
    /// The tree on top, of `layer`.
    pub top: Option<NodeId>,
    /// What lies under it.
    pub base: Option<NodeId>,
    /// True for light sources.
    pub emits: bool,
    /// True for holes.
    pub hole: bool,
}

/// What leaves are made from beside the tree's node.
pub struct LeafContext<'a> {
    /// The tree.
    pub tree: &'a Tree,
    /// Choices of the render.
    pub settings: Settings,
    /// The viewer.
    pub wo: &'a Column3,
    /// Geometric normals.
    pub ng: &'a Column3,
}

/// The parameters of one leaf, by position, with defaults for what is missing.
struct Arguments<'a> {
    tree: &'a Tree,
    params: &'a [Param],
    keywords: &'a [(u32, Param)],
    spec: &'a ClosureSpec,
}

impl Arguments<'_> {
    fn float(&self, index: usize) -> Floats {
        if let Some(Param::Float(value)) = self.params.get(index) { *value } else { Floats::Uniform(0.0) }
    }

    fn triple(&self, index: usize) -> [Floats; 3] {
        if let Some(Param::Triple(value)) = self.params.get(index) { *value } else { [Floats::Uniform(0.0); 3] }
    }

    fn ints(&self, index: usize) -> Ints {
        if let Some(Param::Int(value) | Param::String(value)) = self.params.get(index) {
            *value
        } else {
            Ints::Uniform(0)
        }
    }

    fn closure(&self, index: usize) -> Option<NodeId> {
        if let Some(Param::Closure(value)) = self.params.get(index) { *value } else { None }
    }

    fn keyword(&self, name: &str) -> Option<Ints> {
        let index = self.spec.keywords.iter().position(|k| k.name == name)? as u32;
        self.keywords.iter().rev().find(|(k, _)| *k == index).and_then(|(_, value)| match value {
            Param::Int(value) | Param::String(value) => Some(*value),
            _ => None,
        })
    }

    fn text(&self, column: Ints, lane: usize) -> &'static str {
        Symbol(self.tree.int(column, lane)).text()
    }
}

/// The codes that occur in a batch, each with the gate of its lanes; code 0 means no surface.
fn variants(
    surfaces: &mut Surfaces,
    columns: &[Option<Ints>],
    code: impl Fn(usize) -> u32,
    floats_vary: bool,
) -> Vec<(u32, u32)> {
    let uniform = !floats_vary && columns.iter().all(|c| !matches!(c, Some(Ints::Varying(_))));
    let lanes = if uniform { surfaces.lanes.min(1) } else { surfaces.lanes };
    let mut seen = (0..lanes).fold(0u32, |seen, lane| seen | 1 << code(lane));
    if seen.count_ones() == 1 {
        let only = seen.trailing_zeros();
        return if only == 0 { Vec::new() } else { vec![(only, NONE)] };
    }
    seen &= !1;
    let codes = (1..32).filter(|c| seen >> c & 1 == 1);
    codes.map(|c| (c, surfaces.push_column(|lane| if code(lane) == c { 1.0 } else { 0.0 }))).collect()
}

/// Makes a leaf's surfaces.
pub fn prepare_leaf(surfaces: &mut Surfaces, context: &LeafContext, spec: &ClosureSpec, node: &Node) -> Leaf {
    let Node::Leaf { first_param, param_count, first_keyword, keyword_count, .. } = *node else {
        return Leaf::default();
    };
    let tree = context.tree;
    let arguments = Arguments {
        tree,
        params: &tree.params[first_param as usize..(first_param + param_count) as usize],
        keywords: &tree.keywords[first_keyword as usize..(first_keyword + keyword_count) as usize],
        spec,
    };
    let none = [Floats::Uniform(0.0); 4];
    let mut single = |kind, params, count, eta| {
        let frame = match kind {
            Kind::Transparent => NONE,
            _ => surfaces.frame(tree, arguments.triple(0), None, context.wo, context.ng),
        };
        let request = Request { kind, closure: spec.name, frame, params, count, eta, gate: NONE };
        Leaf { parts: vec![Part { surface: surfaces.push(tree, request), t: 0 }], ..Leaf::default() }
    };
    let one = |value| [value, Floats::Uniform(0.0), Floats::Uniform(0.0), Floats::Uniform(0.0)];
    match spec.model {
        Model::Emission | Model::Background => Leaf { emits: true, ..Leaf::default() },
        Model::Holdout => Leaf { hole: true, ..Leaf::default() },
        Model::Debug | Model::Host(_) => Leaf::default(),
        Model::Diffuse => single(Kind::Lambert, none, 0, None),
        Model::Translucent => single(Kind::Translucent, none, 0, None),
        Model::Transparent => single(Kind::Transparent, none, 0, None),
        Model::OrenNayar => single(Kind::OrenNayar, one(arguments.float(1)), 1, None),
        Model::Velvet => single(Kind::Velvet, one(arguments.float(1)), 1, None),
        Model::Reflection => single(Kind::Reflection, one(arguments.float(1)), 1, Some(0)),
        Model::Refraction => single(Kind::Refraction, one(arguments.float(1)), 1, Some(0)),
        Model::Microfacet => microfacet(surfaces, context, &arguments),
        Model::Sheen => sheen(surfaces, context, &arguments, 1),
        Model::SheenBsdf => sheen(surfaces, context, &arguments, 0),
        Model::Layer => layer(surfaces, context, &arguments),
    }
}

fn rule_at(arguments: &Arguments, column: Option<Ints>, lane: usize, settings: Settings) -> Layering {
    column.map_or(settings.layering, |c| rule_of(arguments.text(c, lane), settings.layering))
}

fn rule_code(rule: Layering) -> u32 {
    Layering::ALL.iter().position(|(_, r)| *r == rule).unwrap_or(0) as u32
}

fn layer(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
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

/// `sheen(base, N, tint, roughness)` with `first` 1, `sheen_bsdf(N, albedo, roughness)` with `first` 0.
fn sheen(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments, first: usize) -> Leaf {
    let (tree, settings) = (context.tree, context.settings);
    let (shadowing, softening, layering) =
        (arguments.keyword("shadowing"), arguments.keyword("softening"), arguments.keyword("layering"));
    let code = |lane| {
        let term =
            shadowing.map_or(settings.shadowing, |c| arguments.text(c, lane).parse().unwrap_or(settings.shadowing));
        let soft = softening.map_or(settings.softening, |c| tree.int(c, lane) != 0);
        let term = Shadowing::ALL.iter().position(|(_, t)| *t == term).unwrap_or(0) as u32;
        1 + rule_code(rule_at(arguments, layering, lane, settings)) + 3 * (term + 3 * u32::from(soft))
    };
    let tint = arguments.triple(first + 1);
    let share = Floats::Uniform(settings.sheen_sampling.uniform_share());
    let params = [arguments.float(first + 2), share, Floats::Uniform(0.0), Floats::Uniform(0.0)];
    let frame = surfaces.frame(tree, arguments.triple(first), None, context.wo, context.ng);
    let mut leaf = Leaf { tint: Some(tint), ..Leaf::default() };
    if first == 1 {
        leaf.base = arguments.closure(0);
    }
    for (code, gate) in variants(surfaces, &[shadowing, softening, layering], code, false) {
        let code = code - 1;
        let kind = Kind::Sheen(Shadowing::ALL[(code / 3 % 3) as usize].1, code / 9 == 1);
        let request = Request { kind, closure: arguments.spec.name, frame, params, count: 2, eta: None, gate };
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

fn microfacet(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let tree = context.tree;
    let (distribution, refract) = (arguments.ints(0), arguments.ints(6));
    let (x, y, eta) = (arguments.float(3), arguments.float(4), arguments.float(5));
    let tangent = if x == y { None } else { Some(arguments.triple(2)) };
    let frame = surfaces.frame(tree, arguments.triple(1), tangent, context.wo, context.ng);
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
            let zero = Floats::Uniform(0.0);
            let (kind, params, count, eta) = match (code, refract) {
                (3, false) => (Kind::Reflection, [eta, zero, zero, zero], 1, 0),
                (3, true) => (Kind::Refraction, [eta, zero, zero, zero], 1, 0),
                (code, refract) => (Kind::Microfacet { beckmann: code == 2, refract }, [x, y, eta, zero], 3, 2),
            };
            let request = Request { kind, closure: arguments.spec.name, frame, params, count, eta: Some(eta), gate };
            leaf.parts.push(Part { surface: surfaces.push(tree, request), t: 0 });
        }
    }
    leaf
}
