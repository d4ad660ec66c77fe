//! Every closure of these models, written as shader text: it compiles, gives lobes, and lanes may differ in form.

use crate::{direction, narrow};
use glam::Vec3;
use velour::closure::{Evaluation, Lobes, Samples, Settings};
use velour::compile::Compiler;
use velour::exec::{Machine, Points};
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate};

/// The lobes that the text of a closure gives in so many lanes, where u is 0 and 1 in turn.
fn lobes_of(closure: &str, lanes: usize) -> Lobes {
    let text = format!("shader s() {{ Ci = {closure}; }}");
    let shader = Compiler::new().compile("test.osl", &text).unwrap_or_else(|e| panic!("{closure}: {e}"));
    let group = shader.group().build().unwrap();
    let mut points = Points::new(lanes);
    let wo = narrow(direction(0.6, 0.5));
    for lane in 0..lanes {
        points.u[lane] = (lane % 2) as f32;
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
        points.i.set(lane, -wo);
    }
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &points);
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(group.library(), tree, &Column3::splat(wo, lanes), &Column3::splat(Vec3::Z, lanes));
    lobes
}

fn names(lobes: &Lobes, lane: usize) -> Vec<&'static str> {
    lobes.describe(lane).iter().map(|lobe| lobe.closure).collect()
}

