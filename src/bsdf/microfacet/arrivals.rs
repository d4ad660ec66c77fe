//! From where the light comes that facets send to a direction: three cosines for what arrives lower than it leaves, one for the
//! rest.
//!
//! A layer over the facets lets the less through, the lower light arrives. By the rule that is safe over all bases it takes as much from
//! light that arrives higher as from light that arrives where it leaves, so only the lower part has to be integrated well: by the
//! nodes of its Gauss rule, whatever the layer.
//!
//! Decision (2026-11-29): Gauss nodes, because one table of width and cosine then serves every top, nested ones and colors too;
//! instead of a table for each kind of top over its roughness.

use super::albedo::{COSINES, WIDTHS, around, cosine_at, cosine_axis, cubic, facets, width_at, width_axis};
use super::distribution::{Distribution, Widths};
use super::geometry::{Facets, Geometry};
use super::white::WhiteTable;
use crate::bsdf::{ARRIVALS, Arrivals, select};
use crate::math::quadrature::{Node, gauss_legendre, gauss_rule};
use std::sync::OnceLock;

/// How many of the cosines stand for light that arrives lower.
const LOWER: usize = ARRIVALS - 1;

/// The rules of a distribution under a shadowing term: the weight of each node, and that times its place, which is the cosine over
/// the viewer's for lower light, and how far the cosine is from the viewer's to 1 for the rest.
#[derive(Debug)]
pub struct ArrivalTable {
    cells: Vec<[f32; 2 * ARRIVALS]>,
}

impl ArrivalTable {
    /// The table of a distribution under a shadowing term, made when it is first asked for: some 60 ms.
    pub fn of<D: Distribution>(geometry: Geometry) -> &'static ArrivalTable {
        static TABLES: [[OnceLock<ArrivalTable>; Geometry::ALL.len()]; Facets::COUNT] =
            [const { [const { OnceLock::new() }; Geometry::ALL.len()] }; Facets::COUNT];
        TABLES[D::FACETS as usize][geometry as usize].get_or_init(|| ArrivalTable::build::<D>(geometry))
    }

    /// The table of what facets reflect more than once, which arrives alike whatever the direction it leaves to.
    pub fn between(facets: Facets, geometry: Geometry) -> &'static ArrivalTable {
        static TABLES: [[OnceLock<ArrivalTable>; Geometry::ALL.len()]; Facets::COUNT] =
            [const { [const { OnceLock::new() }; Geometry::ALL.len()] }; Facets::COUNT];
        TABLES[facets as usize][geometry as usize].get_or_init(|| {
            let white = WhiteTable::of(facets, geometry);
            // In the cube root of the cosine what is lost is smooth down to the horizon.
            let rule = gauss_legendre(48, 0.0, 1.0);
            ArrivalTable::new(|alpha, _, point| {
                for node in &rule {
                    let up = node.x * node.x * node.x;
                    point(up, node.weight * node.x.powi(5) * f64::from(white.lost(alpha, up as f32)));
                }
            })
        })
    }

    fn build<D: Distribution>(geometry: Geometry) -> Self {
        let (along, across) = (gauss_legendre(28, 0.0, 1.0), gauss_legendre(14, 0.0, 1.0));
        ArrivalTable::new(|alpha, cos, point| {
            let distribution = D::new(Widths { x: alpha, y: alpha });
            facets(&distribution, geometry, [alpha, cos], [&along, &across], |_, up, weight| point(up, weight));
        })
    }

    /// A table from the points of the measure of light of a width and a cosine: cosines at which it arrives, and weights.
    fn new(measure: impl Fn(f32, f32, &mut dyn FnMut(f64, f64))) -> Self {
        let mut cells = Vec::with_capacity(WIDTHS * COSINES);
        let mut points = Vec::new();
        for i in 0..WIDTHS {
            let alpha = width_at(i as f32 / (WIDTHS - 1) as f32);
            for j in 0..COSINES {
                let cos = f64::from(cosine_at(j as f32 / (COSINES - 1) as f32, alpha));
                let (mut total, mut upper, mut moment) = (0.0, 0.0, 0.0);
                points.clear();
                measure(alpha, cos as f32, &mut |up, weight| {
                    total += weight;
                    if up < cos {
                        points.push(Node { x: up / cos, weight });
                    } else {
                        upper += weight;
                        moment += weight * (up - cos) / (1.0 - cos).max(1e-12);
                    }
                });
                let rule: [Node; LOWER] = gauss_rule(&points);
                let scale = 1.0 / f64::max(total, 1e-30);
                let mut cell = [0.0; 2 * ARRIVALS];
                for k in 0..LOWER {
                    let weight = rule[k].weight * scale;
                    (cell[k], cell[ARRIVALS + k]) = (weight as f32, (weight * rule[k].x) as f32);
                }
                (cell[LOWER], cell[ARRIVALS + LOWER]) = ((upper * scale) as f32, (moment * scale) as f32);
                cells.push(cell);
            }
        }
        ArrivalTable { cells }
    }

    /// Cosines of the light, and the part of it that each stands for.
    ///
    /// Domain: alpha 1e-3..1, cosine 0..1. Gives: three cosines below `cos` and one above, and parts that sum to 1.
    #[inline(always)]
    pub fn at(&self, alpha: f32, cos: f32) -> Arrivals {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let (column, by_column) = cubic(cosine_axis(cos, alpha), COSINES);
        let mut sum = [0.0; 2 * ARRIVALS];
        for (row, by_row) in around(row, WIDTHS).into_iter().zip(by_row) {
            for (column, by_column) in around(column, COSINES).into_iter().zip(by_column) {
                let cell = &self.cells[row * COSINES + column];
                for k in 0..2 * ARRIVALS {
                    sum[k] += by_row * by_column * cell[k];
                }
            }
        }
        let total: f32 = sum[..ARRIVALS].iter().map(|part| part.max(0.0)).sum();
        let mut out = [(cos, 0.0); ARRIVALS];
        for k in 0..ARRIVALS {
            let part = sum[k].max(0.0);
            let place = select(part > 1e-6, sum[ARRIVALS + k] / part.max(1e-6), 1.0).clamp(0.0, 1.0);
            let at = if k < LOWER { cos * place } else { cos + (1.0 - cos) * place };
            out[k] = (at, part / total.max(1e-6));
        }
        out
    }
}
