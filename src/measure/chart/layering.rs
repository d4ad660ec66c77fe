//! Rules of layering: what each costs, and what energy it loses, gains or sends only one way.

use super::closures;
use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::MEDIANS;
use super::race::race;
use super::truth::ROUGHNESSES;
use crate::bsdf::sheen::albedo::{AlbedoCurve, LONG_METHOD, SheenAlbedo};
use crate::bsdf::sheen::reference::average;
use crate::closure::{Layering, Settings};
use crate::math::quadrature::gauss_legendre;

/// The worst of a rule: loss over white Lambert, gain over a mirror, and difference of both ways.
#[derive(Clone, Copy, Default)]
struct Worst {
    loss: f64,
    gain: f64,
    one_way: f64,
}

/// Looks at a white sheen of all roughnesses from many sides; albedos come from the longest polynomial (3.2e-5).
fn worst(rule: Layering) -> Worst {
    let cosines: Vec<f64> = (1..=32).map(|k| (f64::from(k) / 32.0).powi(3)).collect();
    let mut out = Worst::default();
    for r in ROUGHNESSES {
        let curve = AlbedoCurve::exact(SheenAlbedo::Long, true, r as f32);
        let albedo = |cos: f64| f64::from(curve.by::<LONG_METHOD>(cos as f32));
        let mean = average(albedo);
        let scale_of = |i: f64, o: f64, diffuse: bool| {
            let (pass_i, pass_o) = (1.0 - albedo(i), 1.0 - albedo(o));
            match rule {
                Layering::Min => pass_i.min(pass_o),
                Layering::View => pass_o,
                Layering::Lossless if !diffuse => pass_i.min(pass_o),
                Layering::Kelemen | Layering::Lossless => pass_i * pass_o / (1.0 - mean),
            }
        };
        let scale = |i: f64, o: f64| scale_of(i, o, true);
        for &o in &cosines {
            // The albedo bends where both sides are alike, so the integral is split there.
            let split = o.cbrt();
            let parts = [(0.0, split), (split, 1.0)].into_iter().flat_map(|(a, b)| gauss_legendre(24, a, b));
            let base: f64 = parts.map(|n| n.weight * 6.0 * n.x.powi(5) * scale(n.x.powi(3), o)).sum();
            out.loss = out.loss.max((1.0 - albedo(o) - base).abs());
            out.gain = out.gain.max(albedo(o) + scale_of(o, o, false) - 1.0);
            for &i in &cosines {
                out.one_way = out.one_way.max((scale(i, o) - scale(o, i)).abs());
            }
        }
    }
    out
}

/// Below this an error is rounding.
const NOTHING: f64 = 1e-4;

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let text = "surface s() { Ci = sheen(diffuse(N), N, color(1), 0.3); }";
    let mut runners = Vec::new();
    for (_, layering) in Layering::ALL {
        let settings = Settings { layering, ..Settings::default() };
        runners.push(closures::evaluation(closures::lobes(text, settings, closures::LANES)?, closures::LANES));
    }
    let costs = race(&mut runners, effort.laps);
    let mut points: Vec<Point> = Vec::new();
    for ((name, rule), cost) in Layering::ALL.iter().zip(costs) {
        let Worst { loss, gain, one_way } = worst(*rule);
        for (group, error) in
            [("energy over white Lambert", loss), ("gain over a mirror", gain), ("difference of both ways", one_way)]
        {
            let error = if error < NOTHING { 0.0 } else { error };
            points.push(Point::new(
                group,
                &if error == 0.0 { format!("{name} (0)") } else { (*name).to_owned() },
                cost,
                error,
            ));
        }
    }
    Ok(Figure {
        name: "layering",
        title: "Rules of layering: cost against energy and reciprocity".to_owned(),
        cost: format!("ns to evaluate a sheen over Lambert, {} lanes at a time", closures::LANES),
        error: "largest error, below 1e-4 shown as 0".to_owned(),
        meaning: format!(
            "{MEDIANS} Three errors, each the worst over roughness 0.06 to 1 and all cosines, for a white sheen (softened exact \
                  term): how far the albedo of sheen over a white Lambertian base is from 1; what a mirror under it sends back \
                  beyond 1; and how much the scale of the base changes when light and viewer trade places. Only `min` \
                  and `lossless` never gain and are reciprocal, and only the latter loses nothing over Lambert."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
