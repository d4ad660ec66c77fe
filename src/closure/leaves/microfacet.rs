//! Rough boundaries, which become smooth ones where their width is small.

use super::{Arguments, Leaf, LeafContext, Part, largest, variants};
use crate::bsdf::fresnel::{Term, eta_of_reflectance};
use crate::bsdf::limited;
use crate::bsdf::microfacet::{Geometry, MIN_ALPHA, MIN_ETA_DIFFERENCE, Sampling, method};
use crate::closure::kinds::{Facets, Kind};
use crate::closure::surfaces::{Request, Surfaces};
use crate::closure::tree::{Floats, Ints, Tree};

const WHITE: [Floats; 3] = [Floats::Uniform(1.0); 3];
const FACETS: [Facets; 3] = [Facets::Ggx, Facets::Beckmann, Facets::Blinn];

/// What the boundary closures have in common.
struct Boundary<'a> {
    arguments: &'a Arguments<'a>,
    term: Term,
    distribution: Ints,
    normal: [Floats; 3],
    tangent: [Floats; 3],
    widths: [Floats; 2],
    /// Parameters of the Fresnel term, without the side that Schlick's has at the end.
    fresnel: Vec<Floats>,
    /// Colors of the reflecting and the transmitting half; black switches one off.
    tints: [[Floats; 3]; 2],
    /// Which halves there are: 0 reflects, 1 refracts, 2 does both.
    refract: Ints,
}

/// What may differ between lanes and decides about the model; it numbers the parts of a leaf.
#[derive(Clone, Copy)]
struct Style {
    /// An index into [`FACETS`]; none is smooth.
    facets: Option<u32>,
    /// Indices into [`Geometry::ALL`] and [`Sampling::ALL`].
    method: [u32; 2],
    /// Nothing passes, so both sides look alike.
    opaque: bool,
}

impl Style {
    /// A number from 1 to 38.
    fn code(self) -> u32 {
        let rough = |facets: u32| 1 + facets + 3 * (self.method[0] + 3 * self.method[1]);
        1 + u32::from(self.opaque) + 2 * self.facets.map_or(0, rough)
    }

    fn of(code: u32) -> Self {
        let (opaque, rough) = ((code - 1) % 2 == 1, (code - 1) / 2);
        let Some(rough) = rough.checked_sub(1) else { return Style { facets: None, method: [0; 2], opaque } };
        Style { facets: Some(rough % 3), method: [rough / 3 % 3, rough / 9], opaque }
    }

    fn method(self) -> f32 {
        method(Geometry::ALL[self.method[0] as usize].1, Sampling::ALL[self.method[1] as usize].1)
    }
}

fn varies(values: &[Floats]) -> bool {
    values.iter().any(|v| matches!(v, Floats::Varying(_)))
}

