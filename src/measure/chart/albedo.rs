//! The directional albedo of the sheen: polynomials, tables and direct integration.

use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::lanes::{Curve, curve_lanes};
use super::race::{MEDIANS, Runner, race};
use super::tables::{Axes, Interpolation, Table, nodes};
use super::truth::{ROUGHNESSES, albedos, cosines, viewer};
use crate::bsdf::sheen::albedo::{AlbedoCurve, FIT_METHOD, LONG_METHOD, SHORT_METHOD, SheenAlbedo};
use crate::bsdf::sheen::reference::Model;
use crate::bsdf::sheen::{EXACT, Sheen};
use crate::bsdf::{Scatter, params};
use glam::Vec3;
use std::hint::black_box;
use std::sync::Arc;

const LANES: usize = 128;

#[derive(Clone, Copy)]
struct Polynomial<const METHOD: u8>(AlbedoCurve);

impl<const METHOD: u8> Curve for Polynomial<METHOD> {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        self.0.by::<METHOD>(cos)
    }
}

#[derive(Clone, Copy)]
struct Lookup<'a>(&'a Table, f32, Interpolation);

impl Curve for Lookup<'_> {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        self.0.at(cos, self.1, self.2)
    }
}

/// The rational quadratic of MaterialX (mx_microfacet_sheen), for Charlie's D with Ashikhmin's visibility.
#[derive(Clone, Copy)]
struct Rational(f32);

impl Curve for Rational {
    #[inline(always)]
    fn at(&self, c: f32) -> f32 {
        let r = self.0;
        let above =
            13.673 - 68.780_18 * c + 799.088_26 * r - 905.000_6 * c * r + 60.289_56 * c * c + 1_086.964_7 * r * r;
        let below = 1.0 + 61.577_46 * c + 442.782_1 * r + 2_597.493 * c * r + 121.812_41 * c * c + 3_045.550_8 * r * r;
        (above / below).clamp(0.0, 1.0)
    }
}

#[derive(Clone, Copy)]
struct Integral<'a>(Sheen<EXACT, true>, &'a [(Vec3, f32)]);

impl Curve for Integral<'_> {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
        let view = self.0.view(wo);
        self.1.iter().map(|(wi, weight)| weight * self.0.eval_from(wo, view, *wi).f_cos).sum()
    }
}

/// Gives the albedos of many cosines for one roughness.
type Evaluate = dyn Fn(f32, &[f32], &mut [f32]);

/// A method: its model, its name, and what gives albedos of many cosines for one roughness.
struct Method {
    model: Model,
    name: String,
    run: Box<Evaluate>,
}

fn method(model: Model, name: impl Into<String>, run: impl Fn(f32, &[f32], &mut [f32]) + 'static) -> Method {
    Method { model, name: name.into(), run: Box::new(run) }
}

