//! Where methods fail: one test for each known failure of naive single-precision code, and for what a shader may ask for.
//!
//! The rows 1 to 15 are the failure cases of the sheen formulas, with the value that naive code gives in the comment.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::bsdf::sheen::albedo::AlbedoCurve;
use velour::bsdf::sheen::shadowing::{Exact, Published, Shadowing, soften};
use velour::bsdf::sheen::{ASHIKHMIN, EXACT, PUBLISHED, Sheen, charlie};
use velour::bsdf::velvet::Velvet;
use velour::bsdf::{Scatter, params};
use velour::closure::{Evaluation, Library, Lobes, Samples, Settings};
use velour::compile::compile;
use velour::exec::{Group, Machine, Points};
use velour::lang::closures::{ClosureSpec, ParamKind};
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate};
use velour::measure::statistics::Random;

/// Naive: NaN at r = 0.15 and r = 1, because n . h comes out as 1.0000001 in 15 % of mirror configurations.
#[test]
fn row_01_a_half_vector_longer_than_one() {
    let n = Vec3::new(-0.403_824_8, 0.816_492_5, 0.412_632_56);
    let v = Vec3::new(-0.782_364_3, -0.409_227_67, 0.469_509_24);
    let frame = velour::math::frame::Frame::from_normal(n);
    let wo = frame.to_local(v);
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    for (r, most) in [(0.15, 1e-15), (0.25, 1e-12), (1.0, 1e-3)] {
        let d = charlie::distribution(charlie::sin2_half(wo, wi), 1.0 / r);
        assert!((0.0..most).contains(&d), "r = {r}: {d}");
    }
}

/// Naive: 9 % too small at an angle of 1e-3 and 0 at 1e-4, because 1 - cos² has no digits left.
#[test]
fn row_02_half_vectors_close_to_the_normal() {
    for (angle, r, expected) in
        [(1e-3, 0.25, 9.549_29e-13), (1e-3, 1.0, 4.774_65e-4), (1e-4, 1.0, 4.774_65e-5), (1e-4, 0.25, 9.549_29e-17)]
    {
        let wo = narrow(direction(f64::cos(angle), 0.7));
        let wo = Vec3::new((angle.sin() * 0.7f64.cos()) as f32, (angle.sin() * 0.7f64.sin()) as f32, wo.z);
        let d = charlie::distribution(charlie::sin2_half(wo, wo), (1.0 / r) as f32);
        assert!((f64::from(d) / expected - 1.0).abs() < 2e-4, "{angle} {r}: {d}");
    }
}

/// Naive: NaN, NaN and -5.37.
#[test]
fn row_03_roughness_zero_denormal_and_negative() {
    for r in [0.0, 1e-39, -0.1, -0.0, f32::MIN_POSITIVE] {
        let sheen = Sheen::<EXACT, true>::prepare(params([r]));
        let sharpest = Sheen::<EXACT, true>::prepare(params([charlie::MIN_ROUGHNESS]));
        let (wo, wi) = (narrow(direction(0.3, 0.0)), narrow(direction(0.2, 2.0)));
        assert_eq!(sheen.eval(wo, wi), sharpest.eval(wo, wi), "r = {r}");
        assert!(sheen.eval(wo, wi).f_cos > 0.0);
    }
}

/// Naive: NaN for light below the horizon.
#[test]
fn row_04_the_published_fit_below_the_horizon() {
    let sheen = Sheen::<PUBLISHED, true>::prepare(params([0.25]));
    for cos in [-1e-7, -0.1, -1.0] {
        let eval = sheen.eval(narrow(direction(0.5, 0.0)), narrow(direction(cos, 1.0)));
        assert_eq!((eval.f_cos, eval.pdf), (0.0, 0.0), "{cos}");
    }
}

/// Naive: NaN, a power of -1.2e-7.
#[test]
fn row_05_the_published_fit_at_a_cosine_above_one() {
    assert!((Published::new(0.25).lambda(1.000_000_1) - 1.0149e-8).abs() < 1e-11);
}

