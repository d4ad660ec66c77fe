//! Reciprocity: light takes the same way in both directions.

use super::finding::{Check, Finding, Verdict};
use super::laws::cosine;
use super::subject::{Promise, Scatterer};
use super::view::View;
use crate::closure::{Evaluation, Samples};
use crate::math::columns::Column3;
use crate::measure::sphere::LANES;
use crate::measure::statistics::Random;
use glam::Vec3;

/// How much f may change, relatively, when its directions are exchanged.
pub const RECIPROCITY: f64 = 2e-3;
/// Differences of f below this are rounding.
const FLOOR: f64 = 1e-5;
/// Directions nearer to the horizon are left out: dividing by their cosines would compare rounding errors.
const LEAST_COS: f32 = 0.02;

/// Compares f of random pairs, and of pairs that the sampler draws, with f of the same pairs exchanged.
pub fn reciprocity(
    scatterer: &mut dyn Scatterer,
    promise: Promise,
    batches: usize,
    random: &mut Random,
) -> Option<Finding> {
    let (mut worst, mut place, mut any) = (0.0, String::new(), false);
    let (mut there, mut back) = (Evaluation::default(), Evaluation::default());
    for batch in 0..batches {
        let wo = any_directions(random);
        scatterer.look(&wo);
        let mut wi = any_directions(random);
        if batch % 2 == 1 {
            drawn_directions(scatterer, random, &mut wi);
        }
        scatterer.evaluate(&wi, &mut there);
        scatterer.look(&wi);
        scatterer.evaluate(&wo, &mut back);
        for lane in 0..LANES {
            let (o, i) = (wo.get(lane), wi.get(lane));
            let there = there.f_cos.get(lane).as_dvec3() / f64::from(i.z);
            let back = back.f_cos.get(lane).as_dvec3() / f64::from(o.z);
            any |= there != glam::DVec3::ZERO || back != glam::DVec3::ZERO;
            for k in 0..3 {
                let off = ((there[k] - back[k]).abs() - FLOOR) / there[k].max(back[k]).max(FLOOR);
                if off > worst || off.is_nan() {
                    worst = off;
                    let turn = (o.truncate().angle_to(i.truncate())).to_degrees();
                    place = format!("{}, light cos {:.3}, {turn:.0} degrees apart", cosine(short(o.z)), short(i.z));
                }
            }
        }
    }
    let broken = worst.is_nan() || worst > RECIPROCITY;
    let (verdict, note) = match promise {
        Promise::Kept | Promise::Waived(_) | Promise::Open if !broken => (Verdict::Pass, String::new()),
        Promise::Kept => (Verdict::Fail, "f changes when its directions are exchanged".to_owned()),
        Promise::Waived(why) => (Verdict::Waived, why.to_owned()),
        Promise::Open => (Verdict::Info, "not reciprocal".to_owned()),
    };
    let bound = format!("<= {RECIPROCITY:e}");
    any.then_some(Finding { check: Check::Reciprocity, verdict, value: worst, severity: worst, bound, place, note })
}

/// A cosine as people read it.
fn short(cos: f32) -> f64 {
    (f64::from(cos) * 1000.0).round() / 1000.0
}

/// Directions above the surface.
fn any_directions(random: &mut Random) -> Column3 {
    let mut out = Column3::zeros(LANES);
    for lane in 0..LANES {
        let cos = LEAST_COS + (1.0 - LEAST_COS) * random.number();
        let azimuth = std::f64::consts::TAU * f64::from(random.number());
        out.set(lane, View { cos: f64::from(cos), azimuth }.wo());
    }
    out
}

/// Replaces directions by drawn ones where those lie above the surface: narrow lobes are met nowhere else.
fn drawn_directions(scatterer: &mut dyn Scatterer, random: &mut Random, wi: &mut Column3) {
    let (mut xi, mut samples) = (Column3::zeros(LANES), Samples::default());
    for lane in 0..LANES {
        xi.set(lane, Vec3::new(random.number(), random.number(), random.number()));
    }
    scatterer.sample(&xi, &mut samples);
    for lane in 0..LANES {
        let drawn = samples.wi.get(lane);
        if drawn.is_finite() && drawn.z >= LEAST_COS {
            wi.set(lane, drawn);
        }
    }
}
