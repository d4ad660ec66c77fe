//! Precision: the sheen's formula in single and in double precision, with short and with general powers.

use super::closures;
use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::{MEDIANS, Runner, race};
use super::truth::viewer;
use crate::bsdf::sheen::reference::{self, Model};
use crate::bsdf::sheen::shadowing::Exact;
use crate::bsdf::sheen::{EXACT, Sheen};
use crate::bsdf::{Scatter, params};
use crate::lanes;
use crate::math::columns::Column3;
use crate::math::elementary::pow;
use glam::Vec3;
use std::hint::black_box;

/// f cos of two directions.
trait Lobe: Copy {
    fn at(&self, wo: Vec3, wi: Vec3) -> f64;
}

/// As the engine has it.
#[derive(Clone, Copy)]
struct Engine(Sheen<EXACT, true>);

impl Lobe for Engine {
    #[inline(always)]
    fn at(&self, wo: Vec3, wi: Vec3) -> f64 {
        f64::from(self.0.eval(wo, wi).f_cos)
    }
}

/// Single precision with powers that serve all numbers; `HALF` takes the sine of the half vector from its cosine.
#[derive(Clone, Copy)]
struct General<const HALF: bool> {
    n: f32,
    exact: Exact,
}

impl<const HALF: bool> Lobe for General<HALF> {
    #[inline(always)]
    fn at(&self, wo: Vec3, wi: Vec3) -> f64 {
        let h = wo + wi;
        let length2 = h.dot(h);
        let sin2 = if HALF { 1.0 - h.z * h.z / length2 } else { (h.x * h.x + h.y * h.y) / length2 };
        let d = (2.0 + self.n) / std::f32::consts::TAU * pow(sin2.max(0.0), 0.5 * self.n);
        let x = 1.0 - wi.z;
        let light = pow(self.exact.lambda(wi.z), 1.0 + 2.0 * pow(x, 8.0));
        f64::from(d / (4.0 * wo.z * (1.0 + light + self.exact.lambda(wo.z))))
    }
}

/// Double precision by the library's powers.
#[derive(Clone, Copy)]
struct Doubles(f64);

impl Lobe for Doubles {
    #[inline(always)]
    fn at(&self, wo: Vec3, wi: Vec3) -> f64 {
        let wide = |w: Vec3| w.to_array().map(f64::from);
        reference::f(Model::ExactFit, true, wide(wo), wide(wi), self.0) * f64::from(wi.z)
    }
}

lanes! {
    fn lobe_lanes<L: Lobe>(lobe: L, wo: &Column3, wi: &Column3, out: &mut [f64]) {
        let n = out.len();
        let (ox, oy, oz) = (&wo.x[..n], &wo.y[..n], &wo.z[..n]);
        let (ix, iy, iz) = (&wi.x[..n], &wi.y[..n], &wi.z[..n]);
        for k in 0..n {
            out[k] = lobe.at(Vec3::new(ox[k], oy[k], oz[k]), Vec3::new(ix[k], iy[k], iz[k]));
        }
    }
}

type Run = Box<dyn Fn(&Column3, &Column3, &mut [f64])>;

fn boxed<L: Lobe + 'static>(lobe: L) -> Run {
    Box::new(move |wo, wi, out| lobe_lanes(lobe, wo, wi, out))
}

const NAMES: [&str; 4] =
    ["f32, short powers (the engine)", "f32, general powers", "f32, D from the cosine", "f64, library powers"];

fn methods(r: f64) -> [Run; 4] {
    let n = 1.0 / r as f32;
    let exact = Exact::new(n);
    [
        boxed(Engine(Sheen::prepare(params([r as f32])))),
        boxed(General::<false> { n, exact }),
        boxed(General::<true> { n, exact }),
        boxed(Doubles(f64::from(r as f32))),
    ]
}

/// The largest relative error where f cos exceeds 1e-6, over random pairs and pairs near the mirror direction.
fn errors() -> [f64; 4] {
    let lanes = 2048;
    let (mut wo, mut wi) = (closures::hemisphere(lanes, 5), closures::hemisphere(lanes, 6));
    for lane in (0..lanes).step_by(3) {
        let o = viewer(0.05 + 0.9 * lane as f64 / lanes as f64);
        let offset = wi.get(lane) * (1e-3 + 0.1 * (lane as f32 / lanes as f32));
        wo.set(lane, o);
        wi.set(lane, (Vec3::new(-o.x, -o.y, o.z) + offset).normalize());
    }
    let wide = |w: Vec3| w.to_array().map(f64::from);
    let (mut worst, mut out) = ([0.0f64; 4], vec![0.0; lanes]);
    for r in [0.06, 0.15, 0.4, 1.0] {
        for (run, worst) in methods(r).iter().zip(&mut worst) {
            run(&wo, &wi, &mut out);
            for lane in 0..lanes {
                let (o, i) = (wo.get(lane), wi.get(lane));
                // The formula in double precision, and at the last digit of r, is the truth for all.
                let truth = reference::f(Model::ExactFit, true, wide(o), wide(i), f64::from(r as f32)) * f64::from(i.z);
                if truth > 1e-6 && o.z > 1e-4 && i.z > 1e-4 {
                    *worst = worst.max((out[lane] / truth - 1.0).abs());
                }
            }
        }
    }
    worst
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let (wo, wi) = (closures::hemisphere(closures::LANES, 1), closures::hemisphere(closures::LANES, 2));
    let mut runners: Vec<Runner> = methods(0.3)
        .into_iter()
        .map(|run| {
            let (wo, wi, mut out) = (wo.clone(), wi.clone(), vec![0.0; closures::LANES]);
            Runner::new(closures::LANES, move || {
                run(black_box(&wo), &wi, &mut out);
                black_box(&out);
            })
        })
        .collect();
    let costs = race(&mut runners, effort.laps);
    let points: Vec<Point> =
        NAMES.iter().zip(costs).zip(errors()).map(|((name, cost), error)| Point::new("", name, cost, error)).collect();
    Ok(Figure {
        name: "precision",
        title: "Precision of the sheen's formula: cost against error".to_owned(),
        cost: format!("ns an evaluation, {} lanes at a time", closures::LANES),
        error: "largest relative error of f cos".to_owned(),
        meaning: format!(
            "{MEDIANS} Error: the largest relative error of f cos where it exceeds 1e-6, against the same formula in f64, over 2048 \
                  random pairs of directions, a third of them near the mirror direction, for roughness 0.06 to 1. The f64 \
                  row is that formula itself, so its error is 0 by definition."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
