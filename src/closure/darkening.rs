//! Coat darkening: what a coat's boundary throws back at a diffuse base from inside is scattered once more, and again.
//!
//! A base of albedo rho under a boundary of inner reflectance F (diffuse light) lights itself rho F times, so its lobe counts
//! 1 / (1 - rho F) times: f = Ti To rho / (pi eta² (1 - rho F)), in each color channel. rho is the sum of the mean albedos of the
//! diffuse reflecting lobes that lie in the coat, each times its weight over the coat's; what layers between them take is left out,
//! and rho is limited to 1, so that nothing gains. Diffuse light that comes through from below is brightened in the same way.
//!
//! A coat in a coat counts as a diffuse base of the albedo that the two have together; its own reflection is left out.
//! Absorption is taken as if all inner reflection were total, beyond the critical angle (of index 1.5: 93 % of it).
//!
//! Source: Saunderson 1942 (the interreflection), Walsh 1926 (F of a smooth boundary), OpenPBR 2024 ("coat darkening").
//!
//! Decision (2026-11-29): the factor is computed when a tree is flattened, from the flat lobes, because only there it is known
//! which lobes share a coat and with what colors, and then costs a multiplication a lobe and nothing a light; instead of a lobe of
//! its own for what comes back, which would have to be evaluated and sampled.

use super::coats::{Boundary, Coat};
use super::flat::{Flat, Lobe};
use super::layering::{Layers, Top};
use super::store::NONE;
use super::weights::{Weight, Weights};
use crate::bsdf::fresnel::{Dielectric, dielectric};
use crate::bsdf::microfacet::albedo::FacetTable;
use crate::bsdf::microfacet::{Geometry, Ggx};
use crate::math::elementary::exp;
use crate::math::quadrature::{GAUSS_8, cosine_means};
use glam::Vec3;

/// A layer that is a coat, and the weight that reaches it.
#[derive(Clone, Copy, Debug)]
pub struct Coated {
    /// The layer.
    pub layer: u32,
    /// Its weight.
    pub weight: Weight,
}

/// Multiplies the diffuse lobes under coats by the part of their light that leaves in the end, (1 - F) / (1 - rho F), which is at
/// most 1 and right to pick lobes by. The coats divide f by 1 - F, so that it is the formula's.
pub fn darken(flat: &mut Flat, weights: &Weights, coated: &[Coated]) {
    if !coated.iter().any(|over| coat_of(flat, over).is_some_and(Coat::darkens_any)) {
        return;
    }
    let n = flat.lanes;
    let innermost = innermost(&flat.layers, coated);
    let mut factors = base_albedos(flat, weights, coated, &innermost);
    let mut escapes = vec![1.0; n * coated.len()];
    for index in (0..coated.len()).rev() {
        let Some(coat) = coat_of(flat, &coated[index]) else { continue };
        let (before, here) = factors.split_at_mut(3 * n * index);
        let around = under(&innermost, flat.layers.list[coated[index].layer as usize].parent);
        let mut known = None;
        for lane in 0..n {
            let returned = returned(coat, lane, &mut known);
            let escape = (1.0 - returned.clear).max(1e-6);
            escapes[index * n + lane] = escape;
            for channel in 0..3 {
                let rho = here[channel * n + lane].clamp(0.0, 1.0);
                let leaves = escape / (1.0 - rho * returned.absorbed[channel]).max(escape);
                here[channel * n + lane] = if coat.darkens(lane) { leaves } else { 1.0 };
                if let Some(outer) = around {
                    let share = relative(weights, [coated[index], coated[outer]], channel, lane, n);
                    before[(3 * outer + channel) * n + lane] += share * returned.passes * rho * leaves;
                }
            }
        }
    }
    for (index, over) in coated.iter().enumerate() {
        flat.coats.set_escape(flat.layers.coat(over.layer), &escapes[index * n..(index + 1) * n]);
    }
    // Outer coats first: what is in a coat in a coat is brightened by both.
    for index in 0..coated.len() {
        if let Some(outer) = under(&innermost, flat.layers.list[coated[index].layer as usize].parent) {
            let (before, here) = factors.split_at_mut(3 * n * index);
            let outer = &before[3 * n * outer..3 * n * (outer + 1)];
            here.iter_mut().zip(outer).for_each(|(factor, outer)| *factor *= outer);
        }
    }
    for index in 0..flat.lobes.len() {
        let lobe = flat.lobes[index];
        if let (Some(over), true) = (under(&innermost, lobe.layer), flat.model(lobe).kind.is_even()) {
            let weight = &mut flat.weights[3 * n * index..3 * n * (index + 1)];
            let factors = &factors[3 * n * over..3 * n * (over + 1)];
            weight.iter_mut().zip(factors).for_each(|(weight, factor)| *weight *= factor);
        }
    }
}

/// The coat of a layer that is one.
fn coat_of<'a>(flat: &'a Flat, over: &Coated) -> Option<&'a Coat> {
    flat.coats.get(flat.layers.coat(over.layer))
}

