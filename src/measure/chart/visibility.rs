//! The visibility term of the sheen: what the choice of Lambda does to a whole lobe and its energy.

use super::closures;
use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::MEDIANS;
use super::race::race;
use super::truth::{ROUGHNESSES, albedos, directions, viewer};
use crate::bsdf::sheen::reference::Model;
use crate::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, SERIES, Sheen};
use crate::bsdf::{Scatter, params};
use crate::closure::{Settings, settings::Shadowing};

/// The albedo of a lobe in single precision, integrated in double.
fn albedo<M: Scatter>(roughness: f64, cos: f64, nodes: &[(glam::Vec3, f64)]) -> f64 {
    let (model, wo) = (M::prepare(params([roughness as f32])), viewer(cos));
    let view = model.view(wo);
    nodes.iter().map(|(wi, weight)| weight * f64::from(model.eval_from(wo, view, *wi).f_cos)).sum()
}

/// The largest error of the albedo of every term.
fn errors<const SOFT: bool>(effort: &Effort) -> [f64; 4] {
    let cosines = [0.01, 0.03, 0.1, 0.25, 0.45, 0.7, 0.9];
    let truth = albedos(Model::Exact, SOFT, &ROUGHNESSES, &cosines, effort.steps);
    let mut worst = [0.0f64; 4];
    for (k, &cos) in cosines.iter().enumerate() {
        let nodes = directions(cos, effort.steps);
        for (row, &r) in truth.iter().zip(&ROUGHNESSES) {
            let values = [
                albedo::<Sheen<EXACT, SOFT>>(r, cos, &nodes),
                albedo::<Sheen<PUBLISHED, SOFT>>(r, cos, &nodes),
                albedo::<Sheen<ASHIKHMIN, false>>(r, cos, &nodes),
                albedo::<Sheen<SERIES, SOFT>>(r, cos, &nodes),
            ];
            for (worst, value) in worst.iter_mut().zip(values) {
                *worst = worst.max((value - row[k]).abs());
            }
        }
    }
    worst
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let text = "surface s() { Ci = sheen_bsdf(N, color(1), 0.3); }";
    let mut runners = Vec::new();
    for (softening, (_, shadowing)) in [false, true].into_iter().flat_map(|s| Shadowing::ALL.map(|t| (s, t))) {
        let settings = Settings { shadowing, softening, ..Settings::default() };
        runners.push(closures::evaluation(closures::lobes(text, settings, closures::LANES)?, closures::LANES));
    }
    let costs = race(&mut runners, effort.laps);
    let names = ["exact, fitted (default)", "published fit", "Ashikhmin's visibility", "exact, Chebyshev series"];
    let errors = [("without softening", errors::<false>(effort)), ("softened", errors::<true>(effort))];
    let rows =
        errors.iter().flat_map(|(group, errors)| names.iter().zip(errors).map(move |(name, e)| (group, name, e)));
    let points: Vec<Point> = rows
        .zip(costs)
        // The visibility of Ashikhmin has no Lambda to soften.
        .filter(|((group, name, _), _)| **group != "softened" || **name != names[2])
        .map(|((group, name, error), cost)| Point::new(group, name, cost, *error))
        .collect();
    Ok(Figure {
        name: "visibility",
        title: "Visibility term of the sheen: cost of the lobe against error of its energy".to_owned(),
        cost: format!("ns to evaluate the lobe and its density, {} lanes at a time", closures::LANES),
        error: "largest error of the directional albedo".to_owned(),
        meaning: format!(
            "{MEDIANS} Error: the largest difference of the directional albedo (F = 1) from that of Smith's \
                  term with the exact Lambda, integrated in f64, for roughness 0.06 to 1 and cosines 0.01 to 0.9. The lobe is \
                  evaluated in f32 as the engine does. Ashikhmin's visibility is 1 / (4 (ci + co - ci co)), the term of \
                  Lambda = 1 / c - 1."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
