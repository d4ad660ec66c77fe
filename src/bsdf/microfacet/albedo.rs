//! Directional albedo of the reflecting half under any Fresnel term, from one table a distribution and shadowing term.
//!
//! The albedo is the integral of F(o.m) over a measure of the cosines o.m, which depends on the viewer's cosine and the width
//! alone. The table keeps the six nodes and weights of the Gauss rule of that measure, so the albedo is a sum of six
//! Fresnel terms: exact for polynomials of degree 11, and 2e-5 off for an index of 1.1 to 2.5 and for metals.
//!
//! Decision (2026-11-22): Gauss nodes instead of moments against fixed hat functions, because F falls from 1 within a
//! range of sqrt(eta² - 1), which takes some sixty hats; and instead of a table for each Fresnel term, which a textured
//! index would need by the lane. Axes: cubic interpolation in log alpha + 6 alpha and in log(1 + cos / (0.04 alpha)), whose
//! range is scaled to the width, because masking depends on cos / alpha near the horizon and on alpha itself elsewhere.
//! Decision (2026-11-22): cells are blended over the width first and over the cosine then, because a material of one width needs
//! the first once a batch ([`Row`]), and the bits are the same whether it does so or not; instead of a curve over the cosine for each
//! material, which a textured width or index would need by the lane. Nodes fill whole vectors, so that one lane's are computed
//! side by side. An albedo of one width takes 24 ns a lane.

use super::distribution::{Distribution, MIN_ALPHA, Widths};
use super::geometry::{Facets, Geometry};
use super::ggx::Ggx;
use crate::bsdf::fresnel::{Fresnel, limited};
use crate::bsdf::power::{exp2, log2};
use crate::bsdf::select;
use crate::math::elementary::floor_and_rest;
use crate::math::quadrature::{Node, gauss_legendre, gauss_rule};
use glam::{Mat4, Vec3, Vec4};
use std::f32::consts::LN_2;
use std::sync::OnceLock;

/// Nodes of the rule.
const NODES: usize = 6;
/// Widths in the table.
pub(super) const WIDTHS: usize = 24;
/// Cosines in the table, for each width.
pub(super) const COSINES: usize = 40;
/// How much of the axis is linear in the width.
const LINEAR: f32 = 6.0;
/// Where the axis of cosines turns from linear to logarithmic, in widths.
const BEND: f32 = 0.04;
const LEAST: f32 = MIN_ALPHA;

/// Vectors of four that hold a cell.
const QUADS: usize = 2 * NODES / 4;
/// Lanes that a row computes side by side.
pub const BLOCK: usize = 8;

/// Weights, times the distance of their nodes from the viewer's cosine, and the weights alone.
///
/// Nodes are interpolated as centers of gravity, because those of almost no weight lie far away in one cell and not in the next.
type Cell = [Vec4; QUADS];

/// The cells of one width for all cosines.
#[derive(Debug)]
pub struct Row {
    alpha: f32,
    cells: [Cell; COSINES],
}

/// Four cells, weighted.
#[inline(always)]
fn blend(cells: [&Cell; 4], weights: [f32; 4]) -> Cell {
    let mut sum = [Vec4::ZERO; QUADS];
    for q in 0..QUADS {
        let near = cells[0][q] * weights[0] + cells[1][q] * weights[1];
        sum[q] = near + (cells[2][q] * weights[2] + cells[3][q] * weights[3]);
    }
    sum
}

/// The cells of a block number by number, each number of all lanes together.
#[inline(always)]
fn transposed(cells: &[Cell; BLOCK]) -> [[f32; BLOCK]; 2 * NODES] {
    let mut out = [[0.0; BLOCK]; 2 * NODES];
    for first in [0, 4] {
        for q in 0..QUADS {
            let [a, b, c, d] = [cells[first][q], cells[first + 1][q], cells[first + 2][q], cells[first + 3][q]];
            let four = Mat4::from_cols(a, b, c, d).transpose();
            let rows = four.to_cols_array();
            for k in 0..4 {
                for l in 0..4 {
                    out[4 * q + k][first + l] = rows[4 * k + l];
                }
            }
        }
    }
    out
}

