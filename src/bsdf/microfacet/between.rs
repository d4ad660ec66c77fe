//! Light that bounces between the facets of a boundary that only reflects.
//!
//! Decision (2026-11-29): this lobe of its own beside the single-scattering one, because it is reciprocal, has its own way of
//! sampling, and a boundary whose facets lose next to nothing does without it; instead of scaling the whole lobe by its white
//! albedo (Turquin 2019), which is not reciprocal and tints what was reflected once.

use super::arrivals::ArrivalTable;
use super::distribution::{MIN_ALPHA, Widths};
use super::geometry::{Facets, Geometry};
use super::white::WhiteTable;
use crate::bsdf::fresnel::{Fresnel, limited};
use crate::bsdf::{Arrivals, Choice, Eval, Params, Scatter, Spread, View, select, unknown_arrivals};
use crate::math::quadrature::GAUSS_8;
use crate::math::warp::cosine_hemisphere;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// The choice of a distribution and its shadowing term, for [`Between`].
pub fn choice(facets: Facets, geometry: Geometry) -> Choice {
    Choice(geometry as u8 + 3 * facets as u8)
}

/// What facets reflect more than once.
///
/// Parameters: widths along x and y, and those of the Fresnel term. Choice: [`choice`].
/// Source: Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks": F_ms (1 - E_o)(1 - E_i) / (pi (1 - E_avg)),
/// with F_ms = F_avg² E_avg / (1 - F_avg (1 - E_avg)).
/// Domain: widths clamped to 1e-3..1. Gives: f cos in 1/sr; with the single-scattering lobe a white boundary has albedo 1.
/// Departs from source: where the two widths differ, E is the larger one of two round boundaries', of the width in the
/// direction's azimuth and of the geometric mean, and up to a tenth of the rest stays lost, so that no direction gains.
#[derive(Clone, Copy, Debug)]
pub struct Between<F> {
    width: [f32; 2],
    fresnel: F,
    facets: Facets,
    geometry: Geometry,
}

impl<F: Fresnel> Between<F> {
    /// 1 - E toward a direction.
    #[inline(always)]
    fn lost(&self, table: &WhiteTable, w: Vec3) -> f32 {
        let ([x, y], cos) = (self.width, w.z.abs().min(1.0));
        if x == y {
            return table.lost(x, cos);
        }
        let widths = Widths { x, y };
        widths.given_back() * table.lost(widths.toward(w), cos).min(table.lost((x * y).sqrt(), cos))
    }

    /// The mean of 1 - E, or a little more.
    #[inline(always)]
    fn mean_lost(&self, table: &WhiteTable) -> f32 {
        let [x, y] = self.width;
        Widths { x, y }.given_back() * table.mean_lost((x * y).sqrt())
    }

    /// The color of what leaves in the end.
    #[inline(always)]
    fn color(&self, mean_lost: f32) -> Vec3 {
        let mut mean = Vec3::ZERO;
        for (x, weight) in GAUSS_8 {
            for cos in [0.5 - 0.5 * x, 0.5 + 0.5 * x] {
                mean += self.fresnel.color(cos) * (weight * cos);
            }
        }
        let mean = mean.clamp(Vec3::ZERO, Vec3::ONE);
        mean * mean * (1.0 - mean_lost) / (Vec3::ONE - mean * mean_lost).max(Vec3::splat(1e-6))
    }
}

impl<F: Fresnel> Scatter for Between<F> {
    const PARAMS: usize = 2 + F::PARAMS;
    const SPREAD: Spread = Spread::Narrow;
    const COLORED: bool = F::COLORED;
    const VIEW: usize = 4;
    const TOP: bool = true;
    const ARRIVALS: bool = true;

    #[inline(always)]
    fn prepare(params: Params) -> Self {
        let width = [limited(params[0], MIN_ALPHA, 1.0), limited(params[1], MIN_ALPHA, 1.0)];
        Between { width, fresnel: F::prepare(params, 2), facets: Facets::Ggx, geometry: Geometry::Smith }
    }

    #[inline(always)]
    fn choose(self, Choice(number): Choice) -> Self {
        let geometry = Geometry::numbered(number);
        let facets = match number / 3 {
            0 => Facets::Ggx,
            1 => Facets::Beckmann,
            _ => Facets::Blinn,
        };
        Between { facets, geometry, ..self }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let table = WhiteTable::of(self.facets, self.geometry);
        let mean_lost = self.mean_lost(table);
        let color = self.color(mean_lost);
        let scale = FRAC_1_PI * self.lost(table, wo) / mean_lost;
        [scale, color.x, color.y, color.z, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let table = WhiteTable::of(self.facets, self.geometry);
        let lit = wi.z > 0.0 && wo.z > 0.0;
        let part = if F::COLORED { 1.0 } else { view[1] };
        let f_cos = view[0] * self.lost(table, wi) * wi.z * part;
        Eval { f_cos: select(lit, f_cos, 0.0), pdf: select(lit, wi.z * FRAC_1_PI, 0.0) }
    }

    #[inline(always)]
    fn color_from(&self, _wo: Vec3, view: View, _wi: Vec3) -> Vec3 {
        if F::COLORED { Vec3::new(view[1], view[2], view[3]) } else { Vec3::ONE }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        cosine_hemisphere(xi.x, xi.y)
    }

    /// The same toward all directions, of which more or fewer lie lower. Of stretched facets nothing is known.
    fn arrivals(&self, cos: f32) -> Arrivals {
        match self.width {
            [x, y] if x == y => ArrivalTable::between(self.facets, self.geometry).at(x, cos),
            _ => unknown_arrivals(cos),
        }
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.top_albedo(Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos))
    }

    /// Exact where the widths are equal: F_ms (1 - E).
    #[inline(always)]
    fn top_albedo(&self, w: Vec3) -> f32 {
        let table = WhiteTable::of(self.facets, self.geometry);
        self.color(self.mean_lost(table)).max_element() * self.lost(table, w)
    }

    /// Where both widths are equal, color and row are found once.
    #[inline(always)]
    fn top_albedos(&self, [x, y, z]: [&[f32]; 3], out: &mut [f32]) {
        let n = out.len();
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        let table = WhiteTable::of(self.facets, self.geometry);
        let color = self.color(self.mean_lost(table)).max_element();
        if self.width[0] == self.width[1] {
            let row = table.row(self.width[0]);
            for i in 0..n {
                out[i] = color * row.lost(z[i].abs().min(1.0));
            }
            return;
        }
        for i in 0..n {
            out[i] = color * self.lost(table, Vec3::new(x[i], y[i], z[i]));
        }
    }
}
