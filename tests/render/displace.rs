//! Surfaces that shaders move, seen by the renderer.

use super::materials::{picture_with, scene_with};
use std::sync::Arc;
use velour::render::{Image, Renderer, Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

const GREY: &str = "surface grey() { Ci = .5 * diffuse(N); }";
const WHITE: &str = "surface white() { Ci = background(); }";

fn scene(body: &str, displacement: &str) -> String {
    let groups = match displacement {
        "" => "",
        _ => r#"<ShaderGroup name="it" type="displacement">shader move d1;</ShaderGroup>"#,
    };
    format!(
        r#"<World><Camera eye="0,0,4" look_at="0,0,0" fov="60"/>
        <ShaderGroup name="it">shader grey l1;</ShaderGroup>{groups}{body}
        <ShaderGroup>shader white l1;</ShaderGroup><Background/></World>"#
    )
}

fn picture(body: &str, displacement: &str) -> Image {
    let xml = scene(body, displacement);
    let mut shaders = vec![GREY, WHITE];
    shaders.extend((!displacement.is_empty()).then_some(displacement));
    picture_with(&xml, &shaders, |s| s.samples = 64)
}

/// The root mean square of the difference of two pictures.
fn difference(a: &Image, b: &Image) -> f64 {
    let squares = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / a.pixels.len() as f64).sqrt()
}

