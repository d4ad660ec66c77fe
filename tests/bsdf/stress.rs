//! A million directions, a third near the mirror, a third near grazing, against f64.

use crate::SEED;
use glam::Vec3;
use velour::bsdf::fresnel::Dielectric;
use velour::bsdf::microfacet::{Beckmann, Ggx, Microfacet};
use velour::bsdf::oren_nayar::OrenNayar;
use velour::bsdf::sheen::reference::{self, Model};
use velour::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, SERIES, Sheen, charlie};
use velour::bsdf::velvet::Velvet;
use velour::bsdf::{Scatter, Side, params};
use velour::measure::statistics::Random;

fn direction(random: &mut Random, grazing: bool) -> Vec3 {
    let z = if grazing { 10f32.powf(-6.0 * random.number()) } else { random.number().max(1e-3) };
    let phi = random.number() * std::f32::consts::TAU;
    let s = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(s * phi.cos(), s * phi.sin(), z).normalize()
}

/// View, light and roughness of the k-th case.
fn case(random: &mut Random, k: u32) -> (Vec3, Vec3, f32) {
    let wo = direction(random, k % 3 == 1);
    let wi = match k % 3 {
        0 => {
            let offset = 10f32.powf(-1.0 - 6.0 * random.number());
            let jitter = Vec3::new(random.number() - 0.5, random.number() - 0.5, random.number() - 0.5) * offset;
            (Vec3::new(-wo.x, -wo.y, wo.z) + jitter).normalize()
        }
        _ => direction(random, k % 3 == 1 && k.is_multiple_of(2)),
    };
    let r = match k % 17 {
        0 => 0.0,
        1 => 1e-39,
        2 => 1.0,
        _ => random.number(),
    };
    (wo, wi, r)
}

/// The largest absolute error of f (or of f cos) over the set, and that nothing is not finite.
fn worst_error<const S: u8, const SOFT: bool>(model: Model, count: u32) -> (f64, f64) {
    let mut random = Random(SEED);
    let (mut worst_f, mut worst_f_cos) = (0.0f64, 0.0f64);
    for k in 0..count {
        let (wo, wi, r) = case(&mut random, k);
        let sheen = Sheen::<S, SOFT>::prepare(params([r]));
        let (f, eval) = (sheen.f(wo, wi), sheen.eval(wo, wi));
        assert!(f.is_finite() && f >= 0.0 && eval.f_cos.is_finite() && eval.pdf.is_finite(), "{wo} {wi} {r}");
        assert!(sheen.albedo(wo.z).is_finite());
        let wide = |v: Vec3| [f64::from(v.x), f64::from(v.y), f64::from(v.z)];
        let expected = reference::f(model, SOFT, wide(wo), wide(wi), f64::from(charlie::clamp_roughness(r)));
        worst_f_cos = worst_f_cos.max((f64::from(eval.f_cos) - expected * f64::from(wi.z.max(0.0))).abs());
        if wo.z > 1e-5 && wi.z > 1e-5 {
            // Unsoftened, f grows as 1 / cos and passes 1e4, where single floats cannot err by less than 1e-3.
            let scale = if SOFT { 1.0 } else { expected.max(1.0) };
            worst_f = worst_f.max((f64::from(f) - expected).abs() / scale);
        }
    }
    (worst_f, worst_f_cos)
}

#[test]
fn sheen_is_finite_and_right_everywhere() {
    let cases = [
        ("exact, softened", worst_error::<EXACT, true>(Model::ExactFit, 1_000_000)),
        ("exact", worst_error::<EXACT, false>(Model::ExactFit, 200_000)),
        ("series, softened", worst_error::<SERIES, true>(Model::Exact, 20_000)),
        ("series", worst_error::<SERIES, false>(Model::Exact, 20_000)),
        ("published, softened", worst_error::<PUBLISHED, true>(Model::Published, 200_000)),
        ("published", worst_error::<PUBLISHED, false>(Model::Published, 200_000)),
        ("ashikhmin", worst_error::<ASHIKHMIN, false>(Model::Ashikhmin, 200_000)),
    ];
    for (name, (f, f_cos)) in cases {
        println!("{name}: f {f:.2e}, f cos {f_cos:.2e}");
        assert!(f < 5e-4 && f_cos < 5e-4, "{name}: {f:e} {f_cos:e}");
    }
}

