//! Terminators of meshes with smooth normals: every remedy comes nearer to a fine mesh, none adds energy, and what has no smooth
//! normals does not change.

use super::materials::{picture_with, scene_with};
use std::fmt::Write;
use velour::render::{Image, LightStrategy, Plan, Settings, Terminator};

/// A ball of radius 1 of `around` x `down` patches, as OBJ, with smooth normals or without.
fn ball(around: usize, down: usize, smooth: bool) -> String {
    let mut out = String::new();
    for j in 0..=down {
        for i in 0..around {
            let (theta, phi) =
                (std::f64::consts::PI * j as f64 / down as f64, std::f64::consts::TAU * i as f64 / around as f64);
            let [x, y, z] = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()];
            writeln!(out, "v {x:.7} {y:.7} {z:.7}\nvn {x:.7} {y:.7} {z:.7}").unwrap();
        }
    }
    for (j, i) in (0..down).flat_map(|j| (0..around).map(move |i| (j, i))) {
        let at = |j: usize, i: usize| j * around + i % around + 1;
        let [a, b, c, d] = [at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)];
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            match smooth {
                true => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}").unwrap(),
                false => writeln!(out, "f {a} {b} {c}").unwrap(),
            }
        }
    }
    out
}

/// A scene beside its mesh `it.obj`.
fn with_mesh(obj: &str, scene: &str, shaders: &[&str], change: impl FnOnce(&mut Settings)) -> Image {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("it.obj"), obj).unwrap();
    let path = folder.path().join("s.xml");
    std::fs::write(&path, scene).unwrap();
    picture_with(path.to_str().unwrap(), shaders, change)
}

/// Where the light of a small lamp at the side ends.
const LIT: &str = r#"<World><Camera eye="0,0.4,6" look_at="0,0,0" fov="11"/>
    <ShaderGroup>color Cs 1 1 1; shader matte l1;</ShaderGroup><Model filename="it.obj"/>
    <ShaderGroup is_light="yes">color c 1000 1000 1000; shader glow l1;</ShaderGroup>
    <Quad corner="8,1,-0.2" edge_x="0,0,0.2" edge_y="0,0.2,0"/></World>"#;

fn mean(image: &Image) -> f64 {
    image.pixels.iter().map(|p| f64::from(*p)).sum::<f64>() / image.pixels.len() as f64
}

fn squared(a: &Image, b: &Image) -> f64 {
    let squares = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>() / a.pixels.len() as f64
}

/// Measured with 256 samples: 16 x 8 patches .168 without, .024 with `origin`; 32 x 16 .67 and .0007 (of the mean squared).
/// `factor` darkens what `none` has too bright and too dark alike: .32 and .98.
#[test]
fn light_at_the_smooth_surface_comes_near_a_fine_ball() {
    let lit = |obj: &str, terminator| with_mesh(obj, LIT, &[], |s| (s.samples, s.terminator) = (64, terminator));
    let truth = lit(&ball(256, 128, true), Terminator::None);
    for ((around, down), better) in [((16, 8), 5.0), ((32, 16), 200.0)] {
        let obj = ball(around, down, true);
        let [none, factor, origin] = Terminator::ALL.map(|(_, method)| squared(&lit(&obj, method), &truth));
        assert!(origin * better < none && origin * better < factor, "{around}: {none}, {factor}, {origin}");
    }
    // A fine ball is nearly its own smooth surface.
    let fine = lit(&ball(256, 128, true), Terminator::Origin);
    assert!((mean(&fine) / mean(&truth) - 1.0).abs() < 0.01, "{} and {}", mean(&fine), mean(&truth));
}

/// A cube whose faces share normals as if it were round.
fn rounded_cube() -> String {
    let mut out = String::new();
    for k in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 0.6 } else { -0.6 });
        writeln!(out, "v {x} {y} {z}\nvn {x} {y} {z}").unwrap();
    }
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        writeln!(out, "f {a}//{a} {b}//{b} {c}//{c} {d}//{d}").unwrap();
    }
    out
}

/// Whatever absorbs nothing shows no more than the light around it, and with its light at the smooth surface it loses nothing.
#[test]
fn no_remedy_adds_energy() {
    let shaders = [
        "surface it() { Ci = diffuse(N); }",
        "surface it() { Ci = 0.5 * diffuse(N) + 0.5 * translucent(N); }",
        "surface it() { Ci = reflection(N, 0); }",
        "surface it() { Ci = conductor_bsdf(N, vector(1,0,0), 0.3, 0.3, color(0), color(1e6), \"ggx\"); }",
        "surface it() { Ci = dielectric_bsdf(N, vector(1,0,0), color(1), color(1), 0, 0, 1.5, \"ggx\"); }",
        "surface it() { Ci = sheen(diffuse(N), N, color(1), 0.3); }",
    ];
    for (name, obj) in [("ball", ball(16, 8, true)), ("coarse ball", ball(5, 3, true)), ("cube", rounded_cube())] {
        for floor in ["", r#"<Quad corner="-9,-0.6,-9" edge_x="0,0,18" edge_y="18,0,0"/>"#] {
            let scene = format!(
                r#"<World><Camera eye="1,1.5,6" look_at="0,0,0" fov="16"/>
                <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="0"/>
                <ShaderGroup>color Cs 1 1 1; shader matte l1;</ShaderGroup>{floor}
                <ShaderGroup>shader it l1;</ShaderGroup><Model filename="it.obj"/></World>"#
            );
            for (shader, (method, terminator)) in shaders.iter().flat_map(|s| Terminator::ALL.map(|t| (s, t))) {
                let image = with_mesh(&obj, &scene, &[shader], |s| {
                    (s.width, s.height, s.samples, s.terminator) = (24, 24, 64, terminator);
                });
                let (mean, most) = (mean(&image), image.pixels.iter().copied().fold(0.0, f32::max));
                assert!(mean < 1.0 + 1e-3, "{name} {method}: {mean}, {most}: {shader}");
                if terminator == Terminator::Origin && shader.contains("= diffuse") {
                    assert!(mean > 1.0 - 1e-3, "{name} {method}: {mean}, {most}: {shader}");
                }
            }
        }
    }
}

