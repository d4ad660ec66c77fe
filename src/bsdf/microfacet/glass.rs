//! What single scattering leaves of white light at a rough boundary that reflects and transmits: what its lobe is divided by
//! to lose nothing.
//!
//! Source: Turquin 2019, "Practical multiple scattering compensation for microfacet models": the whole lobe over its own white
//! albedo. That depends on the viewer alone, so the lobe is not reciprocal any more.
//!
//! The tables hold the part of what a mirror of the same facets leaves, which [`WhiteTable`] knows closely: beyond the critical
//! angle that is 1, and elsewhere smoother than the albedo itself.
//!
//! Decision (2026-11-29): tables over width and cosine, one for each of some indices, made when a scene asks for their
//! neighbourhood, because a scene has a few indices and one table takes some 100 ms; instead of one over all indices.
//!
//! Decision (2026-11-29): two of three indices are below 1 and dense as a cube toward it, because the error between two of 65 that lay
//! alike on both sides was the largest by far, 6.6e-3 inside just below 1; instead of 257 of those, which are as good and cost
//! a scene of few indices nothing, but one whose index varies, or a thorough test, four times as many tables.

use super::albedo::{around, cosine_at, cosine_axis, cubic, width_at, width_axis};
use super::distribution::{Distribution, Widths};
use super::geometry::{Facets, Geometry};
use super::ggx::{Ggx, sample_visible};
use super::white::{WhiteRow, WhiteTable, weighted};
use super::{Beckmann, Blinn};
use crate::bsdf::fresnel::{dielectric, refracted};
use crate::bsdf::power::{exp2, log2};
use crate::math::elementary::exp;
use glam::Vec3;
use std::f32::consts::LN_2;
use std::sync::OnceLock;

/// Widths, cosines and indices of the tables.
const WIDTHS: usize = 14;
const COSINES: usize = 36;
const INDICES: usize = 121;
/// The largest |ln eta|; beyond it the value there stands.
const MOST: f32 = 2.0;
/// The least width of the tables; what narrower facets lose is no part of theirs.
const LEAST: f32 = 0.01;
/// Facets that are averaged, and the step of their azimuths: consecutive numbers of Fibonacci, which fill the square evenly and along
/// curved edges too. On one half of the facets, for the other mirrors it. So many are at most 7e-4 off, mean 1.4e-4 (300 places against 2^18
/// facets), where 4096 of Roberts's sequence on both halves were 1.9e-3 and 4e-4 off.
const FACETS: u32 = 4181;
const STEP: u32 = 2584;

/// One index of refraction.
type Table = Vec<f32>;

/// The part of the axis below 1.
const INSIDE: f32 = 2.0 / 3.0;

/// Place of an index on its axis, 0..1; densest below 1 and close to it, where the critical angle moves fastest.
fn index_axis(eta: f32) -> f32 {
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
fn narrow_axis(alpha: f32) -> f32 {
    let least = width_axis(LEAST);
    ((width_axis(alpha) - least) / (1.0 - least)).max(0.0)
}

fn table(facets: Facets, geometry: Geometry, index: usize) -> &'static Table {
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
    let mut out = Vec::with_capacity(WIDTHS * COSINES);
    for i in 0..WIDTHS {
        let least = width_axis(LEAST);
        let alpha = width_at(least + (1.0 - least) * i as f32 / (WIDTHS - 1) as f32);
        for j in 0..COSINES {
            let cos = cosine_at(j as f32 / (COSINES - 1) as f32, alpha);
            let [all, mirror] = white::<D>(geometry, [alpha, cos], eta, (0..FACETS).map(place));
            out.push((all / mirror.max(1e-9)).min(100.0) as f32);
        }
    }
    out
}

/// Where the random numbers of a facet would be.
fn place(facet: u32) -> [f32; 2] {
    let of_all = |k: u32| (k as f32 + 0.5) / FACETS as f32;
    [of_all(facet), 0.5 * of_all(facet * STEP % FACETS)]
}

/// What leaves a boundary of one width toward one cosine, and what leaves a mirror, as sums over visible facets.
fn white<D: Distribution>(
    geometry: Geometry,
    [alpha, cos]: [f32; 2],
    eta: f32,
    facets: impl Iterator<Item = [f32; 2]>,
) -> [f64; 2] {
    let widths = Widths { x: alpha, y: alpha };
    let (d, ggx) = (D::new(widths), Ggx(widths));
    let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
    let lambda_o = f64::from(d.lambda(wo));
    let masking = 1.0 + f64::from(ggx.lambda(wo));
    let (mut all, mut mirror) = (0.0, 0.0);
    for [u, v] in facets {
        let m = sample_visible(wo, widths, u, v);
        let om = wo.dot(m);
        if om <= 0.0 {
            continue;
        }
        let ratio = masking * f64::from(d.d(m) / ggx.d(m).max(1e-30));
        let part = |wi: Vec3| {
            let lambdas = [lambda_o, f64::from(d.lambda(wi))];
            // A facet's cosine to the light stands to that to the viewer as VGroove needs it; the others do not read it.
            let cosines = [f64::from(cos), f64::from(wi.z.abs() * om / wi.dot(m).abs().max(1e-20))];
            ratio * geometry.part(lambdas, cosines, f64::from(om), f64::from(m.z))
        };
        let reflected = f64::from(dielectric(om, eta));
        let (up, down) = (m * (2.0 * om) - wo, refracted(wo, m, eta));
        let up = if up.z > 0.0 { part(up) } else { 0.0 };
        mirror += up;
        all += reflected * up;
        all += if down.z < 0.0 { (1.0 - reflected) * part(down) } else { 0.0 };
    }
    [all, mirror]
}