/// For every layer the innermost coat among it and the layers around it, as an index of `coated`, or [`NONE`].
fn innermost(layers: &Layers, coated: &[Coated]) -> Vec<u32> {
    let mut out: Vec<u32> = Vec::with_capacity(layers.list.len());
    let mut next = 0;
    for (index, layer) in layers.list.iter().enumerate() {
        let own = matches!(layer.top, Top::Boundary) && coated.get(next).is_some_and(|c| c.layer as usize == index);
        out.push(match own {
            true => next as u32,
            false => out.get(layer.parent as usize).copied().unwrap_or(NONE),
        });
        next += usize::from(own);
    }
    out
}

/// The innermost coat over what lies under a layer.
fn under(innermost: &[u32], layer: u32) -> Option<usize> {
    innermost.get(layer as usize).filter(|&&over| over != NONE).map(|&over| over as usize)
}

/// A weight in a coat over the weight of a coat around it.
fn relative(weights: &Weights, [inner, outer]: [Coated; 2], channel: usize, lane: usize, n: usize) -> f32 {
    ratio(weights.get(inner.weight, channel, lane, n), weights.get(outer.weight, channel, lane, n))
}

/// A part of a whole; no part of nothing.
fn ratio(part: f32, whole: f32) -> f32 {
    let ratio = part / whole;
    if ratio.is_finite() { ratio } else { 0.0 }
}

/// What the diffuse lobes in each coat reflect, of diffuse light, as three columns a coat.
fn base_albedos(flat: &Flat, weights: &Weights, coated: &[Coated], innermost: &[u32]) -> Vec<f32> {
    let n = flat.lanes;
    let (mut out, mut mean) = (vec![0.0; 3 * n * coated.len()], vec![0.0; n]);
    for (index, &lobe) in flat.lobes.iter().enumerate() {
        let (Some(over), true) = (under(innermost, lobe.layer), reflects_evenly(flat, lobe)) else { continue };
        let model = flat.model(lobe);
        let Some(loops) = model.kind.loops() else { continue };
        (loops.average)(flat.models.numbers(model), model.choice, &mut mean);
        for channel in 0..3 {
            let own = &flat.weights[(3 * index + channel) * n..(3 * index + channel + 1) * n];
            let out = &mut out[(3 * over + channel) * n..(3 * over + channel + 1) * n];
            for lane in 0..n {
                out[lane] += mean[lane] * ratio(own[lane], weights.get(coated[over].weight, channel, lane, n));
            }
        }
    }
    out
}

fn reflects_evenly(flat: &Flat, lobe: Lobe) -> bool {
    let kind = flat.model(lobe).kind;
    kind.is_even() && kind.loops().is_some_and(|loops| loops.reflects)
}

/// How a boundary treats diffuse light.
#[derive(Clone, Copy, Debug)]
struct Returned {
    /// What passes from outside.
    passes: f32,
    /// What comes back inside of a coat that absorbs nothing.
    clear: f32,
    /// What comes back.
    absorbed: Vec3,
}

/// How a coat treats diffuse light in a lane; what is known of the lane before is used where the boundary is the same.
fn returned(coat: &Coat, lane: usize, known: &mut Option<(Boundary, f32)>) -> Returned {
    let boundary = coat.boundary(lane);
    let passes = match *known {
        Some((before, passes)) if before == boundary => passes,
        _ => mean_pass(boundary),
    };
    *known = Some((boundary, passes));
    let eta = boundary.eta.max(1e-3);
    let smooth_and_light = boundary.alpha.is_none() && eta < 1.0;
    // From inside a lighter coat, diffuse light meets what it meets from outside a denser one.
    let inverse = Boundary { eta: 1.0 / eta, ..boundary };
    let clear = if smooth_and_light { 1.0 - mean_pass(inverse) } else { 1.0 - passes / (eta * eta) };
    let clear = clear.clamp(0.0, 1.0);
    let absorbed = coat.depth(lane).map_or(Vec3::splat(clear), |depth| clear * there_and_back(depth, eta));
    Returned { passes, clear, absorbed }
}

/// The part of diffuse light that passes a boundary from outside.
fn mean_pass(Boundary { eta, alpha }: Boundary) -> f32 {
    let fresnel = Dielectric::of(eta);
    let mut sum = 0.0;
    for (cos, weight) in cosine_means() {
        let reflected = match alpha {
            None => dielectric(cos, eta),
            Some(alpha) => FacetTable::of::<Ggx>(Geometry::Smith).color(&fresnel, alpha.min(1.0), cos).x,
        };
        sum += weight * (1.0 - reflected);
    }
    sum
}

/// What absorption leaves of light that is totally reflected, from the base to the boundary and back.
fn there_and_back(depth: Vec3, eta: f32) -> Vec3 {
    let widest = if eta > 1.0 { (1.0 - 1.0 / (eta * eta)).sqrt() } else { 1.0 };
    let mut sum = Vec3::ZERO;
    for (x, weight) in GAUSS_8 {
        for t in [0.5 - 0.5 * x, 0.5 + 0.5 * x] {
            let path = -2.0 * depth / (widest * t).max(1e-6);
            sum += weight * t * Vec3::new(exp(path.x), exp(path.y), exp(path.z));
        }
    }
    sum
}
