//! Samplers against each other; `tests/verify.rs` holds every one of them against its density.

use crate::{direction, narrow};
use velour::bsdf::sheen::normals::ByNormals;
use velour::bsdf::sheen::sampling::SheenSampling;
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
fn the_default_sheen_sampler_beats_the_others() {
    fn mean<M: Scatter>(r: f32, scheme: SheenSampling) -> f64 {
        let model = M::prepare(params([r])).choose(scheme.into());
        [0.05, 0.25, 0.5, 0.75, 0.999].iter().map(|&c| relative_variance(&model, c)).sum::<f64>() / 5.0
    }
    for (r, bar) in [(0.06, 0.40), (0.15, 0.25), (0.25, 0.20), (0.4, 0.15), (0.65, 0.12), (1.0, 0.10)] {
        let [ltc, uniform, cosine] = [SheenSampling::Proposal, SheenSampling::Uniform, SheenSampling::Cosine]
            .map(|scheme| mean::<Sheen<EXACT, true>>(r, scheme));
        let normals = mean::<ByNormals<EXACT, true>>(r, SheenSampling::Normals);
        println!("r {r}: ltc {ltc:.3}, uniform {uniform:.3}, cosine {cosine:.3}, normals {normals:.3}");
        assert!(ltc < bar && ltc < uniform && ltc < cosine && ltc < normals, "r {r}");
        let unsoftened = mean::<Sheen<EXACT, false>>(r, SheenSampling::Proposal);
        println!("   without softening: ltc {unsoftened:.3}");
        assert!(unsoftened < bar, "r {r}: {unsoftened}");
    }
}
