//! `velour verify`: every closure passes, and what is spoiled on purpose fails the check that is there for it.

use std::process::Command;
use velour::closure::{Evaluation, Samples, Settings, settings::SheenSampling};
use velour::compile::{Compiler, compile};
use velour::math::columns::Column3;
use velour::measure::verify::{
    Check, ClosureSubject, Effort, Finding, Promises, Report, Scatterer, ShaderSubject, Subject, Verdict, verify,
};

/// The effort of `cargo test`; `VELOUR_LONG_TESTS=1` asks for all there is.
fn effort() -> Effort {
    if std::env::var_os("VELOUR_LONG_TESTS").is_some() { Effort::full() } else { Effort::quick() }
}

fn closure(name: &str, thorough: bool, settings: Settings) -> ClosureSubject {
    let compiler = Compiler::new();
    let (id, _) = compiler.closures.named(name).next().expect("a closure of this name");
    ClosureSubject::new(&compiler, id, thorough, settings).expect("a shader that calls it")
}

fn run(subjects: &[&dyn Subject], effort: &Effort) -> Report {
    verify(subjects, effort, &|_, _| ())
}

/// What went wrong, for people to read.
fn failures(report: &Report) -> Vec<String> {
    let failed = report.lines.iter().filter(|line| line.finding.verdict == Verdict::Fail);
    let text = |Finding { check, value, bound, place, note, .. }: &Finding| {
        format!("{check} {value:e} ({bound}) {place}: {note}")
    };
    failed.map(|line| format!("{}, {}: {}", line.subject, line.label, text(&line.finding))).collect()
}

#[test]
fn every_closure_passes() {
    let compiler = Compiler::new();
    let long = std::env::var_os("VELOUR_LONG_TESTS").is_some();
    let subjects: Vec<ClosureSubject> = (0..compiler.closures.specs().len() as u32)
        .map(velour::lang::closures::ClosureId)
        .map(|id| ClosureSubject::new(&compiler, id, long, Settings::default()).expect("a shader that calls it"))
        .collect();
    let list: Vec<&dyn Subject> = subjects.iter().map(|subject| subject as &dyn Subject).collect();
    let report = run(&list, &effort());
    println!("{} findings, {} chi-square tests", report.lines.len(), report.tests);
    let failures = failures(&report);
    assert!(failures.is_empty(), "{} checks fail:\n{}", failures.len(), failures.join("\n"));
    for name in ["sheen_bsdf", "microfacet", "oren_nayar", "ashikhmin_velvet"] {
        let of = report.lines.iter().filter(|line| line.subject == name && line.finding.check == Check::ChiSquare);
        assert!(of.count() >= 25, "{name}: five widths from five views");
    }
}

#[test]
fn the_uniform_sampler_of_sheen_passes() {
    let settings = Settings { sheen_sampling: SheenSampling::Uniform, ..Settings::default() };
    let report = run(&[&closure("sheen_bsdf", false, settings)], &effort());
    assert!(report.passed(), "{}", failures(&report).join("\n"));
}

/// At index 1 a boundary lets everything straight through, a lobe of one direction, beside a reflection of nothing that is
/// still picked now and then: what the straight one passes must not depend on how often it happened to be picked.
#[test]
fn lobes_of_one_direction_are_measured_without_noise() {
    let subject = closure("dielectric_bsdf", false, Settings::default());
    for seed in 0..8 {
        let report = run(&[&subject], &Effort { sampled: vec![0.5], integrated: vec![], seed, ..Effort::quick() });
        let straight = report.lines.iter().filter(|line| line.label.contains("ior 1,"));
        let energy: Vec<f64> =
            straight.filter(|line| line.finding.check == Check::Energy).map(|line| line.finding.value).collect();
        assert!(!energy.is_empty() && energy.iter().all(|e| (e - 1.0).abs() < 3e-4), "seed {seed}: {energy:?}");
    }
}

/// What is spoiled of a sound closure.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spoil {
    /// Nothing: the wrapper itself does no harm.
    Sound,
    /// The density is 5 % off, up on one side and down on the other, so that its sum stays.
    Tilted,
    /// The density is 5 % too high everywhere.
    Swollen,
    /// Everything is 2 % too bright.
    Bright,
    /// Only the weights of samples are.
    Weights,
    /// Not a number near the horizon.
    Broken,
    /// Brighter for viewers along the normal.
    OneWay,
    /// Samples never go to one side, where there is light.
    Blind,
}

/// One variant of a closure, spoiled.
struct Spoiled {
    inner: ClosureSubject,
    variant: usize,
    spoil: Spoil,
}

impl Spoiled {
    fn new(name: &str, label: &str, spoil: Spoil) -> Self {
        let inner = closure(name, true, Settings::default());
        let variant = (0..inner.variants()).find(|&v| inner.label(v).contains(label)).expect("a variant");
        Spoiled { inner, variant, spoil }
    }
}

