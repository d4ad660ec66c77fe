//! Lambda, the auxiliary function of Smith's shadowing: the published fit and ways to compute the exact one.

use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::lanes::{Curve, curve_lanes};
use super::race::{Cost, Laps, MEDIANS, Runner, race};
use super::truth::ROUGHNESSES;
use crate::bsdf::sheen::reference::lambda_by_area;
use crate::bsdf::sheen::shadowing::{Exact, Published, Series};
use std::hint::black_box;

/// Lanes that are timed.
const LANES: usize = 128;
/// The roughness that is timed.
const TIMED: f64 = 0.3;

impl Curve for Exact {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        self.lambda(cos)
    }
}

impl Curve for Published {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        self.lambda(cos)
    }
}

impl Curve for Series {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        self.lambda(cos)
    }
}

/// The closed form summed term by term.
#[derive(Clone, Copy)]
struct Sum<const TERMS: u32> {
    n: f32,
}

impl<const TERMS: u32> Curve for Sum<TERMS> {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        let u = (1.0 - cos) * (1.0 + cos);
        let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
        for _ in 0..TERMS {
            term *= (k - 0.5) * (k - 0.5 * self.n) / ((k + 1.0) * (k + 1.0)) * u;
            sum += term;
            k += 1.0;
        }
        0.5 * (sum / cos - 1.0)
    }
}

/// The closed form summed in double precision until the terms vanish.
#[derive(Clone, Copy)]
struct Doubles {
    n: f64,
}

impl Curve for Doubles {
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        let cos = f64::from(cos);
        (0.5 * (crate::bsdf::sheen::reference::exact_f(cos, self.n) / cos - 1.0)) as f32
    }
}

/// A method with what makes it for one roughness.
type Method = (&'static str, fn(f64) -> Box<Evaluate>);
/// Gives Lambda of many cosines.
type Evaluate = dyn Fn(&[f32], &mut [f32]);

fn boxed<C: Curve + 'static>(curve: C) -> Box<Evaluate> {
    Box::new(move |x, out| curve_lanes(curve, x, out))
}

const METHODS: [Method; 8] = [
    ("published fit", |r| boxed(Published::new(r as f32))),
    ("exact, fitted (default)", |r| boxed(Exact::new(1.0 / r as f32))),
    ("exact, Chebyshev series", |r| boxed(Series::new(1.0 / r as f32))),
    ("closed form, 8 terms", |r| boxed(Sum::<8> { n: 1.0 / r as f32 })),
    ("closed form, 16 terms", |r| boxed(Sum::<16> { n: 1.0 / r as f32 })),
    ("closed form, 32 terms", |r| boxed(Sum::<32> { n: 1.0 / r as f32 })),
    ("closed form, 128 terms", |r| boxed(Sum::<128> { n: 1.0 / r as f32 })),
    ("closed form, f64", |r| boxed(Doubles { n: 1.0 / r })),
];

/// Cosines from 0.02 to 0.98, where the error of Lambda is stated.
fn cosines(count: usize) -> Vec<f64> {
    (0..count).map(|k| 0.02 + 0.96 * k as f64 / (count - 1) as f64).collect()
}

/// The largest relative error of every method over roughnesses and cosines.
fn errors(roughnesses: &[f64], cosines: &[f64]) -> [f64; METHODS.len()] {
    let x: Vec<f32> = cosines.iter().map(|c| *c as f32).collect();
    let mut worst = [0.0; METHODS.len()];
    let mut out = vec![0.0; x.len()];
    for &r in roughnesses {
        let truth: Vec<f64> = x.iter().map(|c| lambda_by_area(f64::from(*c), f64::from(r as f32))).collect();
        for ((_, method), worst) in METHODS.iter().zip(&mut worst) {
            method(f64::from(r as f32))(&x, &mut out);
            for (value, truth) in out.iter().zip(&truth) {
                *worst = f64::max(*worst, (f64::from(*value) / truth - 1.0).abs());
            }
        }
    }
    worst
}

fn costs(laps: Laps) -> Vec<Cost> {
    let x: Vec<f32> = (0..LANES).map(|k| 0.02 + 0.96 * k as f32 / LANES as f32).collect();
    let mut runners: Vec<Runner> = METHODS
        .iter()
        .map(|(_, method)| {
            let (method, x, mut out) = (method(TIMED), x.clone(), vec![0.0; LANES]);
            Runner::new(LANES, move || {
                method(black_box(&x), &mut out);
                black_box(&out);
            })
        })
        .collect();
    race(&mut runners, laps)
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let errors = errors(&ROUGHNESSES, &cosines(effort.cosines));
    let costs = costs(effort.laps);
    let points: Vec<Point> = METHODS
        .iter()
        .zip(costs)
        .zip(errors)
        .map(|(((name, _), cost), error)| Point::new("", name, cost, error))
        .collect();
    Ok(Figure {
        name: "lambda",
        title: "Lambda of the sheen: cost against error".to_owned(),
        cost: format!("ns a direction, {LANES} lanes at a time"),
        error: "largest relative error of Lambda".to_owned(),
        meaning: format!(
            "{MEDIANS} Error: the largest relative error of Lambda for roughness 0.06 to 1 and cosines 0.02 to 0.98, against \
                  the projected area of the micronormals integrated in f64, which uses no closed form. The closed form is \
                  c (1 + 2 Lambda) = 2F1(-1/2, -1/(2r); 1; 1 - c²)."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
