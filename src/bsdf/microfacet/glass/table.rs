//! The tables of what is left, and their axes.

use super::leaving::{Looked, Places, SUMS, leaving};
use crate::bsdf::microfacet::albedo::{cosine_at, width_at, width_axis};
use crate::bsdf::microfacet::distribution::Distribution;
use crate::bsdf::microfacet::geometry::{Facets, Geometry};
use crate::bsdf::microfacet::{Beckmann, Blinn, Ggx};
use crate::bsdf::power::{exp2, log2};
use crate::math::elementary::exp;
use std::f32::consts::LN_2;
use std::sync::{LazyLock, OnceLock};

/// Widths, cosines and indices of the tables.
pub const WIDTHS: usize = 14;
pub const COSINES: usize = 36;
pub const INDICES: usize = 121;
/// The largest |ln eta|; beyond it the value there stands.
const MOST: f32 = 2.0;
/// The least width of the tables; what narrower facets lose is no part of theirs.
const LEAST: f32 = 0.01;
/// Facets that are averaged, and the step of their azimuths: consecutive numbers of Fibonacci, which fill the square evenly and along
/// curved edges too. On one half of the facets, for the other mirrors it. So many are at most 7e-4 off, mean 1.4e-4 (300 places against 2^18
/// facets), where 4096 of Roberts's sequence on both halves were 1.9e-3 and 4e-4 off.
const FACETS: u32 = 4181;
const STEP: u32 = 2584;

/// What leaves at one width and cosine, in parts of what leaves a mirror: the sums of [`leaving`] but the first.
pub type Parts = [f32; SUMS - 1];

/// One index of refraction, cosine by cosine and width by width.
pub type Table = Vec<Parts>;

/// The part of the axis below 1.
const INSIDE: f32 = 2.0 / 3.0;

/// Place of an index on its axis, 0..1; densest below 1 and close to it, where the critical angle moves fastest.
pub fn index_axis(eta: f32) -> f32 {
    let x = (log2(eta.max(1e-6)) * (LN_2 / MOST)).clamp(-1.0, 1.0);
    if x < 0.0 { INSIDE * (1.0 - root(-x)) } else { INSIDE + (1.0 - INSIDE) * x.sqrt() }
}

/// The cube root of a number of 0..1.
fn root(x: f32) -> f32 {
    if x > 0.0 { exp2(log2(x) * (1.0 / 3.0)) } else { 0.0 }
}

fn index_at(place: f32) -> f32 {
    let inside = (1.0 - place / INSIDE).max(0.0);
    let outside = (place - INSIDE).max(0.0) / (1.0 - INSIDE);
    let x = outside * outside - inside * inside * inside;
    // At 1 a boundary is none; an index close to it stands for the limit.
    if x.abs() < 1e-6 { 1.0 + 1e-4 } else { exp(MOST * x) }
}

/// Place of a width on the axis of the tables, 0..1.
pub fn narrow_axis(alpha: f32) -> f32 {
    let least = width_axis(LEAST);
    ((width_axis(alpha) - least) / (1.0 - least)).max(0.0)
}

/// The table of an index, made when it is first asked for.
pub fn table(facets: Facets, geometry: Geometry, index: usize) -> &'static Table {
    static TABLES: [[[OnceLock<Table>; INDICES]; Geometry::ALL.len()]; Facets::COUNT] =
        [const { [const { [const { OnceLock::new() }; INDICES] }; Geometry::ALL.len()] }; Facets::COUNT];
    TABLES[facets as usize][geometry as usize][index].get_or_init(|| {
        let eta = index_at(index as f32 / (INDICES - 1) as f32);
        match facets {
            Facets::Ggx => build::<Ggx>(geometry, eta),
            Facets::Beckmann => build::<Beckmann>(geometry, eta),
            Facets::Blinn => build::<Blinn>(geometry, eta),
        }
    })
}

fn build<D: Distribution>(geometry: Geometry, eta: f32) -> Table {
    static PLACES: LazyLock<Places> = LazyLock::new(|| Places::new((0..FACETS).map(place)));
    let mut out = Vec::with_capacity(WIDTHS * COSINES);
    for i in 0..WIDTHS {
        let least = width_axis(LEAST);
        let alpha = width_at(least + (1.0 - least) * i as f32 / (WIDTHS - 1) as f32);
        for j in 0..COSINES {
            let cos = cosine_at(j as f32 / (COSINES - 1) as f32, alpha);
            let [mirror, parts @ ..] = leaving::<D>(Looked { geometry, alpha, cos, eta }, &PLACES);
            out.push(parts.map(|part| (part / mirror.max(1e-9)).clamp(-100.0, 100.0) as f32));
        }
    }
    out
}

/// Where the random numbers of a facet would be.
fn place(facet: u32) -> [f32; 2] {
    let of_all = |k: u32| (k as f32 + 0.5) / FACETS as f32;
    [of_all(facet), 0.5 * of_all(facet * STEP % FACETS)]
}
