//! A renderer that somebody drives: rounds, stops, and changes that keep the hierarchy.

use super::materials::{scene, scene_with};
use super::speed::FIGURE1;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use velour::exec::Group;
use velour::render::{Image, Progress, RenderError, Renderer, Settings, Silent, render};
use velour::scene::{Camera, CameraFlaw, Scene};

/// Spheres, a quad and a cloth of triangles under a lamp and a sky that is sampled.
const ROOM: &str = r#"<World><Camera eye="0,1,4" look_at="0,0,0" fov="60"/>
    <ShaderGroup name="sky">shader sun l1;</ShaderGroup><Background resolution="32"/>
    <ShaderGroup name="ball">shader cloth l1;</ShaderGroup><Sphere center="0,0,0" radius="0.8"/>
    <ShaderGroup name="floor">shader matte l1;</ShaderGroup><Quad corner="-3,-1,-3" edge_x="0,0,6" edge_y="6,0,0"/>
    <Weave corner="-2,-0.9,2" edge_x="1.5,0,0" edge_y="0,0,-1.5" warp="4" weft="4"/>
    <ShaderGroup name="lamp">float power 40; shader emitter l1;</ShaderGroup>
    <Quad corner="-1,3,-1" edge_x="2,0,0" edge_y="0,0,2"/></World>"#;

fn settings(samples: u32) -> Settings {
    Settings { width: 40, height: 24, samples, threads: 2, ..Settings::default() }
}

fn bits(image: &Image) -> Vec<u32> {
    image.pixels.iter().map(|p| p.to_bits()).collect()
}

