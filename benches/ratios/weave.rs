//! The woven cloth of `shaders/weave.osl`: pattern alone, with closure tree and lobes, and with an evaluation.

use super::Table;
use super::hand::{Batch, Columns, N, columns, cut, directions};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};
use std::hint::black_box;
use velour::bsdf::oren_nayar::OrenNayar;
use velour::bsdf::sheen::{EXACT, Sheen};
use velour::bsdf::{Scatter, View, params};
use velour::closure::Evaluation;
use velour::lanes;
use velour::math::elementary as e;
use velour::math::frame::Frame;
use velour::math::noise::{Endless, perlin::perlin3};

/// The shader's text.
pub const SHADER: &str = include_str!("../../shaders/weave.osl");
const WARP: Vec3 = Vec3::new(0.55, 0.12, 0.1);
const WEFT: Vec3 = Vec3::new(0.1, 0.12, 0.45);
const TINT: f32 = 0.8;

/// What a point's lobes need: what flattening gives, for one point.
#[derive(Clone, Copy)]
struct Lobes {
    thread: Vec3,
    roughness: f32,
    frame: Frame,
    wo: Vec3,
    view: View,
    alpha_o: f32,
    picks: [f32; 2],
}

/// Numbers that [`Lobes`] come to as columns.
const COLUMNS: usize = 3 + 1 + 9 + 3 + 5 + 1 + 2;

#[inline(always)]
fn floor<const LIBM: bool>(x: f32) -> f32 {
    if LIBM { x.floor() } else { e::floor(x) }
}

/// The color and roughness of a point.
#[inline(always)]
fn pattern<const LIBM: bool>(p: Vec3, u: f32, v: f32) -> (Vec3, f32) {
    let (s, t) = (u * 40.0, v * 40.0);
    let (row, column) = (floor::<LIBM>(s), floor::<LIBM>(t));
    let sum = row + column;
    let above = sum - 2.0 * floor::<LIBM>(sum * 0.5) < 1.0;
    let octave = |f: f32| perlin3::<0>(Endless, p.x * f, p.y * f, p.z * f).value;
    let uneven = octave(8.0) + 0.5 * octave(16.0) + 0.25 * octave(32.0);
    let angle = PI * if above { s - row } else { t - column };
    let height = if LIBM { angle.sin() } else { e::sin(angle) };
    let shade = 0.7 + 0.3 * height + 0.15 * uneven;
    let pick = |a: f32, b: f32| shade * if above { a } else { b };
    let thread = Vec3::new(pick(WARP.x, WEFT.x), pick(WARP.y, WEFT.y), pick(WARP.z, WEFT.z));
    let r = 0.3 + 0.2 * uneven;
    (thread, r.clamp(0.06, 1.0))
}

#[inline(always)]
fn luminance(c: Vec3) -> f32 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// The lobes of a point.
#[inline(always)]
fn lobes(thread: Vec3, roughness: f32, normal: Vec3, wo: Vec3) -> Lobes {
    let frame = Frame::from_normal(normal);
    let wo = frame.to_local(wo);
    let sheen = Sheen::<EXACT, true>::prepare(params([roughness]));
    let albedo = sheen.albedo(wo.z);
    let alpha_o = (1.0 - TINT * albedo).max(0.0);
    let base = OrenNayar::prepare(params([0.4])).albedo(wo.z);
    let (over, under) = (TINT * albedo, luminance(thread) * base * alpha_o);
    let inverse = 1.0 / (over + under).max(1e-30);
    Lobes { thread, roughness, frame, wo, view: sheen.view(wo), alpha_o, picks: [over * inverse, under * inverse] }
}

/// f cos and density of a point's lobes.
#[inline(always)]
fn evaluate(lobes: Lobes, wi: Vec3) -> (Vec3, f32) {
    let wi = lobes.frame.to_local(wi);
    let sheen = Sheen::<EXACT, true>::prepare(params([lobes.roughness]));
    let top = sheen.eval_from(lobes.wo, lobes.view, wi);
    let base = OrenNayar::prepare(params([0.4])).eval(lobes.wo, wi);
    let scale = (1.0 - TINT * sheen.albedo(wi.z)).min(lobes.alpha_o) * base.f_cos;
    let f_cos = Vec3::splat(TINT * top.f_cos) + lobes.thread * scale;
    (f_cos, lobes.picks[0] * top.pdf + lobes.picks[1] * wi.z.max(0.0) * FRAC_1_PI)
}

/// What a loop reads.
#[derive(Clone, Copy)]
struct Points<'a> {
    p: Columns<'a>,
    uv: [&'a [f32]; 2],
    normal: Columns<'a>,
    wo: Columns<'a>,
    wi: Columns<'a>,
}

/// Points to a block: of a fixed length, for the loop to become SIMD.
const BLOCK: usize = 16;

/// Numbers of a block, by column.
type Block = [[f32; BLOCK]; COLUMNS];

/// How far a loop goes.
const PATTERN: u8 = 0;
const LOBES: u8 = 1;