/// Naive: infinite, and NaN times the cosine.
#[test]
fn row_06_light_exactly_at_the_horizon() {
    let (wo, wi) = (narrow(direction(0.5, 0.0)), Vec3::new(0.6, 0.8, 0.0));
    for eval in [
        Sheen::<EXACT, true>::prepare(params([0.25])).eval(wo, wi),
        Sheen::<EXACT, false>::prepare(params([0.25])).eval(wo, wi),
        Sheen::<PUBLISHED, false>::prepare(params([0.25])).eval(wo, wi),
    ] {
        assert_eq!(eval.f_cos, 0.0);
    }
    // Just above, f is D / (2 f(0) co), with f(0) = 2F1(-1/2, -n/2; 1; 1) = 1.875 for n = 4.
    let near = narrow(direction(1e-6, 2.0));
    let d = charlie::distribution(charlie::sin2_half(wo, near), 4.0);
    let f = Sheen::<EXACT, false>::prepare(params([0.25])).f(wo, near);
    assert!((f / (d / (2.0 * 1.875 * 0.5)) - 1.0).abs() < 6e-3, "{f}");
}

/// Naive: NaN, -6.25 and infinite.
#[test]
fn row_07_the_real_time_visibility() {
    let sheen = Sheen::<ASHIKHMIN, false>::prepare(params([0.25]));
    for (co, ci) in [(0.0, 0.0), (0.2, -0.3), (0.5, -1.0)] {
        let eval = sheen.eval(narrow(direction(co, 0.0)), narrow(direction(ci, 2.0)));
        assert_eq!(eval.f_cos, 0.0, "{co} {ci}");
    }
}

/// Naive: NaN (0/0) along the normal, and NaN for a width of 0.
#[test]
fn row_08_velvet_along_the_normal() {
    let velvet = |m: f32| Velvet::prepare(params([m]));
    assert!((velvet(0.25).distribution(0.0) - 0.254_648).abs() < 1e-6);
    for sin2 in [0.0, 0.5, 1.0] {
        assert!(velvet(0.0).distribution(sin2).is_finite());
    }
}

/// Naive: infinite, a power of 52.
#[test]
fn row_09_softening_below_the_horizon() {
    for cos in [-0.5, -1e-6] {
        let eval = Sheen::<EXACT, true>::prepare(params([0.25]))
            .eval(narrow(direction(0.5, 0.0)), narrow(direction(cos, 1.0)));
        assert_eq!(eval.f_cos, 0.0);
    }
    for r in [0.01, 0.25, 1.0] {
        for cos in [0.0, 1e-30, 1e-13, 1e-6] {
            assert!(soften(Exact::new(1.0 / r).lambda(cos), cos).is_finite(), "{r} {cos}");
            assert!(soften(Published::new(r).lambda(cos), cos).is_finite(), "{r} {cos}");
        }
    }
}

/// Naive: r = 1.5 acts as r = 0.5, and r = 2 as r = 0.
#[test]
fn row_10_roughness_above_one() {
    let (wo, wi) = (narrow(direction(0.3, 0.0)), narrow(direction(0.6, 2.0)));
    let widest = Sheen::<PUBLISHED, true>::prepare(params([1.0])).eval(wo, wi);
    for r in [1.5, 2.0, 1e30] {
        assert_eq!(Sheen::<PUBLISHED, true>::prepare(params([r])).eval(wo, wi), widest);
    }
}

/// The published fit reflects 1.50 of the light at r = 1 and a view of cosine 1e-6, in any precision; the exact term
/// never passes 1 at any view, and neither does any albedo evaluator.
#[test]
fn row_11_extreme_grazing_views() {
    let table = Library::standard();
    for r in [0.01, 0.06, 0.25, 1.0] {
        for cos in [1e-4, 1e-6, 1e-8, 1e-10] {
            let group = group(&format!("sheen_bsdf(N, color(1), {r}, \"softening\", 0)"));
            let mut lobes = seen(&group, &table, narrow(direction(cos, 0.3)));
            // Gauss-Legendre in the cube root of the cosine, split where the integrand has its knee.
            let albedo = integrate(&mut lobes, 1, &hemisphere(96, 128, cos.max(1e-3)))[0][0];
            assert!((0.7..1.0 + 1e-3).contains(&albedo), "r = {r}, cos = {cos}: {albedo}");
            for term in [Shadowing::Exact, Shadowing::Published, Shadowing::Ashikhmin] {
                let curve = AlbedoCurve::new(term, false, r as f32);
                assert!(curve.at::<true>(cos as f32).is_finite());
            }
            let own = lobes.describe(0)[0].albedo;
            assert!((0.0..=1.0).contains(&own), "{own}");
        }
    }
}

