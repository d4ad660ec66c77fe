//! Sampling of the sheen: what a sample costs and how much its weight varies.

use super::closures;
use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::MEDIANS;
use super::race::race;
use super::truth::{directions, viewer};
use crate::bsdf::sheen::normals::ByNormals;
use crate::bsdf::sheen::{EXACT, Sheen};
use crate::bsdf::{Scatter, params};
use crate::closure::{Settings, settings::SheenSampling};

const ROUGHNESSES: [f32; 4] = [0.1, 0.25, 0.5, 1.0];

/// Variance of f cos / pdf over the square of its mean, the mean over four viewers.
fn relative_variance<M: Scatter>(roughness: f32, scheme: SheenSampling, steps: usize) -> f64 {
    let model = M::prepare(params([roughness])).choose(scheme.into());
    let cosines = [0.1, 0.35, 0.6, 0.85];
    let mut mean = 0.0;
    for cos in cosines {
        let wo = viewer(cos);
        let view = model.view(wo);
        let (mut first, mut second) = (0.0, 0.0);
        for (wi, weight) in directions(cos, steps) {
            let value = model.eval_from(wo, view, wi);
            let (f, pdf) = (f64::from(value.f_cos), f64::from(value.pdf));
            first += weight * f;
            second += if pdf > 0.0 { weight * f * f / pdf } else { 0.0 };
        }
        mean += (second / (first * first) - 1.0) / cosines.len() as f64;
    }
    mean
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    let (mut runners, mut rows) = (Vec::new(), Vec::new());
    for r in ROUGHNESSES {
        let text = format!("surface s() {{ Ci = sheen_bsdf(N, color(1), {r:?}); }}");
        for (name, sheen_sampling) in SheenSampling::ALL {
            let settings = Settings { sheen_sampling, ..Settings::default() };
            runners.push(closures::sampling(closures::lobes(&text, settings, closures::LANES)?, closures::LANES));
            let variance = match sheen_sampling {
                SheenSampling::Normals => relative_variance::<ByNormals<EXACT, true>>(r, sheen_sampling, effort.steps),
                _ => relative_variance::<Sheen<EXACT, true>>(r, sheen_sampling, effort.steps),
            };
            rows.push((format!("r = {r}"), name, variance));
        }
    }
    let costs = race(&mut runners, effort.laps);
    let points: Vec<Point> = rows
        .iter()
        .zip(costs)
        .map(|((group, name, variance), cost)| Point::new(group, name, cost, *variance))
        .collect();
    Ok(Figure {
        name: "sampling",
        title: "Sampling of the sheen: cost of a sample against its variance".to_owned(),
        cost: format!("ns a sample with weight and density, {} lanes at a time", closures::LANES),
        error: "relative variance of f cos / pdf".to_owned(),
        meaning: format!(
            "{MEDIANS} Error: the variance of one sample's weight over the square of its mean, by quadrature of (f cos)² / pdf, mean \
                  over the viewer's cosines 0.1, 0.35, 0.6 and 0.85; softened exact term. \"ltc\" is the transformed mixture \
                  of cosines (default), \"uniform\" the paper's hemisphere, \"normals\" the half vector."
        ),
        join: Join::Front,
        points,
    }
    .with_front())
}