#[test]
fn a_ball_that_is_blown_up_is_a_larger_ball() {
    let small = r#"<Sphere center=".2,0,0" radius=".8" resolution="128"/>"#;
    let large = picture(r#"<Sphere center=".2,0,0" radius="1.2"/>"#, "");
    for moves in ["P += 0.4 * N;", "displace(0.4);", "displace(\"world\", 0.4);", "P += vector(0.4 * N);"] {
        let moved = picture(small, &format!("displacement move() {{ {moves} }}"));
        let unmoved = picture(small, "displacement move() { N = -N; }");
        assert!(difference(&moved, &large) < 4e-3, "{moves}: {}", difference(&moved, &large));
        assert!(difference(&unmoved, &large) > 0.1, "a shader that leaves P moves nothing");
    }
}

#[test]
fn a_board_that_is_moved_is_a_board_elsewhere() {
    let board = |z: &str| format!(r#"<Quad corner="-1,-1,{z}" edge_x="2,0,0" edge_y="0,2,0" resolution="7"/>"#);
    let moved = picture(&board("0"), "displacement move(float by = .5) { P[2] += by; }");
    let there = picture(&board(".5"), "");
    assert!(difference(&moved, &there) < 3e-3, "{}", difference(&moved, &there));
}

/// A slope raised over a board turns its normals, and its area is that of the slope.
#[test]
fn normals_and_areas_are_those_of_the_moved_surface() {
    let shaders = ["surface grey() { Ci = emission() * color(N[1] / N[2], surfacearea(), 0); }", WHITE];
    let board = r#"<Quad corner="-1,-1,0" edge_x="2,0,0" edge_y="0,2,0" resolution="16"/>"#;
    let xml = scene(board, "move");
    let moves = "displacement move() { P[2] += .25 * P[1] + .1 * u; }";
    let image = picture_with(&xml, &[shaders[0], shaders[1], moves], |s| s.samples = 4);
    let [slope, area, _] = image.pixel(32, 32)[..3] else { panic!("three channels") };
    let exact = 4.0 * (1.0f32 + 0.25 * 0.25 + 0.05 * 0.05).sqrt();
    assert!((slope + 0.25).abs() < 1e-4, "{slope}");
    assert!((area - exact).abs() < 1e-3, "{area} against {exact}");
}

/// A closed mesh, each face with corners of its own and no normals, moved face by face in other directions.
#[test]
fn no_crack_opens_between_faces() {
    let folder = tempfile::tempdir().unwrap();
    let face = |signs: u32| {
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 2.0 } else { -2.0 };
        format!("v {} 0 0\nv 0 {} 0\nv 0 0 {}\nf -3 -2 -1\n", sign(0), sign(1), sign(2))
    };
    let write = |name: String, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("all.obj".to_owned(), (0..8).map(face).collect());
    (0..8).for_each(|number| write(format!("{number}.obj"), face(number)));
    let background_seen = |models: &[String], moves: &str| {
        let body: String = models.iter().map(|name| format!(r#"<Model filename="{name}.obj"/>"#)).collect();
        let xml = scene(&body, moves).replace("0,0,4", "0.1,0.05,0.02").replace("60", "120");
        let files = ["surface grey() { Ci = 0; }", WHITE, moves].into_iter();
        let files = files.fold(ShaderFiles::default(), |files, text| files.with_shader(text).unwrap());
        let scene = Scene::load(&xml, &[folder.path().to_owned()], &files).unwrap_or_else(|e| panic!("{e}"));
        let settings = Settings { width: 96, height: 96, samples: 16, ..Settings::default() };
        render(&scene, &settings, &Silent).unwrap().mean()[0]
    };
    let outward = "displacement move() { P += .3 * Ng * sign(dot(P, Ng)) + .1 * noise(\"perlin\", 7 * P); }";
    assert_eq!(background_seen(&["all".to_owned()], outward), 0.0);
    let apart: Vec<String> = (0..8).map(|number| number.to_string()).collect();
    assert!(background_seen(&apart, outward) > 0.01, "elements of their own part");
}

#[test]
fn what_is_not_finite_stays_and_is_told() {
    let ball = r#"<Sphere center="0,0,0" radius="1" resolution="8"/>"#;
    let image = picture(ball, "displacement move() { P += N * log(-1 + (u > .5)) / 0; if (u > .5) P = P / (P - P); }");
    assert!(image.pixels.iter().all(|x| x.is_finite()));
    let image = picture(ball, "displacement move() { P *= 1e30; P *= 1e30; }");
    let told: Vec<String> = image.about.reports.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("sends") && text.contains("corners nowhere")), "{told:?}");
}

#[test]
fn a_scene_that_moves_nothing_keeps_its_geometry() {
    let ball = r#"<Sphere center="0,0,0" radius="1"/>"#;
    let settings = Settings { width: 8, height: 8, ..Settings::default() };
    for (moves, same) in [("", true), ("displacement move() { P += N; }", false)] {
        let shaders: Vec<&str> = [GREY, WHITE, moves].into_iter().filter(|text| !text.is_empty()).collect();
        let scene = scene_with(&scene(ball, moves), &shaders);
        let renderer = Renderer::new(&scene, &settings).unwrap();
        assert_eq!(Arc::ptr_eq(&renderer.scene().geometry, &scene.geometry), same);
        assert_eq!(renderer.plan().to_string().contains("moved surfaces: material 0, as triangles"), !same);
    }
}

#[test]
fn a_group_that_moves_may_come_before_the_one_that_shades() {
    let ball = r#"<Sphere center="0,0,0" radius=".5"/>"#;
    let moves = "displacement move() { P += .5 * N; }";
    let after = scene(ball, moves);
    let (surface, moving) = (">shader grey", r#" type="displacement">shader move"#);
    let before = after.replace(surface, ">x").replace(moving, surface).replace(">x", moving);
    assert_ne!(after, before);
    let [after, before] = [after, before].map(|xml| picture_with(&xml, &[GREY, WHITE, moves], |_| ()));
    assert!(difference(&after, &before) == 0.0 && after.mean()[0] < 0.95);
}

/// A shader of emission by position, under a group that moves nothing or not all.
fn seen(body: &str, shade: &str, moves: &str, at: [u32; 2]) -> [f32; 3] {
    let shade = format!("surface grey() {{ Ci = emission() * color({shade}); }}");
    let image = picture_with(&scene(body, moves), &[&shade, WHITE, moves], |s| s.samples = 4);
    image.pixel(at[0], at[1])[..3].try_into().unwrap()
}

#[test]
fn objects_of_equal_area_do_not_share_it() {
    let weave = r#"<Weave corner="-1,-1,0" edge_x="2,0,0" edge_y="0,2,0" warp="6" weft="6"/>"#;
    let shade = "surface grey() { Ci = emission() * surfacearea(); }";
    let nothing = "displacement move() { }";
    let [with, without] = [nothing, ""].map(|moves| {
        let shaders: Vec<&str> = [shade, WHITE, moves].into_iter().filter(|text| !text.is_empty()).collect();
        picture_with(&scene(weave, moves), &shaders, |s| s.samples = 4)
    });
    assert!(difference(&with, &without) < 1e-4, "{}", difference(&with, &without));
}

#[test]
fn a_surface_that_is_moved_in_part_bends_at_the_edge() {
    let board = r#"<Quad corner="-1,-1,0" edge_x="2,0,0" edge_y="0,2,0" resolution="8"/>"#;
    let moves = "displacement move() { if (P[0] > 0) P[2] += .6 * P[0]; }";
    // Beside the middle the normal is half way, not where it was.
    let left = seen(board, "-N[0], 0, 0", moves, [31, 32])[0];
    assert!(left > 0.15 && left < 0.35, "{left}");
    assert!(seen(board, "-N[0], 0, 0", moves, [20, 32])[0].abs() < 1e-4);
}

#[test]
fn how_a_polygon_is_cut_does_not_show() {
    let folder = tempfile::tempdir().unwrap();
    let cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
        f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
    std::fs::write(folder.path().join("cube.obj"), cube).unwrap();
    let moves = "displacement move() { P += .2 * N; }";
    let black = "surface grey() { Ci = 0; }";
    let files = [black, WHITE, moves].into_iter();
    let files = files.fold(ShaderFiles::default(), |files, text| files.with_shader(text).unwrap());
    let xml = scene(r#"<Model filename="cube.obj"/>"#, moves).replace("0,0,4", "0,0,30").replace("60", "12");
    let loaded = Scene::load(&xml, &[folder.path().to_owned()], &files).unwrap_or_else(|e| panic!("{e}"));
    let settings = Settings { width: 64, height: 64, samples: 1, jitter: false, ..Settings::default() };
    let image = render(&loaded, &settings, &Silent).unwrap();
    for y in 0..64 {
        for x in 0..32 {
            assert_eq!(image.pixel(x, y), image.pixel(63 - x, y), "{x} {y}");
        }
    }
}

#[test]
fn displacement_is_a_ray_type_of_its_own() {
    let board = r#"<Quad corner="-1,-1,0" edge_x="2,0,0" edge_y="0,2,0"/>"#;
    let moves = r#"displacement move() { if (raytype("displacement") && !raytype("shadow")) P[2] += .4; }"#;
    assert!((seen(board, "P[2], 0, 0", moves, [32, 32])[0] - 0.4).abs() < 1e-5);
}

#[test]
fn what_cannot_be_moved_is_told() {
    let settings = Settings { width: 8, height: 8, samples: 1, ..Settings::default() };
    let moves = "displacement move() { P = 0; }";
    let ball = r#"<Sphere center="0,0,0" radius="1" resolution="4294967295"/>"#;
    let board = r#"<Quad corner="-1,-1,0" edge_x="2,0,0" edge_y="0,2,0" resolution="1"/>"#;
    for fine in [ball.to_owned(), format!("{ball}{board}"), format!("{ball}{ball}")] {
        let error = render(&scene_with(&scene(&fine, moves), &[GREY, WHITE, moves]), &settings, &Silent).unwrap_err();
        assert!(error.to_string().contains("give spheres and quads a smaller `resolution`"), "{error}");
    }
    let image = picture(r#"<Sphere center="0,0,0" radius="1"/>"#, moves);
    let told: Vec<String> = image.about.reports.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("triangles no area; they are left out")), "{told:?}");
    let alone = scene("", moves).replace(r#"<ShaderGroup name="it">shader grey l1;</ShaderGroup>"#, "");
    let warnings = scene_with(&alone, &[GREY, WHITE, moves]).warnings;
    assert!(warnings.iter().any(|text| text.contains("displacement group `it` is alone")), "{warnings:?}");
}

/// What displacement has said is said again after a change, and prints of every corner do not fill memory.
#[test]
fn what_shaders_say_meanwhile_is_kept() {
    let ball = r#"<Sphere center="0,0,0" radius="1" resolution="32"/>"#;
    let moves = r#"displacement move() { printf("at %g\\n", P); warning("moving"); P += .1 * N; }"#;
    let scene = scene_with(&scene(ball, moves), &[GREY, WHITE, moves]);
    let settings = Settings { width: 8, height: 8, samples: 1, ..Settings::default() };
    let mut renderer = Renderer::new(&scene, &settings).unwrap();
    for change in 0..2 {
        if change == 1 {
            renderer.set_camera(scene.camera).unwrap();
        }
        renderer.finish(&Silent).unwrap();
        let told: Vec<String> = renderer.picture().about.reports.iter().map(ToString::to_string).collect();
        assert!(told.iter().any(|text| text.contains("moving")), "{change}: {told:?}");
        assert!((900..=1100).contains(&told.len()), "{}", told.len());
    }
}
