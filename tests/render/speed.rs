//! How fast it is: run with `cargo test --release --test render -- --ignored --nocapture`.

use super::materials::scene;
use velour::render::{Settings, Silent, render};

/// The scene that peers were timed on.
pub const FIGURE1: &str = r#"<World>
  <Camera eye="0,1.2,11" look_at="0,0.9,0" fov="28" />
  <Option max_bounces="int 4" />
  <ShaderGroup>shader sky l1;</ShaderGroup>
  <Background resolution="64" />
  <ShaderGroup>color Cs 0.5 0.5 0.5; shader matte l1;</ShaderGroup>
  <Quad corner="-20,0,-20" edge_x="0,0,40" edge_y="40,0,0" />
  <ShaderGroup>float rough 0.15; shader cloth l1;</ShaderGroup><Sphere center="-4.4,1,0" radius="1" />
  <ShaderGroup>float rough 0.25; shader cloth l1;</ShaderGroup><Sphere center="-2.2,1,0" radius="1" />
  <ShaderGroup>float rough 0.40; shader cloth l1;</ShaderGroup><Sphere center="0,1,0" radius="1" />
  <ShaderGroup>float rough 0.65; shader cloth l1;</ShaderGroup><Sphere center="2.2,1,0" radius="1" />
  <ShaderGroup>float rough 1.0; shader cloth l1;</ShaderGroup><Sphere center="4.4,1,0" radius="1" />
  <ShaderGroup is_light="yes">float power 400; shader emitter l1;</ShaderGroup>
  <Quad corner="-3,6,2" edge_x="6,0,0" edge_y="0,0,3" />
</World>"#;

#[test]
#[ignore = "a measurement"]
fn figure_1() {
    let scene = scene(FIGURE1);
    for threads in [1, 2, 1, 2] {
        let settings = Settings { width: 640, height: 256, samples: 64, threads, ..Settings::default() };
        let image = render(&scene, &settings.with_options(&scene.options), &Silent).unwrap();
        let about = &image.about;
        println!(
            "{threads} threads: {:.2} M samples/s, {:.2} M rays/s, prepared in {:.1} ms, mean {:.5}",
            about.paths as f64 / about.seconds_tracing * 1e-6,
            about.rays as f64 / about.seconds_tracing * 1e-6,
            about.seconds_preparing * 1e3,
            image.mean()[0],
        );
        velour::render::output::write(&image, &std::env::temp_dir().join("figure1.png")).unwrap();
    }
}

/// A bumpy ball of 2 n^2 triangles, as OBJ.
pub fn ball(n: usize) -> String {
    use std::fmt::Write;
    let mut out = String::new();
    for i in 0..=n {
        for j in 0..=n {
            let (theta, phi) =
                (std::f32::consts::PI * i as f32 / n as f32, std::f32::consts::TAU * j as f32 / n as f32);
            let r = 0.9 + 0.1 * (20.0 * theta).sin() * (17.0 * phi).sin();
            let (x, y, z) = (r * theta.sin() * phi.cos(), r * theta.cos(), r * theta.sin() * phi.sin());
            writeln!(out, "v {x} {y} {z}").unwrap();
        }
    }
    for i in 0..n {
        for j in 1..=n {
            let (a, b) = (i * (n + 1) + j, (i + 1) * (n + 1) + j);
            writeln!(out, "f {a} {b} {}\nf {a} {} {}", b + 1, b + 1, a + 1).unwrap();
        }
    }
    out
}

#[test]
#[ignore = "a measurement"]
fn waves_and_tiles() {
    let scene = scene(FIGURE1);
    for round in 0..2 {
        for (tile_size, wave_size) in [(16, 4096), (16, 2048), (16, 1024), (16, 512), (16, 8192), (8, 1024), (32, 4096)]
        {
            let settings = Settings {
                width: 320,
                height: 128,
                samples: 64,
                threads: 1,
                tile_size,
                wave_size,
                ..Settings::default()
            };
            let about = render(&scene, &settings.with_options(&scene.options), &Silent).unwrap().about;
            let rate = about.paths as f64 / about.seconds_tracing * 1e-6;
            println!("{round}: tile {tile_size}, wave {wave_size}: {rate:.2} M paths/s");
        }
    }
}
