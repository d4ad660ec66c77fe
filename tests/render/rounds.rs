//! A renderer that somebody drives: rounds, stops, and changes that keep the hierarchy.

use super::materials::{scene, scene_with};
use super::speed::FIGURE1;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use velour::exec::Group;
use velour::render::{Image, Progress, RenderError, Renderer, Settings, Silent, render};
use velour::scene::{Camera, CameraFlaw, Object, Scene};

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
    scene_with(&xml, &LOOPS).materials[0].surface.clone()
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
fn an_object_without_primitives_does_no_harm() {
    let scene = scene(ROOM);
    let mut geometry = (*scene.geometry).clone();
    for material in 0..scene.materials.len() as u32 {
        let object = Object { material, ..geometry.objects[0].clone() };
        geometry.objects.push(object);
    }
    let more = Scene { geometry: Arc::new(geometry), ..scene.clone() };
    assert!(bits(&whole(&more, &settings(2))) == bits(&whole(&scene, &settings(2))));
    // As a mesh that keeps no face leaves it.
    let mut bare = (*more.geometry).clone();
    bare.primitives.clear();
    let empty = Scene { geometry: Arc::new(bare), ..more };
    assert!(whole(&empty, &settings(2)).pixels.iter().all(|p| p.is_finite()));
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

/// A lamp and a sky of which nothing is known until their shaders have run, loops and all.
const LOOPS: [&str; 2] = [
    "surface lamp(float power = 9) { float x = u; for (int i = 0; i < 9; i++) x = .5 * (x + noise(P * i)); Ci = power * x * emission(); }",
    "surface heaven(float bright = 1)
     { float x = 0; for (int i = 0; i < 2; i++) x += pow(max(I[1], 0.0), 9 * i); Ci = bright * x * background(); }",
];

#[test]
fn what_changes_after_a_stop_is_prepared_when_it_goes_on() {
    let scene =
        scene_with(&ROOM.replace("shader sun", "shader heaven").replace("shader emitter", "shader lamp"), &LOOPS);
    type Change<'a> = &'a dyn Fn(&mut Renderer);
    let lamp: Change =
        &|r| r.set_material(r.material("lamp").unwrap(), group("float power 20; shader lamp l1;")).unwrap();
    let sky: Change =
        &|r| r.set_material(r.material("sky").unwrap(), group("float bright 3; shader heaven l1;")).unwrap();
    let look: Change = &|r| r.set_camera(Camera { fov: 50.0, ..scene.camera }).unwrap();
    let set: Change = &|r| r.set_settings(&Settings { seed: 3, ..settings(4) }).unwrap();
    let restart: Change = &|r| r.restart();
    let stop = |renderer: &Renderer, on: bool| renderer.stop().store(on, Ordering::Relaxed);
    let all = [
        ("lamp", lamp, lamp),
        ("lamp and camera", lamp, look),
        ("sky and lamp", sky, lamp),
        ("settings", set, restart),
    ];
    for (name, first, second) in all {
        let [mut free, mut stopped] = [(); 2].map(|()| renderer(&scene, &settings(4)));
        [first, second].iter().for_each(|change| change(&mut free));
        stop(&stopped, true);
        [first, second].iter().for_each(|change| change(&mut stopped));
        assert!(stopped.round(&Silent).unwrap(), "{name}: something is left");
        assert_eq!(finished(&mut stopped).about.taken, [0, 0], "{name}");
        stop(&stopped, false);
        let picture = finished(&mut stopped);
        assert!(bits(&picture) == bits(&finished(&mut free)), "{name}");
        assert_eq!(picture.about.taken, [4, 4]);
    }
}

#[test]
fn a_part_that_is_gone_on_from_while_stopped_is_kept() {
    let scene = scene_with(&ROOM.replace("shader emitter", "shader lamp"), &LOOPS);
    let whole = finished(&mut renderer(&scene, &settings(6)));
    let mut first = renderer(&scene, &settings(6));
    first.round_of(2, &Silent).unwrap();
    let mut second = renderer(&scene, &settings(6));
    second.stop().store(true, Ordering::Relaxed);
    second.set_camera(scene.camera).unwrap();
    second.resume(first.part()).unwrap();
    second.stop().store(false, Ordering::Relaxed);
    assert!(bits(&finished(&mut second)) == bits(&whole));
}

#[test]
fn a_time_that_is_up_while_surfaces_are_moved_leaves_no_renderer() {
    let slow = "displacement slow() { float x = u; for (int i = 0; i < 3000; i++) x = pow(x + noise(P * i), .99); P += x * N; }";
    let xml = ROOM.replace("name=\"floor\">shader matte l1;", "name=\"floor\">shader matte l1;</ShaderGroup><ShaderGroup name=\"floor\" type=\"displacement\">shader slow l1;");
    let times = Settings { seconds: Some(1e-3), ..settings(1) };
    assert!(matches!(Renderer::new(&scene_with(&xml, &[slow]), &times), Err(RenderError::Late)));
}
