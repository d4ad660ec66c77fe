//! Shaders for the render tests, as texts, and how a scene of them becomes a picture.

use std::path::PathBuf;
use velour::render::{Image, Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

/// The shaders that scenes of the tests name, all in memory.
const SHADERS: [&str; 8] = [
    "surface matte(color Cs = 0.5, float through = 0) { Ci = Cs * diffuse(N) + through * transparent(); }",
    "surface cloth(color base = color(0.6, 0.05, 0.05), color tint = 1, float rough = 0.4)
     { Ci = sheen(base * diffuse(N), N, tint, rough); }",
    "surface emitter(float power = 1) { Ci = (power / (M_PI * surfacearea())) * emission(); }",
    "surface glow(color c = 1, color Cs = 0) { Ci = c * emission() + Cs * diffuse(N); }",
    "surface ramp() { Ci = 2 * u * emission(); }",
    "surface sky(color c = 0.3) { Ci = c * background(); }",
    "surface sun(float base = 0.1, float sharpness = 100)
     { Ci = (base + 20 * pow(max(I[1], 0.0), sharpness)) * background(); }",
    // What u multiplies overflows for every u, so the difference of two infinities is computed at each point.
    "surface nan(color Cs = 0.5, float huge = 1e38)
     { float infinite = huge * (1e10 + u); Ci = (infinite - infinite) * emission() + Cs * diffuse(N); }",
];

/// The compiler of the tests: the shaders above, and those of `more`.
pub fn materials(more: &[&str]) -> ShaderFiles {
    let add = |files: ShaderFiles, text: &&str| files.with_shader(text).unwrap_or_else(|e| panic!("{e}"));
    SHADERS.iter().chain(more).fold(ShaderFiles::default(), add)
}

/// Loads a scene given as text or as a file.
pub fn scene(xml: &str) -> Scene {
    scene_with(xml, &[])
}

/// The same, with more shaders.
pub fn scene_with(xml: &str, shaders: &[&str]) -> Scene {
    let folders: Vec<PathBuf> = Vec::new();
    Scene::load(xml, &folders, &materials(shaders)).unwrap_or_else(|e| panic!("{e}"))
}

/// Renders a scene of the shaders above.
pub fn picture(xml: &str, change: impl FnOnce(&mut Settings)) -> Image {
    picture_with(xml, &[], change)
}

/// Renders a scene of the shaders above and of `shaders`.
pub fn picture_with(xml: &str, shaders: &[&str], change: impl FnOnce(&mut Settings)) -> Image {
    let scene = scene_with(xml, shaders);
    let mut settings = Settings { width: 64, height: 64, samples: 16, threads: 2, ..Settings::default() };
    settings = settings.with_options(&scene.options);
    change(&mut settings);
    render(&scene, &settings, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

/// The mean of the middle quarter of the picture's first channel.
pub fn middle(image: &Image) -> f64 {
    let (w, h) = (image.width, image.height);
    let (mut sum, mut count) = (0.0, 0.0);
    for y in h / 4..h - h / 4 {
        for x in w / 4..w - w / 4 {
            sum += f64::from(image.pixel(x, y)[0]);
            count += 1.0;
        }
    }
    sum / count
}