/// What single scattering leaves of white light at a dielectric boundary, both halves together.
///
/// Domain: alpha 1e-3..1, cosine 0..1, index (transmitted over incident) > 0. Gives: 0..1.
pub fn left(facets: Facets, geometry: Geometry, alpha: f32, cos: f32, eta: f32) -> f32 {
    let around_here = Neighbours::new(facets, geometry, alpha, eta);
    let (column, by_column) = cubic(cosine_axis(cos, alpha), COSINES);
    let four = around(column, COSINES).map(|column| around_here.at(column));
    let mirror = 1.0 - WhiteTable::of(facets, geometry).lost(alpha, cos);
    (weighted(four, by_column) * mirror).clamp(1e-2, 1.0)
}

/// The tables and rows between which an index and a width lie.
struct Neighbours {
    tables: [&'static Table; 2],
    by_index: [f32; 2],
    rows: [usize; 4],
    by_row: [f32; 4],
}

impl Neighbours {
    fn new(facets: Facets, geometry: Geometry, alpha: f32, eta: f32) -> Self {
        let at = index_axis(eta) * (INDICES - 1) as f32;
        let first = (at as usize).min(INDICES - 2);
        let by_index = [1.0 - (at - first as f32), at - first as f32];
        // A table that does not count is not made.
        let [near, far] = [0, 1].map(|k| if by_index[k] == 0.0 { 1 - k } else { k });
        let tables = [near, far].map(|k| table(facets, geometry, first + k));
        let (row, by_row) = cubic(narrow_axis(alpha), WIDTHS);
        Neighbours { tables, by_index, rows: around(row, WIDTHS), by_row }
    }

    /// What is left at one of the tables' cosines.
    #[inline(always)]
    fn at(&self, column: usize) -> f32 {
        let [near, far] =
            self.tables.map(|table| weighted(self.rows.map(|row| table[row * COSINES + column]), self.by_row));
        self.by_index[0] * near + self.by_index[1] * far
    }
}

/// What one width of one index leaves at all cosines.
#[derive(Clone, Copy, Debug)]
pub struct LeftRow {
    alpha: f32,
    left: [f32; COSINES],
    mirror: WhiteRow,
}

impl LeftRow {
    /// The row of a width and an index.
    pub fn new(facets: Facets, geometry: Geometry, alpha: f32, eta: f32) -> Self {
        let around_here = Neighbours::new(facets, geometry, alpha, eta);
        let mirror = WhiteTable::of(facets, geometry).row(alpha);
        LeftRow { alpha, left: std::array::from_fn(|column| around_here.at(column)), mirror }
    }

    /// [`left`] of the row's width and index, with the same bits.
    #[inline(always)]
    pub fn at(&self, cos: f32) -> f32 {
        let (column, by_column) = cubic(cosine_axis(cos, self.alpha), COSINES);
        let four = around(column, COSINES).map(|column| self.left[column]);
        (weighted(four, by_column) * (1.0 - self.mirror.lost(cos))).clamp(1e-2, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the nodes of all axes, from both sides and close to total reflection, against sixteen times the facets, which are others.
    #[test]
    fn what_is_left_is_known_between_the_nodes() {
        const MANY: u32 = 1 << 16;
        // Roberts's sequence.
        let place =
            |k: u32| [0.754_877_666_246_692_8, 0.569_840_290_998_053_2].map(|s| (f64::from(k) * s).fract() as f32);
        let mut squares = 0.0;
        let etas = [1.07, 1.09, 1.22, 1.34, 1.52, 2.0, 2.6];
        let places: Vec<(f32, u32)> =
            etas.iter().flat_map(|&e| [e, 1.0 / e]).flat_map(|e| (0..12).map(move |k| (e, k))).collect();
        for &(eta, k) in &places {
            let at = |step: f32| (0.5 + (k as f32 + 3.0 * eta) * step).fract();
            let (alpha, cos) = (0.03 + 0.97 * at(0.754_877_7), 0.01 + 0.99 * at(0.569_840_3).powi(2));
            let [all, _] = white::<Ggx>(Geometry::Smith, [alpha, cos], eta, (0..MANY).map(place));
            let known = f64::from(left(Facets::Ggx, Geometry::Smith, alpha, cos, eta));
            let error = known / (all / f64::from(MANY)) - 1.0;
            assert!(error.abs() <= 2e-3, "{eta} {alpha} {cos}: {known}, {error}");
            squares += error * error / places.len() as f64;
        }
        assert!(squares.sqrt() < 4e-4, "{}", squares.sqrt());
    }
}
