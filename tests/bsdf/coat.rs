//! Clear coats: the formula of Weidlich and Wilkie, darkening, absorption, energy over every base, and nesting.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::bsdf::fresnel::dielectric;
use velour::closure::{Evaluation, Lobes, Samples, Settings, event};
use velour::compile::compile;
use velour::exec::{Machine, Points};
use velour::math::columns::Column3;
use velour::math::quadrature::gauss_legendre;
use velour::measure::furnace::{hemisphere, integrate, sample_mean};
use velour::measure::statistics::Random;

/// The lobes of a closure expression seen at a cosine.
fn lobes(expression: &str, cos: f64) -> Lobes {
    let wo = narrow(direction(cos, 0.3));
    let shader = compile(&format!("surface s() {{ Ci = {expression}; }}")).expect("a right shader");
    let group = shader.group().build().expect("a group");
    let points = Points::single(wo);
    let mut machine = Machine::new();
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
    assert!(lobes.dropped().is_empty(), "{:?}", lobes.dropped());
    lobes
}

fn f_cos(lobes: &mut Lobes, wi: Vec3) -> Vec3 {
    let mut out = Evaluation::default();
    lobes.evaluate(&Column3::splat(wi, 1), &mut out);
    out.f_cos.get(0)
}

/// The cosine inside a coat.
fn inner(cos: f64, eta: f64) -> f64 {
    (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt()
}

fn pass(cos: f64, eta: f64) -> f64 {
    1.0 - f64::from(dielectric(cos as f32, eta as f32))
}

/// Reflected light of one lane by sampling: mean and standard error of its first component.
fn reflected(lobes: &mut Lobes, count: u32) -> (f64, f64) {
    let mut random = Random(SEED);
    let means: Vec<f64> = (0..20).map(|_| sample_mean(lobes, 1, count / 20, || random.number())[0][0]).collect();
    let mean = means.iter().sum::<f64>() / 20.0;
    let spread = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (19.0 * 20.0);
    (mean, spread.sqrt())
}

#[test]
fn a_coat_of_air_changes_nothing() {
    let base = "0.7 * oren_nayar(N, 0.4) + 0.2 * microfacet(\"ggx\", N, 0.3, 1.5, 0)";
    let (mut bare, mut coated) = (lobes(base, 0.6), lobes(&format!("coat({base}, N, 0, 1, color(3), 0)"), 0.6));
    for (cos, phi) in [(0.9, 0.1), (0.5, 3.0), (0.1, 5.0)] {
        let wi = narrow(direction(cos, phi));
        let (a, b) = (f_cos(&mut bare, wi), f_cos(&mut coated, wi));
        assert!((a - b).abs().max_element() < 1e-5 * a.max_element(), "{a} {b}");
    }
}

#[test]
fn a_diffuse_base_follows_the_published_formula() {
    for (cos_o, cos_i) in [(1.0, 0.7), (0.6, 0.6), (0.2, 0.9), (0.05, 0.3)] {
        let mut coated = lobes("coat(0.8 * diffuse(N), N, 0, 1.5, color(0.5, 1, 2), 0.3, \"darkening\", 0)", cos_o);
        let f = f_cos(&mut coated, narrow(direction(cos_i, 2.0))) / cos_i as f32;
        let path = 1.0 / inner(cos_i, 1.5) + 1.0 / inner(cos_o, 1.5);
        for (k, absorption) in [0.5, 1.0, 2.0].into_iter().enumerate() {
            let through = pass(cos_o, 1.5) * pass(cos_i, 1.5) * (-absorption * 0.3 * path).exp();
            let expected = 0.8 / std::f64::consts::PI * through;
            assert!((f64::from(f[k]) / expected - 1.0).abs() < 1e-4, "{cos_o} {cos_i}: {f} {expected}");
        }
    }
}

#[test]
fn white_under_a_coat_of_the_paper_reflects_what_passes_twice() {
    // Fresnel's part, and of the rest what the boundary lets out on average.
    let out: f64 = gauss_legendre(64, 0.0, 1.0).iter().map(|n| 2.0 * n.weight * n.x * pass(n.x, 1.5)).sum();
    let paper = "coat(diffuse(N), N, 0, 1.5, color(0), 1, \"darkening\", 0)";
    for cos in [0.1, 0.5, 1.0] {
        let expected = 1.0 - pass(cos, 1.5) + pass(cos, 1.5) * out;
        let (mean, error) = reflected(&mut lobes(paper, cos), 200_000);
        assert!((mean - expected).abs() < 4.0 * error && error < 4e-3, "{cos}: {mean} +- {error}, {expected}");
        let base = integrate(&mut lobes(paper, cos), 1, &hemisphere(48, 64, cos));
        assert!((base[0][0] - pass(cos, 1.5) * out).abs() < 1e-3, "{cos}: {:?}", base[0]);
    }
}

/// The diffuse reflectance of a smooth boundary from inside, by the formula of Walsh 1926 for the outside. Domain: n above 1.
fn inner_reflectance(n: f64) -> f64 {
    let n2 = n * n;
    let outside = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n2 * n2 - 1.0))
        + 8.0 * n2 * n2 * (n2 * n2 + 1.0) / ((n2 + 1.0) * (n2 * n2 - 1.0).powi(2)) * n.ln();
    1.0 - (1.0 - outside) / n2
}

