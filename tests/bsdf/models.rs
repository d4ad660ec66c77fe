//! The models beside microfacets and sheen: against double precision, against themselves exchanged, and at their edges.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use std::f64::consts::PI;
use velour::bsdf::ashikhmin_shirley::{Highlight, Under};
use velour::bsdf::burley::Burley;
use velour::bsdf::eon::Eon;
use velour::bsdf::lafortune::Lafortune;
use velour::bsdf::phong::Phong;
use velour::bsdf::sheen::fibers::Fibers;
use velour::bsdf::ward::Ward;
use velour::bsdf::{Params, Scatter, params};
use velour::measure::furnace::hemisphere;
use velour::measure::statistics::Random;

type Wide = [f64; 3];

fn wide(v: Vec3) -> Wide {
    let w = [f64::from(v.x), f64::from(v.y), f64::from(v.z)];
    unit(w)
}

fn dot(a: Wide, b: Wide) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: Wide) -> Wide {
    let length = dot(a, a).sqrt();
    a.map(|v| v / length)
}

fn half(a: Wide, b: Wide) -> Wide {
    unit([a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

/// The published formulas in double precision: f of two directions above the horizon, with white parameters.
mod published {
    use super::{PI, Params, Wide, dot, half};

    fn wide(p: f32) -> f64 {
        f64::from(p)
    }

    fn lobe(cos: f64, n: f64) -> f64 {
        if cos > 0.0 { cos.powf(n) } else { 0.0 }
    }

    pub fn phong(p: Params, o: Wide, i: Wide) -> f64 {
        let n = wide(p[0]);
        (n + 2.0) / (2.0 * PI) * lobe(dot([-o[0], -o[1], o[2]], i), n)
    }

    pub fn lafortune(p: Params, o: Wide, i: Wide) -> f64 {
        let largest = wide(p[0].abs().max(p[1].abs()).max(p[2].abs()));
        let c = [0, 1, 2].map(|k| wide(p[k]) / largest * o[k]);
        (wide(p[3]) + 2.0) / (2.0 * PI) * lobe(dot(c, i), wide(p[3]))
    }

    fn gauss(p: Params, h: Wide) -> f64 {
        let (x, y) = (h[0] / wide(p[0]), h[1] / wide(p[1]));
        (-(x * x + y * y) / (h[2] * h[2])).exp() / (4.0 * PI * wide(p[0]) * wide(p[1]))
    }

    pub fn ward(p: Params, o: Wide, i: Wide) -> f64 {
        gauss(p, half(o, i)) / (o[2] * i[2]).sqrt()
    }

    pub fn ward_bounded(p: Params, o: Wide, i: Wide) -> f64 {
        let h = half(o, i);
        gauss(p, h) / (dot(h, i).powi(2) * h[2].powi(4))
    }

    pub fn highlight(p: Params, o: Wide, i: Wide) -> f64 {
        let h = half(o, i);
        let e = (wide(p[0]) * h[0] * h[0] + wide(p[1]) * h[1] * h[1]) / (1.0 - h[2] * h[2]).max(1e-15);
        let norm = ((wide(p[0]) + 1.0) * (wide(p[1]) + 1.0)).sqrt() / (8.0 * PI);
        let k = dot(h, i);
        let fresnel = wide(p[2]) + (1.0 - wide(p[2])) * (1.0 - k).powi(5);
        norm * h[2].powf(e) * fresnel / (k * o[2].max(i[2]))
    }

    pub fn under(p: Params, o: Wide, i: Wide) -> f64 {
        let side = |c: f64| 1.0 - (1.0 - 0.5 * c).powi(5);
        28.0 / (23.0 * PI) * wide(p[3]) * (1.0 - wide(p[0])) * side(o[2]) * side(i[2])
    }

    pub fn burley(p: Params, o: Wide, i: Wide) -> f64 {
        let f90 = 0.5 + 2.0 * wide(p[0]) * dot(half(o, i), i).powi(2);
        let side = |c: f64| 1.0 + (f90 - 1.0) * (1.0 - c).powi(5);
        side(o[2]) * side(i[2]) / PI
    }

    pub fn eon(p: Params, o: Wide, i: Wide) -> f64 {
        let (r, rho) = (wide(p[0]), wide(p[1]));
        let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
        let mean = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
        let single = |c: f64| {
            let (theta, s) = (c.acos(), (1.0 - c * c).sqrt());
            let g = s * (theta - s * c - 2.0 / 3.0) + 2.0 / 3.0 * theta.tan() * (1.0 - s.powi(3));
            a * (1.0 + r / PI * g)
        };
        let s = dot(o, i) - o[2] * i[2];
        let once = a * (1.0 + r * s / if s > 0.0 { o[2].max(i[2]) } else { 1.0 });
        let color = rho * mean / (1.0 - rho * (1.0 - mean));
        // What the closure multiplies with rho.
        (once + color * (1.0 - single(o[2])) * (1.0 - single(i[2])) / (1.0 - mean)) / PI
    }
}

fn random_direction(random: &mut Random, grazing: bool) -> Vec3 {
    let z = if grazing { 10f64.powf(-4.0 * f64::from(random.number())) } else { f64::from(random.number().max(1e-3)) };
    narrow(direction(z, 6.3 * f64::from(random.number())))
}

/// Holds f, its red color included, to a formula over random directions, a third near the peak and a third grazing.
fn agrees<M: Scatter, const N: usize>(values: [f32; N], formula: fn(Params, Wide, Wide) -> f64, bar: f64) {
    let (p, mut random, mut worst) = (params(values), Random(SEED), 0.0f64);
    let model = M::prepare(p);
    for k in 0..20_000 {
        let wo = random_direction(&mut random, k % 3 == 1);
        let mut wi = if k % 3 == 0 {
            model.sample(wo, Vec3::splat(random.number()))
        } else {
            random_direction(&mut random, k % 2 == 1)
        };
        if wi.z <= 0.0 {
            wi = Vec3::Z;
        }
        let value = f64::from(model.colored(wo, wi).x);
        let expected = formula(p, wide(wo), wide(wi)) * f64::from(wi.z);
        worst = worst.max((value - expected).abs() / expected.max(1e-2));
    }
    println!("{} {values:?}: {worst:.1e}", std::any::type_name::<M>());
    assert!(worst < bar, "{} {values:?}: {worst:e}", std::any::type_name::<M>());
}

#[test]
fn models_agree_with_their_published_formulas() {
    for n in [0.0, 1.0, 1.5, 3.0, 20.0, 150.0, 2000.0] {
        // The rounding of a direction, 6e-8, counts n times; below a power of 1 without bound, where the lobe ends.
        let bar = 2e-5 + 3e-7 * f64::from(n);
        agrees::<Phong, 1>([n], published::phong, bar);
        for c in [[-1.0, -1.0, 1.0], [0.3, 2.0, -0.7], [1.0, 1.0, 1.0], [-0.2, -0.9, 0.4]] {
            agrees::<Lafortune, 4>([c[0], c[1], c[2], n], published::lafortune, bar);
        }
        for ny in [0.0, 10.0, 1000.0] {
            agrees::<Highlight, 5>([n, ny, 0.2, 0.5, 1.0], published::highlight, 5e-5 + 2e-6 * f64::from(n.max(ny)));
        }
    }
    for (x, y) in [(0.2f32, 0.2), (0.02, 0.05), (0.1, 0.7), (1.0, 0.3)] {
        let bar = 5e-5 + 4e-6 / f64::from(x.min(y));
        agrees::<Ward<false>, 2>([x, y], published::ward, bar);
        agrees::<Ward<true>, 2>([x, y], published::ward_bounded, bar);
    }
    for r in [0.0, 0.3, 1.0] {
        agrees::<Under, 6>([r, 0.5, 0.1, 0.8, 1.0, 0.0], published::under, 1e-5);
        agrees::<Burley, 1>([r], published::burley, 1e-5);
        for rho in [0.0, 0.4, 1.0] {
            agrees::<Eon, 4>([r, rho, 0.5, 0.5], published::eon, 2e-4);
        }
    }
}

#[test]
fn known_values() {
    // Along the normal the lobe of Phong is (n + 2) / (2 pi), Ward's 1 / (4 pi ax ay), Burley's 1 / pi.
    let peak =
        |value: f32, expected: f64| assert!((f64::from(value) / expected - 1.0).abs() < 1e-5, "{value} {expected}");
    peak(Phong::prepare(params([1e6])).eval(Vec3::Z, Vec3::Z).f_cos, 1_000_002.0 / (2.0 * PI));
    peak(Ward::<false>::prepare(params([0.1, 0.3])).eval(Vec3::Z, Vec3::Z).f_cos, 1.0 / (0.12 * PI));
    peak(Burley::prepare(params([0.7])).eval(Vec3::Z, Vec3::Z).f_cos, 1.0 / PI);
    peak(Eon::prepare(params([0.0, 1.0, 1.0, 1.0])).eval(Vec3::Z, Vec3::Z).f_cos, 1.0 / PI);
    // Coefficients (-1, -1, 1) of any length are Phong's lobe.
    let (wo, wi) = (narrow(direction(0.4, 1.0)), narrow(direction(0.5, 4.0)));
    let phong = Phong::prepare(params([40.0])).eval(wo, wi);
    assert_eq!(Lafortune::prepare(params([-3.0, -3.0, 3.0, 40.0])).eval(wo, wi), phong);
    // Beside white, EON's color of repeated scattering is rho² in all.
    let eon = Eon::prepare(params([1.0, 0.0, 0.5, 1.0])).colored(wo, wi);
    assert!(eon.x < eon.y && eon.y < eon.z);
    // Nodes of the published table: roughness and cosine of 31ths, and what the sheen reflects.
    for (row, column, expected) in FIBER_NODES {
        let model = Fibers::prepare(params([f32::from(row) / 31.0]));
        let albedo = model.albedo(f32::from(column) / 31.0);
        assert!((albedo - expected).abs() < 0.005, "{row} {column}: {albedo} {expected}");
    }
}

/// Five nodes of the published table of the sheen of fibers: row, column, reflected light.
const FIBER_NODES: [(u8, u8, f32); 5] =
    [(8, 4, 0.31773), (15, 0, 0.69404), (15, 20, 0.07655), (31, 0, 0.74973), (31, 31, 0.34187)];

/// Calls a function with every model at five settings or so.
macro_rules! everywhere {
    ($check:ident) => {
        for n in [20.0, 0.0, 3.0, 150.0, 2000.0] {
            $check::<Phong>(params([n]), true, 1e-4);
            $check::<Lafortune>(params([-1.0, -1.0, 1.0, n]), true, 1e-4);
            $check::<Lafortune>(params([0.7, 0.7, 1.0, n]), true, 1e-4);
            $check::<Highlight>(params([n, n, 0.1, 0.1, 0.1]), true, 1e-2);
            $check::<Highlight>(params([n, n, 1.0, 1.0, 1.0]), true, 1e-2);
        }
        for a in [0.2, 0.02, 0.1, 0.5, 1.0] {
            $check::<Ward<true>>(params([a, a]), true, 1e-2);
            $check::<Ward<false>>(params([a, a]), true, 1.2e-2);
        }
        for r in [0.5, 0.0, 0.2, 0.8, 1.0] {
            $check::<Burley>(params([r]), true, 1e-4);
            $check::<Eon>(params([r, 1.0, 1.0, 1.0]), true, 2e-4);
            $check::<Eon>(params([r, 0.3, 0.3, 0.3]), true, 2e-4);
            $check::<Under>(params([r, r, r, 1.0, 1.0, 1.0]), true, 1e-4);
            $check::<Fibers>(params([r]), false, 1e-4);
        }
    };
}

/// The mean weight of stratified samples, of the largest component, and the part of them that is not lost.
fn by_samples<M: Scatter>(model: &M, wo: Vec3) -> (f64, f64) {
    const SIDE: u32 = 400;
    let (mut sum, mut kept) = (0.0, 0.0);
    for k in 0..SIDE * SIDE {
        let (u, v) = (((k / SIDE) as f32 + 0.5) / SIDE as f32, ((k % SIDE) as f32 + 0.5) / SIDE as f32);
        let wi = model.sample(wo, Vec3::new(u, v, 0.5));
        let eval = model.eval(wo, wi);
        if wi != Vec3::ZERO && eval.pdf > 0.0 {
            sum += f64::from(model.colored(wo, wi).max_element()) / f64::from(eval.pdf);
            kept += 1.0;
        }
    }
    let count = f64::from(SIDE * SIDE);
    (sum / count, kept / count)
}

/// What a model reflects of a white sky: diffuse ones over the whole hemisphere, narrow ones over their samples.
fn reflected<M: Scatter>(model: &M, wo: Vec3) -> f64 {
    let name = std::any::type_name::<M>();
    if !["Burley", "Eon", "Under"].iter().any(|n| name.contains(n)) {
        return by_samples(model, wo).0;
    }
    let all = hemisphere(64, 192, f64::from(wo.z));
    all.iter().map(|(wi, w)| w * f64::from(model.colored(wo, *wi).max_element())).sum()
}

const COSINES: [f64; 7] = [1e-3, 0.02, 0.1, 0.3, 0.55, 0.8, 1.0];

fn albedo_is_right<M: Scatter>(p: Params, _: bool, bar: f64) {
    let (model, name) = (M::prepare(p), std::any::type_name::<M>());
    // Those that gain say so in the closure table.
    let gains = name.contains("Ward<false>") || name.contains("Burley") && p[0] > 0.4;
    let mut worst = 0.0f64;
    for c in COSINES {
        let sum = reflected(&model, narrow(direction(c, 0.3)));
        let albedo = f64::from(model.albedo(c as f32));
        let error = (albedo - sum.min(1.0)).abs();
        worst = worst.max(error);
        // The strata leave 2e-4 where the horizon cuts a lobe.
        assert!(error < bar + 3e-4, "{name} {p:?} at {c}: {albedo} against {sum}");
        assert!(gains || sum <= 1.0 + 1e-4, "{name} {p:?} at {c} gains: {sum}");
    }
    println!("{name} {:?}: albedo {worst:.1e}", &p[..4]);
}

#[test]
fn albedos_are_what_the_lobes_reflect_and_they_gain_nothing() {
    everywhere!(albedo_is_right);
    // EON keeps all of it.
    for r in [0.0, 0.3, 1.0] {
        let sum = reflected(&Eon::prepare(params([r, 1.0, 1.0, 1.0])), narrow(direction(0.2, 0.0)));
        assert!((sum - 1.0).abs() < 2e-4, "{r}: {sum}");
    }
    let most = Burley::prepare(params([1.0])).whole_albedo(0.0);
    assert!((most - 1.557_54).abs() < 1e-5, "{most}");
}

fn density_is_one<M: Scatter>(p: Params, _: bool, _: f64) {
    let model = M::prepare(p);
    for c in [0.05, 0.5, 0.95] {
        let wo = narrow(direction(c, 0.3));
        let sum: f64 = hemisphere(96, 1536, c).iter().map(|(wi, w)| w * f64::from(model.eval(wo, *wi).pdf)).sum();
        let (_, kept) = by_samples(&model, wo);
        // Lobes narrower than the rule's steps are left to the samples.
        let narrow_lobe = p[0].max(p[3]) > 1000.0 || std::any::type_name::<M>().contains("Ward") && p[0] < 0.05;
        assert!(narrow_lobe || (sum - kept).abs() < 4e-3, "{} {p:?} at {c}: {sum} {kept}", std::any::type_name::<M>());
    }
}

#[test]
fn densities_integrate_to_what_is_not_lost() {
    everywhere!(density_is_one);
}

fn is_reciprocal<M: Scatter>(p: Params, reciprocal: bool, _: f64) {
    let name = std::any::type_name::<M>();
    let model = M::prepare(p);
    let mut random = Random(SEED);
    for k in 0..4000 {
        let (a, b) = (random_direction(&mut random, k % 3 == 0), random_direction(&mut random, k % 3 == 1));
        let (x, y) = (model.colored(a, b).x * a.z, model.colored(b, a).x * b.z);
        assert!(!reciprocal || (x - y).abs() <= 2e-3 * x.max(y) + 1e-7, "{name} {p:?} {a} {b}: {x} {y}");
    }
}

#[test]
fn exchanged_directions_give_the_same_light() {
    everywhere!(is_reciprocal);
}

fn is_finite<M: Scatter>(p: Params) {
    let name = std::any::type_name::<M>();
    let (model, mut random) = (M::prepare(p), Random(SEED));
    for k in 0..1500 {
        let z = if k % 4 == 0 { 1e-10 } else { 10f64.powf(-8.0 * f64::from(random.number())) };
        let wo = narrow(direction(z, f64::from(k)));
        let sampled = model.sample(wo, Vec3::new(random.number(), random.number(), random.number()));
        assert!(sampled.is_finite() && sampled.z >= 0.0, "{name} {p:?} {wo} {sampled}");
        let grazing = narrow(direction(1e-10, f64::from(random.number()) * 6.3));
        for wi in [sampled, grazing, -wo, wo, Vec3::new(-wo.x, -wo.y, wo.z), Vec3::ZERO, Vec3::Z, -Vec3::Z] {
            let (eval, color) = (model.eval(wo, wi), model.colored(wo, wi));
            assert!(eval.f_cos.is_finite() && eval.f_cos >= 0.0, "{name} {p:?} {wo} {wi} {eval:?}");
            assert!(eval.pdf.is_finite() && eval.pdf >= 0.0, "{name} {p:?} {wo} {wi} {eval:?}");
            assert!(color.is_finite() && color.min_element() >= 0.0, "{name} {p:?} {wo} {wi} {color}");
            assert!(wi.z > 0.0 || eval.f_cos == 0.0, "{name} {p:?} reflects from below: {wi}");
            if eval.pdf > 0.0 && wi == sampled && !["Ward<false>", "Burley", "Eon"].iter().any(|n| name.contains(n)) {
                let weight = eval.f_cos / eval.pdf;
                assert!(weight < 2.1, "{name} {p:?} {wo} {wi}: weight {weight}");
            }
        }
        let albedo = model.albedo(wo.z);
        assert!((0.0..=1.0).contains(&albedo), "{name} {p:?}: albedo {albedo}");
    }
}

#[test]
fn edges_give_finite_light() {
    let edges = [0.0, -0.0, -5.0, 1e-30, 1.0, 7.0, 1e6, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for e in edges {
        is_finite::<Phong>(params([e]));
        is_finite::<Lafortune>(params([e, 1.0, -0.5, 10.0]));
        is_finite::<Lafortune>(params([0.0, 0.0, e, 10.0]));
        is_finite::<Lafortune>(params([-1.0, -1.0, 1.0, e]));
        is_finite::<Ward<false>>(params([e, 0.1]));
        is_finite::<Ward<true>>(params([e, e]));
        is_finite::<Ward<true>>(params([0.2, e]));
        is_finite::<Highlight>(params([e, 10.0, 0.5, e, 0.5]));
        is_finite::<Highlight>(params([e, e, 1.0, 1.0, e]));
        is_finite::<Under>(params([e, 0.1, 0.2, e, e, 0.2]));
        is_finite::<Burley>(params([e]));
        is_finite::<Eon>(params([e, 1.0, e, 0.0]));
        is_finite::<Fibers>(params([e]));
    }
    // Coefficients that are all zero scatter nothing, also with exponent 0.
    let none = Lafortune::prepare(params([0.0, 0.0, 0.0, 0.0]));
    assert_eq!(none.eval(Vec3::Z, Vec3::Z).f_cos, 0.0);
    assert_eq!(none.albedo(0.5), 0.0);
}

/// The largest errors of the albedos of unequal widths, whose azimuth an albedo cannot know; the documents state them.
#[test]
fn albedos_of_stretched_lobes_err_as_documented() {
    let mean =
        |model: &dyn Fn(f64, f64) -> f64, c: f64| (0..8).map(|k| model(c, f64::from(k) * PI / 8.0)).sum::<f64>() / 8.0;
    let mut worst = [0.0f64; 3];
    for c in COSINES {
        for (x, y) in [(0.1, 0.4), (0.4, 0.1), (0.25, 1.0)] {
            let model = Ward::<true>::prepare(params([x, y]));
            let sum = mean(&|c, phi| by_samples(&model, narrow(direction(c, phi))).0, c);
            worst[0] = worst[0].max((f64::from(model.albedo(c as f32)) - sum).abs());
        }
        for (x, y) in [(10.0, 1000.0), (1000.0, 10.0)] {
            let model = Highlight::prepare(params([x, y, 0.5, 0.5, 0.5]));
            let sum = mean(&|c, phi| by_samples(&model, narrow(direction(c, phi))).0, c);
            worst[1] = worst[1].max((f64::from(model.albedo(c as f32)) - sum).abs());
        }
        for c2 in [[0.3, 1.0, 0.8], [-1.0, -0.5, 1.0]] {
            let model = Lafortune::prepare(params([c2[0], c2[1], c2[2], 20.0]));
            let sum = mean(&|c, phi| by_samples(&model, narrow(direction(c, phi))).0, c);
            worst[2] = worst[2].max((f64::from(model.albedo(c as f32)) - sum).abs());
        }
    }
    println!("stretched: Ward {:.3}, Ashikhmin-Shirley {:.3}, Lafortune {:.3}", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 0.06 && worst[1] < 0.03 && worst[2] < 0.015, "{worst:?}");
}
