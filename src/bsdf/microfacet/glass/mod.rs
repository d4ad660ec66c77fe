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
//! neighbourhood, because a scene has a few indices and one table takes some 35 ms, of Beckmann's facets 260 ms; instead of one
//! over all indices.
//!
//! Decision (2026-11-29): a table holds the dielectric and, for Schlick's term, what a boundary that reflects nothing leaves and what the
//! rise of the term changes, for six exponents, because the albedo is linear in those and its error falls from 1e-2 to 2e-3; instead of
//! guessing Schlick's albedo from a dielectric's. The sums share the facets.
//!
//! Decision (2026-11-29): two of three indices are below 1 and dense as a cube toward it, because the error between two of 65 that lay
//! alike on both sides was the largest by far, 6.6e-3 inside just below 1; instead of 257 of those, which are as good and cost
//! a scene of few indices nothing, but one whose index varies, or a thorough test, four times as many tables.

mod leaving;
mod table;

use super::albedo::{CosineAxis, around, cosine_axis, cubic};
use super::geometry::{Facets, Geometry};
use super::white::{WhiteRow, WhiteTable, weighted};
use crate::bsdf::fresnel::Ends;
use leaving::EXPONENTS;
use table::{COSINES, INDICES, Parts, Table, WIDTHS, index_axis, narrow_axis, table};

/// What decides how much a round boundary leaves, but for the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// The distribution of its facets.
    pub facets: Facets,
    /// How they shadow each other.
    pub geometry: Geometry,
    /// Their width, 1e-3..1.
    pub alpha: f32,
    /// Transmitted over incident index, > 0.
    pub eta: f32,
    /// What Schlick's term is made of; nothing for a dielectric.
    pub ends: Option<Ends>,
}

impl Glass {
    /// What single scattering leaves of white light at a boundary, both halves together.
    ///
    /// Domain: cosine 0..1. Gives: 0..1.
    pub fn left(&self, cos: f32) -> f32 {
        let around_here = Neighbours::new(self);
        let (column, by_column) = cubic(cosine_axis(cos, self.alpha), COSINES);
        let four = around(column, COSINES).map(|column| around_here.at(column));
        let mirror = 1.0 - WhiteTable::of(self.facets, self.geometry).lost(self.alpha, cos);
        (weighted(four, by_column) * mirror).clamp(1e-2, 1.0)
    }

    /// The same at all cosines.
    pub fn row(&self) -> LeftRow {
        let around_here = Neighbours::new(self);
        let mirror = WhiteTable::of(self.facets, self.geometry).row(self.alpha);
        LeftRow {
            axis: CosineAxis::new(self.alpha),
            left: std::array::from_fn(|column| around_here.at(column)),
            mirror,
        }
    }
}

/// How much each number of the table counts in the albedo.
fn counting(ends: Option<Ends>) -> Parts {
    let mut counts = [0.0; EXPONENTS.len() + 2];
    let Some(Ends { f0, f90, exponent }) = ends else {
        counts[0] = 1.0;
        return counts;
    };
    // Lagrange's polynomial over p / (p + 5), which is 0 where the term is f90 everywhere and the rest of a mirror counts.
    let place = |p: f32| if p < f32::INFINITY { p / (p + 5.0) } else { 1.0 };
    let u = place(exponent);
    let nodes: [f32; EXPONENTS.len() + 1] = std::array::from_fn(|k| if k == 0 { 0.0 } else { place(EXPONENTS[k - 1]) });
    let weight = |k: usize| -> f32 {
        let others = (0..nodes.len()).filter(|&j| j != k);
        others.map(|j| (u - nodes[j]) / (nodes[k] - nodes[j])).product()
    };
    counts[1] = 1.0 - f0 - (f90 - f0) * weight(0);
    for (k, count) in counts[2..].iter_mut().enumerate() {
        *count = (f90 - f0) * weight(k + 1);
    }
    counts
}