/// What one node adds to the integral of a Fresnel term.
#[inline(always)]
fn term<F: Fresnel>(fresnel: &F, cos: f32, (moment, weight): (f32, f32)) -> Vec3 {
    let away = select(weight > 1e-9, moment / weight.max(1e-9), 0.0);
    let at = limited(cos + away, 0.0, 1.0);
    if F::COLORED { fresnel.color(at) * weight } else { Vec3::splat(fresnel.largest(at) * weight) }
}

impl Row {
    /// [`FacetTable::color`] of the row's width at many cosines, by component, with the same bits; only the first component
    /// counts where a term has no color.
    #[inline(always)]
    pub fn colors<F: Fresnel>(&self, fresnel: &F, cos: &[f32; BLOCK]) -> [[f32; BLOCK]; 3] {
        // Steps of their own: the first and the last run over lanes in SIMD, the middle over the numbers of a cell.
        let (mut places, mut weights) = ([0; BLOCK], [[0.0; BLOCK]; 4]);
        for l in 0..BLOCK {
            let (place, w) = cubic(cosine_axis(cos[l], self.alpha), COSINES);
            places[l] = place;
            (weights[0][l], weights[1][l], weights[2][l], weights[3][l]) = (w[0], w[1], w[2], w[3]);
        }
        let mut cells = [[Vec4::ZERO; QUADS]; BLOCK];
        for l in 0..BLOCK {
            let [a, b, c, d] = around(places[l], COSINES);
            let four = [&self.cells[a], &self.cells[b], &self.cells[c], &self.cells[d]];
            cells[l] = blend(four, [weights[0][l], weights[1][l], weights[2][l], weights[3][l]]);
        }
        let numbers = transposed(&cells);
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..NODES {
            for l in 0..BLOCK {
                let more = term(fresnel, cos[l], (numbers[k][l], numbers[NODES + k][l]));
                (x[l], y[l], z[l]) = (x[l] + more.x, y[l] + more.y, z[l] + more.z);
            }
        }
        [x, y, z]
    }
}

/// The albedo of the reflecting half of one distribution with one shadowing term.
#[derive(Debug)]
pub struct FacetTable {
    cells: Vec<Cell>,
}

/// Place of a width on its axis, 0..1.
#[inline(always)]
pub(super) fn width_axis(alpha: f32) -> f32 {
    let place = |a: f32| log2(a) * LN_2 + LINEAR * a;
    (place(alpha) - place(LEAST)) / (place(1.0) - place(LEAST))
}

/// The axis of cosines of a width.
#[derive(Clone, Copy, Debug)]
pub(super) struct CosineAxis {
    over: f32,
    whole: f32,
}

impl CosineAxis {
    #[inline(always)]
    pub(super) fn new(alpha: f32) -> Self {
        let over = 1.0 / (BEND * alpha);
        CosineAxis { over, whole: log2(1.0 + over) }
    }

    /// Place of a cosine, 0..1.
    #[inline(always)]
    pub(super) fn place(self, cos: f32) -> f32 {
        log2(1.0 + cos * self.over) / self.whole
    }
}

/// Place of a cosine on the axis of a width, 0..1.
#[inline(always)]
pub(super) fn cosine_axis(cos: f32, alpha: f32) -> f32 {
    CosineAxis::new(alpha).place(cos)
}

/// The cosine at a place of the axis of a width.
pub(super) fn cosine_at(place: f32, alpha: f32) -> f32 {
    let over = 1.0 / (BEND * alpha);
    ((exp2(place * log2(1.0 + over)) - 1.0) / over).clamp(1e-6, 1.0)
}

