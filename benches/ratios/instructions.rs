//! Chains of instructions, against the same arithmetic as one loop over lanes and as compiled code a point at a time.

use super::Table;
use super::hand::{Batch, N};
use std::hint::black_box;
use velour::lanes;
use velour::math::elementary as e;
use velour::ops::arithmetic::{div, min, sqrt};

/// Ten instructions in a row.
pub const TEN: &str = "shader ten(float k = 0.3, output float result = 0) {
    float a = u + k; float b = a * u; float c = b - k; float d = a / c; float e = min(d, c);
    float f = sqrt(e); float g = f * a + b; float h = floor(g); float i = exp(-f); result = i * h + g; }";

/// Ten rounds of eleven instructions.
pub const ROUNDS: &str = "shader rounds(output float result = 0) {
    float x = u, y = v;
    for (int j = 0; j < 10; ++j) {
        float a = x + y; float b = a * x; float c = b - y; float d = a / c; float e = min(d, c);
        float f = sqrt(e); float g = f * a + b; float h = floor(g); float i = exp(-f);
        x = i * h + 0.1 * g; y = x * 0.5 + v; }
    result = x; }";

/// Lanes that are computed together.
const BLOCK: usize = 16;

/// The elementary functions of this library, or (`LIBM`) of the standard one, which cannot become SIMD.
#[inline(always)]
fn exp<const LIBM: bool>(x: f32) -> f32 {
    if LIBM { x.exp() } else { e::exp(x) }
}

#[inline(always)]
fn floor<const LIBM: bool>(x: f32) -> f32 {
    if LIBM { x.floor() } else { e::floor(x) }
}

/// One round of either chain: `i`, `h` and `g`.
#[inline(always)]
fn round<const LIBM: bool>(a: f32, b: f32, c: f32) -> (f32, f32, f32) {
    let f = sqrt(min(div(a, c), c));
    let g = f * a + b;
    (exp::<LIBM>(-f), floor::<LIBM>(g), g)
}

/// The first chain over lanes or points that are kept apart.
#[inline(always)]
fn ten<const LIBM: bool>(u: &[f32; BLOCK], _v: &[f32; BLOCK], out: &mut [f32; BLOCK]) {
    for l in 0..BLOCK {
        // What passes a black box is a point of its own, which no compiler can join with its neighbours.
        let u = if LIBM { black_box(u[l]) } else { u[l] };
        let a = u + 0.3;
        let b = a * u;
        let (i, h, g) = round::<LIBM>(a, b, b - 0.3);
        out[l] = i * h + g;
    }
}

/// The second chain.
#[inline(always)]
fn rounds<const LIBM: bool>(u: &[f32; BLOCK], v: &[f32; BLOCK], out: &mut [f32; BLOCK]) {
    let step = |x: f32, y: f32, v: f32| {
        let a = x + y;
        let b = a * x;
        let (i, h, g) = round::<LIBM>(a, b, b - y);
        let x = i * h + 0.1 * g;
        (x, x * 0.5 + v)
    };
    if LIBM {
        for l in 0..BLOCK {
            let (u, v) = black_box((u[l], v[l]));
            let (mut x, mut y) = (u, v);
            for _ in 0..10 {
                (x, y) = step(x, y, v);
            }
            out[l] = x;
        }
        return;
    }
    let (mut x, mut y) = (*u, *v);
    for _ in 0..10 {
        for l in 0..BLOCK {
            (x[l], y[l]) = step(x[l], y[l], v[l]);
        }
    }
    *out = x;
}

/// Loops over blocks of lanes and of points.
macro_rules! loops {
    ($($name:ident $function:ident $libm:literal;)*) => {$(
        lanes! {
            fn $name(u: &[f32], v: &[f32], out: &mut [f32]) {
                let (u, v) = (u.as_chunks::<BLOCK>().0, v.as_chunks::<BLOCK>().0);
                for ((u, v), out) in u.iter().zip(v).zip(out.as_chunks_mut::<BLOCK>().0) {
                    $function::<$libm>(u, v, out);
                }
            }
        }
    )*};
}

loops! {
    ten_lanes ten false;
    ten_points ten true;
    rounds_lanes rounds false;
    rounds_points rounds true;
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