/// What leaves a smooth coat over a diffuse base of this albedo, without what the boundary reflects itself.
fn darkened(cos: f64, eta: f64, rho: f64) -> f64 {
    let inside = inner_reflectance(eta);
    pass(cos, eta) * rho * (1.0 - inside) / (1.0 - rho * inside)
}

#[test]
fn a_coat_darkens_a_diffuse_base_by_the_formula() {
    assert!((inner_reflectance(1.5) - 0.5963).abs() < 1e-4, "{}", inner_reflectance(1.5));
    for rho in [0.1, 0.3, 0.5, 0.8, 1.0] {
        for eta in [1.2, 1.33, 1.5, 1.8, 2.0] {
            for cos in [0.05, 0.3, 1.0] {
                let mut coated = lobes(&format!("coat({rho} * diffuse(N), N, 0, {eta}, color(0), 1)"), cos);
                let base = integrate(&mut coated, 1, &hemisphere(96, 16, cos))[0][0];
                let expected = darkened(cos, eta, rho);
                assert!((base / expected - 1.0).abs() < 5e-3, "{rho} {eta} {cos}: {base} {expected}");
            }
        }
    }
    // Measured against the control: the formula without what comes back.
    let mut paper = lobes("coat(0.5 * diffuse(N), N, 0, 1.5, color(0), 1, \"darkening\", 0)", 1.0);
    let base = integrate(&mut paper, 1, &hemisphere(96, 16, 1.0))[0][0];
    assert!(base > 1.4 * darkened(1.0, 1.5, 0.5), "{base}");
}

#[test]
fn a_white_base_under_a_coat_sends_out_all_light() {
    for (eta, rough, base) in [
        (1.2, 0.0, "diffuse(N)"),
        (1.5, 0.0, "diffuse(N)"),
        (2.0, 0.0, "diffuse(N)"),
        (0.7, 0.0, "diffuse(N)"),
        (1.5, 0.0, "0.3 * diffuse(N) + 0.7 * diffuse(N)"),
        (1.5, 0.4, "diffuse(N)"),
    ] {
        for cos in [0.1, 0.5, 1.0] {
            let (mean, error) =
                reflected(&mut lobes(&format!("coat({base}, N, {rough}, {eta}, color(0), 1)"), cos), 200_000);
            assert!((mean - 1.0).abs() < 4.0 * error + 1e-3 && error < 4e-3, "{base} {eta} {cos}: {mean} +- {error}");
        }
    }
}

