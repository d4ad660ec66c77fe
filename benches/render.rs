//! Whole renders of the shipped scenes, beside the limit that their rays alone set: `cargo bench --bench render`.
//!
//! For each scene: camera samples a second on one and on two threads, the gain of the second thread, rays a sample, and
//! how many times longer the render takes than tracing as many rays of the same kinds and doing nothing else. A scene of
//! primitives that are tested one and all has its limit from the hierarchy as well, so that it may lie below 1.

use std::path::PathBuf;
use std::time::Instant;
use velour::render::accel::{Accel, Method, NOTHING, Ray};
use velour::render::{Image, Settings, Silent, random, render};
use velour::scene::{Scene, ShaderFiles, Shape};

const SCENES: [(&str, u32); 4] = [("spheres", 64), ("lamps", 16), ("layers", 16), ("million", 16)];
const TURNS: usize = 3;
const RAYS: u32 = 1 << 16;

fn main() {
    println!("scene      loaded  1 thread  2 threads   gain  rays a sample  times its rays alone");
    for (name, samples) in SCENES {
        let start = Instant::now();
        let scene = load(name);
        let loaded = start.elapsed().as_secs_f64();
        let mut images = [None, None];
        for turn in 0..2 * TURNS {
            let threads = 1 + turn % 2;
            let settings = Settings { width: 320, height: 128, samples, threads, ..Settings::default() };
            let image = render(&scene, &settings.with_options(&scene.options), &Silent);
            let image = image.unwrap_or_else(|error| panic!("{error}"));
            let best: &mut Option<Image> = &mut images[threads - 1];
            if best.as_ref().is_none_or(|best| image.about.seconds_tracing < best.about.seconds_tracing) {
                *best = Some(image);
            }
        }
        let [Some(one), Some(two)] = images.map(|image| image.map(|image| image.about)) else { continue };
        let rate = |about: &velour::render::About| about.paths as f64 / about.seconds_tracing * 1e-6;
        let limit = one.rays as f64 * seconds_a_ray(&scene);
        println!(
            "{name:9}  {loaded:5.2} s  {:6.2} M  {:7.2} M  {:5.2}  {:13.2}  {:20.2}",
            rate(&one),
            rate(&two),
            rate(&two) / rate(&one),
            one.rays as f64 / one.paths as f64,
            one.seconds_tracing / limit,
        );
    }
}

fn load(name: &str) -> Scene {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("shaders/scenes").join(format!("{name}.xml"));
    let folders: Vec<PathBuf> = Vec::new();
    Scene::load(&path.to_string_lossy(), &folders, &ShaderFiles::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The mean time of a ray of the camera and of one that leaves what it hit in a random direction.
fn seconds_a_ray(scene: &Scene) -> f64 {
    let accel = Accel::with(&scene.geometry, Method::Wide);
    let camera = &scene.camera;
    let (side, half) = (RAYS.isqrt(), (camera.fov.to_radians() * 0.5).tan() * 0.5);
    let right = camera.direction.cross(camera.up).normalize();
    let up = right.cross(camera.direction);
    let first = |i: u32| {
        let at = |k: u32| 2.0 * half * ((k as f32 + 0.5) / side as f32 - 0.5);
        let toward = camera.direction + right * (at(i % side) * 2.5) + up * at(i / side);
        Ray::new(camera.eye, toward.normalize())
    };
    let mut rays: Vec<Ray> = (0..RAYS).map(first).collect();
    let (mut hits, mut seconds, mut count) = (Vec::new(), 0.0, 0);
    for bounce in 0..2 {
        let mut best = f64::INFINITY;
        for _ in 0..TURNS {
            let start = Instant::now();
            accel.closest(&rays, &mut hits);
            best = best.min(start.elapsed().as_secs_f64());
        }
        (seconds, count) = (seconds + best, count + rays.len());
        let mut next = Vec::new();
        for (i, (ray, hit)) in rays.iter().zip(&hits).enumerate().filter(|(_, (_, hit))| hit.primitive != NOTHING) {
            let p = ray.origin + ray.direction * hit.t;
            let n = match scene.geometry.primitives[hit.primitive as usize].shape {
                Shape::Sphere { center, .. } => p - center,
                Shape::Quad { edge_x, edge_y, .. } => edge_x.cross(edge_y),
                Shape::Triangle { a, b, c } => (b - a).cross(c - a),
            };
            let n = n.normalize() * -n.dot(ray.direction).signum();
            let r = random::sample(1, i as u32, bounce);
            let d = (n + (glam::Vec3::from_slice(&r) * 2.0 - 1.0).normalize_or(n)).normalize_or(n);
            next.push(Ray { skip: hit.primitive, ..Ray::new(accel.leave(p, n, d, hit.primitive), d) });
        }
        rays = next;
    }
    seconds / count as f64
}
