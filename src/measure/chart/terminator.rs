//! Remedies for terminators: what each costs, and how far a coarse ball with smooth normals is from a fine one.

use super::effort::Effort;
use super::figure::{Figure, Join, Point};
use super::race::{Runner, race};
use crate::render::{Image, Settings, Silent, Terminator, render};
use crate::scene::{Geometry, Object, Primitive, Scene, ShaderFiles, Shape};
use glam::Vec3;
use std::f32::consts::PI;
use std::hint::black_box;
use std::sync::Arc;

/// A small lamp to the right of a ball, of which the picture shows the middle, where the light ends.
const LIT: &str = r#"<World><Camera eye="0,0.4,6" look_at="0,0,0" fov="11"/>
    <ShaderGroup>color Cs 1 1 1; shader matte l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
    <ShaderGroup is_light="yes">float power 1000; shader emitter l1;</ShaderGroup>
    <Quad corner="8,1,-0.2" edge_x="0,0,0.2" edge_y="0,0.2,0"/></World>"#;

/// A white ball in white light.
const FURNACE: &str = r#"<World><Camera eye="0,0,6" look_at="0,0,0" fov="13"/>
    <ShaderGroup>color Cs 1 1 1; shader matte l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
    <ShaderGroup>color radiance 1 1 1; shader sky l1;</ShaderGroup><Background resolution="0"/></World>"#;

/// The ball of the scenes, of `around` x `down` patches in place of a round one.
fn ball(geometry: &Geometry, around: usize, down: usize) -> Geometry {
    let mut out = Geometry::default();
    for (number, object) in geometry.objects.iter().enumerate() {
        for primitive in geometry.primitives.iter().filter(|p| p.object as usize == number) {
            let Shape::Sphere { center, radius } = primitive.shape else {
                out.primitives.push(*primitive);
                continue;
            };
            let at = |i: usize, j: usize| {
                let (theta, phi) = (PI * j as f32 / down as f32, 2.0 * PI * (i % around) as f32 / around as f32);
                let round = if j == 0 || j == down { 0.0 } else { theta.sin() };
                Vec3::new(round * phi.cos(), theta.cos(), round * phi.sin())
            };
            for (i, j) in (0..around).flat_map(|i| (0..down).map(move |j| (i, j))) {
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                for corners in [[a, c, b], [a, d, c]] {
                    let [a, b, c] = corners.map(|n| center + radius * n);
                    let shape = Shape::Triangle { a, b, c };
                    if shape.area() > 1e-8 {
                        let normals = out.normals.len() as u32;
                        out.normals.push(corners);
                        out.primitives.push(Primitive { shape, normals, ..*primitive });
                    }
                }
            }
        }
        out.objects.push(Object { ..object.clone() });
    }
    out
}

/// A scene with its ball made of patches.
fn scene(text: &str, around: usize, down: usize) -> Result<Scene, String> {
    let mut scene = Scene::load(text, &[], &ShaderFiles::default()).map_err(|e| e.to_string())?;
    scene.geometry = Arc::new(ball(&scene.geometry, around, down));
    Ok(scene)
}

fn picture(scene: &Scene, settings: &Settings) -> Result<Image, String> {
    render(scene, settings, &Silent).map_err(|e| e.to_string())
}

fn mean(image: &Image) -> f64 {
    image.pixels.iter().map(|p| f64::from(*p)).sum::<f64>() / image.pixels.len().max(1) as f64
}

/// Measures the figure.
pub(super) fn figure(effort: &Effort) -> Result<Figure, String> {
    const SIDE: u32 = 48;
    let samples = 4 * effort.steps as u32;
    let base = Settings { width: SIDE, height: SIDE, samples, threads: 1, ..Settings::default() };
    let with = |terminator| Settings { terminator, ..base.clone() };
    let truth = picture(&scene(LIT, 256, 128)?, &with(Terminator::None))?;
    let (coarse, furnace) = (scene(LIT, 16, 8)?, scene(FURNACE, 16, 8)?);
    // Enough of them that preparing the scene does not count.
    const TIMED: u32 = 16;
    let timed = |terminator| Settings { samples: TIMED, ..with(terminator) };
    let mut runners: Vec<Runner> = Vec::new();
    for (_, terminator) in Terminator::ALL {
        let (settings, coarse) = (timed(terminator), &coarse);
        runners.push(Runner::new((TIMED * SIDE * SIDE) as usize, move || {
            drop(black_box(render(coarse, &settings, &Silent)));
        }));
    }
    let costs = race(&mut runners, effort.laps);
    let mut points = Vec::new();
    for ((name, terminator), cost) in Terminator::ALL.into_iter().zip(costs) {
        let image = picture(&coarse, &with(terminator))?;
        let squares = image.pixels.iter().zip(&truth.pixels).map(|(a, b)| f64::from(a - b).powi(2));
        let error = squares.sum::<f64>() / image.pixels.len().max(1) as f64 / mean(&truth).powi(2);
        let bias = (mean(&image) / mean(&truth) - 1.0).abs();
        let lost = (1.0 - mean(&picture(&furnace, &with(terminator))?)).abs();
        for (group, error) in
            [("squared error at the terminator", error), ("bias there", bias), ("energy in a white furnace", lost)]
        {
            points.push(Point::new(group, name, cost, error));
        }
    }
    Ok(Figure {
        name: "terminator",
        title: "Facets at the terminator: cost against error".to_owned(),
        cost: "ns a camera ray to render a ball of 16 x 8 patches, one thread".to_owned(),
        error: "error".to_owned(),
        meaning: "A matte ball of 16 x 8 patches with smooth normals and a small lamp at its side. Three errors: the mean squared \
                  difference to a ball of 256 x 128 patches over the square of its mean, where the light ends; how far the \
                  mean is from its there; and how far the ball is from 1 in a white furnace when it is white. Each cost is the median of interleaved renders."
            .to_owned(),
        join: Join::Front,
        points,
    }
    .with_front())
}