/// One point to its place in a block: the color and roughness, the lobes, or the light they scatter.
#[inline(always)]
fn point<const LIBM: bool, const STAGE: u8>(from: [Vec3; 4], [u, v]: [f32; 2], lane: usize, out: &mut Block) {
    let [p, normal, wo, wi] = from;
    let (thread, roughness) = pattern::<LIBM>(p, u, v);
    if STAGE == PATTERN {
        let color = thread * roughness;
        (out[0][lane], out[1][lane], out[2][lane]) = (color.x, color.y, color.z);
        return;
    }
    let all = lobes(thread, roughness, normal, wo);
    if STAGE != LOBES {
        let (f, pdf) = evaluate(all, wi);
        (out[0][lane], out[1][lane], out[2][lane], out[3][lane]) = (f.x, f.y, f.z, pdf);
        return;
    }
    let Frame { tangent: t, bitangent: b, normal: n } = all.frame;
    (out[0][lane], out[1][lane], out[2][lane]) = (thread.x, thread.y, thread.z);
    (out[3][lane], out[4][lane], out[5][lane]) = (t.x, t.y, t.z);
    (out[6][lane], out[7][lane], out[8][lane]) = (b.x, b.y, b.z);
    (out[9][lane], out[10][lane], out[11][lane]) = (n.x, n.y, n.z);
    (out[12][lane], out[13][lane], out[14][lane]) = (all.wo.x, all.wo.y, all.wo.z);
    (out[15][lane], out[16][lane], out[17][lane]) = (all.view[0], all.view[1], all.view[2]);
    (out[18][lane], out[19][lane]) = (all.view[3], all.view[4]);
    (out[20][lane], out[21][lane]) = (roughness, all.alpha_o);
    (out[22][lane], out[23][lane]) = (all.picks[0], all.picks[1]);
}

lanes! {
    /// The same as one loop over lanes, or (`LIBM`) over points.
    fn run<const LIBM: bool, const STAGE: u8>(from: Points<'_>, out: &mut [Block]) {
        let [p, normal, wo, wi] = [cut(from.p, N), cut(from.normal, N), cut(from.wo, N), cut(from.wi, N)];
        let uv = [&from.uv[0][..N], &from.uv[1][..N]];
        for (block, out) in out[..N / BLOCK].iter_mut().enumerate() {
            let first = BLOCK * block;
            let mut x = [[0.0; BLOCK]; 14];
            let inputs =
                [p[0], p[1], p[2], normal[0], normal[1], normal[2], wo[0], wo[1], wo[2], wi[0], wi[1], wi[2], uv[0], uv[1]];
            for (to, column) in x.iter_mut().zip(inputs) {
                to.copy_from_slice(&column[first..first + BLOCK]);
            }
            for l in 0..BLOCK {
                let mut triples = [
                    Vec3::new(x[0][l], x[1][l], x[2][l]),
                    Vec3::new(x[3][l], x[4][l], x[5][l]),
                    Vec3::new(x[6][l], x[7][l], x[8][l]),
                    Vec3::new(x[9][l], x[10][l], x[11][l]),
                ];
                let mut uv = [x[12][l], x[13][l]];
                if LIBM {
                    (triples, uv) = black_box((triples, uv));
                }
                point::<LIBM, STAGE>(triples, uv, l, out);
            }
        }
    }
}

/// The shader without its closures, as peers were timed that refuse those.
fn without_closures() -> String {
    SHADER.lines().filter(|line| !line.trim_start().starts_with("Ci =")).collect::<Vec<_>>().join("\n")
}

/// Compares the engine's pattern and light with the loop's.
fn check(batch: &mut Batch, from: Points, wi: &velour::math::columns::Column3, out: &mut Vec<Block>) {
    batch.flatten();
    let mut light = Evaluation::default();
    batch.lobes.evaluate(wi, &mut light);
    run::<false, 2>(from, out);
    for lane in 0..N {
        let (f, pdf) = (out[lane / BLOCK][1][lane % BLOCK], out[lane / BLOCK][3][lane % BLOCK]);
        assert!((light.f_cos.y[lane] - f).abs() < 1e-4, "another weave: {} and {f} in {lane}", light.f_cos.y[lane]);
        assert!((light.pdf[lane] - pdf).abs() < 1e-3, "another density: {} and {pdf} in {lane}", light.pdf[lane]);
    }
}

/// Prints the rows of one limit; `bars` are for the pattern and for the rest.
fn stages<const LIBM: bool>(table: &Table, limit: &str, from: Points, bars: [&str; 2]) {
    let (mut plain, mut batch) = (Batch::new(&without_closures()), Batch::new(SHADER));
    let (wi, mut light) = (directions(2), Evaluation::default());
    let mut out: Vec<Block> = vec![[[0.0; BLOCK]; COLUMNS]; N / BLOCK];
    check(&mut batch, from, &wi, &mut out);
    table.head("weave of three noises", limit);
    let what = |stage: &str| format!("weave, {stage}, {limit}");
    let by_hand = &mut || run::<LIBM, PATTERN>(black_box(from), &mut out);
    table.time(&what("pattern"), (&mut || plain.shade(), N), (by_hand, N), bars[0]);
    let by_hand = &mut || run::<LIBM, LOBES>(black_box(from), &mut out);
    table.time(&what("to lobes"), (&mut || batch.flatten(), N), (by_hand, N), bars[1]);
    let by_hand = &mut || run::<LIBM, 2>(black_box(from), &mut out);
    let evaluated = &mut || {
        batch.flatten();
        batch.lobes.evaluate(black_box(&wi), &mut light);
    };
    table.time(&what("evaluated"), (evaluated, N), (by_hand, N), bars[1]);
}

/// Prints the rows.
pub fn rows(table: &Table) {
    let batch = Batch::new(SHADER);
    let (points, wo, wi) = (&batch.points, &batch.wo, directions(2));
    let from = Points {
        p: columns(&points.p),
        uv: [&points.u, &points.v],
        normal: columns(&points.n),
        wo: columns(wo),
        wi: columns(&wi),
    };
    stages::<false>(table, "by hand", from, ["<= 1.5; <= 15.2 ns (a tenth of OSL)", "<= 1.5"]);
    stages::<true>(table, "scalar", from, ["<= 0.33"; 2]);
}
