//! What the rows share: points, shaders, directions, and lobes as one loop over lanes.

use glam::Vec3;
use std::hint::black_box;
use velour::bsdf::Scatter;
use velour::closure::{Evaluation, Lobes, Settings};
use velour::compile::Compiler;
use velour::exec::{Group, MAX_LANES, Machine, Points};
use velour::lanes;
use velour::math::columns::Column3;
use velour::math::frame::Frame;
use velour::math::warp::uniform_hemisphere;
use velour::measure::statistics::Random;

/// Lanes of a batch.
pub const N: usize = MAX_LANES;

/// Compiles a shader's text, with all of its outputs.
pub fn group(text: &str) -> Group {
    let shader = Compiler::new().compile("bench.osl", text).unwrap_or_else(|e| panic!("{e}"));
    shader.group().keep_outputs().build().unwrap_or_else(|e| panic!("{e}"))
}

/// A batch of points on the plane z = 1, whose normals look up.
pub fn points() -> Points {
    let mut points = Points::new(N);
    for lane in 0..N {
        let at = lane as f32 / N as f32;
        points.u[lane] = at + 0.01;
        points.v[lane] = (at * 7.0 + 0.02).fract();
        points.p.set(lane, Vec3::new(at, points.v[lane], 1.0));
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
    }
    points
}

/// Numbers in [0, 1), three a lane.
pub fn numbers(seed: u64) -> Column3 {
    let mut random = Random(seed);
    let mut out = Column3::zeros(N);
    for lane in 0..N {
        out.set(lane, Vec3::new(random.number(), random.number(), random.number()));
    }
    out
}

/// Directions on the upper hemisphere.
pub fn directions(seed: u64) -> Column3 {
    let (xi, mut out) = (numbers(seed), Column3::zeros(N));
    for lane in 0..N {
        out.set(lane, uniform_hemisphere(xi.x[lane], xi.y[lane]));
    }
    out
}

/// A shaded and flattened batch.
pub struct Batch {
    /// The shaders.
    pub group: Group,
    /// The points.
    pub points: Points,
    /// The machine that ran them.
    pub machine: Machine,
    /// The lobes.
    pub lobes: Lobes,
    /// The viewers.
    pub wo: Column3,
}

impl Batch {
    /// Shades and flattens a text.
    pub fn new(text: &str) -> Self {
        let (group, points, machine) = (group(text), points(), Machine::new());
        let (lobes, wo) = (Lobes::new(Settings::default()), directions(1));
        let mut batch = Batch { group, points, machine, lobes, wo };
        batch.flatten();
        batch
    }

    /// Runs the shader alone.
    pub fn shade(&mut self) {
        black_box(self.machine.shade(&self.group, black_box(&self.points)));
    }

    /// Runs the shader and flattens its tree.
    pub fn flatten(&mut self) {
        let tree = self.machine.shade(&self.group, black_box(&self.points));
        self.lobes.flatten(self.group.library(), tree, &self.wo, &self.points.ng);
    }

    /// The largest difference of an evaluation to columns that should equal it.
    pub fn differs(&mut self, wi: &Column3, f_cos: &[f32], pdf: &[f32]) -> f32 {
        let mut out = Evaluation::default();
        self.lobes.evaluate(wi, &mut out);
        let worst = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        worst(&out.f_cos.x, f_cos).max(worst(&out.pdf, pdf))
    }
}

/// A direction's columns.
pub type Columns<'a> = [&'a [f32]; 3];

/// Borrows columns, unknown to the optimizer.
pub fn columns(w: &Column3) -> Columns<'_> {
    let w = black_box(w);
    [&w.x, &w.y, &w.z]
}