/// The tables and rows between which an index and a width lie.
struct Neighbours {
    tables: [&'static Table; 2],
    by_index: [f32; 2],
    rows: [usize; 4],
    by_row: [f32; 4],
    counts: Parts,
    /// Only the first part counts.
    dielectric: bool,
    /// What is left where the table's numbers are all 0, in parts of a mirror.
    constant: f32,
}

impl Neighbours {
    fn new(glass: &Glass) -> Self {
        let Glass { facets, geometry, alpha, eta, ends } = *glass;
        let at = index_axis(eta) * (INDICES - 1) as f32;
        let first = (at as usize).min(INDICES - 2);
        let by_index = [1.0 - (at - first as f32), at - first as f32];
        // A table that does not count is not made.
        let [near, far] = [0, 1].map(|k| if by_index[k] == 0.0 { 1 - k } else { k });
        let tables = [near, far].map(|k| table(facets, geometry, first + k));
        let (row, by_row) = cubic(narrow_axis(alpha), WIDTHS);
        let counts = counting(ends);
        // Of a mirror that which the others do not have is left: f0, and of the rise with exponent 0 all.
        let constant = if ends.is_some() { 1.0 - counts[1] } else { 0.0 };
        Neighbours { tables, by_index, rows: around(row, WIDTHS), by_row, counts, dielectric: ends.is_none(), constant }
    }