/// The albedo of the base is what its lobes have in the coat: weights around the coat do not count, and each channel has its own.
#[test]
fn a_coat_darkens_each_color_by_its_own_albedo() {
    let expressions = [
        "coat(color(0.8, 0.5, 0.2) * diffuse(N), N, 0, 1.5, color(0), 1)",
        "coat(color(0.4, 0.25, 0.1) * diffuse(N) + 0.5 * (color(0.8, 0.5, 0.2) * diffuse(N)), N, 0, 1.5, color(0), 1)",
        "0.25 * (color(4, 4, 4) * coat(color(0.8, 0.5, 0.2) * diffuse(N), N, 0, 1.5, color(0), 1))",
        "0.3 * coat(color(0.8, 0.5, 0.2) * diffuse(N), N, 0, 1.5, color(0), 1)
            + 0.7 * coat(color(0.8, 0.5, 0.2) * diffuse(N), N, 0, 1.5, color(0), 1)",
    ];
    let wi = narrow(direction(0.6, 1.0));
    for expression in expressions {
        let f = f_cos(&mut lobes(expression, 1.0), wi);
        for (k, rho) in [0.8, 0.5, 0.2].into_iter().enumerate() {
            let flat = pass(0.6, 1.5) / (1.0 - inner_reflectance(1.5)) / 2.25;
            let expected = darkened(1.0, 1.5, rho) * flat * 0.6 / std::f64::consts::PI;
            assert!((f64::from(f[k]) / expected - 1.0).abs() < 1e-3, "{expression}: {f} {expected}");
        }
    }
}

/// In a coat in a coat light is thrown back by both; in an absorbing one less comes back.
#[test]
fn coats_in_coats_darken_and_absorption_dims_what_comes_back() {
    let value = |expression: &str| f64::from(f_cos(&mut lobes(expression, 0.8), narrow(direction(0.7, 2.0))).x);
    // Two boundaries that do not differ from one: the inner one bends nothing.
    let one = value("coat(0.6 * diffuse(N), N, 0, 1.5, color(0), 1)");
    let two = value("coat(coat(0.6 * diffuse(N), N, 0, 1, color(0), 1), N, 0, 1.5, color(0), 1)");
    assert!((one / two - 1.0).abs() < 1e-4, "{one} {two}");
    let outer = value("coat(coat(0.6 * diffuse(N), N, 0, 1.5, color(0), 1), N, 0, 1, color(0), 1)");
    assert!((one / outer - 1.0).abs() < 1e-4, "{one} {outer}");
    let dim = value("coat(0.6 * diffuse(N), N, 0, 1.5, color(1), 0.2)");
    let path = (-0.2 * (1.0 / inner(0.8, 1.5) + 1.0 / inner(0.7, 1.5))).exp();
    let (most, least) = (one * path, one * path * (1.0 - 0.6 * inner_reflectance(1.5)));
    assert!(dim < 0.98 * most && dim > least, "{dim} {most} {least}");
}

#[test]
fn a_mirror_under_a_coat_keeps_its_energy() {
    for cos in [0.15, 0.6, 1.0] {
        let mut coated = lobes("coat(reflection(N, 0), N, 0, 1.5, color(1, 0, 0), 0.25)", cos);
        let wo = narrow(direction(cos, 0.3));
        let expected = pass(cos, 1.5).powi(2) * (-0.5 / inner(cos, 1.5)).exp();
        let (mut samples, mut random, mut sums) = (Samples::default(), Random(SEED), [0.0f64; 3]);
        for _ in 0..20_000 {
            let xi = Vec3::new(random.number(), random.number(), random.number());
            coated.sample(&Column3::splat(xi, 1), &mut samples);
            assert_eq!(samples.event[0], event::DELTA_REFLECT);
            assert!((samples.wi.get(0) - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-5);
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += f64::from(samples.weight.get(0)[k]) / 20_000.0;
            }
        }
        let mirror = 1.0 - pass(cos, 1.5);
        assert!((sums[0] - mirror - expected).abs() < 0.02, "{cos}: {sums:?} {mirror} {expected}");
        assert!((sums[1] - mirror - pass(cos, 1.5).powi(2)).abs() < 0.02, "{cos}: {sums:?}");
    }
}

