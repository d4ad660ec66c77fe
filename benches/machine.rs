//! What shading costs: nanoseconds a point and an operation, from input columns to results, at the default batch width.
//!
//! Every figure is `Machine::shade` end to end. The last line of each name says how many operations a point takes.

use divan::counter::ItemsCount;
use std::sync::LazyLock;
use velour::compile::Compiler;
use velour::exec::{Group, MAX_LANES, Machine, Points};

fn main() {
    divan::main();
}

fn group(text: &str) -> Group {
    let shader = Compiler::new().compile("bench.osl", text).unwrap_or_else(|e| panic!("{e}"));
    shader.group().keep_outputs().build().unwrap_or_else(|e| panic!("{e}"))
}

fn points() -> Points {
    let mut points = Points::new(MAX_LANES);
    for lane in 0..MAX_LANES {
        let at = lane as f32 / MAX_LANES as f32;
        points.u[lane] = at;
        points.v[lane] = (at * 7.0).fract();
        points.p.x[lane] = at;
        points.p.y[lane] = points.v[lane];
        points.p.z[lane] = 1.0;
        points.n.z[lane] = 1.0;
    }
    points
}

/// Times one text; `operations` a point are counted as items, so that divan prints operations a second.
fn shade(bencher: divan::Bencher, group: &Group, operations: usize) {
    let points = points();
    let mut machine = Machine::new();
    machine.shade(group, &points);
    let count = ItemsCount::new(MAX_LANES * operations);
    bencher.counter(count).bench_local(|| {
        divan::black_box(machine.shade(group, divan::black_box(&points)));
    });
}

static TEN: LazyLock<Group> = LazyLock::new(|| {
    group(
        "shader ten(output float result = 0) {
            float a = u + 0.3; float b = a * u; float c = b - 0.3; float d = a / c; float e = min(d, c);
            float f = sqrt(e); float g = f * a + b; float h = floor(g); result = h * d; }",
    )
});

static LOOP: LazyLock<Group> = LazyLock::new(|| {
    group(
        "shader rounds(output float result = 0) {
            float x = u; float y = v;
            for (int k = 0; k < 10; ++k) {
                float a = x * y; float b = a + x; float c = b - y; float d = c / a; float e = max(c, d);
                float f = sqrt(e); float g = f * a + b; float h = floor(g); x = exp(-f) * h; y = x * 0.5 + v;
            }
            result = x; }",
    )
});

static PERLIN: LazyLock<Group> =
    LazyLock::new(|| group("shader perlin(output float result = 0) { result = noise(\"perlin\", P * 8); }"));

static WEAVE: LazyLock<Group> = LazyLock::new(|| {
    group(
        "surface weave(color warp = color(0.5, 0.1, 0.1), color weft = color(0.1, 0.1, 0.4), float scale = 50) {
            float s = u * scale; float t = v * scale;
            int top = mod(floor(s) + floor(t), 2.0) < 1.0;
            float rough = snoise(P * 8) + 0.5 * snoise(P * 16) + 0.25 * snoise(P * 32);
            float bend = top ? sin(M_PI * (s - floor(s))) : sin(M_PI * (t - floor(t)));
            color thread = (top ? warp : weft) * (0.7 + 0.3 * bend + 0.1 * rough);
            Ci = sheen(thread * diffuse(N), N, color(0.8), clamp(0.3 + 0.2 * rough, 0.05, 1.0)); }",
    )
});

/// Ten operations: `+ * - / min sqrt *+ floor *`.
#[divan::bench]
fn chain_of_10(bencher: divan::Bencher) {
    shade(bencher, &TEN, 10);
}

/// Ten rounds of thirteen.
#[divan::bench]
fn loop_of_130(bencher: divan::Bencher) {
    shade(bencher, &LOOP, 130);
}

/// One noise a point.
#[divan::bench]
fn perlin_3d(bencher: divan::Bencher) {
    shade(bencher, &PERLIN, 1);
}

/// One weave with its closures a point.
#[divan::bench]
fn procedural_weave(bencher: divan::Bencher) {
    shade(bencher, &WEAVE, 1);
}