/// Naive: NaN from normalising a zero half vector.
#[test]
fn row_12_opposite_directions_in_the_horizon() {
    for (wo, wi) in [(Vec3::X, -Vec3::X), (Vec3::Y, -Vec3::Y)] {
        assert!(charlie::distribution(charlie::sin2_half(wo, wi), 4.0) < 1e-30);
        let eval = Sheen::<EXACT, true>::prepare(params([0.25])).eval(wo, wi);
        assert!(eval.f_cos == 0.0 && eval.pdf.is_finite());
    }
}

/// Naive: an index beyond the end of the table.
#[test]
fn row_13_albedo_at_the_ends_of_its_domain() {
    for r in [0.0, 0.06, 1.0, 3.0, f32::NAN] {
        let sheen = Sheen::<EXACT, true>::prepare(params([r]));
        for cos in [0.0, 1e-4, 1.0, 1.000_001, 7.0] {
            assert!((0.0..=1.0).contains(&sheen.albedo(cos)), "r = {r}, cos = {cos}: {}", sheen.albedo(cos));
        }
    }
    let curve = Sheen::<EXACT, true>::prepare(params([0.25]));
    let end = curve.albedo(f32::NAN);
    assert!((0.0..=1.0).contains(&end), "{end}");
}

/// Naive: 10 % wrong at 1 - 1e-6, because (f / c - 1) / 2 cancels.
#[test]
fn row_14_lambda_close_to_the_normal() {
    for n in [1.0f64, 4.0, 20.0] {
        for below in [1e-3, 1e-5, 1e-6] {
            let c = (1.0 - below) as f32;
            // Lambda = (1 + n/2) (1 - c) + O((1 - c)²) near the normal, from f = 1 + (n/4) (1 - c²) + ...
            let u = 1.0 - f64::from(c);
            let expected = 0.5 * (1.0 + 0.5 * n) * u;
            let lambda = f64::from(Exact::new(n as f32).lambda(c));
            assert!((lambda / expected - 1.0).abs() < 2e-2 + 3.0 * n * below, "n = {n}, {below}: {lambda} {expected}");
        }
    }
}

/// Naive: division by zero in the fibre layer's fit at roughness 0.
#[test]
fn row_15_the_fibre_layer_at_roughness_zero() {
    let table = Library::standard();
    for r in ["0.0", "-1.0", "2.0"] {
        let group = group(&format!("sheen_bsdf(N, color(1), {r}, \"mode\", 1)"));
        for cos in [1.0, 0.3, 1e-6] {
            harmless(&mut seen(&group, &table, narrow(direction(cos, 0.3))), &format!("r = {r}, cos = {cos}"));
        }
    }
}

/// The group of a shader whose `Ci` is this expression.
fn group(expression: &str) -> Group {
    let text = format!("surface s() {{ Ci = {expression}; }}");
    compile(&text).unwrap_or_else(|e| panic!("{text}\n{e}")).group().build().expect("a group")
}

/// What a group scatters toward a viewer.
fn seen(group: &Group, table: &Library, wo: Vec3) -> Lobes {
    let (points, mut machine) = (Points::single(wo), Machine::new());
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(table, machine.shade(group, &points), &Column3::splat(wo, 1), &points.ng);
    lobes
}

/// Evaluates and samples, and asserts that all that comes out is a number and not negative.
fn harmless(lobes: &mut Lobes, what: &str) {
    let (wo, mut out) = (lobes.viewer().get(0), Evaluation::default());
    let mut random = Random(SEED);
    let directions = [
        Vec3::Z,
        -Vec3::Z,
        Vec3::X,
        wo,
        -wo,
        Vec3::new(-wo.x, -wo.y, wo.z),
        narrow(direction(1e-10, 1.0)),
        narrow(direction(-1e-10, 4.0)),
        narrow(direction(0.6, 2.0)),
        narrow(direction(-0.6, 5.0)),
    ];
    for wi in directions {
        lobes.evaluate(&Column3::splat(wi, 1), &mut out);
        let f = out.f_cos.get(0);
        assert!(f.is_finite() && out.pdf[0].is_finite() && out.pdf[0] >= 0.0, "{what}: {wi} gives {f}, {}", out.pdf[0]);
    }
    let mut samples = Samples::default();
    for _ in 0..64 {
        let xi = Vec3::new(random.number(), random.number(), random.number());
        lobes.sample(&Column3::splat(xi, 1), &mut samples);
        let (weight, wi) = (samples.weight.get(0), samples.wi.get(0));
        assert!(weight.is_finite() && samples.pdf[0].is_finite() && wi.is_finite(), "{what}: {weight} along {wi}");
    }
    assert!(lobes.emission().get(0).is_finite(), "{what}");
}