#[test]
fn no_base_gains_energy_under_a_coat() {
    let bases = [
        "diffuse(N)",
        "microfacet(\"ggx\", N, 0.05, 0, 0)",
        "microfacet(\"ggx\", N, 0.5, 0, 0)",
        "sheen(diffuse(N), N, color(1), 0.2)",
        "oren_nayar(N, 1)",
        "translucent(N)",
        "coat(diffuse(N), N, 0.3, 1.3, color(0), 0)",
        "transparent()",
    ];
    for base in bases {
        for (eta, rough) in [(1.5, 0.0), (1.5, 1.0), (2.5, 0.4), (0.7, 0.0), (0.7, 0.3)] {
            for cos in [0.05, 0.4, 1.0] {
                let mut coated = lobes(&format!("coat({base}, N, {rough}, {eta}, color(0), 1)"), cos);
                let (mean, error) = reflected(&mut coated, 60_000);
                assert!(
                    mean < 1.0 + 1e-4 + 4.0 * error && error < 0.015,
                    "{base} {eta} {rough} {cos}: {mean} +- {error}"
                );
            }
        }
    }
}

#[test]
fn coats_are_reciprocal() {
    let expression = "coat(0.7 * diffuse(N) + microfacet(\"ggx\", N, 0.3, 0, 0), N, 0.2, 1.6, color(1, 2, 3), 0.2)";
    for (a, b, phi) in [(0.9, 0.2, 1.0), (0.5, 0.6, 3.0), (0.05, 0.99, 2.0)] {
        let (wo, wi) = (narrow(direction(a, 0.3)), narrow(direction(b, phi)));
        let there = f_cos(&mut lobes(expression, a), wi) / wi.z;
        // The other way round: the viewer stands at wi, whose azimuth the frame does not care for.
        let back = narrow(direction(a, 0.3 - phi + 0.3));
        let here = f_cos(&mut lobes(expression, b), back) / wo.z;
        assert!((there - here).abs().max_element() < 1e-4 * there.max_element(), "{there} {here}");
    }
}

#[test]
fn one_leaf_serves_inside_and_outside_of_a_coat() {
    let shared = "0.5 * diffuse(N) + coat(diffuse(N), N, 0, 1.5, color(1), 0.1)";
    let wi = narrow(direction(0.4, 1.0));
    let sum = f_cos(&mut lobes(shared, 0.7), wi);
    let parts = f_cos(&mut lobes("0.5 * diffuse(N)", 0.7), wi)
        + f_cos(&mut lobes("coat(diffuse(N), N, 0, 1.5, color(1), 0.1)", 0.7), wi);
    assert!((sum - parts).abs().max_element() < 1e-6, "{sum} {parts}");
    // A closure variable that is used twice is one node of the tree.
    let shader =
        compile("surface s() { closure color d = diffuse(N); Ci = 0.5 * d + coat(d, N, 0, 1.5, color(1), 0.1); }")
            .expect("a right shader");
    let group = shader.group().build().expect("a group");
    let wo = narrow(direction(0.7, 0.3));
    let (points, mut machine) = (Points::single(wo), Machine::new());
    let mut shared = Lobes::new(Settings::default());
    shared.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
    assert!((f_cos(&mut shared, wi) - parts).abs().max_element() < 1e-6);
}

#[test]
fn emission_under_a_coat_is_tinted_and_dimmed() {
    let coated = lobes("coat(emission(), N, 0, 1.5, color(1, 2, 0), 0.5)", 0.6);
    let light = coated.emission().get(0);
    for (k, absorption) in [1.0, 2.0, 0.0].into_iter().enumerate() {
        let expected = pass(0.6, 1.5) * (-absorption * 0.5 / inner(0.6, 1.5)).exp();
        assert!((f64::from(light[k]) - expected).abs() < 1e-5, "{light} {expected}");
    }
}

#[test]
fn strange_coats_do_no_harm() {
    for parameters in [
        "0, 0, color(0), 1",
        "2, 1e30, color(-1), -1",
        "-1, -3, color(1e38), 1e38",
        "0.3, 1.5, color(1e38), 0",
        "0, 1, color(1), 1e-38",
        "0, 0.5, color(0), 1",
        "0.5, 0.01, color(1), 1",
    ] {
        for cos in [1.0, 0.3, 1e-6] {
            let mut coated = lobes(&format!("coat(diffuse(N), N, {parameters})"), cos);
            let mut out = Evaluation::default();
            for wi in [Vec3::Z, -Vec3::Z, narrow(direction(1e-10, 1.0)), narrow(direction(cos, 3.4))] {
                coated.evaluate(&Column3::splat(wi, 1), &mut out);
                let f = out.f_cos.get(0);
                assert!(
                    f.is_finite() && f.min_element() >= 0.0 && out.pdf[0].is_finite(),
                    "{parameters} {cos} {wi}: {f}"
                );
            }
            let (mean, error) = reflected(&mut coated, 20_000);
            assert!(mean.is_finite() && mean < 1.001 + 4.0 * error, "{parameters} {cos}: {mean}");
        }
    }
}