const CLOSURES: &[(&str, usize)] = &[
    ("phong(N, 30)", 1),
    ("ward(N, vector(1, 0, 0), 0.2, 0.5)", 1),
    (r#"ward(N, vector(1, 0, 0), 0.2, 0.5, "bounded", 1)"#, 1),
    ("ashikhmin_shirley(N, vector(1, 0, 0), 10, 100, color(0.3), color(0.5))", 2),
    ("lafortune(N, vector(1, 0, 0), vector(-1, -1, 0.9), 12)", 1),
    ("subsurface(1.3, 0, color(1), color(0.8, 0.5, 0.3))", 1),
    ("oren_nayar_diffuse_bsdf(N, color(0.8, 0.5, 0.3), 0.5)", 1),
    (r#"oren_nayar_diffuse_bsdf(N, color(0.8, 0.5, 0.3), 0.5, "energy_compensation", 1)"#, 1),
    ("burley_diffuse_bsdf(N, color(0.8, 0.5, 0.3), 0.5)", 1),
    ("translucent_bsdf(N, color(0.8, 0.5, 0.3))", 1),
    ("transparent_bsdf()", 1),
    ("subsurface_bssrdf(N, color(0.8, 0.5, 0.3), color(1), 0)", 1),
    (r#"sheen_bsdf(N, color(0.8, 0.5, 0.3), 0.5, "mode", 1)"#, 1),
];

#[test]
fn every_closure_gives_its_lobes() {
    for (text, count) in CLOSURES {
        let mut lobes = lobes_of(text, 3);
        let name = text.split('(').next().unwrap_or("");
        assert_eq!(names(&lobes, 1), vec![name; *count], "{text}");
        assert!(lobes.dropped().is_empty(), "{text}");
        let mut samples = Samples::default();
        lobes.sample(&Column3::splat(Vec3::new(0.3, 0.2, 0.4), 3), &mut samples);
        assert!(samples.pdf[2] > 0.0 && samples.weight.get(2).is_finite(), "{text}: {samples:?}");
    }
}

#[test]
fn every_lane_gives_the_same_bits() {
    // Whole vectors and what is left over of them run different code.
    const LANES: usize = 37;
    let hair = HAIR.replace("ABSORPTION", "0.1, 0.5, 3");
    for text in CLOSURES.iter().map(|(text, _)| *text).chain([hair.as_str()]) {
        let mut lobes = lobes_of(text, LANES);
        let mut out = Evaluation::default();
        for wi in [narrow(direction(0.4, 3.0)), narrow(direction(0.01, 1.0)), narrow(direction(-0.4, 2.0))] {
            lobes.evaluate(&Column3::splat(wi, LANES), &mut out);
            assert!((1..LANES).all(|k| out.f_cos.get(k) == out.f_cos.get(0) && out.pdf[k] == out.pdf[0]), "{text}");
        }
        let mut samples = Samples::default();
        for k in 0..20 {
            let t = (k as f32 + 0.5) / 20.0;
            lobes.sample(&Column3::splat(Vec3::new((7.0 * t).fract(), t, (3.0 * t).fract()), LANES), &mut samples);
            assert!((1..LANES).all(|k| samples.wi.get(k) == samples.wi.get(0)), "{text}");
            assert!((1..LANES).all(|k| samples.weight.get(k) == samples.weight.get(0)), "{text}");
        }
    }
}

#[test]
fn colors_reach_the_light() {
    for (text, _) in CLOSURES.iter().filter(|(text, _)| text.contains("color(0.8, 0.5, 0.3)")) {
        let mut lobes = lobes_of(text, 1);
        let mut directions = hemisphere(16, 32, 0.6);
        if text.starts_with("translucent") {
            directions.iter_mut().for_each(|(w, _)| w.z = -w.z);
        }
        let [r, g, b] = integrate(&mut lobes, 1, &directions)[0];
        if text.contains("energy_compensation") {
            // Scattered again and again, light is colored more.
            assert!(g / r < 0.5 / 0.8 && b / g < 0.3 / 0.5 && r < 0.8, "{text}: {r} {g} {b}");
        } else {
            assert!((g / r - 0.5 / 0.8).abs() < 1e-4 && (b / r - 0.3 / 0.8).abs() < 1e-4, "{text}: {r} {g} {b}");
        }
    }
    for text in ["subsurface(1.3, 0, color(1), color(0.8))", "subsurface_bssrdf(N, color(0.8), color(1), 0)"] {
        assert!((integrate(&mut lobes_of(text, 1), 1, &hemisphere(16, 32, 0.6))[0][0] - 0.8).abs() < 1e-4);
    }
}

const HAIR: &str = "chiang_hair_bsdf(N, vector(1, 0.2, 0), color(1), color(1), color(1), 1.55, 0.1, 0.05, 0.2, 0.4, 0.5, 0.6, 0.48, color(ABSORPTION))";

#[test]
fn white_hair_loses_nothing_and_dark_hair_does() {
    let sphere = || {
        let up = hemisphere(64, 256, 0.6);
        let down = up.iter().map(|(w, weight)| (Vec3::new(w.x, w.y, -w.z), *weight)).collect::<Vec<_>>();
        [up, down].concat()
    };
    let mut white = lobes_of(&HAIR.replace("ABSORPTION", "0"), 1);
    assert_eq!(names(&white, 0), ["chiang_hair_bsdf"; 4]);
    let sum = integrate(&mut white, 1, &sphere())[0];
    assert!(sum.iter().all(|s| (s - 1.0).abs() < 1e-3), "{sum:?}");
    let mut samples = Samples::default();
    for k in 0..50 {
        let t = (k as f32 + 0.5) / 50.0;
        white.sample(&Column3::splat(Vec3::new((7.0 * t).fract(), (3.0 * t).fract(), t), 1), &mut samples);
        assert!((samples.weight.x[0] - 1.0).abs() < 1e-3, "every sample weighs what nothing lost weighs: {samples:?}");
    }
    let [r, g, b] = integrate(&mut lobes_of(&HAIR.replace("ABSORPTION", "0.1, 0.5, 3"), 1), 1, &sphere())[0];
    assert!(r > g && g > b && b > 0.03 && r < 0.95, "{r} {g} {b}");
}

#[test]
fn emittance_is_emitted() {
    let lobes = lobes_of(r#"0.5 * uniform_edf(color(1, 2, 3) * (1 + u), "label", "lamp")"#, 2);
    assert_eq!(lobes.emission().get(0), Vec3::new(0.5, 1.0, 1.5));
    assert_eq!(lobes.emission().get(1), Vec3::new(1.0, 2.0, 3.0));
    let group = Compiler::new().compile("a.osl", "shader s() { Ci = uniform_edf(color(1)); }").unwrap().group().build();
    assert!(group.unwrap().can_emit());
}

#[test]
fn lanes_may_take_different_forms() {
    for (text, keyword) in [
        ("ward(N, vector(1, 0, 0), 0.2, 0.5", "bounded"),
        ("oren_nayar_diffuse_bsdf(N, color(0.8, 0.5, 0.3), 0.9", "energy_compensation"),
        ("sheen_bsdf(N, color(0.8, 0.5, 0.3), 0.5", "mode"),
    ] {
        let form = |value: &str| {
            let mut out = Evaluation::default();
            let mut lobes = lobes_of(&format!("{text}, \"{keyword}\", {value})"), 2);
            lobes.evaluate(&Column3::splat(narrow(direction(0.4, 3.0)), 2), &mut out);
            (out.f_cos.get(0), out.f_cos.get(1), out.pdf[1])
        };
        let (mixed, zero, one) = (form("u > 0.5"), form("0"), form("1"));
        assert_eq!((mixed.0, mixed.1, mixed.2), (zero.0, one.1, one.2), "{keyword}");
        assert_ne!(zero.1, one.1, "{keyword}");
    }
}

#[test]
fn the_fibers_lie_over_a_base() {
    let text = r#"layer(sheen_bsdf(N, color(1), 0.7, "mode", 1), diffuse(N))"#;
    let sum = integrate(&mut lobes_of(text, 1), 1, &hemisphere(40, 96, 0.6))[0][0];
    assert!(sum > 0.8 && sum <= 1.0 + 1e-4, "{sum}");
}