/// A call of a closure whose float and color parameters are the shader parameters `p0`, `p1`... and whose others are usual.
fn call(spec: &ClosureSpec) -> (String, Vec<(String, bool)>) {
    let (mut arguments, mut free) = (Vec::new(), Vec::new());
    for param in &spec.params {
        let text = match param.kind {
            ParamKind::Normal => "N".to_owned(),
            ParamKind::Vector => "dPdu".to_owned(),
            ParamKind::Closure => "diffuse(N)".to_owned(),
            ParamKind::String => format!("\"{}\"", param.choices.first().unwrap_or(&"")),
            ParamKind::Int => format!("{}", param.sweep.last().copied().unwrap_or(0.0) as i32),
            ParamKind::Float | ParamKind::Color => {
                free.push((format!("p{}", free.len()), param.kind == ParamKind::Color));
                free.last().map_or(String::new(), |(name, _)| name.clone())
            }
        };
        arguments.push(text);
    }
    (format!("{}({})", spec.name, arguments.join(", ")), free)
}

/// Shades every closure of the table with every combination of one hostile value in one of its parameters.
fn with_every_closure(values: &[f64], views: &[f64]) {
    let table = Library::standard();
    for spec in table.specs() {
        let (call, free) = call(spec);
        let typed = |(name, color): &(String, bool)| format!("{} {name} = 0.5", if *color { "color" } else { "float" });
        let declared: Vec<String> = free.iter().map(typed).collect();
        let text = format!("surface s({}) {{ Ci = {call}; }}", declared.join(", "));
        let shader = compile(&text).unwrap_or_else(|e| panic!("{text}\n{e}"));
        for (name, color) in free.iter().map(|(n, c)| (n.as_str(), *c)).chain((free.is_empty()).then_some(("", false)))
        {
            for &value in values {
                let mut builder = shader.group();
                if !name.is_empty() {
                    builder = builder.param(name, &vec![value; if color { 3 } else { 1 }]);
                }
                let group = builder.build().expect("a group");
                for &cos in views {
                    let what = format!("{call} with {name} = {value} at {cos}");
                    harmless(&mut seen(&group, &table, narrow(direction(cos, 0.3))), &what);
                }
            }
        }
    }
}

#[test]
fn roughness_zero_and_above_one() {
    with_every_closure(&[0.0, 1.0, 1.5, 2.0, 100.0], &[1.0, 0.3]);
}

#[test]
fn grazing_views() {
    with_every_closure(&[0.01, 0.5, 1.0], &[1e-3, 1e-6, 1e-10, 0.0]);
}

#[test]
fn parameters_that_are_no_numbers() {
    with_every_closure(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e38, -1e38, 1e-40], &[0.7, 1e-6]);
}

/// A parameter that is not a number drops its closure and says so; others in the sum stay.
#[test]
fn a_broken_closure_is_dropped_alone() {
    let text = "surface s(float p = 0) { Ci = 0.5 * diffuse(N) + sheen_bsdf(N, color(1), p); }";
    let group = compile(text).expect("a shader").group().param("p", &[f64::NAN]).build().expect("a group");
    let lobes = seen(&group, &Library::standard(), Vec3::Z);
    assert_eq!(lobes.len(), 1);
    assert_eq!(lobes.dropped().iter().map(|d| d.closure).collect::<Vec<_>>(), ["sheen_bsdf"]);
}

/// Light straight back through the surface, and straight back to the viewer.
#[test]
fn light_from_behind_is_black_for_reflecting_lobes() {
    for expression in ["diffuse(N)", "sheen_bsdf(N, color(1), 0.3)", "microfacet(\"ggx\", N, 0.2, 1.5, 0)"] {
        let (group, mut out) = (group(expression), Evaluation::default());
        let wo = narrow(direction(0.4, 0.3));
        let mut lobes = seen(&group, &Library::standard(), wo);
        lobes.evaluate(&Column3::splat(-wo, 1), &mut out);
        assert_eq!((out.f_cos.get(0), out.pdf[0]), (Vec3::ZERO, 0.0), "{expression}");
    }
}