impl FacetTable {
    /// The albedo of a full mirror at all places of the table, width by width.
    pub(super) fn mirrors(&self) -> impl Iterator<Item = f32> + '_ {
        // The weights of a rule fill the second half of a cell.
        self.cells.iter().map(|[_, q, r]| q.z + q.w + r.element_sum())
    }

    /// The albedos of all widths of a distribution under a shadowing term, made when they are first asked for.
    pub fn of<D: Distribution>(geometry: Geometry) -> &'static FacetTable {
        static TABLES: [[OnceLock<FacetTable>; Geometry::ALL.len()]; Facets::COUNT] =
            [const { [const { OnceLock::new() }; Geometry::ALL.len()] }; Facets::COUNT];
        TABLES[D::FACETS as usize][geometry as usize].get_or_init(|| FacetTable::build::<D>(geometry))
    }

    /// Integrates the distribution at all places of the table; takes some 40 to 60 ms on one thread, for grooves at most four times that.
    pub fn build<D: Distribution>(geometry: Geometry) -> Self {
        // The shadowing of grooves has edges, over which few nodes are up to 4e-3 off.
        let finer = if geometry == Geometry::VGroove { 2 } else { 1 };
        let (along, across) = (gauss_legendre(20 * finer, 0.0, 1.0), gauss_legendre(14 * finer, 0.0, 1.0));
        let mut cells = Vec::with_capacity(WIDTHS * COSINES);
        let mut points = Vec::with_capacity(along.len() * across.len());
        for i in 0..WIDTHS {
            let alpha = width_at(i as f32 / (WIDTHS - 1) as f32);
            let distribution = D::new(Widths { x: alpha, y: alpha });
            for j in 0..COSINES {
                let cos = cosine_at(j as f32 / (COSINES - 1) as f32, alpha);
                points.clear();
                facets(&distribution, geometry, [alpha, cos], [&along, &across], |om, _, weight| {
                    points.push(Node { x: om, weight });
                });
                let rule: [Node; NODES] = gauss_rule(&points);
                let mut cell = [0.0; 2 * NODES];
                for k in 0..NODES {
                    cell[k] = (rule[k].weight * (rule[k].x - f64::from(cos))) as f32;
                    cell[NODES + k] = rule[k].weight as f32;
                }
                let quad = |q: usize| Vec4::from_slice(&cell[4 * q..4 * q + 4]);
                cells.push([quad(0), quad(1), quad(2)]);
            }
        }
        FacetTable { cells }
    }

    /// The albedo of a width at a cosine under a Fresnel term.
    ///
    /// Domain: alpha 1e-3..1, cosine 0..1. Gives: 0..1.
    #[inline(always)]
    pub fn color<F: Fresnel>(&self, fresnel: &F, alpha: f32, cos: f32) -> Vec3 {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let (column, by_column) = cubic(cosine_axis(cos, alpha), COSINES);
        let (row, [a, b, c, d]) = (around(row, WIDTHS), around(column, COSINES));
        let (a, b) = (self.over_widths(row, by_row, a), self.over_widths(row, by_row, b));
        let (c, d) = (self.over_widths(row, by_row, c), self.over_widths(row, by_row, d));
        let [p, q, r] = blend([&a, &b, &c, &d], by_column);
        let (p, q, r) = (p.to_array(), q.to_array(), r.to_array());
        // Two empty nodes fill a vector, so that the terms are computed side by side; they are added in the order of a row.
        let moments = [p[0], p[1], p[2], p[3], q[0], q[1], 0.0, 0.0];
        let weights = [q[2], q[3], r[0], r[1], r[2], r[3], 0.0, 0.0];
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            let part = term(fresnel, cos, (moments[k], weights[k]));
            (x[k], y[k], z[k]) = (part.x, part.y, part.z);
        }
        let mut sum = Vec3::ZERO;
        for k in 0..NODES {
            sum += Vec3::new(x[k], y[k], z[k]);
        }
        sum.clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// The cells of one width, 1e-3..1.
    #[inline(always)]
    pub fn row(&self, alpha: f32) -> Row {
        let (row, by_row) = cubic(width_axis(alpha), WIDTHS);
        let row = around(row, WIDTHS);
        let mut cells = [[Vec4::ZERO; QUADS]; COSINES];
        for (j, cell) in cells.iter_mut().enumerate() {
            *cell = self.over_widths(row, by_row, j);
        }
        Row { alpha, cells }
    }

    /// The cell of one cosine between four widths.
    #[inline(always)]
    fn over_widths(&self, row: [usize; 4], by_row: [f32; 4], j: usize) -> Cell {
        let [a, b, c, d] = row;
        let cells = &self.cells;
        let four = [&cells[a * COSINES + j], &cells[b * COSINES + j], &cells[c * COSINES + j], &cells[d * COSINES + j]];
        blend(four, by_row)
    }
}

