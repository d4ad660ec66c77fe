//! Text to lobes: a batch of points is shaded, and its lobes are evaluated and sampled for all of them at once.
//!
//! `cargo run --release --example evaluate_lobes` prints a line for each viewer.

use std::error::Error;
use velour::closure::{Evaluation, Lobes, Samples, Settings};
use velour::exec::{Machine, Points};
use velour::glam::Vec3;
use velour::math::columns::Column3;

const SHADER: &str =
    "surface cloth(float r = 0.3) { Ci = sheen(color(0.6, 0.05, 0.05) * diffuse(N), N, color(1), r); }";
const LANES: usize = 6;

fn main() -> Result<(), Box<dyn Error>> {
    let group = velour::compile::compile(SHADER)?.group().param("r", &[0.4]).build()?;
    // One point of a plane, seen from the zenith in the first lane and from the side in the last.
    let (mut points, mut wo) = (Points::new(LANES), Column3::zeros(LANES));
    for lane in 0..LANES {
        let height = 1.0 - lane as f32 / LANES as f32;
        wo.set(lane, Vec3::new((1.0 - height * height).sqrt(), 0.0, height));
        points.i.set(lane, -wo.get(lane));
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
    }
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &points);
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(group.library(), tree, &wo, &points.ng);

    let (mut evaluation, mut samples) = (Evaluation::default(), Samples::default());
    lobes.evaluate(&Column3::splat(Vec3::new(0.6, 0.0, 0.8), LANES), &mut evaluation);
    lobes.sample(&Column3::splat(Vec3::new(0.3, 0.5, 0.7), LANES), &mut samples);
    for lane in 0..LANES {
        let (f_cos, pdf) = (evaluation.f_cos.get(lane), evaluation.pdf[lane]);
        let (cos, wi, weight) = (wo.get(lane).z, samples.wi.get(lane), samples.weight.get(lane));
        println!("viewer cos {cos:.2}: f cos {f_cos:.3}, pdf {pdf:.3}; sampled {wi:.3} of weight {weight:.3}");
    }
    Ok(())
}
