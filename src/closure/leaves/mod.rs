//! Leaves: from a closure of the tree to surfaces, by its model; the only place that knows what each closure stands for.
//!
//! What may differ between lanes although the lane loops need it fixed (distribution, refract, keyword strings, a width so small
//! that the boundary is smooth) splits a leaf into parts, each with a gate that is 1 in its lanes.

mod cloth;
mod coat;
mod hair;
mod historic;
mod materialx;
mod microfacet;

use super::kinds::Kind;
use super::media::Coat;
use super::settings::{Layering, Settings};
use super::surfaces::{NONE, Request, Seen, Surfaces};
use super::tree::{Floats, Ints, Node, NodeId, Param, Tree};
use crate::bsdf::fresnel::Term;
use crate::lang::closures::{ClosureSpec, Model};
use smallvec::{SmallVec, smallvec};

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
#[derive(Debug, Default)]
pub struct Leaf {
    /// Its surfaces.
    pub parts: SmallVec<[Part; 4]>,
    /// How it covers its base.
    pub covers: SmallVec<[Cover; 2]>,
    /// A color that its weight is multiplied with.
    pub tint: Option<[Floats; 3]>,
    /// A color for each part in their order, in place of `tint`; empty for none.
    pub tints: SmallVec<[[Floats; 3]; 2]>,
    /// The tree on top, of `layer`.
    pub top: Option<NodeId>,
    /// The coat over the base, of `coat`; flattening makes a medium of it.
    pub coat: Option<Coat>,
    /// The medium under the coat.
    pub inner: Option<u32>,
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
    /// How the surface is seen.
    pub seen: Seen<'a>,
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

    fn text(&self, column: Ints, lane: usize) -> &str {
        self.tree.text(column, lane)
    }
}

/// The codes that occur in a batch, below 128, each with the gate of its lanes; code 0 means no surface.
fn variants(
    surfaces: &mut Surfaces,
    columns: &[Option<Ints>],
    code: impl Fn(usize) -> u32,
    floats_vary: bool,
) -> SmallVec<[(u32, u32); 2]> {
    let uniform = !floats_vary && columns.iter().all(|c| !matches!(c, Some(Ints::Varying(_))));
    let lanes = if uniform { surfaces.lanes.min(1) } else { surfaces.lanes };
    let mut seen = (0..lanes).fold(0u128, |seen, lane| seen | 1 << code(lane));
    if seen.count_ones() == 1 {
        let only = seen.trailing_zeros();
        return if only == 0 { SmallVec::new() } else { smallvec![(only, NONE)] };
    }
    seen &= !1;
    let codes = (1..128).filter(|c| seen >> c & 1 == 1);
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
    let tint =
        |index: usize| matches!(arguments.params.get(index), Some(Param::Triple(_))).then(|| arguments.triple(index));
    let mut single = |kind, params: &[Floats], eta| {
        let frame = match kind {
            Kind::Transparent => NONE,
            _ => surfaces.frame(tree, arguments.triple(0), None, &context.seen),
        };
        let request = Request { kind, closure: spec.name, frame, params, eta, gate: NONE };
        let parts = smallvec![Part { surface: surfaces.push(tree, request), t: 0 }];
        // The color of a diffuse closure, where it has one, follows its normal.
        let colored = matches!(kind, Kind::Lambert | Kind::Translucent | Kind::Burley);
        Leaf { parts, tint: if colored { tint(1) } else { None }, ..Leaf::default() }
    };
    let mut leaf = match spec.model {
        Model::Emission | Model::Background => Leaf { emits: true, tint: tint(0), ..Leaf::default() },
        Model::Holdout => Leaf { hole: true, ..Leaf::default() },
        Model::Debug | Model::Host(_) => Leaf::default(),
        Model::Diffuse => single(Kind::Lambert, &[], None),
        Model::Translucent => single(Kind::Translucent, &[], None),
        Model::Transparent => single(Kind::Transparent, &[], None),
        Model::OrenNayar => single(Kind::OrenNayar, &[arguments.float(1)], None),
        Model::Velvet => single(Kind::Velvet, &[arguments.float(1)], None),
        Model::Hair => hair::leaf(surfaces, context, &arguments),
        Model::OrenNayarDiffuse => materialx::oren_nayar(surfaces, context, &arguments),
        Model::BurleyDiffuse => single(Kind::Burley, &[arguments.float(2)], None),
        Model::Phong => single(Kind::Phong, &[arguments.float(1)], None),
        Model::Subsurface => {
            let frame = surfaces.frame(tree, [Floats::Uniform(0.0); 3], None, &context.seen);
            let request =
                Request { kind: Kind::Lambert, closure: spec.name, frame, params: &[], eta: None, gate: NONE };
            let parts = smallvec![Part { surface: surfaces.push(tree, request), t: 0 }];
            Leaf { parts, tint: Some(arguments.triple(3)), ..Leaf::default() }
        }
        Model::Ward => historic::ward(surfaces, context, &arguments),
        Model::AshikhminShirley => historic::ashikhmin_shirley(surfaces, context, &arguments),
        Model::Lafortune => historic::lafortune(surfaces, context, &arguments),
        Model::Reflection => single(Kind::Reflection(Term::Dielectric), &[arguments.float(1)], Some(0)),
        Model::Refraction => single(Kind::Refraction(Term::Dielectric), &[arguments.float(1)], Some(0)),
        Model::Microfacet => microfacet::plain(surfaces, context, &arguments),
        Model::DielectricBsdf => microfacet::dielectric(surfaces, context, &arguments),
        Model::ConductorBsdf => microfacet::conductor(surfaces, context, &arguments),
        Model::GeneralizedSchlickBsdf => microfacet::generalized_schlick(surfaces, context, &arguments),
        Model::Sheen => cloth::sheen(surfaces, context, &arguments, 1),
        Model::SheenBsdf => cloth::sheen(surfaces, context, &arguments, 0),
        Model::Coat => coat::leaf(surfaces, context, &arguments),
        Model::Layer => cloth::layer(surfaces, context, &arguments),
    };
    // As a top, a colored leaf takes no more than its color reflects; leaves that say so themselves are left alone.
    if let (Some(tint), true) = (leaf.tint, leaf.parts.iter().any(|part| part.t == 0)) {
        let t = largest(surfaces, tree, tint);
        leaf.parts.iter_mut().filter(|part| part.t == 0).for_each(|part| part.t = t);
    }
    leaf
}

/// A column of the largest component of a color, which is how much a layer's top takes; offset 0 is 1 everywhere.
fn largest(surfaces: &mut Surfaces, tree: &Tree, tint: [Floats; 3]) -> u32 {
    if tint == [Floats::Uniform(1.0); 3] {
        return 0;
    }
    surfaces.push_column(|lane| {
        let most = tint.iter().map(|&c| tree.float(c, lane).abs()).fold(0.0, f32::max);
        if most.is_finite() { most } else { 0.0 }
    })
}
