//! Rough boundaries: golden figures of Blinn and V-grooves, both samplings, Fresnel terms, and parameters at their ends.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use serde_json::Value;
use std::sync::LazyLock;
use velour::bsdf::fresnel::{Conductor, Dielectric, Fresnel, Schlick, conductor, dielectric, eta_of_reflectance};
use velour::bsdf::microfacet::distribution::{Distribution, Widths};
use velour::bsdf::microfacet::{Beckmann, Blinn, Geometry, Ggx, Method, Microfacet, Sampling};
use velour::bsdf::{Choice, Params, Scatter, Side, params};
use velour::math::quadrature::{Node, gauss_legendre};
use velour::measure::statistics::Random;

static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../reference/microfacet.json")).expect("the reference file is JSON")
});

/// The numbers of a table, row by row, in the order of its columns.
fn rows(table: &str) -> Vec<Vec<f64>> {
    let numbers = |row: &Value| row.as_array().expect("a row").iter().map(|v| v.as_f64().expect("a number")).collect();
    REFERENCE[table]["rows"].as_array().expect("rows").iter().map(numbers).collect()
}

fn relative(value: f32, expected: f64, floor: f64) -> f64 {
    (f64::from(value) - expected).abs() / expected.abs().max(floor)
}

fn hold(worst: f64, bar: f64, what: &str) {
    println!("{what}: {worst:.2e} (bar {bar:.0e})");
    assert!(worst <= bar, "{what}: {worst:e} > {bar:e}");
}

fn isotropic<D: Distribution>(alpha: f32) -> D {
    D::new(Widths { x: alpha, y: alpha })
}

/// The width of a power of the cosine.
fn of_power(s: f64) -> Blinn {
    isotropic((2.0 / (s + 2.0)).sqrt() as f32)
}

/// The methods of shadowing and sampling.
fn methods() -> impl Iterator<Item = (Geometry, Sampling)> {
    Geometry::ALL.iter().flat_map(|g| Sampling::ALL.iter().map(move |s| (g.1, s.1)))
}

#[test]
fn blinn_is_as_tabulated() {
    let mut worst = [0.0f64; 4];
    for row in rows("blinn_d") {
        let d = of_power(row[0]).d(narrow(direction(row[1], 0.3)));
        worst[0] = worst[0].max(relative(d, row[2], 1e-6));
    }
    let lambda = |s: f64, c: f64| of_power(s).lambda(narrow(direction(c, 0.7)));
    for row in rows("blinn_lambda") {
        let l = lambda(row[0], row[1]);
        worst[1] = worst[1].max(relative(l, row[2], 1e-5));
        worst[2] = worst[2].max((1.0 / (1.0 + f64::from(l)) - row[4]).abs());
    }
    for row in rows("blinn_g2") {
        let (i, o) = (lambda(row[0], row[1]), lambda(row[0], row[2]));
        worst[3] = worst[3].max(relative(1.0 / (1.0 + i + o), row[3], 1e-6));
        worst[3] = worst[3].max(relative(1.0 / (1.0 + i + o + i * o), row[4], 1e-6));
    }
    for (value, what) in worst.into_iter().zip(["Blinn D", "Blinn Lambda", "Blinn G1", "Blinn G2"]) {
        hold(value, 2e-5, what);
    }
}

static NODES: LazyLock<Vec<Node>> = LazyLock::new(|| gauss_legendre(300, -1.0, 1.0));

/// Smith's Lambda of Blinn from its definition, in f64.
fn blinn_lambda_by_quadrature(alpha: f64, c: f64) -> f64 {
    // D projected on the azimuth of the direction: P(q) of slopes is proportional to (1 + q²)^(-(s+3)/2), and
    // Lambda = tan * integral over q > cot of (q - cot) P(q), with P normalised over the projected area.
    let half = 1.0 / (alpha * alpha) + 0.5;
    let front = {
        // The integral of (1 + q²)^-half over all q, by the tangent.
        let scale = 6.0 / (2.0 * half).sqrt();
        NODES.iter().map(|n| weight_of(n.x, n.weight, scale, half).1).sum::<f64>()
    };
    let cot = c / ((1.0 - c) * (1.0 + c)).sqrt();
    let scale = 3.0 / (2.0 * half).sqrt();
    let tail = |n: &Node| {
        // q = cot + scale * t / (1 - t), t in 0..1.
        let (t, w) = (0.5 + 0.5 * n.x, 0.5 * n.weight);
        let q = cot + scale * t / (1.0 - t);
        w * scale / (1.0 - t).powi(2) * (q - cot) * (-half * (q * q).ln_1p()).exp()
    };
    NODES.iter().map(tail).sum::<f64>() / front / cot
}