/// A bump map may bend the normal away from the viewer, or below the geometric horizon: no black spots, no light from below.
#[test]
fn normals_bent_below_the_horizon() {
    let table = Library::standard();
    for bend in ["normal(3, 0, 0.1)", "normal(-3, 0, 0.1)", "normal(0, 1, -0.2)", "normal(0, 0, -1)", "normal(0)"] {
        for closure in ["diffuse(B)", "sheen(diffuse(B), B, color(1), 0.2)", "microfacet(\"ggx\", B, 0.1, 1.5, 2)"] {
            let text = format!("surface s() {{ normal B = {bend}; Ci = {closure}; }}");
            let group = compile(&text).expect("a shader").group().build().expect("a group");
            let wo = narrow(direction(0.5, 0.0));
            let mut lobes = seen(&group, &table, wo);
            harmless(&mut lobes, &text);
            let albedo = integrate(&mut lobes, 1, &hemisphere(32, 64, 0.5))[0][0];
            assert!(albedo < 1.0 + 1e-3, "{text}: {albedo}");
            if closure == "diffuse(B)" {
                assert!(albedo > 0.05, "{text}: {albedo}");
            }
        }
    }
}

/// A tint above 1 takes more than there is from the base; the base must not turn negative.
#[test]
fn tint_above_one() {
    let table = Library::standard();
    for tint in ["color(3)", "color(1e6)", "color(0, 5, 0)", "color(-2)"] {
        let with_base = group(&format!("sheen(diffuse(N), N, {tint}, 0.3)"));
        let alone = group(&format!("sheen(0, N, {tint}, 0.3)"));
        for cos in [1.0, 0.2] {
            let wo = narrow(direction(cos, 0.3));
            let wi = narrow(direction(0.5, 2.0));
            let f = |group: &Group| {
                let (mut lobes, mut out) = (seen(group, &table, wo), Evaluation::default());
                lobes.evaluate(&Column3::splat(wi, 1), &mut out);
                out.f_cos.get(0)
            };
            let base = f(&with_base) - f(&alone);
            let scale = f(&alone).abs().max_element();
            assert!(base.min_element() >= -1e-6 * scale && base.max_element() <= 0.16 + 1e-6 * scale, "{tint}: {base}");
        }
    }
}

/// Weights may be negative (a user subtracts closures): the sum is what it says, and sampling stays finite.
#[test]
fn negative_weights() {
    let group = group("diffuse(N) + (-0.25) * diffuse(N) + color(0, -2, 0) * oren_nayar(N, 0)");
    let mut lobes = seen(&group, &Library::standard(), narrow(direction(0.7, 0.3)));
    harmless(&mut lobes, "negative weights");
    let mut out = Evaluation::default();
    lobes.evaluate(&Column3::splat(narrow(direction(0.5, 1.0)), 1), &mut out);
    let expected = Vec3::new(0.75, -1.25, 0.75) * 0.5 / std::f32::consts::PI;
    assert!((out.f_cos.get(0) - expected).length() < 1e-6, "{}", out.f_cos.get(0));
    let mut random = Random(SEED);
    let mean = velour::measure::furnace::sample_mean(&mut lobes, 1, 100_000, || random.number())[0];
    assert!((mean[0] - 0.75).abs() < 0.02 && (mean[1] + 1.25).abs() < 0.02, "{mean:?}");
}

/// Beyond the critical angle all light is reflected and none is refracted, rough or smooth.
#[test]
fn total_internal_reflection() {
    let table = Library::standard();
    let wo = narrow(direction(0.3, 0.3));
    let mut random = Random(SEED);
    for (closure, expected) in [
        ("reflection(N, 0.5)", 1.0),
        ("refraction(N, 0.5)", 0.0),
        ("microfacet(\"ggx\", N, 0, 0.5, 2)", 1.0),
        ("microfacet(\"sharp\", N, 0.3, 0.5, 1)", 0.0),
    ] {
        let mut lobes = seen(&group(closure), &table, wo);
        let mean = velour::measure::furnace::sample_mean(&mut lobes, 1, 4096, || random.number())[0][0];
        // A lobe that scatters nothing may be picked once in a thousand: four standard errors of that.
        assert!((mean - expected).abs() < 2e-3, "{closure}: {mean}");
    }
    // A narrow rough boundary does the same but for a last part in ten thousand.
    let mut lobes = seen(&group("microfacet(\"ggx\", N, 0.01, 0.5, 2)"), &table, wo);
    let mean = velour::measure::furnace::sample_mean(&mut lobes, 1, 4096, || random.number())[0][0];
    assert!((0.99..1.0 + 1e-4).contains(&mean), "{mean}");
}
