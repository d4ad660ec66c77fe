//! Every sampler against its density by chi-square, at a level shared by all tests, with negative controls.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::bsdf::fresnel::Dielectric;
use velour::bsdf::lambert::{Lambert, Translucent};
use velour::bsdf::microfacet::{Beckmann, Ggx, Microfacet};
use velour::bsdf::oren_nayar::OrenNayar;
use velour::bsdf::sheen::normals::ByNormals;
use velour::bsdf::sheen::sampling::SheenSampling;
use velour::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, Sheen};
use velour::bsdf::velvet::Velvet;
use velour::bsdf::{Eval, Params, Scatter, Side, View, params};
use velour::math::quadrature::gauss_legendre;
use velour::measure::statistics::{Random, chi_square, sidak};

const RINGS: usize = 24;
const SECTORS: usize = 24;
const SAMPLES: u32 = 100_000;
/// Probability that a right build fails, over all tests of this file together.
const LEVEL: f64 = 1e-4;
const TESTS: u32 = 160;

/// The cell of a direction: rings of equal cosine, sectors of equal azimuth.
fn cell(w: Vec3) -> usize {
    let ring = ((w.z * 0.5 + 0.5) * RINGS as f32) as usize;
    let turn = (w.y.atan2(w.x) / std::f32::consts::TAU).rem_euclid(1.0);
    ring.min(RINGS - 1) * SECTORS + ((turn * SECTORS as f32) as usize).min(SECTORS - 1)
}

/// How many samples each cell should get; the last one gets what the density leaves out.
fn expectations(model: &impl Scatter, wo: Vec3) -> Vec<f64> {
    let mut out = Vec::with_capacity(RINGS * SECTORS + 1);
    for ring in 0..RINGS {
        let edge = |k: usize| 2.0 * k as f64 / RINGS as f64 - 1.0;
        // Refraction begins with a step where the micronormal reaches the horizon, so equal steps serve better than Gauss's.
        let step = (edge(ring + 1) - edge(ring)) / 64.0;
        let rings: Vec<f64> = (0..64).map(|k| edge(ring) + (f64::from(k) + 0.5) * step).collect();
        for sector in 0..SECTORS {
            let edge = |k: usize| std::f64::consts::TAU * k as f64 / SECTORS as f64;
            let sectors = gauss_legendre(6, edge(sector), edge(sector + 1));
            let mut sum = 0.0;
            for z in &rings {
                for phi in &sectors {
                    sum += step * phi.weight * f64::from(model.eval(wo, narrow(direction(*z, phi.x))).pdf);
                }
            }
            out.push(sum * f64::from(SAMPLES));
        }
    }
    let total: f64 = out.iter().sum();
    out.push((f64::from(SAMPLES) - total).max(0.0));
    out
}

fn counts(model: &impl Scatter, wo: Vec3, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let mut out = vec![0.0; RINGS * SECTORS + 1];
    for _ in 0..SAMPLES {
        let wi = model.sample(wo, Vec3::new(random.number(), random.number(), random.number()));
        let lost = wi == Vec3::ZERO || model.eval(wo, wi).pdf == 0.0;
        out[if lost { RINGS * SECTORS } else { cell(wi) }] += 1.0;
    }
    out
}

fn passes<M: Scatter>(values: [f32; 4], name: &str) {
    follows(&M::prepare(params(values)), &format!("{name} {values:?}"));
}

/// Holds a sampler to its density at three views.
pub fn follows(model: &impl Scatter, name: &str) {
    for (k, c) in [0.1, 0.5, 0.95].into_iter().enumerate() {
        let wo = narrow(direction(c, 0.4 + k as f64));
        let p = chi_square(&counts(model, wo, SEED + k as u64), &expectations(model, wo));
        assert!(p > sidak(LEVEL, TESTS), "{name} at {c}: p = {p:e}");
    }
}

#[test]
fn samples_follow_their_densities() {
    passes::<Lambert>([0.0; 4], "lambert");
    passes::<Translucent>([0.0; 4], "translucent");
    passes::<OrenNayar>([0.5, 0.0, 0.0, 0.0], "oren_nayar");
    for m in [0.1, 0.3, 1.0] {
        passes::<Velvet>([m, 0.0, 0.0, 0.0], "velvet");
    }
    for r in [0.06, 0.25, 1.0] {
        passes::<Sheen<EXACT, true>>([r, 0.1, 0.0, 0.0], "sheen");
        passes::<Sheen<EXACT, false>>([r, 0.1, 0.0, 0.0], "sheen exact");
    }
    passes::<Sheen<EXACT, true>>([0.25, 1.0, 0.0, 0.0], "sheen, uniform");
    passes::<Sheen<EXACT, true>>([0.25, 0.0, 1.0, 0.0], "sheen, cosine");
    for r in [0.06, 0.25, 1.0] {
        passes::<ByNormals<EXACT, true>>([r, 0.0, 0.0, 0.0], "sheen, by normals");
    }
    passes::<Sheen<PUBLISHED, true>>([0.25, 0.1, 0.0, 0.0], "sheen published");
    passes::<Sheen<ASHIKHMIN, false>>([0.4, 0.1, 0.0, 0.0], "sheen ashikhmin");
    for (x, y) in [(0.3, 0.3), (0.2, 0.6), (1.0, 1.0)] {
        passes::<Microfacet<Ggx, Dielectric, false>>([x, y, 1.5, 0.0], "ggx reflecting");
        passes::<Microfacet<Beckmann, Dielectric, false>>([x, y, 1.5, 0.0], "beckmann reflecting");
    }
    for eta in [1.5, 1.0 / 1.5] {
        passes::<Microfacet<Ggx, Dielectric, true>>([0.4, 0.4, eta, 0.0], "ggx refracting");
        passes::<Microfacet<Beckmann, Dielectric, true>>([0.3, 0.5, eta, 0.0], "beckmann refracting");
    }
}

/// A model whose density is wrong by a factor on one half of the hemisphere, so that its sum stays 1.
#[derive(Clone, Copy)]
struct Wrong<M>(M);

impl<M: Scatter> Scatter for Wrong<M> {
    const PARAMS: usize = M::PARAMS;
    const SIDE: Side = M::SIDE;

    fn prepare(params: Params) -> Self {
        Wrong(M::prepare(params))
    }

    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let eval = self.0.eval(wo, wi);
        Eval { pdf: eval.pdf * if wi.x > 0.0 { 1.05 } else { 0.95 }, ..eval }
    }

    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        self.0.sample(wo, xi)
    }

    fn albedo(&self, cos: f32) -> f32 {
        self.0.albedo(cos)
    }
}

#[test]
fn a_density_five_percent_wrong_is_rejected() {
    fn rejected<M: Scatter>(values: [f32; 4]) {
        let model = Wrong(M::prepare(params(values)));
        let wo = narrow(direction(0.5, 1.4));
        let p = chi_square(&counts(&model, wo, SEED), &expectations(&model, wo));
        assert!(p < sidak(LEVEL, TESTS), "p = {p:e}");
    }
    rejected::<Lambert>([0.0; 4]);
    rejected::<Sheen<EXACT, true>>([0.25, 0.1, 0.0, 0.0]);
    rejected::<Microfacet<Ggx, Dielectric, false>>([0.3, 0.3, 1.5, 0.0]);
    rejected::<Microfacet<Ggx, Dielectric, true>>([0.4, 0.4, 1.5, 0.0]);
}

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
        let [share, plain] = scheme.params();
        let model = M::prepare(params([r, share, plain]));
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