impl Boundary<'_> {
    fn black(&self, half: usize, lane: usize) -> bool {
        self.tints[half].iter().all(|&c| self.arguments.tree.float(c, lane) == 0.0)
    }

    /// The index of refraction of a lane, from outside; 0 lets nothing through.
    fn eta(&self, lane: usize) -> f32 {
        let at = |k: usize| self.arguments.tree.float(self.fresnel[k], lane);
        match self.term {
            Term::Dielectric => at(0),
            Term::Conductor => 0.0,
            Term::Schlick => {
                let part = |k: usize| limited(at(k), 0.0, 1.0);
                eta_of_reflectance((part(0) + part(1) + part(2)) * (1.0 / 3.0))
            }
        }
    }

    fn word(&self, keyword: Option<Ints>, lane: usize, known: impl Iterator<Item = &'static str>) -> u32 {
        let Some(column) = keyword else { return 0 };
        let text = self.arguments.text(column, lane);
        known.enumerate().find(|(_, word)| *word == text).map_or(0, |(at, _)| at as u32)
    }

    /// The code of a lane's half; 0 where it has none.
    fn code(&self, half: usize, lane: usize, keywords: [Option<Ints>; 2]) -> u32 {
        let tree: &Tree = self.arguments.tree;
        let transmits = tree.int(self.refract, lane) >= 1 && self.eta(lane) > 0.0 && !self.black(1, lane);
        let there = if half == 0 { tree.int(self.refract, lane) != 1 && !self.black(0, lane) } else { transmits };
        if !there {
            return 0;
        }
        let distribution = self.arguments.text(self.distribution, lane);
        let widest = tree.float(self.widths[0], lane).max(tree.float(self.widths[1], lane));
        let straight = half == 1 && (self.eta(lane) - 1.0).abs() < MIN_ETA_DIFFERENCE;
        let facets = match distribution {
            "beckmann" => 1,
            "blinn" => 2,
            _ => 0,
        };
        let smooth = widest < MIN_ALPHA || distribution == "sharp" || straight;
        let method = [
            self.word(keywords[0], lane, Geometry::ALL.iter().map(|g| g.0)),
            self.word(keywords[1], lane, Sampling::ALL.iter().map(|s| s.0)),
        ];
        let opaque = self.term == Term::Schlick && !transmits;
        Style { facets: (!smooth).then_some(facets), method, opaque }.code()
    }

    fn leaf(&self, surfaces: &mut Surfaces, context: &LeafContext) -> Leaf {
        let tree = context.tree;
        let [x, y] = self.widths;
        let tangent = if x == y { None } else { Some(self.tangent) };
        let frame = surfaces.frame(tree, self.normal, tangent, &context.seen);
        let keywords = [self.arguments.keyword("geometry"), self.arguments.keyword("sampling")];
        let columns = [Some(self.distribution), Some(self.refract), keywords[0], keywords[1]];
        let floats_vary = varies(&self.widths) || varies(&self.fresnel) || self.tints.iter().any(|t| varies(t));
        let mut leaf = Leaf::default();
        for half in 0..2 {
            for (code, gate) in variants(surfaces, &columns, |lane| self.code(half, lane, keywords), floats_vary) {
                let style = Style::of(code);
                let mut params = vec![x, y];
                params.extend(&self.fresnel);
                let mut eta = Some(2);
                if self.term == Term::Schlick {
                    params.push(Floats::Uniform(if style.opaque { 1.0 } else { 2.0 }));
                    eta = Some(params.len() - 1);
                } else if self.term == Term::Conductor {
                    eta = None;
                }
                params.push(Floats::Uniform(style.method()));
                let (term, refract, facets) = (self.term, half == 1, style.facets);
                let (kind, params, eta) = match facets {
                    None if refract => (Kind::Refraction(term), &params[2..params.len() - 1], eta.map(|k| k - 2)),
                    None => (Kind::Reflection(term), &params[2..params.len() - 1], eta.map(|k| k - 2)),
                    Some(f) => (Kind::Microfacet { distribution: FACETS[f as usize], term, refract }, &params[..], eta),
                };
                let request = Request { kind, closure: self.arguments.spec.name, frame, params, eta, gate };
                let surface = surfaces.push(tree, request);
                leaf.parts.push(Part { surface, t: largest(surfaces, tree, self.tints[half]) });
                leaf.tints.push(self.tints[half]);
            }
        }
        leaf
    }
}

/// `microfacet(distribution, N, U, xalpha, yalpha, eta, refract)`.
pub(super) fn plain(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    Boundary {
        arguments,
        term: Term::Dielectric,
        distribution: arguments.ints(0),
        normal: arguments.triple(1),
        tangent: arguments.triple(2),
        widths: [arguments.float(3), arguments.float(4)],
        fresnel: vec![arguments.float(5)],
        tints: [WHITE; 2],
        refract: arguments.ints(6),
    }
    .leaf(surfaces, context)
}

/// `dielectric_bsdf(N, U, reflection_tint, transmission_tint, roughness_x, roughness_y, ior, distribution)`.
pub(super) fn dielectric(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    Boundary {
        arguments,
        term: Term::Dielectric,
        distribution: arguments.ints(7),
        normal: arguments.triple(0),
        tangent: arguments.triple(1),
        widths: [arguments.float(4), arguments.float(5)],
        fresnel: vec![arguments.float(6)],
        tints: [arguments.triple(2), arguments.triple(3)],
        refract: Ints::Uniform(2),
    }
    .leaf(surfaces, context)
}

/// `conductor_bsdf(N, U, roughness_x, roughness_y, ior, extinction, distribution)`.
pub(super) fn conductor(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let (ior, extinction) = (arguments.triple(4), arguments.triple(5));
    Boundary {
        arguments,
        term: Term::Conductor,
        distribution: arguments.ints(6),
        normal: arguments.triple(0),
        tangent: arguments.triple(1),
        widths: [arguments.float(2), arguments.float(3)],
        fresnel: ior.into_iter().chain(extinction).collect(),
        tints: [WHITE; 2],
        refract: Ints::Uniform(0),
    }
    .leaf(surfaces, context)
}

/// `generalized_schlick_bsdf(N, U, reflection_tint, transmission_tint, roughness_x, roughness_y, f0, f90, exponent,
/// distribution)`.
pub(super) fn generalized_schlick(surfaces: &mut Surfaces, context: &LeafContext, arguments: &Arguments) -> Leaf {
    let (f0, f90) = (arguments.triple(6), arguments.triple(7));
    Boundary {
        arguments,
        term: Term::Schlick,
        distribution: arguments.ints(9),
        normal: arguments.triple(0),
        tangent: arguments.triple(1),
        widths: [arguments.float(4), arguments.float(5)],
        fresnel: f0.into_iter().chain(f90).chain([arguments.float(8)]).collect(),
        tints: [arguments.triple(2), arguments.triple(3)],
        refract: Ints::Uniform(2),
    }
    .leaf(surfaces, context)
}