/// Which of so many places comes next before `place` (0..1), and the weights of it and three around it: one before, two behind.
///
/// Source: Catmull and Rom 1974; at the ends a parabola goes on.
#[inline(always)]
pub(super) fn cubic(place: f32, count: usize) -> (u32, [f32; 4]) {
    let last = count as u32 - 2;
    let x = (place * (count - 1) as f32).clamp(0.0, (count - 1) as f32);
    let i = floor_and_rest(x).0.min(last);
    let f = x - i as i32 as f32;
    let (f2, f3) = (f * f, f * f * f);
    let w = [f2 - 0.5 * (f3 + f), 1.5 * f3 - 2.5 * f2 + 1.0, 2.0 * f2 - 1.5 * f3 + 0.5 * f, 0.5 * (f3 - f2)];
    let (first, last) = (select(i == 0, w[0], 0.0), select(i == last, w[3], 0.0));
    let inner = [w[0] - first + last, w[1] + 3.0 * (first - last), w[2] - 3.0 * (first - last), w[3] - last + first];
    (i, inner)
}

/// The four places that [`cubic`] weighs.
#[inline(always)]
pub(super) fn around(i: u32, count: usize) -> [usize; 4] {
    let i = (i as usize).min(count - 2);
    [i.max(1) - 1, i, i + 1, (i + 2).min(count - 1)]
}

