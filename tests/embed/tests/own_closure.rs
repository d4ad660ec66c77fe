//! A closure of a host's own compiles, prints, renders, is described and verified, from another crate.

use velour::closure::print::tree_text;
use velour::closure::{ClosureDef, Library, Lobes, RegisterError, Samples, Settings};
use velour::compile::Compiler;
use velour::exec::{Group, Machine, Points};
use velour::glam::Vec3;
use velour::lang::describe::closure_text;
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate};
use velour::measure::verify::{ClosureSubject, Effort, Subject, verify};
use velour::render::{Settings as RenderSettings, Silent, render};
use velour::scene::{Scene, ShaderFiles};
use velour_embed_tests::{library, minnaert};

fn compiler() -> Compiler {
    Compiler::new().with_closures(library().unwrap())
}

fn group(text: &str) -> Group {
    let shader = compiler().compile("own.osl", text).unwrap_or_else(|error| panic!("{error}"));
    shader.group().build().unwrap()
}

#[test]
fn it_prints() {
    let group =
        group("surface s(float k = 2) { Ci = 0.5 * minnaert(N, color(1, 0.5, 0.25), k, \"label\", \"moon\"); }");
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &Points::single(Vec3::Z));
    assert_eq!(
        tree_text(group.table(), tree, 0),
        "(0.5, 0.5, 0.5) * minnaert ((0, 0, 1), (1, 0.5, 0.25), 2, \"label\", \"moon\")"
    );
}

#[test]
fn it_scatters() {
    let group = group("surface s() { Ci = minnaert(N, color(0.8), 3); }");
    let cos = 0.6;
    let wo = Vec3::new(0.8, 0.0, cos);
    let (points, mut machine, mut lobes) = (Points::single(wo), Machine::new(), Lobes::new(Settings::default()));
    lobes.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
    let sum = integrate(&mut lobes, 1, &hemisphere(24, 32, f64::from(cos)))[0][0];
    assert!((sum - 0.8 * f64::from(cos * cos)).abs() < 1e-4, "{sum}");
    let mut samples = Samples::default();
    lobes.sample(&Column3::splat(Vec3::new(0.3, 0.6, 0.1), 1), &mut samples);
    assert!((samples.weight.x[0] - 0.8 * cos * cos).abs() < 1e-5, "{samples:?}");
}

#[test]
fn it_lies_over_others_and_under_them() {
    let inside = |body: &str| {
        let group = group(&format!("surface s() {{ Ci = {body}; }}"));
        let wo = Vec3::new(0.8, 0.0, 0.6);
        let (points, mut machine, mut lobes) = (Points::single(wo), Machine::new(), Lobes::new(Settings::default()));
        lobes.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
        let lit = lobes.emission().x[0];
        (lobes.describe(0).iter().map(|lobe| (lobe.closure, lobe.through)).collect::<Vec<_>>(), lit)
    };
    // The albedo of the dust at this cosine is 0.6².
    let (lobes, _) = inside("dusted(diffuse(N), N, color(0.5), 3)");
    assert_eq!(lobes[0], ("dusted", 1.0));
    assert!(lobes[1].0 == "diffuse" && (lobes[1].1 - (1.0 - 0.5 * 0.36)).abs() < 1e-6, "{lobes:?}");
    // Nested in a top, it counts as its own dust plus what that lets through of its base.
    let (lobes, _) = inside("layer(dusted(minnaert(N, color(0.5), 3), N, color(0.5), 3), reflection(N, 0))");
    let dust = 0.5 * 0.36;
    let through = 1.0 - (dust + (1.0 - dust) * 0.5 * 0.36);
    let mirror = lobes.iter().find(|lobe| lobe.0 == "reflection").unwrap();
    assert!((mirror.1 - through).abs() < 1e-5, "{lobes:?}");
    let (_, lit) = inside("dusted(glimmer(color(2)), N, color(0.5), 3)");
    assert!((lit - 2.0 * (1.0 - 0.5 * 0.36)).abs() < 1e-5, "{lit}");
}