/// A node in -1..1 spread over all numbers, with the value of (1 + q²)^-half times its weight.
fn weight_of(x: f64, weight: f64, scale: f64, half: f64) -> (f64, f64) {
    let q = scale * x / (1.0 - x * x);
    let slope = scale * (1.0 + x * x) / (1.0 - x * x).powi(2);
    (q, weight * slope * (-half * (q * q).ln_1p()).exp())
}

#[test]
fn blinn_lambda_holds_for_every_width() {
    let (mut worst, mut g1) = (0.0f64, 0.0f64);
    for alpha in [0.001f32, 0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 0.999, 1.0] {
        let blinn = isotropic::<Blinn>(alpha);
        for k in 1..60 {
            let cot = f64::from(alpha) * f64::from(k) * 0.06;
            let c = cot / (1.0 + cot * cot).sqrt();
            // Rounding of the direction would count as an error of the model.
            let v = narrow(direction(c, 0.2));
            let exact = blinn_lambda_by_quadrature(f64::from(alpha), f64::from(v.z));
            let l = blinn.lambda(v);
            g1 = g1.max((1.0 / (1.0 + f64::from(l)) - 1.0 / (1.0 + exact)).abs());
            if exact > 1e-5 {
                worst = worst.max(relative(l, exact, 0.0));
            }
        }
    }
    hold(worst, 1e-5, "Blinn Lambda above 1e-5, all widths");
    hold(g1, 3e-6, "Blinn G1, all widths");
}

#[test]
fn distributions_have_a_projected_area_of_one() {
    fn area<D: Distribution>(x: f32, y: f32) -> f64 {
        let d = D::new(Widths { x, y });
        // In the tangent, scaled to the width; azimuth by equal steps.
        let mut sum = 0.0;
        for node in gauss_legendre(200, 0.0, 1.0) {
            let scale = f64::from(x.min(y));
            let tan = scale * node.x / (1.0 - node.x);
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            // d omega cos = tan cos^4 d tan d phi
            let ring = node.weight * scale / (1.0 - node.x).powi(2) * tan * cos.powi(4);
            for k in 0..64 {
                let m = narrow(direction(cos, (f64::from(k) + 0.5) * std::f64::consts::TAU / 64.0));
                sum += ring * std::f64::consts::TAU / 64.0 * f64::from(d.d(m));
            }
        }
        sum
    }
    let mut worst = 0.0f64;
    for (x, y) in [(0.001, 0.001), (0.02, 0.02), (0.3, 0.3), (0.3, 0.5), (1.0, 1.0)] {
        for sum in [area::<Ggx>(x, y), area::<Beckmann>(x, y), area::<Blinn>(x, y)] {
            worst = worst.max((sum - 1.0).abs());
        }
    }
    hold(worst, 1e-4, "projected area");
}

#[test]
fn grooves_are_as_tabulated() {
    let mut worst = 0.0f64;
    let model =
        |g| Microfacet::<Ggx, Dielectric, false>::prepare(params([0.5, 0.5, 0.0])).choose(method(g, Sampling::Visible));
    for row in rows("vgroove_g") {
        let wo = narrow(direction(row[0].to_radians().cos(), 0.0));
        let wi = narrow(direction(row[1].to_radians().cos(), row[2].to_radians()));
        let (groove, smith) = (model(Geometry::VGroove).eval(wo, wi), model(Geometry::Smith).eval(wo, wi));
        let ggx = isotropic::<Ggx>(0.5);
        let g = groove.f_cos / smith.f_cos / (1.0 + ggx.lambda(wo) + ggx.lambda(wi));
        worst = worst.max(relative(g, row[5], 1e-6));
    }
    hold(worst, 2e-5, "V-groove G");
}

/// The choice of a shadowing term and a way of sampling.
fn method(geometry: Geometry, sampling: Sampling) -> Choice {
    Method { geometry, sampling, ..Method::default() }.into()
}

