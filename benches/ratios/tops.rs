//! Albedo of what lies on top of something: evaluation with a layer, against the same lobes without it.

use super::Table;
use super::hand::{Batch, N, directions};
use std::hint::black_box;
use velour::closure::Evaluation;

const CASES: [(&str, &str, &str, &str); 6] = [
    ("sheen, one roughness", "sheen_bsdf(N, color(0.8), 0.3)", "diffuse(N)", ""),
    ("sheen, a roughness a lane", "sheen_bsdf(N, color(0.8), 0.1 + 0.8 * u)", "diffuse(N)", ""),
    ("ggx, one width", "microfacet(\"ggx\", N, N, 0.3, 0.3, 1.5, 0)", "diffuse(N)", "<= 30 ns"),
    ("ggx, a width a lane", "microfacet(\"ggx\", N, N, 0.1 + 0.8 * u, 0.1 + 0.8 * u, 1.5, 0)", "diffuse(N)", ""),
    (
        "metal, one width",
        "conductor_bsdf(N, N, 0.3, 0.3, color(0.16, 0.42, 1.45), color(3.5, 2.4, 1.9), \"ggx\")",
        "diffuse(N)",
        "",
    ),
    (
        "glass of two halves, one width",
        "dielectric_bsdf(N, N, color(1), color(1), 0.3, 0.3, 1.5, \"ggx\")",
        "diffuse(N)",
        "",
    ),
];

/// Prints the rows.
pub fn rows(table: &Table) {
    table.head("evaluate layer(top, diffuse)", "unlayered");
    for (name, top, base, bar) in CASES {
        let what = format!("top {name}");
        if !table.wants(&what) {
            continue;
        }
        let mut layered = Batch::new(&format!("surface s() {{ Ci = layer({top}, {base}); }}"));
        let mut plain = Batch::new(&format!("surface s() {{ Ci = {top} + {base}; }}"));
        let (wi, mut out, mut other) = (directions(2), Evaluation::default(), Evaluation::default());
        table.time(
            &what,
            (&mut || layered.lobes.evaluate(black_box(&wi), &mut out), N),
            (&mut || plain.lobes.evaluate(black_box(&wi), &mut other), N),
            bar,
        );
    }
}
