//! Widths of batches: what a lane costs when so many are shaded, or evaluated, at once.

use super::closures;
use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::race;
use crate::closure::Settings;

/// Cloth of woven threads with noise: the longest of the usual shaders.
const WEAVE: &str =
    "surface weave(color warp = color(0.5, 0.1, 0.1), color weft = color(0.1, 0.1, 0.4), float scale = 50) {
    float s = u * scale; float t = v * scale;
    int top = mod(floor(s) + floor(t), 2.0) < 1.0;
    float rough = snoise(P * 8) + 0.5 * snoise(P * 16) + 0.25 * snoise(P * 32);
    float bend = top ? sin(M_PI * (s - floor(s))) : sin(M_PI * (t - floor(t)));
    color thread = (top ? warp : weft) * (0.7 + 0.3 * bend + 0.1 * rough);
    Ci = sheen(thread * diffuse(N), N, color(0.8), clamp(0.3 + 0.2 * rough, 0.05, 1.0)); }";
const CLOTH: &str = "surface s() { Ci = sheen(diffuse(N), N, color(1), 0.3); }";

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let widths: Vec<usize> = (0..).map(|k| 1 << k).take_while(|w| *w <= closures::LANES).collect();
    let (mut runners, mut rows) = (Vec::new(), Vec::new());
    for &width in &widths {
        rows.push(("shader: a weave with three noises", width));
        runners.push(closures::shading(closures::group(WEAVE)?, width));
    }
    for &width in &widths {
        rows.push(("closures: evaluate sheen over Lambert", width));
        runners.push(closures::evaluation(closures::lobes(CLOTH, Settings::default(), width)?, width));
    }
    for &width in &widths {
        rows.push(("closures: sample it", width));
        runners.push(closures::sampling(closures::lobes(CLOTH, Settings::default(), width)?, width));
    }
    let costs = race(&mut runners, effort.laps);
    let mut points = Vec::new();
    for ((group, width), cost) in rows.into_iter().zip(costs) {
        let mut p = Point::new(group, "", cost, cost.median);
        // Here the horizontal number is the width, and the cost stands upright.
        (p.cost, p.spread) = (width as f64, [width as f64; 2]);
        p.method =
            if width == 1 || width == closures::LANES { format!("{:.0} ns", cost.median) } else { String::new() };
        points.push(p);
    }
    Ok(Figure {
        name: "widths",
        title: "Width of a batch: cost of a lane".to_owned(),
        cost: "lanes of a batch".to_owned(),
        error: "ns a lane".to_owned(),
        meaning: "No cost and no error: every width gives the same bits. The horizontal number is the width of a batch, the vertical one the \
                  median cost of a lane over interleaved rounds."
            .to_owned(),
        join: Join::Lines,
        points,
    })
}