/// Every model with every method at a few widths.
fn each_model(mut run: impl FnMut(&str, &dyn Fn(Vec3, Vec3) -> (Vec3, f32), &dyn Fn(Vec3, Vec3) -> Vec3, Side)) {
    fn one<M: Scatter>(
        (p, m): (Params, Choice),
        name: &str,
        run: &mut impl FnMut(&str, &dyn Fn(Vec3, Vec3) -> (Vec3, f32), &dyn Fn(Vec3, Vec3) -> Vec3, Side),
    ) {
        let model = M::prepare(p).choose(m);
        run(name, &|o, i| (model.colored(o, i), model.eval(o, i).pdf), &|o, xi| model.sample(o, xi), M::SIDE);
    }
    macro_rules! distributions {
        ($($d:ident),*) => {$(
            for (x, y) in [(0.05, 0.05), (0.3, 0.3), (0.2, 0.7), (1.0, 1.0)] {
                for (g, s) in methods() {
                    let m = method(g, s);
                    let name = |f: &str| format!("{} {f} {x} {y} {g:?} {s:?}", stringify!($d));
                    for eta in [1.5, 1.0 / 1.5] {
                        let p = (params([x, y, eta]), m);
                        one::<Microfacet<$d, Dielectric, false>>(p, &name("dielectric, reflecting"), &mut run);
                        one::<Microfacet<$d, Dielectric, true>>(p, &name("dielectric, refracting"), &mut run);
                    }
                    let metal = (params([x, y, 0.2, 0.9, 1.4, 3.9, 2.4, 1.6]), m);
                    one::<Microfacet<$d, Conductor, false>>(metal, &name("conductor"), &mut run);
                    let glaze = (params([x, y, 0.04, 0.3, 0.0, 1.0, 0.9, 0.5, 5.0, 2.0]), m);
                    one::<Microfacet<$d, Schlick, false>>(glaze, &name("schlick, reflecting"), &mut run);
                    one::<Microfacet<$d, Schlick, true>>(glaze, &name("schlick, refracting"), &mut run);
                }
            }
        )*};
    }
    distributions!(Ggx, Beckmann, Blinn);
}

#[test]
fn densities_count_the_samples_and_weights_sum_to_the_albedo() {
    const SIDES: u32 = 64;
    let (mut counted, mut weighed, mut cases) = (0.0f64, 0.0f64, 0);
    each_model(|name, f, sample, side| {
        if name.contains(" 0.05 ") {
            // Equal cells of the sphere cannot see a peak that narrow.
            return;
        }
        let wo = narrow(direction(0.6, 0.4));
        let (mut kept, mut mean) = (0.0, Vec3::ZERO);
        for a in 0..SIDES {
            for b in 0..SIDES {
                let xi = Vec3::new((a as f32 + 0.5) / SIDES as f32, (b as f32 + 0.5) / SIDES as f32, 0.5);
                let wi = sample(wo, xi);
                let (value, pdf) = f(wo, wi);
                if wi != Vec3::ZERO && pdf > 0.0 {
                    kept += 1.0 / f64::from(SIDES * SIDES);
                    mean += value / pdf / (SIDES * SIDES) as f32;
                }
            }
        }
        let (mut density, mut sum) = (0.0, Vec3::ZERO);
        let sign = if side == Side::Other { -1.0 } else { 1.0 };
        for node in gauss_legendre(160, 0.0, 1.0) {
            for k in 0..240 {
                let mut wi = narrow(direction(node.x, (f64::from(k) + 0.5) * std::f64::consts::TAU / 240.0));
                wi.z *= sign;
                let (value, pdf) = f(wo, wi);
                let weight = node.weight * std::f64::consts::TAU / 240.0;
                density += weight * f64::from(pdf);
                sum += value * weight as f32;
            }
        }
        assert!((density - kept).abs() < 0.02, "{name}: density {density}, kept {kept}");
        assert!((sum - mean).abs().max_element() < 0.02, "{name}: {sum} by quadrature, {mean} by samples");
        assert!(sum.max_element() < 1.0001, "{name}: gains energy, {sum}");
        counted = counted.max((density - kept).abs());
        weighed = weighed.max(f64::from((sum - mean).abs().max_element()));
        cases += 1;
    });
    println!("{cases} models: densities within {counted:.1e}, albedos within {weighed:.1e}");
}