fn whole(scene: &Scene, settings: &Settings) -> Image {
    render(scene, settings, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

fn renderer(scene: &Scene, settings: &Settings) -> Renderer {
    Renderer::new(scene, settings).unwrap_or_else(|e| panic!("{e}"))
}

/// The picture after all rounds.
fn finished(renderer: &mut Renderer) -> Image {
    renderer.finish(&Silent).unwrap_or_else(|e| panic!("{e}"));
    renderer.picture()
}

/// Cancels after a number of tiles.
struct Impatient {
    most: usize,
    done: AtomicUsize,
}

impl Progress for Impatient {
    fn tiles(&self, _done: usize, _total: usize) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.most
    }
}

#[test]
fn however_the_rounds_are_cut_the_picture_is_the_same() {
    for xml in [FIGURE1, ROOM] {
        let scene = scene(xml);
        let expected = whole(&scene, &settings(21));
        for threads in [1, 2] {
            let settings = Settings { threads, ..settings(21) };
            for parts in [&[1; 21][..], &[2, 3, 5, 11], &[20, 1], &[7, 100], &[16, 5]] {
                let mut renderer = renderer(&scene, &settings);
                for (k, part) in parts.iter().enumerate() {
                    let more = renderer.round_of(*part, &Silent).unwrap();
                    assert_eq!(more, k + 1 < parts.len(), "{parts:?}, round {k}");
                }
                let picture = renderer.picture();
                assert!(bits(&picture) == bits(&expected), "{threads} threads, rounds of {parts:?}");
                let counts = |image: &Image| (image.about.taken, image.about.paths, image.about.rays);
                assert_eq!(counts(&picture), counts(&expected));
                // There is nothing left to do, and asking for it does no harm.
                assert!(!renderer.round(&Silent).unwrap());
                assert!(bits(&renderer.picture()) == bits(&expected));
            }
        }
    }
}

#[test]
fn a_picture_on_the_way_is_that_of_fewer_samples() {
    let scene = scene(ROOM);
    let mut renderer = renderer(&scene, &settings(64));
    assert!(renderer.picture().pixels.iter().all(|p| *p == 0.0));
    assert!(renderer.round_of(4, &Silent).unwrap());
    assert!(bits(&renderer.picture()) == bits(&whole(&scene, &settings(4))));
    assert!(renderer.round_of(5, &Silent).unwrap());
    assert!(bits(&renderer.picture()) == bits(&whole(&scene, &settings(9))));
    renderer.restart();
    assert_eq!(renderer.picture().about.taken, [0, 0]);
    renderer.round_of(4, &Silent).unwrap();
    assert!(bits(&renderer.picture()) == bits(&whole(&scene, &settings(4))));
}

#[test]
fn a_stopped_round_is_taken_up_again() {
    let scene = scene(ROOM);
    let expected = whole(&scene, &settings(13));
    for threads in [1, 2] {
        let mut renderer = renderer(&scene, &Settings { threads, tile_size: 8, ..settings(13) });
        for most in [2, 1, 3] {
            let impatient = Impatient { most, done: AtomicUsize::new(0) };
            assert!(renderer.round_of(5, &impatient).unwrap());
        }
        let [fewest, most] = renderer.picture().about.taken;
        assert!(fewest < most && renderer.picture().mean()[0] > 0.0, "{fewest} to {most}");
        assert!(bits(&finished(&mut renderer)) == bits(&expected));
    }
}

#[test]
fn a_render_that_stops_by_noise_goes_on_as_one_that_does_it_in_one_go() {
    let scene = scene(ROOM);
    let settings = Settings { noise: Some(2e-3), ..settings(96) };
    let expected = whole(&scene, &settings);
    let mut renderer = renderer(&scene, &settings);
    let mut rounds = 1;
    while renderer.round(&Silent).unwrap() {
        rounds += 1;
        assert!(renderer.picture().about.noise.is_some());
    }
    assert!(rounds > 1 && bits(&renderer.picture()) == bits(&expected));
    assert_eq!(renderer.picture().about.noise, expected.about.noise);
}

/// The group of the last material of a scene whose shader is `shader`.
fn group(shader: &str) -> Group {
    let xml = format!(r#"<World><ShaderGroup>{shader}</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#);
    scene(&xml).materials[0].surface.clone()
}

#[test]
fn another_group_of_a_material_keeps_the_hierarchy_and_renews_all_else() {
    let scene = scene(ROOM);
    let mut renderer = renderer(&scene, &settings(9));
    let hierarchy = Arc::clone(renderer.accel());
    let before = bits(&finished(&mut renderer));
    let mut now = scene.clone();
    // A surface that starts to glow, a lamp that goes out, a sky that is constant, one that varies again.
    for (name, shader) in [
        ("ball", "color c 3 2 1; shader glow l1;"),
        ("lamp", "shader matte l1;"),
        ("floor", "shader ramp l1;"),
        ("sky", "shader sky l1;"),
        ("sky", "float base 0.3; shader sun l1;"),
    ] {
        let index = renderer.material(name).unwrap();
        now.materials[index].surface = group(shader);
        renderer.set_material(index, now.materials[index].surface.clone()).unwrap();
        assert_eq!(renderer.picture().about.taken, [0, 0]);
        let (picture, expected) = (finished(&mut renderer), whole(&now, &settings(9)));
        assert!(bits(&picture) == bits(&expected), "{name} by {shader}");
        assert!(bits(&picture) != before, "{name} by {shader} shows");
        assert!(Arc::ptr_eq(&hierarchy, renderer.accel()), "{name} by {shader}");
    }
    for (index, material) in scene.materials.iter().enumerate() {
        renderer.set_material(index, material.surface.clone()).unwrap();
    }
    assert!(bits(&finished(&mut renderer)) == before, "all as it was");
    assert_eq!(renderer.material("none"), None);
    let error = renderer.set_material(17, group("shader matte l1;")).unwrap_err();
    assert_eq!(error, RenderError::Material { index: 17, count: 4 });
}

#[test]
fn another_camera_and_other_settings_keep_the_hierarchy() {
    let scene = scene(ROOM);
    let mut renderer = renderer(&scene, &settings(5));
    let hierarchy = Arc::clone(renderer.accel());
    renderer.round(&Silent).unwrap();
    let camera = Camera { eye: glam::Vec3::new(1.0, 2.0, 3.0), fov: 40.0, ..scene.camera };
    renderer.set_camera(camera).unwrap();
    let moved = Scene { camera, ..scene.clone() };
    assert!(bits(&finished(&mut renderer)) == bits(&whole(&moved, &settings(5))));
    let other = Settings { width: 31, seed: 3, threads: 1, alpha: true, max_bounces: 2, ..settings(7) };
    renderer.set_settings(&other).unwrap();
    let picture = finished(&mut renderer);
    assert!(picture.width == 31 && bits(&picture) == bits(&whole(&moved, &other)));
    assert!(Arc::ptr_eq(&hierarchy, renderer.accel()));
}

#[test]
fn what_cannot_be_rendered_is_an_error_of_a_kind() {
    let scene = scene(ROOM);
    let error = |scene: &Scene, settings: &Settings| Renderer::new(scene, settings).map(|_| ()).unwrap_err();
    assert!(matches!(error(&scene, &settings(0)), RenderError::Settings(_)));
    for (fov, flaw) in [
        (0.0, CameraFlaw::Angle),
        (-1.0, CameraFlaw::Angle),
        (180.0, CameraFlaw::Angle),
        (f32::NAN, CameraFlaw::Angle),
        (f32::INFINITY, CameraFlaw::Angle),
        (2e-21, CameraFlaw::TooNarrow),
        (1e-45, CameraFlaw::TooNarrow),
    ] {
        let camera = Camera { fov, ..scene.camera };
        let wrong = Scene { camera, ..scene.clone() };
        assert_eq!(error(&wrong, &settings(1)), RenderError::Camera(flaw), "fov {fov}");
        let mut renderer = renderer(&scene, &settings(1));
        assert_eq!(renderer.set_camera(camera), Err(RenderError::Camera(flaw)));
        assert!(renderer.picture().pixels.len() == bits(&finished(&mut renderer)).len(), "goes on with the old one");
    }
    let eye = glam::Vec3::splat(f32::NAN);
    assert_eq!(
        error(&Scene { camera: Camera { eye, ..scene.camera }, ..scene.clone() }, &settings(1)),
        RenderError::Camera(CameraFlaw::Eye)
    );
}

#[test]
fn the_strangest_cameras_that_are_let_through_make_a_picture() {
    let scene = scene(ROOM);
    for (eye, fov, width, height) in [
        (scene.camera.eye, Camera::LEAST_FOV, 8, 8),
        (scene.camera.eye, 179.99998, 8, 8),
        (scene.camera.eye, Camera::LEAST_FOV, 4096, 1),
        (scene.camera.eye, 179.99998, 1, 4096),
        (glam::Vec3::splat(1e30), 40.0, 8, 8),
        (glam::Vec3::splat(f32::MAX), 40.0, 8, 8),
        (glam::Vec3::splat(-f32::MIN_POSITIVE), 40.0, 8, 8),
    ] {
        let wrong = Scene { camera: Camera { eye, fov, ..scene.camera }, ..scene.clone() };
        let image = whole(&wrong, &Settings { width, height, ..settings(2) });
        assert!(image.pixels.iter().all(|p| p.is_finite()), "{eye} {fov}");
    }
}

#[test]
fn what_a_shader_prints_is_told_again_after_a_restart() {
    let says = r#"surface says() { printf("here\n"); Ci = diffuse(N); }"#;
    let xml = r#"<World><Camera eye="0,0,3" look_at="0,0,0" fov="40"/><ShaderGroup>shader says l1;</ShaderGroup>
        <Sphere center="0,0,0" radius="1"/></World>"#;
    let mut renderer = renderer(&scene_with(xml, &[says]), &settings(2));
    for _ in 0..2 {
        assert_eq!(finished(&mut renderer).about.reports.len(), 1);
        renderer.restart();
        assert_eq!(renderer.picture().about.reports.len(), 0);
    }
}
