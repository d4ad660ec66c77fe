//! What single scattering leaves of white light at facets that reflect all of it: the albedo of a rough mirror.
//!
//! The rest bounces between the facets. [`super::between`] gives it back.

use super::albedo::{COSINES, CosineAxis, FacetTable, WIDTHS, around, cosine_axis, cubic, width_at, width_axis};
use super::geometry::{Facets, Geometry};
use super::{Beckmann, Blinn, Ggx};
use crate::math::quadrature::gauss_legendre;
use std::sync::OnceLock;

/// A sum of four weighted numbers.
#[inline(always)]
pub(super) fn weighted([a, b, c, d]: [f32; 4], by: [f32; 4]) -> f32 {
    (by[0] * a + by[1] * b) + (by[2] * c + by[3] * d)
}

/// 1 - E of one width.
#[derive(Clone, Copy, Debug)]
pub struct WhiteRow {
    axis: CosineAxis,
    lost: [f32; COSINES],
}

impl WhiteRow {
    /// [`WhiteTable::lost`] of the row's width, with the same bits.
    #[inline(always)]
    pub fn lost(&self, cos: f32) -> f32 {
        self.lost_at(self.axis.place(cos))
    }

    /// The same at a place on the axis of cosines.
    #[inline(always)]
    pub(super) fn lost_at(&self, place: f32) -> f32 {
        let (column, by_column) = cubic(place, COSINES);
        weighted(around(column, COSINES).map(|column| self.lost[column]), by_column).clamp(0.0, 1.0)
    }
}

/// 1 - E of a distribution under a shadowing term, over width and cosine, and its cosine-weighted mean over width.
#[derive(Debug)]
pub struct WhiteTable {
    lost: Vec<f32>,
    mean: [f32; WIDTHS],
}

impl WhiteTable {
    /// The table of a distribution under a shadowing term, made when it is first asked for from that of all Fresnel terms.
    pub fn of(facets: Facets, geometry: Geometry) -> &'static WhiteTable {
        static TABLES: [[OnceLock<WhiteTable>; Geometry::ALL.len()]; Facets::COUNT] =
            [const { [const { OnceLock::new() }; Geometry::ALL.len()] }; Facets::COUNT];
        TABLES[facets as usize][geometry as usize].get_or_init(|| {
            WhiteTable::new(match facets {
                Facets::Ggx => FacetTable::of::<Ggx>(geometry),
                Facets::Beckmann => FacetTable::of::<Beckmann>(geometry),
                Facets::Blinn => FacetTable::of::<Blinn>(geometry),
            })
        })
    }

    fn new(table: &FacetTable) -> Self {
        let lost = table.mirrors().map(|e| 1.0 - e).collect();
        let mut white = WhiteTable { lost, mean: [0.0; WIDTHS] };
        // In the cube root of the cosine the albedo is smooth down to the horizon.
        let rule = gauss_legendre(32, 0.0, 1.0);
        for i in 0..WIDTHS {
            let alpha = width_at(i as f32 / (WIDTHS - 1) as f32);
            let at = |t: f64| f64::from(white.lost(alpha, (t * t * t) as f32)) * 6.0 * t.powi(5);
            white.mean[i] = rule.iter().map(|node| node.weight * at(node.x)).sum::<f64>() as f32;
        }
        white
    }

    /// 1 - E at a cosine.
    ///
    /// Domain: alpha 1e-3..1, cosine 0..1. Gives: 0..1, within 1e-3.
    #[inline(always)]
    pub fn lost(&self, alpha: f32, cos: f32) -> f32 {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let (column, by_column) = cubic(cosine_axis(cos, alpha), COSINES);
        let rows = around(row, WIDTHS);
        let four = around(column, COSINES).map(|column| self.over_widths(rows, by_row, column));
        weighted(four, by_column).clamp(0.0, 1.0)
    }

    /// 1 - E at many cosines, for one width.
    #[inline(always)]
    pub fn row(&self, alpha: f32) -> WhiteRow {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let rows = around(row, WIDTHS);
        WhiteRow {
            axis: CosineAxis::new(alpha),
            lost: std::array::from_fn(|column| self.over_widths(rows, by_row, column)),
        }
    }

    #[inline(always)]
    fn over_widths(&self, rows: [usize; 4], by_row: [f32; 4], column: usize) -> f32 {
        weighted(rows.map(|row| self.lost[row * COSINES + column]), by_row)
    }

    /// The mean of 1 - E over the hemisphere, weighted by the cosine.
    #[inline(always)]
    pub fn mean_lost(&self, alpha: f32) -> f32 {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let [a, b, c, d] = around(row, WIDTHS).map(|row| self.mean[row]);
        (by_row[0] * a + by_row[1] * b + by_row[2] * c + by_row[3] * d).clamp(1e-7, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::microfacet::distribution::{Distribution, Widths};
    use crate::bsdf::microfacet::ggx::sample_visible;
    use glam::Vec3;

    /// Of grooves that are seen at grazing angles the facets seen most steeply send out most; they are few, and must not be missed.
    #[test]
    fn what_grooves_lose_is_known_down_to_the_horizon() {
        const MANY: u32 = 1 << 18;
        let table = WhiteTable::of(Facets::Ggx, Geometry::VGroove);
        for alpha in [0.1f32, 0.3, 1.0] {
            let ggx = Ggx(Widths { x: alpha, y: alpha });
            for cos in [5e-4f32, 2e-3, 0.01, 0.05, 0.3] {
                let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
                let leaves = |k: u32| {
                    // Roberts's sequence.
                    let at = |step: f64| (f64::from(k) * step).fract() as f32;
                    let m = sample_visible(wo, ggx.0, at(0.754_877_666_246_692_8), at(0.569_840_290_998_053_2));
                    let om = wo.dot(m);
                    let up = 2.0 * om * m.z - cos;
                    let part = (2.0 * m.z * cos.min(up) / om.max(1e-20)).min(1.0);
                    if om > 0.0 && up > 0.0 { f64::from((1.0 + ggx.lambda(wo)) * part) } else { 0.0 }
                };
                let exact = 1.0 - (0..MANY).map(leaves).sum::<f64>() / f64::from(MANY);
                let known = f64::from(table.lost(alpha, cos));
                assert!((known - exact).abs() < 2.5e-3, "{alpha} at {cos}: {known} against {exact}");
            }
        }
    }
}
