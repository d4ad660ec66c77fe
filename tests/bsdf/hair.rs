//! Hair: each lobe against the published formulas, no light lost without absorption.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use std::f64::consts::{PI, TAU};
use velour::bsdf::hair::{Hair, scaled_bessel};
use velour::bsdf::{Scatter, params};
use velour::math::quadrature::gauss_legendre;
use velour::measure::statistics::Random;

/// The modified Bessel function of order 0 by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..400 {
        term *= (0.5 * x / f64::from(k)).powi(2);
        sum += term;
    }
    sum
}

#[test]
fn the_bessel_function_is_right() {
    for k in 0..600 {
        let x = 0.1 * f64::from(k);
        let exact = bessel(x) * (-x).exp();
        assert!((f64::from(scaled_bessel(x as f32)) / exact - 1.0).abs() < 1e-6, "{x}");
    }
    assert!((scaled_bessel(1000.0) / 0.012_617_24 - 1.0).abs() < 1e-6);
}

/// ior, v, s, cuticle, absorption, tint.
type Fiber = [f32; 10];

/// Mp Np and Ap of one lobe, all in double precision, as published: no form against overflow or cancellation.
fn published(p: u32, fiber: Fiber, wo: Vec3, wi: Vec3) -> (f64, [f64; 3]) {
    let [ior, v, s, cuticle] = [0, 1, 2, 3].map(|k| f64::from(fiber[k]));
    // Single floats are unit vectors only just; along the fiber that would be a thousandth of the cosine.
    let [o, i] = [wo, wi].map(|w| (w.as_dvec3() / w.as_dvec3().length()).to_array());
    let angles = |w: [f64; 3]| (w[0].clamp(-1.0, 1.0).asin(), w[1].atan2(w[2]));
    let ((theta_o, phi_o), (theta_i, phi_i)) = (angles(o), angles(i));
    let scales = (cuticle - 0.5) * PI;
    let tilted = theta_o + scales * [2.0, -1.0, -4.0, 0.0][p as usize];
    let (a, b) = (theta_i.cos() * tilted.cos().abs() / v, theta_i.sin() * tilted.sin() / v);
    let m = (-b).exp() * bessel(a) / (2.0 * v * (1.0 / v).sinh());
    let eta = (ior * ior - theta_o.sin().powi(2)).sqrt() / theta_o.cos();
    let gamma_t = (phi_o.sin() / eta).asin();
    let middle = phi_o + 2.0 * f64::from(p) * gamma_t - 2.0 * phi_o + f64::from(p) * PI;
    let x = (phi_i - middle + PI).rem_euclid(TAU) - PI;
    let s = s * (PI / 8.0).sqrt();
    let cdf = |x: f64| 1.0 / (1.0 + (-x / s).exp());
    let logistic = (-x.abs() / s).exp() / (s * (1.0 + (-x.abs() / s).exp()).powi(2));
    let n = if p > 2 { 1.0 / TAU } else { logistic / (cdf(PI) - cdf(-PI)) };
    let length = 2.0 * gamma_t.cos() / (1.0 - (theta_o.sin() / ior).powi(2)).sqrt();
    let c = theta_o.cos() * phi_o.cos();
    let g = (ior * ior - 1.0 + c * c).sqrt();
    let f = 0.5 * ((g - c) / (g + c)).powi(2) * (1.0 + ((c * (g + c) - 1.0) / (c * (g - c) + 1.0)).powi(2));
    let colors = [0, 1, 2].map(|k| {
        let t = (-f64::from(fiber[4 + k]) * length).exp();
        let tt = (1.0 - f).powi(2) * t;
        f64::from(fiber[7 + k]) * [f, tt, tt * t * f, tt * t * f * t * f / (1.0 - t * f)][p as usize]
    });
    (m * n, colors)
}

fn agrees<const P: u32>(fiber: Fiber) {
    let (model, mut random, mut worst) = (Hair::<P>::prepare(params(fiber)), Random(SEED), 0.0f64);
    for k in 0..3000 {
        let mut number = || random.number();
        let wo = narrow(direction(f64::from(number().max(0.01)), 6.3 * f64::from(number())));
        let sampled = model.sample(wo, Vec3::new(number(), number(), number()));
        let anywhere = narrow(direction(2.0 * f64::from(number()) - 1.0, 6.3 * f64::from(number())));
        let wi = if k % 2 == 0 { sampled } else { anywhere };
        assert!((wi.length() - 1.0).abs() < 1e-5, "{wi}");
        let (density, color) = published(P, fiber, wo, wi);
        let eval = model.eval(wo, wi);
        worst = worst.max((f64::from(eval.pdf) - density).abs() / density.max(1e-2));
        let value = model.colored(wo, wi);
        for c in 0..3 {
            let expected = density * color[c];
            worst = worst.max((f64::from(value[c]) - expected).abs() / expected.max(1e-2));
        }
    }
    println!("{P} {fiber:?}: {worst:.1e}");
    // The rounding of a direction counts by the narrower of the two widths, that of the angle's middle by s.
    let bar = 1e-5 + 2e-6 / f64::from(fiber[1].sqrt().min(0.63 * fiber[2]));
    assert!(worst < bar, "{P} {fiber:?}: {worst:e} {bar:e}");
}

