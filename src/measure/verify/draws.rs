//! Drawing directions of a scatterer, with what each of them is worth.

use super::subject::Scatterer;
use crate::closure::{Evaluation, Samples, event};
use crate::math::columns::Column3;
use crate::measure::sphere::LANES;
use crate::measure::statistics::Random;
use glam::Vec3;

/// What came of a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// No direction: the light is absorbed.
    Lost,
    /// A direction of a lobe with a density.
    Spread,
    /// The direction of a lobe that has only one.
    Single,
}

/// One drawn direction.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Unit direction, zero for none.
    pub wi: Vec3,
    /// f |cos| / pdf.
    pub weight: Vec3,
    /// The density of the direction, lobes of one direction apart.
    pub pdf: f64,
    /// What came of it.
    pub kind: Kind,
    /// By how much, relatively, weight and density differ from what the evaluation of the direction says.
    pub mismatch: f64,
}

/// Draws about `count` directions of a scatterer that looks in [`LANES`] lanes.
///
/// `even` spreads the number that picks the lobe evenly, which leaves next to no noise in lobes of one direction.
pub fn draw(scatterer: &mut dyn Scatterer, count: usize, even: bool, random: &mut Random, mut take: impl FnMut(Draw)) {
    let (mut xi, mut samples, mut evaluation) = (Column3::zeros(LANES), Samples::default(), Evaluation::default());
    let batches = count.div_ceil(LANES);
    for batch in 0..batches {
        for lane in 0..LANES {
            let mut first = random.number();
            if even {
                first = ((batch * LANES + lane) as f32 + first) / (batches * LANES) as f32;
            }
            xi.set(lane, Vec3::new(first.min(0.999_999_94), random.number(), random.number()));
        }
        scatterer.sample(&xi, &mut samples);
        scatterer.evaluate(&samples.wi, &mut evaluation);
        for lane in 0..LANES {
            take(one(&samples, &evaluation, lane));
        }
    }
}

fn one(samples: &Samples, evaluation: &Evaluation, lane: usize) -> Draw {
    let (wi, weight) = (samples.wi.get(lane), samples.weight.get(lane));
    let (f_cos, pdf) = (evaluation.f_cos.get(lane), evaluation.pdf[lane]);
    let kind = match samples.event[lane] {
        event::DELTA_REFLECT | event::DELTA_REFRACT | event::STRAIGHT => Kind::Single,
        // A direction that was drawn and gives no light counts as absorbed, but it was drawn.
        event::NONE if wi == Vec3::ZERO || f_cos != Vec3::ZERO || pdf.is_nan() || pdf <= 0.0 => Kind::Lost,
        _ => Kind::Spread,
    };
    let mut mismatch = 0.0;
    if kind == Kind::Spread && samples.event[lane] != event::NONE {
        let worth = (weight.as_dvec3() * f64::from(samples.pdf[lane]) - f_cos.as_dvec3()).abs().max_element();
        // What is on the verge of zero has no digits to compare.
        let light = f64::from(f_cos.abs().max_element()).max(1e-20);
        let density = (f64::from(samples.pdf[lane]) - f64::from(pdf)).abs() / f64::from(pdf);
        mismatch = (worth / light).max(density);
        if mismatch.is_nan() {
            mismatch = f64::INFINITY;
        }
    }
    Draw { wi, weight, pdf: f64::from(pdf), kind, mismatch }
}
