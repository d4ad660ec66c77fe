//! The pictures of the README: scenes that are in the binary, and shaders on the ball and the cloth of `velour render my.osl`.
//!
//! `cargo run --release --example gallery -- FOLDER 400` renders them as they are stored; without numbers they are sketches.

#[path = "shared/jpeg.rs"]
mod jpeg;

use jpeg::jpeg;
use std::path::{Path, PathBuf};
use velour::render::{Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

/// Scenes of the binary, and the sizes of their pictures.
const SCENES: [(&str, [u32; 2]); 7] = [
    ("still", [960, 480]),
    ("figure1", [640, 256]),
    ("curtain", [400, 300]),
    ("million", [400, 300]),
    ("models", [640, 320]),
    ("lamps", [400, 300]),
    ("layers", [400, 300]),
];

/// Shaders of their own for the ball and the cloth; `weave` and `cloth` are in the binary.
const SHADERS: [(&str, &str); 9] = [
    ("cloth", ""),
    ("weave", ""),
    (
        "satin",
        "surface satin(color c = color(0.30, 0.015, 0.05)) {
            vector along = normalize(dPdu);
            Ci = c * diffuse(N) + 0.25 * color(1, 0.75, 0.8) * ward(N, along, 0.12, 0.4);
            Ci = sheen(Ci, N, color(0.9, 0.6, 0.65), 0.35);
        }",
    ),
    (
        "velvet_black",
        "surface velvet_black() { Ci = sheen(color(0.004) * diffuse(N), N, color(0.75, 0.72, 0.9), 0.22); }",
    ),
    (
        "gold",
        "surface gold() {
            Ci = conductor_bsdf(N, normalize(dPdu), 0.22, 0.07, color(0.18, 0.42, 1.37), color(3.42, 2.35, 1.77), \"ggx\");
        }",
    ),
    (
        "glass",
        "surface glass() { Ci = dielectric_bsdf(N, normalize(dPdu), color(1), color(0.93, 0.98, 0.96), 0.02, 0.02, 1.5, \"ggx\"); }",
    ),
    (
        "lacquer",
        "surface lacquer() {
            float wave = noise(\"perlin\", P * 1.3 + 2 * noise(\"perlin\", P * 2.1));
            color base = mix(color(0.02, 0.13, 0.11), color(0.5, 0.36, 0.1), smoothstep(0.05, 0.35, wave));
            Ci = base * oren_nayar(N, 0.3);
            Ci = layer(dielectric_bsdf(N, normalize(dPdu), color(1), color(0), 0.06, 0.06, 1.5, \"ggx\"), Ci);
        }",
    ),
    (
        "denim",
        "surface denim(float scale = 90) {
            float s = u * scale, t = v * scale;
            int warp = mod(floor(s) + floor(t), 3) < 2;
            float thread = warp ? sin(M_PI * (s - floor(s))) : sin(M_PI * (t - floor(t)));
            float worn = 0.7 + 0.5 * noise(\"perlin\", P * 3) + 0.3 * noise(\"perlin\", P * 17);
            color c = warp ? color(0.05, 0.1, 0.26) * worn : color(0.5, 0.5, 0.46);
            Ci = sheen(c * (0.45 + 0.55 * thread) * oren_nayar(N, 0.5), N, color(0.5), 0.5);
        }",
    ),
    (
        "sheet_of_pearl",
        "surface sheet_of_pearl() {
            float facing = abs(dot(N, I)) / length(I);
            color tint = 0.6 + 0.4 * cos(6 * facing + vector(0, 2.1, 4.2) + 3 * (vector)noise(\"perlin\", P));
            Ci = 0.35 * diffuse(N) + layer(microfacet(\"ggx\", N, 0.18, 1.6, 0), 0.4 * (color)tint * diffuse(N));
        }",
    ),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = PathBuf::from(arguments.first().map_or("gallery", String::as_str));
    let samples: Option<u32> = arguments.get(1).map(|text| text.parse()).transpose()?;
    std::fs::create_dir_all(&folder)?;
    let mut shaders = ShaderFiles::default();
    for (_, text) in SHADERS.iter().filter(|(_, text)| !text.is_empty()) {
        shaders = shaders.with_shader(text)?;
    }
    for (name, size) in SCENES {
        let scene = Scene::load(name, &[], &shaders)?;
        picture(&scene, name, size, samples, &folder)?;
    }
    for (name, _) in SHADERS {
        let scene = Scene::of_shader(Path::new(name), &[], &shaders)?;
        picture(&scene, name, [400, 300], samples, &folder)?;
    }
    Ok(())
}

/// Renders a picture and stores it; a sketch has few samples of few pixels.
fn picture(
    scene: &Scene,
    name: &str,
    [width, height]: [u32; 2],
    samples: Option<u32>,
    folder: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let scale = if samples.is_some() { 1 } else { 8 };
    let settings =
        Settings { width: width / scale, height: height / scale, samples: samples.unwrap_or(1), ..Settings::default() };
    let image = render(scene, &settings, &Silent)?;
    let path = folder.join(format!("{name}.jpg"));
    std::fs::write(&path, jpeg(&image, 90)?)?;
    println!("{}", path.display());
    Ok(())
}