impl Subject for Spoiled {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn variants(&self) -> usize {
        1
    }

    fn label(&self, _: usize) -> String {
        self.inner.label(self.variant)
    }

    fn promises(&self, _: usize) -> Promises {
        self.inner.promises(self.variant)
    }

    fn scatterer(&self, _: usize) -> Box<dyn Scatterer + '_> {
        Box::new(Twisted { inner: self.inner.scatterer(self.variant), spoil: self.spoil, wo: Column3::default() })
    }
}

struct Twisted<'a> {
    inner: Box<dyn Scatterer + 'a>,
    spoil: Spoil,
    wo: Column3,
}

impl Twisted<'_> {
    /// The factors of f |cos| and of the density.
    fn factors(&self, wi: glam::Vec3, lane: usize) -> (f32, f32) {
        match self.spoil {
            Spoil::Sound | Spoil::Weights => (1.0, 1.0),
            Spoil::Tilted => (1.0, if wi.x > 0.0 { 1.05 } else { 0.95 }),
            Spoil::Swollen => (1.0, 1.05),
            Spoil::Bright => (1.02, 1.0),
            Spoil::Broken => (if (0.0..0.01).contains(&wi.z) { f32::NAN } else { 1.0 }, 1.0),
            Spoil::OneWay => (0.5 + 0.1 * self.wo.get(lane).z, 1.0),
            Spoil::Blind => (1.0, if wi.x > 0.0 { 0.0 } else { 1.0 }),
        }
    }
}

impl Scatterer for Twisted<'_> {
    fn look(&mut self, wo: &Column3) {
        self.wo.clone_from(wo);
        self.inner.look(wo);
    }

    fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation) {
        self.inner.evaluate(wi, out);
        for lane in 0..wi.len() {
            let (f, pdf) = self.factors(wi.get(lane), lane);
            out.f_cos.set(lane, out.f_cos.get(lane) * f);
            out.pdf[lane] *= pdf;
        }
    }

    fn sample(&mut self, xi: &Column3, out: &mut Samples) {
        self.inner.sample(xi, out);
        for lane in 0..xi.len() {
            let (f, pdf) = self.factors(out.wi.get(lane), lane);
            if pdf == 0.0 {
                out.wi.set(lane, glam::Vec3::ZERO);
                out.event[lane] = velour::closure::event::NONE;
            }
            let weights = if self.spoil == Spoil::Weights { 1.02 } else { 1.0 };
            let factor = if pdf == 0.0 { 0.0 } else { weights * f / pdf };
            out.weight.set(lane, out.weight.get(lane) * factor);
            out.pdf[lane] *= pdf;
        }
    }

    fn stated_albedo(&self, lane: usize) -> f64 {
        self.inner.stated_albedo(lane)
    }

    fn complaint(&self) -> Option<String> {
        self.inner.complaint()
    }
}

/// The checks that fail for a spoiled variant.
fn rejected(name: &str, label: &str, spoil: Spoil) -> Vec<Check> {
    let report = run(&[&Spoiled::new(name, label, spoil)], &Effort::quick());
    let failed = report.lines.iter().filter(|line| line.finding.verdict == Verdict::Fail);
    let mut checks: Vec<Check> = failed.map(|line| line.finding.check).collect();
    checks.dedup();
    println!("{name}, {label}, {spoil:?}: {checks:?}");
    checks
}

#[test]
fn what_is_spoiled_is_rejected() {
    let subjects = [
        ("diffuse", ""),
        ("sheen_bsdf", "roughness 0.25"),
        ("sheen_bsdf", "roughness 0.06"),
        ("microfacet", "xalpha 0.3"),
        ("microfacet", "xalpha 0.02"),
        ("microfacet", "refract 1"),
        ("translucent", ""),
    ];
    for (name, label) in subjects {
        let rejected = |spoil| rejected(name, label, spoil);
        assert_eq!(rejected(Spoil::Sound), []);
        assert!(rejected(Spoil::Tilted).contains(&Check::ChiSquare));
        assert!(rejected(Spoil::Swollen).contains(&Check::Density));
        assert_eq!(rejected(Spoil::Weights)[0], Check::Weight);
        assert!(rejected(Spoil::Blind).contains(&Check::Coverage));
    }
    for name in ["diffuse", "translucent"] {
        assert_eq!(rejected(name, "", Spoil::Bright), [Check::Energy], "2 % too bright");
    }
    assert!(rejected("diffuse", "", Spoil::Broken).contains(&Check::Finite));
    assert!(rejected("oren_nayar", "sigma 0.7", Spoil::OneWay).contains(&Check::Reciprocity));
}