#[test]
fn every_model_is_finite_everywhere() {
    fn check<M: Scatter>(values: [f32; 4], random: &mut Random, k: u32) {
        let (wo, mut wi, r) = case(random, k);
        let model = M::prepare(params(values.map(|p| if p < 0.0 { r } else { p })));
        if M::SIDE == Side::Other {
            wi = -wi;
        }
        let sampled = model.sample(wo, Vec3::new(random.number(), random.number(), random.number()));
        assert!(sampled.is_finite(), "{values:?} {wo}");
        for w in [wi, sampled, Vec3::ZERO, -wo, wo] {
            let eval = model.eval(wo, w);
            assert!(
                eval.f_cos.is_finite() && eval.pdf.is_finite() && eval.f_cos >= 0.0 && eval.pdf >= 0.0,
                "{values:?} {wo} {w} {eval:?}"
            );
        }
    }
    let mut random = Random(SEED + 1);
    for k in 0..60_000 {
        for eta in [0.0, 0.7, 1.0, 1.5] {
            check::<Microfacet<Ggx, Dielectric, false>>([-1.0, 0.3, eta, 0.0], &mut random, k);
            check::<Microfacet<Ggx, Dielectric, true>>([-1.0, -1.0, eta, 0.0], &mut random, k);
            check::<Microfacet<Beckmann, Dielectric, false>>([-1.0, -1.0, eta, 0.0], &mut random, k);
            check::<Microfacet<Beckmann, Dielectric, true>>([-1.0, 0.9, eta, 0.0], &mut random, k);
        }
        check::<OrenNayar>([-1.0, 0.0, 0.0, 0.0], &mut random, k);
        check::<Velvet>([0.0, 0.0, 0.0, 0.0], &mut random, k);
        check::<Velvet>([0.5, 0.0, 0.0, 0.0], &mut random, k);
        check::<Sheen<EXACT, true>>([-1.0, 0.1, 0.0, 0.0], &mut random, k);
        check::<Sheen<PUBLISHED, true>>([-1.0, 1.0, 0.0, 0.0], &mut random, k);
    }
}

#[test]
fn unsoftened_models_are_reciprocal() {
    let mut random = Random(SEED + 2);
    for k in 0..20_000 {
        let (wo, wi, r) = case(&mut random, k);
        if wi.z <= 0.0 {
            continue;
        }
        let sheen = Sheen::<EXACT, false>::prepare(params([r]));
        let rough = Microfacet::<Ggx, Dielectric, false>::prepare(params([r.max(0.05), 0.2, 1.5]));
        let diffuse = OrenNayar::prepare(params([r]));
        let both =
            |a: f32, b: f32| assert!((a - b).abs() <= 2e-3 * a.abs().max(b.abs()) + 1e-6, "{a} {b} {wo} {wi} {r}");
        both(sheen.eval(wo, wi).f_cos * wo.z, sheen.eval(wi, wo).f_cos * wi.z);
        both(rough.eval(wo, wi).f_cos * wo.z, rough.eval(wi, wo).f_cos * wi.z);
        both(diffuse.eval(wo, wi).f_cos * wo.z, diffuse.eval(wi, wo).f_cos * wi.z);
    }
    let soft = Sheen::<PUBLISHED, true>::prepare(params([0.15]));
    let (a, b) = (
        crate::narrow(crate::direction(30f64.to_radians().cos(), 0.0)),
        crate::narrow(crate::direction(80f64.to_radians().cos(), 0.0)),
    );
    assert!(
        (soft.f(a, b) - 0.03728).abs() < 1e-5 && (soft.f(b, a) - 0.07667).abs() < 1e-5,
        "softening is not reciprocal"
    );
}
