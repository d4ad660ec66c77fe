//! A scene that is rendered round by round, looked at in between, given another material, and rendered again.
//!
//! `cargo run --release --example render_scene` writes `red.png` and `blue.png`.

use std::error::Error;
use std::path::Path;
use velour::render::{Renderer, Settings, Silent, output};
use velour::scene::{Scene, ShaderFiles};

// `sky` and `cloth` are in the library; a folder with shaders of one's own would be named in `Scene::load`.
const SCENE: &str = r#"<World>
  <Camera eye="0,0,3" dir="0,0,-1" fov="45"/>
  <ShaderGroup>color radiance 1 1 1; shader sky l1;</ShaderGroup><Background resolution="16"/>
  <ShaderGroup name="ball">float roughness 0.3; shader cloth l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
</World>"#;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene::load(SCENE, &[], &ShaderFiles::default())?;
    let settings = Settings { width: 160, height: 120, samples: 16, ..Settings::default() };
    let mut renderer = Renderer::new(&scene, &settings)?;
    let mut left = true;
    while left {
        left = renderer.round_of(4, &Silent)?;
        let picture = renderer.picture();
        println!("{} samples a pixel, mean {:.3?}", picture.about.taken[1], picture.mean());
    }
    output::write(&renderer.picture(), Path::new("red.png"))?;

    // The hierarchy over the geometry stays; only what the material needs is prepared anew.
    let blue = "surface blue() { Ci = sheen(color(0.05, 0.1, 0.6) * diffuse(N), N, color(0.8), 0.4); }";
    let ball = renderer.material("ball").ok_or("the scene names its ball")?;
    renderer.set_material(ball, velour::compile::compile(blue)?.group().build()?)?;
    renderer.finish(&Silent)?;
    println!("blue, mean {:.3?}", renderer.picture().mean());
    output::write(&renderer.picture(), Path::new("blue.png"))?;
    Ok(())
}