#[test]
fn it_renders() {
    let shaders = [
        "surface moon(float k = 1) { Ci = minnaert(N, color(1), k); }",
        "surface sky() { Ci = background(); }",
        "surface lamp() { Ci = glimmer(color(0.75, 0.5, 0.25)); }",
    ];
    let files = shaders.iter().fold(ShaderFiles::new(compiler()), |files, text| files.with_shader(text).unwrap());
    let picture = |group: &str| {
        let scene = format!(
            r#"<World><Camera eye="0,0,4" dir="0,0,-1" fov="80"/><ShaderGroup>shader sky l1;</ShaderGroup><Background/>
            <ShaderGroup>{group}</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#
        );
        let scene = Scene::load(&scene, &[], &files).unwrap_or_else(|error| panic!("{error}"));
        let settings = RenderSettings { width: 16, height: 16, samples: 16, threads: 1, ..RenderSettings::default() };
        render(&scene, &settings, &Silent).unwrap_or_else(|error| panic!("{error}"))
    };
    // Lambert's law vanishes in a white sky; with k = 3 the middle does still, and the rim is darker.
    let (lambert, moon) = (picture("float k 1; shader moon l1;"), picture("float k 3; shader moon l1;"));
    assert!(lambert.pixels.iter().all(|p| (p - 1.0).abs() < 1e-3));
    let (middle, rim) = (moon.pixel(8, 8)[0], moon.pixel(8, 4)[0]);
    assert!((middle - 1.0).abs() < 0.1 && (0.35..0.65).contains(&rim), "{middle} {rim}");
    let lamp = picture("shader lamp l1;");
    let lit = lamp.pixel(8, 8);
    assert!(lit.iter().zip([0.75, 0.5, 0.25]).all(|(a, b)| (a - b).abs() < 1e-6), "{lit:?}");
}

#[test]
fn it_is_described() {
    let library = library().unwrap();
    let (_, spec) = library.named("minnaert").next().unwrap();
    let expected = "closure color minnaert(normal N, color albedo, float k, [\"label\", string])
    darkens toward the rim (Minnaert 1941)
    parameters:
        normal N: shading normal, unit length
        color albedo: color of the reflection, 0..1
        float k: how dark the rim is, 1 (not at all) to 20
    keyword parameters:
        string label: a name for the host; velour carries it and gives it no meaning
";
    assert_eq!(closure_text(spec), expected);
}

#[test]
fn it_passes_verification() {
    let compiler = compiler();
    let ids: Vec<_> =
        ["minnaert", "dusted"].iter().map(|name| compiler.closures.named(name).next().unwrap().0).collect();
    let subjects: Vec<ClosureSubject> =
        ids.into_iter().map(|id| ClosureSubject::new(&compiler, id, false, Settings::default()).unwrap()).collect();
    assert!(subjects[0].variants() >= 4 && subjects[1].variants() >= 3);
    let subjects: Vec<&dyn Subject> = subjects.iter().map(|subject| subject as &dyn Subject).collect();
    let report = verify(&subjects, &Effort::quick(), &|_, _| {});
    assert!(report.passed(), "{:#?}", report.worst());
}

#[test]
fn what_cannot_be_called_is_refused() {
    velour::arguments! {
        struct Nothing {}
    }
    let named = |name| ClosureDef::new(name, "nothing", |_: Nothing, _| {}).inert();
    let mut library = Library::standard();
    assert_eq!(library.register(named("my closure")), Err(RegisterError::NoName("my closure")));
    assert_eq!(library.register(named("holdout")), Err(RegisterError::Known("holdout")));
    assert!(library.register(minnaert()).is_ok());
    assert_eq!(library.register(minnaert()), Err(RegisterError::Known("minnaert")));
    // Other arguments under a known name are an overload.
    assert!(library.register(named("minnaert")).is_ok());
}

#[test]
fn velours_own_compiler_knows_nothing_of_it() {
    let error = Compiler::new().compile("s.osl", "surface s() { Ci = minnaert(N, color(1), 1); }").unwrap_err();
    assert!(error.to_string().contains("there is no function `minnaert`"), "{error}");
}