/// The width at a place of the axis, by bisection.
pub(super) fn width_at(place: f32) -> f32 {
    let (mut low, mut high) = (LEAST, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if width_axis(middle) < place {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// A viewer over stretched facets, in the plane of the normal and the viewer.
struct Stretched {
    alpha: f64,
    cos: f64,
    sin: f64,
    /// Sine and cosine of the stretched viewer.
    view: [f64; 2],
}

impl Stretched {
    /// The facet whose unstretched normal lies `across` the plane and, in it, at `along` from the stretched viewer; with o.m
    /// and the cosine of the reflected direction.
    fn facet(&self, along: f64, across: f64) -> ([f64; 3], f64, f64) {
        let in_plane = (1.0 - across * across).max(0.0).sqrt();
        let toward = (1.0 - along * along).max(0.0).sqrt();
        // The direction at right angles to the stretched viewer is (cos, -sin): it leads down to the horizon.
        let x = self.alpha * in_plane * (toward * self.view[0] + along * self.view[1]);
        let z = in_plane * (toward * self.view[1] - along * self.view[0]);
        let y = self.alpha * across;
        let scale = 1.0 / (x * x + y * y + z * z).max(1e-300).sqrt();
        let m = [x * scale, y * scale, z * scale];
        let om = self.sin * m[0] + self.cos * m[2];
        (m, om, 2.0 * om * m[2] - self.cos)
    }

    /// Where on a chord the facet reflects highest, and how high.
    ///
    /// Source: golden section; the cosine has one maximum, and is below the horizon at both ends.
    fn highest(&self, across: f64) -> (f64, f64) {
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let up = |along: f64| self.facet(along, across).2;
        let (mut low, mut high) = (-1.0, self.view[1]);
        let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let (mut up_a, mut up_b) = (up(a), up(b));
        for _ in 0..10 {
            if up_a < up_b {
                (low, a, up_a) = (a, b, up_b);
                b = low + GOLDEN * (high - low);
                up_b = up(b);
            } else {
                (high, b, up_b) = (b, a, up_a);
                a = high - GOLDEN * (high - low);
                up_a = up(a);
            }
        }
        if up_a < up_b { (b, up_b) } else { (a, up_a) }
    }

    /// The interval of `along` in which facets reflect above the horizon, if there is one.
    fn lit(&self, across: f64) -> Option<[f64; 2]> {
        let (top, height) = self.highest(across);
        let edge = |place: &dyn Fn(f64) -> f64, [mut dark, mut light]: [f64; 2]| {
            for _ in 0..13 {
                let middle = 0.5 * (dark + light);
                if self.facet(place(middle), across).2 > 0.0 {
                    light = middle;
                } else {
                    dark = middle;
                }
            }
            place(light)
        };
        // At the rim o.m rises like a root, and grooves reflect most where it is smallest.
        let rim = |s: f64| s * s - 1.0;
        (height > 0.0).then(|| [edge(&rim, [0.0, (top + 1.0).sqrt()]), edge(&|along| along, [self.view[1], top])])
    }
}

/// The measure of cosines o.m, and of those of the light, as points with weights, whose sum is the albedo of a full mirror.
///
/// Source: visible normals of GGX are the projection of a hemisphere (Heitz 2018, "Sampling the GGX Distribution of Visible
/// Normals"), integrated by chords of the disc; each weighs G2 / G1 and the ratio of the distributions.
pub(super) fn facets<D: Distribution>(
    d: &D,
    geometry: Geometry,
    [alpha, cos]: [f32; 2],
    rules: [&[Node]; 2],
    mut point: impl FnMut(f64, f64, f64),
) {
    let ggx = Ggx(Widths { x: alpha, y: alpha });
    let (alpha, c) = (f64::from(alpha), f64::from(cos));
    let sin = ((1.0 - c) * (1.0 + c)).max(0.0).sqrt();
    let length = (alpha * alpha * sin * sin + c * c).sqrt();
    let stretched = Stretched { alpha, cos: c, sin, view: [alpha * sin / length, c / length] };
    let viewer = Vec3::new(sin as f32, 0.0, cos);
    let (lambda, masking) = (d.lambda(viewer), f64::from(1.0 + ggx.lambda(viewer)));
    // Half the disc's visible part; the other half is its mirror image.
    let area = 0.25 * std::f64::consts::PI * (1.0 + stretched.view[1]);
    // Chords far from the middle may have no facet that reflects above the horizon.
    let (mut light, mut dark) = (0.0, 1.0);
    for _ in 0..9 {
        let middle = 0.5 * (light + dark);
        if stretched.highest(middle).1 > 0.0 {
            light = middle;
        } else {
            dark = middle;
        }
    }
    for chord in rules[1] {
        // Slow at the rim, where chords shrink like a square root; so are the chords' ends.
        let (q, p) = (chord.x, chord.weight);
        let across = 0.5 * q * (3.0 - q * q) * dark;
        let width = p * 1.5 * (1.0 - q * q) * dark * (1.0 - across * across).max(0.0).sqrt() / area;
        let Some([from, to]) = stretched.lit(across) else { continue };
        for node in rules[0] {
            let t = node.x;
            let along = from + (to - from) * t * t * (3.0 - 2.0 * t);
            let (m, om, up) = stretched.facet(along, across);
            let z = (up as f32).clamp(1e-12, 1.0);
            let light = Vec3::new(((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z);
            let facet = Vec3::new(m[0] as f32, m[1] as f32, m[2] as f32);
            let lambdas = [f64::from(lambda), f64::from(d.lambda(light))];
            let shadowing = masking * geometry.part(lambdas, [c, up.max(0.0)], om, m[2]);
            let ratio = f64::from(d.d(facet) / ggx.d(facet).max(1e-30));
            let weight = width * node.weight * 6.0 * t * (1.0 - t) * (to - from) * shadowing * ratio;
            point(om.clamp(0.0, 1.0), up.clamp(0.0, 1.0), weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_the_bits_of_its_table() {
        use crate::bsdf::fresnel::{Conductor, Dielectric};
        use crate::bsdf::params;
        let table = FacetTable::build::<Ggx>(Geometry::Smith);
        let glass = Dielectric::prepare(params([1.5]), 0);
        let metal = Conductor::prepare(params([0.16, 0.42, 1.45, 3.5, 2.4, 1.9]), 0);
        for alpha in [1e-3, 0.0173, 0.3, 0.77, 1.0] {
            let row = table.row(alpha);
            for first in 0..20 {
                let cos = std::array::from_fn(|l| (first * BLOCK + l) as f32 / 159.0);
                let ([one, ..], three) = (row.colors(&glass, &cos), row.colors(&metal, &cos));
                for l in 0..BLOCK {
                    let limit = |x: f32| x.clamp(0.0, 1.0).to_bits();
                    assert_eq!(limit(one[l]), table.color(&glass, alpha, cos[l]).x.to_bits(), "{alpha} {}", cos[l]);
                    let color = table.color(&metal, alpha, cos[l]).to_array();
                    let row = [three[0][l], three[1][l], three[2][l]];
                    assert_eq!(row.map(limit), color.map(f32::to_bits), "{alpha} {}", cos[l]);
                }
            }
        }
    }

    #[test]
    fn axes_run_from_end_to_end() {
        assert!((width_at(0.0) - LEAST).abs() < 1e-8 && (width_at(1.0) - 1.0).abs() < 1e-6);
        assert!((cosine_axis(1.0, 0.3) - 1.0).abs() < 1e-6 && cosine_axis(0.0, 0.3) == 0.0);
    }
}
