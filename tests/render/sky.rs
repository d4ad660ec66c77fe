//! The background as a light: suns that may not be missed, gradients, and what is seen of the table.

use super::materials::{middle, picture_with};
use velour::render::LightStrategy;

/// A sun of .53 degrees and radiance 1e4 over a sky of .1, toward a direction.
const SUN: &str = "surface hard_sun(vector toward = vector(0, 1, 0))
    { float c = dot(normalize(I), normalize(toward)); Ci = (c > 0.99998930 ? 1e4 : 0.1) * background(); }";

/// Its solid angle, 2 pi (1 - cos), from the cosine as the shader has it.
fn sun_angle() -> f64 {
    2.0 * std::f64::consts::PI * (1.0 - f64::from(0.999_989_3_f32))
}

fn floor_under(toward: [f64; 3], resolution: u32, change: impl FnOnce(&mut velour::render::Settings)) -> (f64, f64) {
    let [x, y, z] = toward;
    let scene = format!(
        r#"<World><Camera eye="0,5,0.001" look_at="0,0,0" fov="20"/>
        <ShaderGroup>vector toward {x} {y} {z}; shader hard_sun l1;</ShaderGroup><Background resolution="{resolution}"/>
        <ShaderGroup>color Cs 0.5 0.5 0.5; shader matte l1;</ShaderGroup>
        <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/></World>"#
    );
    let image = picture_with(&scene, &[SUN], |s| {
        s.samples = 64;
        change(s);
    });
    let mean = middle(&image);
    let squares = image.pixels.iter().map(|p| (f64::from(*p) - mean).powi(2)).sum::<f64>() / image.pixels.len() as f64;
    (mean, squares.sqrt())
}

#[test]
fn a_hard_sun_is_met_wherever_it_stands_and_leaves_little_noise() {
    for (toward, resolution) in [
        ([0.3, 1.0, 0.15], 64),
        ([0.3, 1.0, 0.15], 1024),
        ([0.0, 1.0, 0.0], 64),
        ([0.02, 0.3, 1.0], 256),
        ([-0.9, 0.5, 0.01], 64),
        ([0.5, 0.7, -0.5], 64),
    ] {
        let (mean, noise) = floor_under(toward, resolution, |_| ());
        let length = toward.iter().map(|a| a * a).sum::<f64>().sqrt();
        let exact = 0.05 + 0.5 / std::f64::consts::PI * 1e4 * sun_angle() * toward[1] / length;
        assert!((mean / exact - 1.0).abs() < 4e-3, "{toward:?}: {mean} against {exact}");
        assert!(noise < 7e-3, "{toward:?}: {noise}");
    }
}

#[test]
fn light_samples_alone_see_the_same_sun() {
    let toward = [0.3, 1.0, 0.15];
    let (mean, _) = floor_under(toward, 64, |s| s.lights = LightStrategy::LightsOnly);
    let exact = 0.05 + 0.5 / std::f64::consts::PI * 1e4 * sun_angle() / 1.1125f64.sqrt();
    assert!((mean / exact - 1.0).abs() < 1e-2, "{mean} against {exact}");
}

/// A sky that is .05 below the horizon and 1 above it, and one that grows toward +x: irradiance on a floor is pi times 1, and
/// pi times the mean over cosines, where x averages out.
#[test]
fn edges_and_gradients_light_the_floor_by_the_formula() {
    let edge = "surface edge() { Ci = (I[1] > 0 ? 1.0 : 0.05) * background(); }";
    let slope = "surface slope() { Ci = (1 + 0.8 * I[0]) * background(); }";
    for (name, shader) in [("edge", edge), ("slope", slope)] {
        let scene = format!(
            r#"<World><Camera eye="0,5,0.001" look_at="0,0,0" fov="20"/>
            <ShaderGroup>shader {name} l1;</ShaderGroup><Background resolution="64"/>
            <ShaderGroup>color Cs 0.5 0.5 0.5; shader matte l1;</ShaderGroup>
            <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/></World>"#
        );
        for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
            let mean = middle(&picture_with(&scene, &[shader], |s| (s.samples, s.lights) = (64, lights)));
            assert!((mean / 0.5 - 1.0).abs() < 2e-3, "{name}, {lights:?}: {mean}");
        }
    }
}