/// Flat meshes, with their own normals or without any, round balls and quads: not a bit changes.
#[test]
fn what_is_not_smooth_does_not_change() {
    // One facet a face, each with the normal that it has anyway.
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 -1\nvn 0 -1 0\nvn -1 0 0\nvn 1 1 1\n\
                f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nf 1//3 4//3 3//3\nf 2//4 3//4 4//4\n";
    for obj in [ball(16, 8, false), flat.to_owned()] {
        let scene = r#"<World><Camera eye="2,2,4" look_at="0,0,0" fov="40"/>
            <ShaderGroup>color c .2 .2 .2; shader sky l1;</ShaderGroup><Background resolution="0"/>
            <ShaderGroup>shader leaf l1;</ShaderGroup><Model filename="it.obj"/><Sphere center="1,0,1" radius=".5"/>
            <Quad corner="-5,-1,-5" edge_x="0,0,10" edge_y="10,0,0"/>
            <ShaderGroup is_light="yes">color c 9 9 9; shader glow l1;</ShaderGroup>
            <Quad corner="3,2,-1" edge_x="0,0,1" edge_y="0,1,0"/></World>"#;
        let leaf = "surface leaf() { Ci = 0.5 * diffuse(N) + 0.3 * translucent(N) + 0.1 * reflection(N, 0); }";
        let [none, factor, origin] =
            Terminator::ALL.map(|(_, method)| with_mesh(&obj, scene, &[leaf], |s| s.terminator = method));
        assert_eq!(none.pixels, factor.pixels);
        assert_eq!(none.pixels, origin.pixels);
    }
}

/// Light that scattering finds and light that is sampled arrive at the same place: every strategy gives the same picture.
#[test]
fn all_strategies_agree_about_smooth_meshes() {
    let scene = r#"<World><Camera eye="2,2,4" look_at="0,0,0" fov="32"/>
        <ShaderGroup>shader leaf l1;</ShaderGroup><Model filename="it.obj"/>
        <ShaderGroup is_light="yes">color c 3 3 3; shader glow l1;</ShaderGroup>
        <Quad corner="1.5,-1,-1" edge_x="0,0,2" edge_y="0,2,0"/></World>"#;
    // What passes through starts on the facet and not above it, so there the strategies differ by how far that is.
    let matte = "surface leaf() { Ci = 0.8 * diffuse(N); }";
    let leaf = "surface leaf() { Ci = 0.5 * diffuse(N) + 0.3 * translucent(N); }";
    for (shader, around, tolerance) in [(matte, 8, 8e-3), (leaf, 8, 2.5e-2), (leaf, 16, 1e-2)] {
        for (name, terminator) in Terminator::ALL.into_iter().skip(1) {
            let of = |lights| {
                let image = with_mesh(&ball(around, around / 2, true), scene, &[shader], |s| {
                    (s.width, s.height, s.samples, s.terminator, s.lights) = (32, 32, 256, terminator, lights);
                });
                mean(&image)
            };
            let expected = of(LightStrategy::Combined);
            for lights in [LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
                let mean = of(lights);
                assert!((mean / expected - 1.0).abs() < tolerance, "{around} {name}, {lights:?}: {mean}, {expected}");
            }
        }
    }
}

/// The plan names the materials that pay, and only those.
#[test]
fn only_smooth_materials_pay() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("smooth.obj", ball(16, 8, true));
    write("flat.obj", ball(16, 8, false));
    let scene = r#"<World><Camera eye="2,2,4" look_at="0,0,0" fov="40"/>
        <ShaderGroup>shader matte l1;</ShaderGroup><Model filename="flat.obj"/><Sphere center="1,0,1" radius=".5"/>
        <ShaderGroup>shader matte l1;</ShaderGroup><Model filename="smooth.obj"/>
        <ShaderGroup>color c 1 1 1; shader glow l1;</ShaderGroup><Model filename="smooth.obj"/></World>"#;
    write("s.xml", scene.to_owned());
    let lamp = "surface glow(color c = 1) { Ci = c * emission(); }";
    let scene = scene_with(folder.path().join("s.xml").to_str().unwrap(), &[lamp]);
    for (_, terminator) in Terminator::ALL {
        let plan = Plan::new(&scene, &Settings { terminator, ..Settings::default() });
        let smooth: Vec<bool> = plan.materials.iter().map(|m| m.smooth).collect();
        assert_eq!(smooth, [false, terminator != Terminator::None, false]);
        assert_eq!(plan.to_string().contains("smooth meshes: material 1, "), smooth[1], "{plan}");
    }
}