/// A rough coat lets through what its facets do not reflect, so its rim is not darker than that of a smooth one.
#[test]
fn a_rough_coat_passes_what_it_does_not_reflect() {
    for (rough, cos) in [(0.2, 0.1), (0.5, 0.1), (1.0, 0.3)] {
        let (mean, error) =
            reflected(&mut lobes(&format!("coat(diffuse(N), N, {rough}, 1.5, color(0), 1)"), cos), 200_000);
        // What it throws back at the white base comes out in the end.
        assert!((mean - 1.0).abs() < 4.0 * error + 2e-3 && error < 5e-3, "{rough} {cos}: {mean} +- {error}");
    }
}

/// A coat whose parameters are no numbers is dropped and told, and its base stays; what is too thick is black.
#[test]
fn a_broken_coat_is_dropped_alone() {
    for parameter in ["r", "e", "a", "t"] {
        let text = "surface s(float r = 0, float e = 1.5, color a = 1, float t = 0.1) { Ci = coat(diffuse(N), N, r, e, a, t); }";
        let values = vec![f64::NAN; if parameter == "a" { 3 } else { 1 }];
        let group = compile(text).expect("a shader").group().param(parameter, &values).build().expect("a group");
        let (points, mut machine) = (Points::single(Vec3::Z), Machine::new());
        let mut broken = Lobes::new(Settings::default());
        broken.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(Vec3::Z, 1), &points.ng);
        assert_eq!(broken.dropped().first().map(|d| d.closure), Some("coat"), "{parameter}");
        let f = f_cos(&mut broken, Vec3::Z).x;
        assert!((f - std::f32::consts::FRAC_1_PI).abs() < 1e-5, "{parameter}: {f}");
    }
    let mut thick = lobes("coat(diffuse(N), N, 0, 1.5, color(1e38), 1e38)", 0.7);
    assert_eq!(f_cos(&mut thick, Vec3::Z), Vec3::ZERO);
}

/// What a top inside a coat takes does not depend on which other lanes are shaded beside it.
#[test]
fn lanes_know_nothing_of_each_other_under_coats() {
    let text = "surface s() {
        closure color a = sheen_bsdf(N, color(1), 0.4), b = diffuse(N);
        if (u > 0.5) Ci = layer(a, b); else Ci = coat(layer(a, b), N, 0.1, 1.5, color(0), 1);
    }";
    let group = compile(text).expect("a shader").group().build().expect("a group");
    let (wo, wi) = (narrow(direction(0.3, 0.3)), narrow(direction(0.4, 2.0)));
    let values = |us: &[f32]| {
        let mut points = Points::new(us.len());
        for (lane, &u) in us.iter().enumerate() {
            points.i.set(lane, -wo);
            points.n.set(lane, Vec3::Z);
            points.ng.set(lane, Vec3::Z);
            points.u[lane] = u;
        }
        let (mut machine, mut lobes, mut out) =
            (Machine::new(), Lobes::new(Settings::default()), Evaluation::default());
        let wo = Column3::splat(wo, us.len());
        lobes.flatten(group.library(), machine.shade(&group, &points), &wo, &points.ng);
        lobes.evaluate(&Column3::splat(wi, us.len()), &mut out);
        (0..us.len()).map(|lane| (out.f_cos.get(lane), out.pdf[lane])).collect::<Vec<_>>()
    };
    let mixed = values(&[0.2, 0.8, 0.3, 0.9]);
    for (lane, u) in [0.2, 0.8, 0.3, 0.9].into_iter().enumerate() {
        assert_eq!(values(&[u])[0], mixed[lane], "u = {u}");
    }
}
