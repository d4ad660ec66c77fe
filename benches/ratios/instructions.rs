//! Chains of instructions, against the same arithmetic as one loop over lanes and as compiled code a point at a time.

use super::Table;
use super::hand::{Batch, N};
use multiversion::multiversion;
use std::hint::black_box;
use velour::math::elementary as e;
use velour::ops::arithmetic::{div, min, sqrt};

const TEN: &str = "shader ten(float k = 0.3, output float result = 0) {
    float a = u + k; float b = a * u; float c = b - k; float d = a / c; float e = min(d, c);
    float f = sqrt(e); float g = f * a + b; float h = floor(g); float i = exp(-f); result = i * h + g; }";

const ROUNDS: &str = "shader rounds(output float result = 0) {
    float x = u, y = v;
    for (int j = 0; j < 10; ++j) {
        float a = x + y; float b = a * x; float c = b - y; float d = a / c; float e = min(d, c);
        float f = sqrt(e); float g = f * a + b; float h = floor(g); float i = exp(-f);
        x = i * h + 0.1 * g; y = x * 0.5 + v; }
    result = x; }";

/// The elementary functions of this library, or (`LIBM`) of the standard one, which cannot become SIMD.
#[inline(always)]
fn exp<const LIBM: bool>(x: f32) -> f32 {
    if LIBM { x.exp() } else { e::exp(x) }
}

#[inline(always)]
fn floor<const LIBM: bool>(x: f32) -> f32 {
    if LIBM { x.floor() } else { e::floor(x) }
}

#[inline(always)]
fn ten<const LIBM: bool>(u: f32, _v: f32) -> f32 {
    const K: f32 = 0.3;
    let a = u + K;
    let b = a * u;
    let c = b - K;
    let f = sqrt(min(div(a, c), c));
    let g = f * a + b;
    exp::<LIBM>(-f) * floor::<LIBM>(g) + g
}

#[inline(always)]
fn rounds<const LIBM: bool>(u: f32, v: f32) -> f32 {
    let (mut x, mut y) = (u, v);
    for _ in 0..10 {
        let a = x + y;
        let b = a * x;
        let c = b - y;
        let f = sqrt(min(div(a, c), c));
        let g = f * a + b;
        x = exp::<LIBM>(-f) * floor::<LIBM>(g) + 0.1 * g;
        y = x * 0.5 + v;
    }
    x
}

/// Loops over lanes and over points.
macro_rules! loops {
    ($($lanes:ident $points:ident $function:ident;)*) => {$(
        #[multiversion(targets("x86_64+avx2"))]
        fn $lanes(u: &[f32], v: &[f32], out: &mut [f32]) {
            let (u, v) = (&u[..N], &v[..N]);
            for (i, out) in out.iter_mut().enumerate() {
                *out = $function::<false>(u[i], v[i]);
            }
        }
        #[multiversion(targets("x86_64+avx2"))]
        fn $points(u: &[f32], v: &[f32], out: &mut [f32]) {
            let (u, v) = (&u[..N], &v[..N]);
            for (i, out) in out.iter_mut().enumerate() {
                // What passes a black box is a point of its own, which no compiler can join with its neighbours.
                let (u, v) = black_box((u[i], v[i]));
                *out = $function::<true>(u, v);
            }
        }
    )*};
}

loops! {
    ten_lanes ten_points ten;
    rounds_lanes rounds_points rounds;
}

type Loop = fn(&[f32], &[f32], &mut [f32]);

/// Prints the rows.
pub fn rows(table: &Table) {
    let cases: [(&str, &str, Loop, Loop, &str); 2] = [
        ("chain of 10", TEN, ten_lanes, ten_points, "<= 8.7 ns (a third of OSL batched, a tenth of OSL: 10.2)"),
        ("loop of 110", ROUNDS, rounds_lanes, rounds_points, "<= 31 ns (a third of OSL batched, a tenth of OSL: 42.5)"),
    ];
    for (limit, scalar) in [("fused lanes", false), ("scalar", true)] {
        table.head("instructions", limit);
        for (name, text, lanes, points, bar) in cases {
            let what = format!("{name}, {limit}");
            let mut batch = Batch::new(text);
            let (u, v, mut out) = (batch.points.u.clone(), batch.points.v.clone(), vec![0.0; N]);
            let by_hand = if scalar { points } else { lanes };
            by_hand(&u, &v, &mut out);
            table.time(
                &what,
                (&mut || batch.shade(), N),
                (&mut || by_hand(black_box(&u), black_box(&v), black_box(&mut out)), N),
                bar,
            );
        }
    }
}