/// Everything that can tell an albedo.
fn methods(effort: &Effort) -> Vec<Method> {
    let mut list = Vec::new();
    list.push(method(Model::ExactFit, "polynomial 5 x 5 (short)", |r, x, out| {
        curve_lanes(Polynomial::<SHORT_METHOD>(AlbedoCurve::exact(SheenAlbedo::Short, true, r)), x, out);
    }));
    list.push(method(Model::ExactFit, "polynomial 9 x 7 (default)", |r, x, out| {
        curve_lanes(Polynomial::<FIT_METHOD>(AlbedoCurve::exact(SheenAlbedo::Fit, true, r)), x, out);
    }));
    list.push(method(Model::ExactFit, "polynomial 13 x 13 (long)", |r, x, out| {
        curve_lanes(Polynomial::<LONG_METHOD>(AlbedoCurve::exact(SheenAlbedo::Long, true, r)), x, out);
    }));
    let mut table = Table::new(effort.cells, Axes::Bent, effort.steps);
    let mut cells = effort.cells;
    while cells >= 8 {
        let shared = Arc::new(table.clone());
        for (how, name) in [
            (Interpolation::Nearest, "nearest"),
            (Interpolation::Bilinear, "linear"),
            (Interpolation::Bicubic, "cubic"),
        ] {
            let shared = Arc::clone(&shared);
            list.push(method(Model::ExactFit, format!("table {cells}, {name}"), move |r, x, out| {
                curve_lanes(Lookup(&shared, shared.row(r), how), x, out);
            }));
        }
        table = table.halved();
        cells /= 2;
    }
    let plain = Table::new(32, Axes::Plain, effort.steps);
    list.push(method(Model::ExactFit, "table 32, linear, plain axes", move |r, x, out| {
        curve_lanes(Lookup(&plain, plain.row(r), Interpolation::Bilinear), x, out);
    }));
    for count in [4, 8, 16, 32] {
        let nodes = nodes(count);
        list.push(method(Model::ExactFit, format!("integral, {count} x {count}"), move |r, x, out| {
            curve_lanes(Integral(Sheen::prepare(params([r])), &nodes), x, out);
        }));
    }
    list.push(method(Model::Ashikhmin, "MaterialX's fit (of its own model)", |r, x, out| {
        curve_lanes(Rational(r), x, out)
    }));
    list
}

/// The largest error of every method.
fn errors(methods: &[Method], effort: &Effort) -> Vec<f64> {
    let cosines = cosines(effort.cosines);
    let x: Vec<f32> = cosines.iter().map(|c| viewer(*c).z).collect();
    let truth = |model, soft| albedos(model, soft, &ROUGHNESSES, &cosines, effort.steps);
    let (exact, ashikhmin) = (truth(Model::ExactFit, true), truth(Model::Ashikhmin, false));
    let mut out = vec![0.0; x.len()];
    let mut worst = vec![0.0f64; methods.len()];
    for (method, worst) in methods.iter().zip(&mut worst) {
        let truth = if method.model == Model::Ashikhmin { &ashikhmin } else { &exact };
        for (row, r) in truth.iter().zip(ROUGHNESSES) {
            (method.run)(r as f32, &x, &mut out);
            for (value, truth) in out.iter().zip(row) {
                *worst = worst.max((f64::from(*value) - truth.min(1.0)).abs());
            }
        }
    }
    worst
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let methods = methods(effort);
    let errors = errors(&methods, effort);
    let x: Vec<f32> = (0..LANES).map(|k| 0.005 + 0.99 * k as f32 / LANES as f32).collect();
    let mut runners: Vec<Runner> = methods
        .iter()
        .map(|method| {
            let (x, mut out) = (x.clone(), vec![0.0; LANES]);
            Runner::new(LANES, move || {
                (method.run)(black_box(0.3), &x, &mut out);
                black_box(&out);
            })
        })
        .collect();
    let costs = race(&mut runners, effort.laps);
    drop(runners);
    let points: Vec<Point> = methods
        .iter()
        .zip(costs)
        .zip(errors)
        .map(|((method, cost), error)| {
            let group = method.name.split([' ', ',']).next().unwrap_or_default();
            Point::new(if method.model == Model::Ashikhmin { "polynomial" } else { group }, &method.name, cost, error)
        })
        .collect();
    Ok(Figure {
        name: "albedo",
        title: "Directional albedo of the sheen: cost against error".to_owned(),
        cost: format!("ns an albedo, {LANES} lanes of one roughness at a time"),
        error: "largest error of the albedo".to_owned(),
        meaning: format!(
            "{MEDIANS} Error: the largest difference from the directional albedo integrated in f64 (softened exact term, F = 1, with the fitted Lambda, which is 7e-5 of the longest polynomial's error) for \
                  roughness 0.06 to 1 and cosines 1e-4 to 1. Tables have that many cells in the cube root of the cosine \
                  and half as many in the logarithm of roughness, or in cosine and roughness themselves (plain axes). \
                  The rational fit of MaterialX is held against its own model, Charlie's D with Ashikhmin's visibility, cut at 1."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
