//! `verify` on shaders that hide what is wrong with them in a narrow place, view, kind of ray or parameter, and on sound ones.

use velour::closure::Settings;
use velour::compile::compile;
use velour::measure::verify::{Check, Effort, Report, ShaderSubject, Subject, Verdict, verify};

fn report(text: &str, seed: u64) -> Report {
    let effort = Effort { seed, ..Effort::quick() };
    let shader = compile(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let subject = ShaderSubject::new("it", &shader, &[], Settings::default(), &effort).expect("a subject");
    let subjects: [&dyn Subject; 1] = [&subject];
    verify(&subjects, &effort, &|_, _| ())
}

/// Each gains light, or is no number, somewhere.
const WRONG: [&str; 30] = [
    "surface s() { Ci = (1 + .1 * mod(floor(u*20) + floor(v*20), 2)) * diffuse(N); }",
    "surface s() { Ci = (1 + .2 * noise(P*20)) * diffuse(N); }",
    "surface s() { Ci = (u > .33 && u < .345 ? 1.2 : 1) * diffuse(N); }",
    "surface s() { Ci = (P[1] > .7 && P[1] < .715 ? 1.1 : .9) * diffuse(N); }",
    "surface s() { float c = -dot(N, I); Ci = (c > .6 && c < .62 ? 1.3 : 1) * diffuse(N); }",
    "surface s() { float big = 1e38 * (1e10 + u); Ci = (u > .2 && u < .22 ? big - big : 1) * diffuse(N); }",
    "surface s() { float big = 1e38 * (1e10 + u), c = -dot(N, I); Ci = (c > .4 && c < .42 ? big - big : 1) * diffuse(N); }",
    "surface s() { Ci = (raytype(\"diffuse\") ? 1.5 : 1) * diffuse(N); }",
    "surface s() { Ci = (raytype(\"glossy\") ? 1.1 : 1) * diffuse(N); }",
    "surface s() { Ci = (raytype(\"refraction\") ? 1.2 : .5) * diffuse(N); }",
    "surface s(int mode = 0) { Ci = (mode == 2 ? 1.2 : 1) * diffuse(N); }",
    "surface s(int mode = 0) { Ci = (mode == 17 ? 1.2 : 1) * diffuse(N); }",
    "surface s(color c = .5) { Ci = 1.2 * c * diffuse(N); }",
    "surface s(string mode = \"dull\") { Ci = (mode == \"bright\" ? 1.3 : .8) * diffuse(N); }",
    "surface s() { Ci = (length(Dx(P)) > 0 ? 1.3 : 1) * diffuse(N); }",
    "surface s() { Ci = (abs(Dx(u)) > .01 ? 1.1 : 1) * diffuse(N); }",
    "surface s(float k = .5) { Ci = k * diffuse(N) + .3 * diffuse(N); }",
    "surface s(float r = .5 [[float min = 0, float max = 1]]) { Ci = (r > .3 && r < .4 ? 1.2 : 1) * diffuse(N); }",
    "surface s() { Ci = .7 * diffuse(N) + (u > .9 ? .4 : .2) * oren_nayar(N, .3); }",
    "surface s() { Ci = (backfacing() ? 1.2 : 1) * diffuse(N); }",
    "surface s() { Ci = (I[0] > .5 && I[0] < .53 ? 1.2 : 1) * diffuse(N); }",
    "surface s() { Ci = diffuse(N) + sheen_bsdf(N, color(1), .4); }",
    "surface s() { Ci = color(1, 1, u > .45 && u < .47 ? 1.15 : 1) * diffuse(N); }",
    "surface s() { Ci = (v > .61 && v < .63 ? 1.1 : 1) * reflection(N, 0); }",
    "surface s() { Ci = (u * v > .9 ? 1.3 : 1) * translucent(N); }",
    "surface s(string finish = \"a\" [[string options = \"a|b|rough\"]]) { Ci = (finish == \"rough\" ? 1.2 : 1) * diffuse(N); }",
    "surface s() { float d = distance(P, point(.3, .7, 0)); Ci = (d < .06 ? 1.4 : 1) * diffuse(N); }",
    "surface s() { Ci = (u > .5 && u < .52 && backfacing() ? 1.4 : 1) * diffuse(N); }",
    "surface s() { Ci = (sin(u * 200) > .99 ? 1.3 : 1) * microfacet(\"ggx\", N, .3, 0, 0); }",
    "surface s() { float c = -dot(N, I); Ci = (c < .02 ? 1.3 : 1) * diffuse(N); }",
];

/// None of these loses a law.
const SOUND: [&str; 14] = [
    "surface s() { Ci = diffuse(N); }",
    "surface s() { Ci = sheen(color(.6, .05, .05) * diffuse(N), N, color(1), .3); }",
    "surface s() { Ci = (.5 + .5 * noise(P*20)) * diffuse(N); }",
    "surface s() { Ci = microfacet(\"ggx\", N, .3, 1.5, 2); }",
    "surface s(float r = .3 [[float min = .05, float max = 1]]) { Ci = conductor_bsdf(N, vector(1,0,0), r, r, color(.2), color(3), \"ggx\"); }",
    "surface s() { Ci = dielectric_bsdf(N, vector(1,0,0), color(1), color(1), .2, .2, 1.5, \"ggx\"); }",
    "surface s() { Ci = .4 * diffuse(N) + .4 * translucent(N) + .2 * transparent(); }",
    "surface s() { Ci = coat(diffuse(N), N, 0, 1.5, color(1), .1); }",
    "surface s() { Ci = u > .5 ? transparent() : diffuse(N); }",
    "surface s() { Ci = layer(.5 * microfacet(\"ggx\", N, .2, 1.5, 0), diffuse(N)); }",
    "surface s(color c = .5, int k = 1) { Ci = c * (k > 0 ? diffuse(N) : oren_nayar(N, .4)); }",
    "surface s() { Ci = phong(N, 50); }",
    "surface s() { Ci = oren_nayar_diffuse_bsdf(N, color(1), .7, \"energy_compensation\", 1); }",
    "surface s() { Ci = reflection(N, 1.5) + refraction(N, 1.5); }",
];

/// How many of a list are tried by default; all of it in the long tests.
fn tried(list: &'static [&'static str], every: usize) -> impl Iterator<Item = &'static str> {
    let every = if std::env::var_os("VELOUR_LONG_TESTS").is_some() { 1 } else { every };
    list.iter().copied().step_by(every)
}

#[test]
fn what_is_wrong_in_a_narrow_place_is_found() {
    let missed: Vec<&str> = tried(&WRONG, 3).filter(|text| report(text, 0).passed()).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn sound_shaders_are_not_accused() {
    let seeds = if std::env::var_os("VELOUR_LONG_TESTS").is_some() { 25 } else { 1 };
    for text in tried(&SOUND, 2) {
        for seed in 0..seeds {
            let report = report(text, seed);
            let failed: Vec<_> = report.lines.iter().filter(|line| line.finding.verdict == Verdict::Fail).collect();
            assert!(failed.is_empty(), "{text}, seed {seed}: {failed:#?}");
        }
    }
}

/// The finding says where: the place, and the kind of ray.
#[test]
fn a_finding_names_the_place_and_the_ray() {
    let report = report(WRONG[7], 0);
    let failed = |line: &&velour::measure::verify::Line| {
        line.finding.verdict == Verdict::Fail && line.finding.check == Check::Energy
    };
    let line = report.lines.iter().find(failed).expect("it fails");
    assert!(line.label.contains("a diffuse ray"), "{}", line.label);
}