#[test]
fn half_vector_samples_weigh_as_in_the_slides() {
    fn check<D: Distribution>(alpha: f32, geometry: Geometry) -> f64 {
        let model = Microfacet::<D, Dielectric, false>::prepare(params([alpha, alpha, 1.5]))
            .choose(method(geometry, Sampling::Normals));
        let d = isotropic::<D>(alpha);
        let (mut random, mut worst) = (Random(SEED), 0.0f64);
        for k in 0..2000 {
            let wo = narrow(direction(0.05 + 0.9 * f64::from(k % 19) / 19.0, 1.0));
            let xi = Vec3::new(random.number(), random.number(), random.number());
            let wi = model.sample(wo, xi);
            let m = d.sample_normal(xi.x, xi.y);
            let om = wo.dot(m);
            if wi.z <= 1e-3 || om <= 1e-3 {
                continue;
            }
            let eval = model.eval(wo, wi);
            let g = match geometry {
                Geometry::Smith => 1.0 / (1.0 + d.lambda(wo) + d.lambda(wi)),
                Geometry::Separable => 1.0 / ((1.0 + d.lambda(wo)) * (1.0 + d.lambda(wi))),
                Geometry::VGroove => (2.0 * m.z * wo.z / om).min(2.0 * m.z * wi.z / om).min(1.0),
            };
            let slides = dielectric(om, 1.5) * g * om / (wo.z * m.z);
            worst = worst.max(relative(eval.f_cos / eval.pdf, f64::from(slides), 1e-6));
        }
        worst
    }
    for (_, geometry) in Geometry::ALL {
        for alpha in [0.1, 0.4, 1.0] {
            let worst = check::<Ggx>(alpha, *geometry).max(check::<Beckmann>(alpha, *geometry));
            hold(worst.max(check::<Blinn>(alpha, *geometry)), 1e-3, "F G (o.m) / ((n.o)(n.m))");
        }
    }
}

/// Fresnel of a complex index by complex arithmetic in f64.
fn complex_fresnel(c: f64, eta: f64, k: f64) -> f64 {
    type C = (f64, f64);
    let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let norm = |a: C| a.0 * a.0 + a.1 * a.1;
    let div = |a: C, b: C| (mul(a, (b.0, -b.1)).0 / norm(b), mul(a, (b.0, -b.1)).1 / norm(b));
    let index = (eta, k);
    let square = mul(index, index);
    let inside = div((1.0 - c * c, 0.0), square);
    // The principal root of 1 - sin² / n².
    let (re, im) = (1.0 - inside.0, -inside.1);
    let length = (re * re + im * im).sqrt();
    let root = (((length + re) / 2.0).max(0.0).sqrt(), ((length - re) / 2.0).max(0.0).sqrt().copysign(im));
    let nt = mul(index, root);
    let s = norm((c - nt.0, -nt.1)) / norm((c + nt.0, nt.1));
    let nc = (eta * c, k * c);
    let p = norm((nc.0 - root.0, nc.1 - root.1)) / norm((nc.0 + root.0, nc.1 + root.1));
    0.5 * (s + p)
}

#[test]
fn conductors_reflect_as_complex_arithmetic_says() {
    let (mut worst, mut glass) = (0.0f64, 0.0f64);
    for eta in [0.05f32, 0.2, 0.9, 1.0, 1.3, 2.9, 10.0, 100.0] {
        for k in [0.0f32, 1e-3, 0.05, 0.5, 1.0, 3.9, 20.0, 200.0] {
            for step in 1..=200 {
                let c = step as f32 / 200.0;
                if k == 0.0 && eta == 1.0 {
                    assert!(conductor(c, eta, k) < 1e-6);
                    continue;
                }
                let exact = complex_fresnel(f64::from(c), f64::from(eta), f64::from(k));
                worst = worst.max((f64::from(conductor(c, eta, k)) - exact).abs());
                if k == 0.0 {
                    glass = glass.max((f64::from(conductor(c, eta, 0.0)) - f64::from(dielectric(c, eta))).abs());
                }
            }
            assert_eq!(conductor(0.0, eta, k), 1.0, "grazing light is reflected: {eta} {k}");
        }
    }
    hold(worst, 1e-5, "conductor Fresnel");
    hold(glass, 1e-5, "conductor without extinction against a dielectric");
    assert_eq!(conductor(0.3, 0.0, 1.0), 1.0);
    assert_eq!(conductor(0.3, 0.0, 0.0), 1.0);
    let metal =
        Conductor::prepare(params([f32::NAN, f32::INFINITY, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY]), 0);
    assert!(metal.color(0.5).is_finite());
}