/// The columns cut to a length, so that no index is checked in a loop.
#[inline(always)]
pub fn cut(w: Columns<'_>, n: usize) -> Columns<'_> {
    [&w[0][..n], &w[1][..n], &w[2][..n]]
}

/// The triple of a lane.
#[inline(always)]
pub fn at(w: Columns<'_>, i: usize) -> Vec3 {
    Vec3::new(w[0][i], w[1][i], w[2][i])
}

/// What a model derives from its viewers, five columns.
pub fn views<M: Scatter>(model: M, wo: &Column3) -> [Vec<f32>; 5] {
    std::array::from_fn(|k| (0..N).map(|lane| model.view(wo.get(lane))[k]).collect())
}

/// What a loop over lanes reads: everything that differs between points, as a renderer has it.
pub struct World {
    /// Viewers in the world, and in the frames.
    pub wo: [Column3; 2],
    /// Tangents, bitangents, shading normals and geometric normals.
    pub axes: [Column3; 4],
    /// What the model derives from the viewers.
    pub view: [Vec<f32>; 5],
    /// Weights of the lobe.
    pub weight: Column3,
}

impl World {
    /// Lobes of weight 1 on a plane.
    pub fn new<M: Scatter>(model: M, wo: &Column3) -> Self {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z].map(|axis| Column3::splat(axis, N));
        World { wo: [wo.clone(), wo.clone()], axes, view: views(model, wo), weight: Column3::splat(Vec3::ONE, N) }
    }
}

lanes! {
    /// One lobe as one loop, from world directions to color times cosine and density. Light that crosses the geometric surface is
    /// cut off.
    pub fn evaluate<M: Scatter>(model: M, world: &World, wi: Columns<'_>, out: [&mut [f32]; 3], pdf: &mut [f32]) {
        let n = pdf.len();
        let [x, y, z] = out;
        let (x, y, z, wi) = (&mut x[..n], &mut y[..n], &mut z[..n], cut(wi, n));
        let [outside, wo, weight] = [of(&world.wo[0], n), of(&world.wo[1], n), of(&world.weight, n)];
        let [t, b, s, g] = [of(&world.axes[0], n), of(&world.axes[1], n), of(&world.axes[2], n), of(&world.axes[3], n)];
        let v = &world.view;
        let v = [&v[0][..n], &v[1][..n], &v[2][..n], &v[3][..n], &v[4][..n]];
        for i in 0..n {
            let w = at(wi, i);
            let local = Vec3::new(w.dot(at(t, i)), w.dot(at(b, i)), w.dot(at(s, i)));
            let ng = at(g, i);
            let visible = ng.dot(w) * 1f32.copysign(ng.dot(at(outside, i))) > 0.0;
            let value = model.eval_from(at(wo, i), [v[0][i], v[1][i], v[2][i], v[3][i], v[4][i]], local);
            let f_cos = if visible { value.f_cos } else { 0.0 };
            (x[i], y[i], z[i]) = (weight[0][i] * f_cos, weight[1][i] * f_cos, weight[2][i] * f_cos);
            pdf[i] = value.pdf;
        }
    }
}

/// Borrows columns of a length.
#[inline(always)]
fn of(w: &Column3, n: usize) -> Columns<'_> {
    [&w.x[..n], &w.y[..n], &w.z[..n]]
}

lanes! {
    /// One lobe of weight 1 as one loop: a direction in the world, its density and its weight.
    pub fn sample<M: Scatter>(
        model: M,
        frame: Frame,
        view: &[Vec<f32>; 5],
        wo: Columns<'_>,
        xi: Columns<'_>,
        wi: [&mut [f32]; 3],
        weight: &mut [f32],
        pdf: &mut [f32],
    ) {
        let n = weight.len();
        let (wo, xi, pdf) = (cut(wo, n), cut(xi, n), &mut pdf[..n]);
        let [x, y, z] = wi;
        let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
        let (a, b, c, d, e) = (&view[0][..n], &view[1][..n], &view[2][..n], &view[3][..n], &view[4][..n]);
        for i in 0..n {
            let seen = [a[i], b[i], c[i], d[i], e[i]];
            let local = model.sample_from(at(wo, i), seen, at(xi, i));
            let value = model.eval_from(at(wo, i), seen, local);
            let world = frame.to_world(local);
            (x[i], y[i], z[i]) = (world.x, world.y, world.z);
            let good = value.pdf > 0.0;
            weight[i] = if good { value.f_cos / value.pdf.max(f32::MIN_POSITIVE) } else { 0.0 };
            pdf[i] = if good { value.pdf } else { 0.0 };
        }
    }
}