#[test]
fn a_shader_that_gains_energy_is_told_where() {
    let text = "surface sum(float r = 0.3 [[ float min = 0.1, float max = 0.9 ]]) \
        { Ci = diffuse(N) + sheen_bsdf(N, color(1), r); }";
    let subject =
        ShaderSubject::new("sum.osl", &compile(text).expect("a shader"), &[], Settings::default(), &Effort::quick())
            .expect("a subject");
    assert!(subject.variants() > 6, "the default, five values of the range, and what the survey found");
    let report = run(&[&subject], &Effort::quick());
    let worst = report.worst();
    let energy = worst.iter().find(|line| line.finding.check == Check::Energy).expect("a furnace");
    assert_eq!((energy.finding.verdict, energy.label.as_str()), (Verdict::Fail, "r 0.9"));
    assert_eq!(energy.finding.place, "view cos 1e-4");
    assert!((energy.finding.value - 1.97).abs() < 0.01, "{}", energy.finding.value);
    // Eq. 4 is not reciprocal on purpose: told, not condemned.
    let reciprocity = worst.iter().find(|line| line.finding.check == Check::Reciprocity).expect("pairs");
    assert_eq!(reciprocity.finding.verdict, Verdict::Info);
}

/// The command in a folder of shaders: status, standard output, standard error.
fn command(arguments: &[&str]) -> (i32, String, String) {
    let place = tempfile::tempdir().expect("a folder");
    for (name, text) in [
        ("gain", "surface gain(float k = 1.3) { Ci = k * diffuse(N); }"),
        ("good", "surface good(color c = 0.8) { Ci = sheen(c * diffuse(N), N, color(1), 0.3); }"),
        ("patches", "surface patches() { Ci = (u > 0.7 && v > 0.7 ? 1.2 : 0.9) * diffuse(N); }"),
        ("lamp", "surface lamp() { Ci = 3 * emission(); }"),
        ("wrong", "surface wrong() { Ci = diffus(N); }"),
    ] {
        std::fs::write(place.path().join(format!("{name}.osl")), text).expect("a file");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_velour"));
    let output = command.arg("verify").args(arguments).current_dir(place.path()).output().expect("the command runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().expect("the command ends by itself"), text(output.stdout), text(output.stderr))
}

/// The line of a check in a table.
fn line<'t>(table: &'t str, check: &str) -> &'t str {
    table.lines().find(|line| line.split_whitespace().nth(1) == Some(check)).expect("a line of the check")
}

#[test]
fn the_command_has_a_verdict_and_a_status() {
    let (status, table, _) = command(&["--quick", "gain.osl"]);
    let energy = line(&table, "energy");
    assert_eq!(status, 1, "{table}");
    assert!(energy.contains("1.30000") && energy.contains("FAIL") && energy.contains("view cos"), "{energy}");
    assert!(energy.contains("sends back 30.00 % more light than arrives"), "{energy}");

    let (status, table, _) = command(&["--quick", "good.osl", "diffuse"]);
    assert_eq!((status, table.contains("FAIL")), (0, false), "{table}");
    assert!(table.ends_with("nothing fails\n") && table.starts_with("subject "), "{table}");

    let (status, table, _) = command(&["--quick", "gain.osl", "--param", "k", "0.5,1.1,0.9"]);
    assert_eq!(status, 1);
    assert!(line(&table, "energy").contains("k 1.1: sends back 10.00 %"), "{table}");
    let (status, ..) = command(&["--quick", "gain.osl", "--param", "k", "0.5,0.9"]);
    assert_eq!(status, 0);

    let (status, table, _) = command(&["--quick", "patches.osl"]);
    assert_eq!(status, 1);
    // Where in the patch depends on the survey; that it is there does not.
    let energy = line(&table, "energy");
    assert!(energy.contains("; u 0.") && energy.contains("sends back 20.00 %"), "{table}");

    let (status, table, _) = command(&["--quick", "lamp.osl"]);
    assert_eq!(status, 0);
    assert!(line(&table, "scatters").contains("scatters nothing"), "{table}");
}

#[test]
fn mistakes_have_messages() {
    let (status, out, error) = command(&["wrong.osl"]);
    assert_eq!((status, out.as_str()), (1, ""));
    assert!(error.contains("there is no function `diffus`") && error.contains("did you mean `diffuse`?"), "{error}");
    let (status, _, error) = command(&["shen"]);
    let expected = "error: `shen` is no closure or shader file\n  help: did you mean `sheen`?\n";
    assert_eq!((status, error.as_str()), (2, expected));
    let (status, _, error) = command(&["none.osl"]);
    assert!(status == 2 && error.starts_with("none.osl: error: cannot be read: "), "{error}");
    let (status, _, error) = command(&["diffuse", "--param", "a", "1"]);
    assert!(status == 2 && error.contains("none is named"), "{error}");
    let (status, _, error) = command(&["good.osl", "--param", "d", "1"]);
    assert!(status == 1 && error.contains("shader `good` has no parameter `d`"), "{error}");
}

#[test]
fn threads_change_nothing() {
    let run =
        |threads: &str| command(&["--quick", "--verbose", "-t", threads, "ashikhmin_velvet", "gain.osl", "diffuse"]);
    assert_eq!(run("1"), run("2"));
}
