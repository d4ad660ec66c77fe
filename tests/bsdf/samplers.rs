//! Samplers against each other; `tests/verify.rs` holds every one of them against its density.

use crate::{direction, narrow};
use velour::bsdf::sheen::{EXACT, Sheen};
use velour::bsdf::{Eval, Scatter, params};

/// Relative variance of the one-sample estimate of the albedo, by quadrature.
fn relative_variance(model: &impl Scatter, c: f64) -> f64 {
    let wo = narrow(direction(c, 0.0));
    let (mut square, mut mean) = (0.0, 0.0);
    for (wi, weight) in velour::measure::furnace::hemisphere(48, 192, c) {
        let Eval { f_cos, pdf } = model.eval(wo, wi);
        square += weight * f64::from(f_cos) * f64::from(f_cos) / f64::from(pdf.max(1e-20));
        mean += weight * f64::from(f_cos);
    }
    square / (mean * mean) - 1.0
}

#[test]
fn the_default_sheen_sampler_beats_the_uniform_one() {
    let cosines = [0.05, 0.25, 0.5, 0.75, 0.999];
    for (r, bar) in [(0.06, 0.40), (0.15, 0.25), (0.25, 0.20), (0.4, 0.15), (0.65, 0.12), (1.0, 0.10)] {
        let mean = |share: f32| {
            let model = Sheen::<EXACT, true>::prepare(params([r, share]));
            cosines.iter().map(|&c| relative_variance(&model, c)).sum::<f64>() / 5.0
        };
        let (proposal, uniform) = (mean(0.1), mean(1.0));
        println!("r {r}: {proposal:.3} against {uniform:.3}");
        assert!(proposal < bar && proposal < uniform, "r {r}: {proposal} {uniform}");
    }
}