    /// What is left at one of the tables' cosines, in parts of a mirror.
    #[inline(always)]
    fn at(&self, column: usize) -> f32 {
        let part = |k: usize| {
            let [near, far] =
                self.tables.map(|table| weighted(self.rows.map(|row| table[row * COSINES + column][k]), self.by_row));
            self.by_index[0] * near + self.by_index[1] * far
        };
        match self.dielectric {
            true => part(0),
            false => self.constant + (1..self.counts.len()).map(|k| self.counts[k] * part(k)).sum::<f32>(),
        }
    }
}

/// What one boundary leaves at all cosines.
#[derive(Clone, Copy, Debug)]
pub struct LeftRow {
    axis: CosineAxis,
    left: [f32; COSINES],
    mirror: WhiteRow,
}

impl LeftRow {
    /// [`Glass::left`], with the same bits.
    #[inline(always)]
    pub fn at(&self, cos: f32) -> f32 {
        let place = self.axis.place(cos);
        let (column, by_column) = cubic(place, COSINES);
        let four = around(column, COSINES).map(|column| self.left[column]);
        (weighted(four, by_column) * (1.0 - self.mirror.lost_at(place))).clamp(1e-2, 1.0)
    }
}

/// How many boundaries [`Rows`] remembers: both sides of two.
const KEPT: usize = 4;

/// The rows of the last few boundaries, for lanes that go from one to another. A row is made for one that comes again, because it
/// costs as much as nine look-ups.
#[derive(Debug, Default)]
pub struct Rows {
    kept: [Option<(Glass, Option<LeftRow>)>; KEPT],
    next: usize,
}

impl Rows {
    /// [`Glass::left`], with the same bits.
    pub fn left(&mut self, glass: &Glass, cos: f32) -> f32 {
        let known = self.kept.iter_mut().flatten().find(|(of, _)| of == glass);
        if let Some((_, row)) = known {
            return row.get_or_insert_with(|| glass.row()).at(cos);
        }
        self.kept[self.next] = Some((*glass, None));
        self.next = (self.next + 1) % KEPT;
        glass.left(cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::fresnel::{Dielectric, Fresnel, Schlick, eta_of_reflectance, refracted};
    use crate::bsdf::microfacet::distribution::{Distribution, Widths};
    use crate::bsdf::microfacet::ggx::{Ggx, sample_visible};
    use crate::bsdf::params;
    use glam::Vec3;

    /// What leaves, facet by facet, of sixteen times as many, which are others.
    fn white(term: impl Fresnel, alpha: f32, cos: f32) -> f64 {
        const MANY: u32 = 1 << 16;
        let ggx = Ggx(Widths { x: alpha, y: alpha });
        let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
        let leaves = |k: u32| {
            // Roberts's sequence.
            let at = |step: f64| (f64::from(k) * step).fract() as f32;
            let m = sample_visible(wo, ggx.0, at(0.754_877_666_246_692_8), at(0.569_840_290_998_053_2));
            let om = wo.dot(m);
            let part = |wi: Vec3| (1.0 + ggx.lambda(wo)) / (1.0 + ggx.lambda(wo) + ggx.lambda(wi));
            let (up, down) = (m * (2.0 * om) - wo, refracted(wo, m, term.eta()));
            let reflected = term.mean(om);
            let up = if up.z > 0.0 { reflected * part(up) } else { 0.0 };
            let down = if down.z < 0.0 { (1.0 - reflected) * part(down) } else { 0.0 };
            if om > 0.0 { f64::from(up + down) } else { 0.0 }
        };
        (0..MANY).map(leaves).sum::<f64>() / f64::from(MANY)
    }

    /// Widths and cosines between the nodes of all axes, other ones for each index.
    fn places(eta: f32) -> impl Iterator<Item = (f32, f32)> {
        (0..12).map(move |k| {
            let at = |step: f32| (0.5 + (k as f32 + 3.0 * eta) * step).fract();
            (0.03 + 0.97 * at(0.754_877_7), 0.01 + 0.99 * at(0.569_840_3).powi(2))
        })
    }

    fn glass(term: impl Fresnel, alpha: f32) -> Glass {
        Glass { facets: Facets::Ggx, geometry: Geometry::Smith, alpha, eta: term.eta(), ends: term.ends() }
    }

    /// From both sides and close to total reflection.
    #[test]
    fn what_is_left_is_known_between_the_nodes() {
        let (mut squares, mut count) = (0.0, 0.0);
        for eta in [1.07, 1.09, 1.22, 1.34, 1.52, 2.0, 2.6].into_iter().flat_map(|e| [e, 1.0 / e]) {
            for (alpha, cos) in places(eta) {
                let term = Dielectric::of(eta);
                let known = f64::from(glass(term, alpha).left(cos));
                let error = known / white(term, alpha, cos) - 1.0;
                assert!(error.abs() <= 2e-3, "{eta} {alpha} {cos}: {known}, {error}");
                (squares, count) = (squares + error * error, count + 1.0);
            }
        }
        assert!(squares < 4e-4 * 4e-4 * count, "{squares} of {count}");
    }

    #[test]
    fn what_is_left_under_schlicks_term_is_known() {
        let mut worst = 0.0f64;
        for (f0, f90) in [(0.002, 1.0), (0.04, 1.0), (0.04, 0.5), (0.2, 1.0), (0.2, 0.2), (0.0, 0.0), (0.1, 0.0)] {
            for exponent in [0.0, 0.7, 1.5, 3.7, 5.0, 7.0, 16.0] {
                for side in [2.0, 0.5] {
                    let term = Schlick::prepare(params([f0, f0, f0, f90, f90, f90, exponent, side]), 0);
                    for (alpha, cos) in places(eta_of_reflectance(f0) + exponent).step_by(3) {
                        let known = f64::from(glass(term, alpha).left(cos));
                        let error = known / white(term, alpha, cos).max(0.01) - 1.0;
                        worst = worst.max(error.abs());
                        // A part that falls off sharply at the critical angle bends more than the tables do.
                        let bound = match (side < 1.0 && f90 < 1.0, exponent <= 10.0) {
                            (true, _) => 1e-2,
                            (_, true) => 2e-3,
                            _ => 4e-3,
                        };
                        assert!(error.abs() <= bound, "{f0} {f90} {exponent} {side}, {alpha} {cos}: {known}, {error}");
                    }
                }
            }
        }
        assert!(worst > 1e-5, "nothing is as exact as {worst}");
    }

    #[test]
    fn rows_have_the_bits_of_single_looks() {
        let mut rows = Rows::default();
        for k in 0..100u32 {
            let eta = [1.5, 1.0 / 1.5, 1.33][(k * k % 7 % 3) as usize];
            let ends = (k % 5 == 0).then_some(Ends { f0: 0.04, f90: 1.0, exponent: 5.0 });
            let glass = Glass { facets: Facets::Ggx, geometry: Geometry::Smith, alpha: 0.3, eta, ends };
            let cos = k as f32 / 99.0;
            assert_eq!(rows.left(&glass, cos).to_bits(), glass.left(cos).to_bits(), "{k}");
        }
    }
}