#[test]
fn lobes_agree_with_the_published_formulas() {
    for (v, s, cuticle) in [(0.05, 0.3, 0.5), (0.3, 1.0, 0.45), (1.0, 0.1, 0.9), (0.01, 0.05, 0.52)] {
        for absorption in [[0.0; 3], [0.1, 0.5, 2.0]] {
            let [r, g, b] = absorption;
            let fiber = [1.55, v, s, cuticle, r, g, b, 1.0, 0.6, 0.2];
            agrees::<0>(fiber);
            agrees::<1>(fiber);
            agrees::<2>(fiber);
            agrees::<3>(fiber);
        }
    }
}

/// The integral of the density over the sphere, by rings about the fiber.
fn total<const P: u32>(fiber: Fiber, wo: Vec3) -> f64 {
    let model = Hair::<P>::prepare(params(fiber));
    let mut sum = 0.0;
    for theta in gauss_legendre(200, -0.5 * PI, 0.5 * PI) {
        for k in 0..720 {
            let phi = f64::from(k) * TAU / 720.0;
            let (sin, cos) = theta.x.sin_cos();
            let wi = narrow([sin, cos * phi.sin(), cos * phi.cos()]);
            sum += theta.weight * cos * TAU / 720.0 * f64::from(model.eval(wo, wi).pdf);
        }
    }
    sum
}

#[test]
fn densities_integrate_to_one() {
    for (v, s, cuticle) in [(0.05, 0.3, 0.5), (0.3, 1.0, 0.6), (1.0, 0.1, 0.9), (0.01, 0.1, 0.48)] {
        let fiber = [1.55, v, s, cuticle, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        for wo in [Vec3::Z, narrow(direction(0.3, 0.2)), narrow(direction(0.1, 2.0))] {
            let sums = [total::<0>(fiber, wo), total::<1>(fiber, wo), total::<2>(fiber, wo), total::<3>(fiber, wo)];
            // The logistic has a kink at its far end, where equal steps leave this much.
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 2e-4), "{fiber:?} {wo}: {sums:?}");
        }
    }
}

#[test]
fn nothing_is_lost_without_absorption() {
    for c in [1e-6, 0.02, 0.3, 0.8, 1.0] {
        for ior in [1.1, 1.55, 2.5] {
            let fiber = params([ior, 0.1, 0.3, 0.5, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
            let wo = narrow(direction(c, 1.0));
            let parts = [
                (Hair::<0>::prepare(fiber).colored(wo, Vec3::Z) / Hair::<0>::prepare(fiber).eval(wo, Vec3::Z).pdf).x,
                (Hair::<1>::prepare(fiber).colored(wo, Vec3::Z) / Hair::<1>::prepare(fiber).eval(wo, Vec3::Z).pdf).x,
                (Hair::<2>::prepare(fiber).colored(wo, Vec3::Z) / Hair::<2>::prepare(fiber).eval(wo, Vec3::Z).pdf).x,
                (Hair::<3>::prepare(fiber).colored(wo, Vec3::Z) / Hair::<3>::prepare(fiber).eval(wo, Vec3::Z).pdf).x,
            ];
            let albedos = [
                Hair::<0>::prepare(fiber).albedo(wo.z),
                Hair::<1>::prepare(fiber).albedo(wo.z),
                Hair::<2>::prepare(fiber).albedo(wo.z),
                Hair::<3>::prepare(fiber).albedo(wo.z),
            ];
            assert!((parts.iter().sum::<f32>() - 1.0).abs() < 1e-4, "{c} {ior}: {parts:?}");
            for (part, albedo) in parts.into_iter().zip(albedos) {
                assert!((part - albedo).abs() < 1e-5, "{c} {ior}: {parts:?} {albedos:?}");
            }
        }
    }
}

fn is_finite<const P: u32>(fiber: Fiber) {
    let (model, mut random) = (Hair::<P>::prepare(params(fiber)), Random(SEED));
    for k in 0..600 {
        let z = if k % 4 == 0 { 1e-10 } else { 10f64.powf(-8.0 * f64::from(random.number())) };
        let along = k % 3 == 0;
        let wo = narrow(direction(z, if along { 0.0 } else { f64::from(k) }));
        let sampled = model.sample(wo, Vec3::new(random.number(), random.number(), random.number()));
        assert!(sampled.is_finite() && (sampled.length() - 1.0).abs() < 1e-4, "{P} {fiber:?} {wo} {sampled}");
        for wi in [sampled, -wo, wo, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z, Vec3::ZERO] {
            let (eval, color) = (model.eval(wo, wi), model.colored(wo, wi));
            assert!(eval.pdf.is_finite() && eval.pdf >= 0.0, "{P} {fiber:?} {wo} {wi} {eval:?}");
            assert!(color.is_finite() && color.min_element() >= 0.0, "{P} {fiber:?} {wo} {wi} {color}");
        }
        assert!((0.0..=1.0).contains(&model.albedo(wo.z)));
    }
}

#[test]
fn edges_give_finite_light() {
    for e in [0.0, -1.0, 1.0, 1e-30, 50.0, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for fiber in [
            [e, 0.1, 0.3, 0.5, 0.1, 0.1, 0.1, 1.0, 1.0, 1.0],
            [1.5, e, e, 0.5, 0.1, 0.1, 0.1, 1.0, 1.0, 1.0],
            [1.5, 0.1, 0.3, e, e, 0.1, 0.0, 0.5, e, 1.0],
        ] {
            is_finite::<0>(fiber);
            is_finite::<1>(fiber);
            is_finite::<2>(fiber);
            is_finite::<3>(fiber);
        }
    }
}
