//! Materials for the render tests: the one place that knows how a group comes to be.

use glam::Vec3;
use std::path::PathBuf;
use velour::exec::{Emission, Group};
use velour::render::{Image, Settings, Silent, render};
use velour::scene::{GroupCompiler, GroupSpec, Scene, SceneError, Values};

/// Compiles a few named shaders without a compiler.
pub struct Materials;

impl GroupCompiler for Materials {
    fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
        let layer = spec.layers.last().expect("a group has a layer");
        let numbers = |name: &str, default: &[f32]| -> Vec<f32> {
            let find = |p: &velour::scene::ParamValue| match &p.values {
                Values::Floats(v) if p.name == name => Some(v.clone()),
                _ => None,
            };
            layer.params.iter().find_map(find).unwrap_or(default.to_vec())
        };
        let color = |name: &str, default: f32| Vec3::from_slice(&numbers(name, &[default; 3]));
        let number = |name: &str, default: f32| numbers(name, &[default])[0];
        let dark = Group { albedo: Vec3::ZERO, through: 0.0, emission: Emission::None };
        Ok(match layer.shader.as_str() {
            "matte" | "cloth" => Group { albedo: color("Cs", 0.5), through: number("through", 0.0), ..dark },
            "emitter" => Group { emission: Emission::Power(number("power", 1.0)), ..dark },
            "glow" => Group { albedo: color("Cs", 0.0), emission: Emission::Uniform(color("c", 1.0)), ..dark },
            "ramp" => Group { emission: Emission::Ramp, ..dark },
            "sky" => Group { emission: Emission::Uniform(color("c", 0.3)), ..dark },
            "sun" => Group {
                emission: Emission::Sky {
                    base: number("base", 0.1),
                    gain: 20.0,
                    sharpness: number("sharpness", 100.0),
                },
                ..dark
            },
            "nan" => Group { albedo: color("Cs", 0.5), emission: Emission::NotANumber, ..dark },
            name => {
                let message = format!("shader `{name}` is not found");
                return Err(SceneError::at(layer.place.clone(), message));
            }
        })
    }
}

/// Loads a scene given as text.
pub fn scene(xml: &str) -> Scene {
    let folders: Vec<PathBuf> = Vec::new();
    Scene::load(xml, &folders, &Materials).unwrap_or_else(|e| panic!("{e}"))
}

/// Renders a scene given as text.
pub fn picture(xml: &str, change: impl FnOnce(&mut Settings)) -> Image {
    let scene = scene(xml);
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
