//! Closures as the engine runs them: a shader's text flattened to lobes, evaluated and sampled in batches.

use super::race::Runner;
use crate::closure::{Evaluation, Lobes, Samples, Settings};
use crate::exec::{Group, MAX_LANES, Machine, Points};
use crate::math::columns::Column3;
use crate::math::warp::uniform_hemisphere;
use crate::measure::statistics::Random;
use glam::Vec3;
use std::hint::black_box;

/// The lanes of a batch that is timed.
pub const LANES: usize = MAX_LANES;

/// Compiles a surface shader whose text is one of ours.
pub fn group(text: &str) -> Result<Group, String> {
    let shader = crate::compile::compile(text).map_err(|error| error.to_string())?;
    shader.group().keep_outputs().build().map_err(|error| error.to_string())
}

/// Points of a flat surface.
pub fn points(lanes: usize) -> Points {
    let mut points = Points::new(lanes);
    for lane in 0..lanes {
        let at = lane as f32 / MAX_LANES as f32;
        (points.u[lane], points.v[lane]) = (at, (at * 7.0).fract());
        points.p.set(lane, Vec3::new(at, points.v[lane], 1.0));
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
    }
    points
}

/// Directions above the horizon, the same for every method.
pub fn hemisphere(lanes: usize, seed: u64) -> Column3 {
    let mut random = Random(seed);
    let mut out = Column3::zeros(lanes);
    (0..lanes).for_each(|lane| out.set(lane, uniform_hemisphere(random.number(), random.number())));
    out
}

/// The lobes of a shader seen from many directions.
pub fn lobes(text: &str, settings: Settings, lanes: usize) -> Result<Lobes, String> {
    let group = group(text)?;
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &points(lanes));
    let mut lobes = Lobes::new(settings);
    lobes.flatten(group.library(), tree, &hemisphere(lanes, 1), &Column3::splat(Vec3::Z, lanes));
    Ok(lobes)
}

/// Times the evaluation of all lobes.
pub fn evaluation(mut lobes: Lobes, lanes: usize) -> Runner<'static> {
    let (wi, mut out) = (hemisphere(lanes, 2), Evaluation::default());
    Runner::new(lanes, move || {
        lobes.evaluate(black_box(&wi), &mut out);
        black_box(&out);
    })
}

/// Times a sample with its weight.
pub fn sampling(mut lobes: Lobes, lanes: usize) -> Runner<'static> {
    let mut random = Random(3);
    let (mut xi, mut out) = (Column3::zeros(lanes), Samples::default());
    (0..lanes).for_each(|lane| xi.set(lane, Vec3::new(random.number(), random.number(), random.number())));
    Runner::new(lanes, move || {
        lobes.sample(black_box(&xi), &mut out);
        black_box(&out);
    })
}

/// Times a shader alone.
pub fn shading(group: Group, lanes: usize) -> Runner<'static> {
    let (points, mut machine) = (points(lanes), Machine::new());
    Runner::new(lanes, move || {
        black_box(machine.shade(&group, black_box(&points)));
    })
}