#[test]
fn schlick_is_exact_at_its_ends() {
    let p = [0.04, 0.5, 0.93, 1.0, 0.8, 0.7];
    for exponent in [0.01, 1.0, 5.0, 40.0] {
        let mut all = params([p[0], p[1], p[2], p[3], p[4], p[5], exponent, 2.0]);
        let outside = Schlick::prepare(all, 0);
        assert_eq!(outside.color(1.0), Vec3::new(p[0], p[1], p[2]));
        assert_eq!(outside.color(0.0), Vec3::new(p[3], p[4], p[5]));
        all[7] = 0.5;
        let inside = Schlick::prepare(all, 0);
        assert!((outside.eta() * inside.eta() - 1.0).abs() < 1e-6);
        assert_eq!(inside.color(1.0), Vec3::new(p[0], p[1], p[2]));
        for c in [0.1f32, 0.4, 0.9] {
            // A facet passes the same both ways.
            let within = (1.0 - (1.0 - c * c) / (outside.eta() * outside.eta())).sqrt();
            assert!((outside.color(c) - inside.color(within)).abs().max_element() < 1e-4);
        }
        let critical = (1.0 - inside.eta() * inside.eta()).sqrt();
        assert_eq!(inside.color(critical * 0.99), Vec3::new(p[3], p[4], p[5]), "total reflection is grazing");
    }
    let flat = Schlick::prepare(params([0.0, 0.0, 0.0, 0.3, 0.3, 0.3, 0.0, 1.0]), 0);
    assert_eq!((flat.color(1.0), flat.color(0.2)), (Vec3::splat(0.3), Vec3::splat(0.3)));
    assert!((eta_of_reflectance(0.04) - 1.5).abs() < 1e-6 && eta_of_reflectance(2.0).is_finite());
}

#[test]
fn parameters_at_their_ends_stay_finite() {
    fn check<M: Scatter>(values: Params, choice: Choice) {
        let model = M::prepare(values).choose(choice);
        let mut random = Random(SEED);
        for k in 0..400 {
            let cos = if k % 3 == 0 { 1e-10 } else { f64::from(random.number()).max(1e-6) };
            let wo = narrow(direction(cos, f64::from(random.number()) * 6.0));
            let wi = model.sample(wo, Vec3::new(random.number(), random.number(), random.number()));
            assert!(wi.is_finite(), "{values:?} {wo}");
            let below = Vec3::new(wo.y, -wo.x, -wo.z);
            for w in [wi, wo, -wo, below, Vec3::X, Vec3::ZERO] {
                let (eval, color) = (model.eval(wo, w), model.colored(wo, w));
                assert!(eval.f_cos >= 0.0 && eval.f_cos.is_finite(), "{values:?} {wo} {w} {eval:?}");
                assert!(eval.pdf >= 0.0 && eval.pdf.is_finite(), "{values:?} {wo} {w} {eval:?}");
                assert!(color.is_finite() && color.min_element() >= 0.0, "{values:?} {wo} {w} {color}");
            }
            assert!((0.0..=1.0).contains(&model.albedo(wo.z)) && (0.0..=1.0).contains(&model.top_albedo(wo)));
        }
    }
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e-39, 1.0, 7.0];
    for (g, s) in methods() {
        for a in odd {
            for b in odd {
                check::<Microfacet<Ggx, Dielectric, false>>(params([a, 0.3, b]), method(g, s));
                check::<Microfacet<Blinn, Dielectric, true>>(params([0.5, a, b]), method(g, s));
                check::<Microfacet<Beckmann, Conductor, false>>(params([a, a, b, 1.0, b, a, b, 0.0]), method(g, s));
                check::<Microfacet<Blinn, Schlick, false>>(params([0.1, a, b, b, a, 1.0, a, b, a, 2.0]), method(g, s));
                check::<Microfacet<Ggx, Schlick, true>>(params([0.1, 0.9, b, a, a, 1.0, a, b, b, 0.5]), method(g, s));
            }
        }
    }
}

#[test]
fn equal_indices_and_total_reflection() {
    let wo = narrow(direction(0.3, 0.0));
    let none = Microfacet::<Ggx, Dielectric, false>::prepare(params([0.3, 0.3, 1.0]));
    assert!(none.eval(wo, narrow(direction(0.4, 3.0))).f_cos < 1e-9, "equal indices reflect nothing");
    let mirror = Microfacet::<Ggx, Dielectric, true>::prepare(params([0.3, 0.3, -1.0]));
    assert_eq!(mirror.sample(wo, Vec3::splat(0.3)), Vec3::ZERO, "an index below zero refracts nothing");
    assert_eq!(mirror.albedo(0.3), 0.0);
    // From glass at a grazing angle nearly all facets reflect all light.
    let within = Microfacet::<Ggx, Dielectric, true>::prepare(params([0.02, 0.02, 1.0 / 1.5]));
    let mut random = Random(SEED);
    for _ in 0..1000 {
        let wi = within.sample(wo, Vec3::new(random.number(), random.number(), 0.5));
        assert!(wi == Vec3::ZERO || within.eval(wo, wi).f_cos >= 0.0);
    }
}
