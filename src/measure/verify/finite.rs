//! Finiteness: numbers that are numbers and not negative, from every direction to every other.

use super::finding::{Check, Finding, Verdict};
use super::laws::cosine;
use super::subject::Scatterer;
use super::view::View;
use crate::closure::{Evaluation, Samples, event};
use crate::math::columns::Column3;
use crate::measure::sphere::LANES;
use crate::measure::statistics::Random;
use glam::Vec3;

/// Cosines of view, down to where a float hardly tells it from the horizon.
const COSINES: [f64; 8] = [1.0, 0.7, 0.2, 0.01, 1e-4, 1e-6, 1e-10, 0.0];
/// Batches of samples a view.
const BATCHES: usize = 4;

/// Looks for anything that is no number, infinite or negative.
pub fn finite(scatterer: &mut dyn Scatterer, random: &mut Random) -> Finding {
    let (mut bad, mut first) = (0.0, None);
    for (k, cos) in COSINES.into_iter().enumerate() {
        let view = View { cos, azimuth: 0.7 * k as f64 };
        scatterer.look(&Column3::splat(view.wo(), LANES));
        let mut tell = |what: String| {
            bad += 1.0;
            first.get_or_insert_with(|| (cosine(cos), what));
        };
        evaluations(scatterer, view.wo(), random, &mut tell);
        samples(scatterer, random, &mut tell);
    }
    if let Some(complaint) = scatterer.complaint() {
        bad += 1.0;
        first.get_or_insert((String::new(), complaint));
    }
    let verdict = if bad == 0.0 { Verdict::Pass } else { Verdict::Fail };
    let (place, note) = first.unwrap_or_default();
    Finding { check: Check::Finite, verdict, value: bad, severity: bad, bound: "none is bad".to_owned(), place, note }
}

fn good(value: f32) -> bool {
    value.is_finite() && value >= 0.0
}

/// Directions that tend to break formulas, and random ones.
fn directions(wo: Vec3, random: &mut Random) -> Column3 {
    let (up, side) = (Vec3::Z, Vec3::new(wo.x, wo.y, 0.0).normalize_or(Vec3::X));
    let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
    let special = [wo, -wo, mirror, -mirror, up, -up, side, -side, Vec3::new(side.y, -side.x, 0.0)];
    let mut out = Column3::zeros(LANES);
    for lane in 0..LANES {
        let cos = match lane % 4 {
            0 => random.number(),
            1 => -random.number(),
            2 => 10f32.powf(-12.0 * random.number()),
            _ => -(10f32.powf(-12.0 * random.number())),
        };
        let azimuth = std::f64::consts::TAU * f64::from(random.number());
        let any = View { cos: f64::from(cos), azimuth }.wo();
        out.set(lane, special.get(lane).copied().unwrap_or(any));
    }
    out
}

fn evaluations(scatterer: &mut dyn Scatterer, wo: Vec3, random: &mut Random, tell: &mut impl FnMut(String)) {
    let (wi, mut out) = (directions(wo, random), Evaluation::default());
    scatterer.evaluate(&wi, &mut out);
    for lane in 0..LANES {
        let (w, f_cos, pdf) = (wi.get(lane), out.f_cos.get(lane), out.pdf[lane]);
        if !f_cos.to_array().into_iter().chain([pdf]).all(good) {
            tell(format!("f cos {f_cos}, pdf {pdf} toward {w}"));
        }
    }
}

fn samples(scatterer: &mut dyn Scatterer, random: &mut Random, tell: &mut impl FnMut(String)) {
    const LAST: f32 = 0.999_999_94;
    let (mut xi, mut out) = (Column3::zeros(LANES), Samples::default());
    for _ in 0..BATCHES {
        for lane in 0..LANES {
            let mut number = |bit: usize| match lane >> (2 * bit) & 3 {
                0 if lane < 64 => 0.0,
                1 if lane < 64 => LAST,
                _ => random.number(),
            };
            xi.set(lane, Vec3::new(number(0), number(1), number(2)));
        }
        scatterer.sample(&xi, &mut out);
        for lane in 0..LANES {
            let (wi, weight, pdf) = (out.wi.get(lane), out.weight.get(lane), out.pdf[lane]);
            let unit = out.event[lane] == event::NONE || (wi.length() - 1.0).abs() < 1e-3;
            if !unit || !wi.is_finite() || !weight.to_array().into_iter().chain([pdf]).all(good) {
                tell(format!("a sample of weight {weight}, pdf {pdf} toward {wi}, for the numbers {}", xi.get(lane)));
            }
        }
    }
}
