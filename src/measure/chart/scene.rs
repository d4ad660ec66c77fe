//! A scene at equal time: how far the image of each setting is from a converged one, and after how many seconds.

use super::figure::{Figure, Join, Point};
use super::race::{Cost, summary};
use super::table::short;
use crate::closure::{Layering, settings::SheenSampling};
use crate::render::{Image, LightStrategy, Settings, Silent, render};
use crate::scene::Scene;
use std::sync::Arc;
use std::time::Instant;

/// How much of a scene is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples a pixel of the converged images.
    pub reference: u32,
    /// Samples a pixel of the most exact image of every setting; each before it has a quarter.
    pub most: u32,
    /// How many images a setting has.
    pub images: u32,
    /// How many times each is rendered, with seeds of their own.
    pub repeats: u32,
}

impl Budget {
    /// Next to nothing, for tests.
    pub fn tiny() -> Self {
        Budget { size: [20, 8], reference: 64, most: 4, images: 2, repeats: 1 }
    }

    /// Half a minute.
    pub fn quick() -> Self {
        Budget { size: [120, 48], reference: 2048, most: 32, images: 3, repeats: 3 }
    }

    /// Some minutes.
    pub fn full() -> Self {
        Budget { size: [160, 64], reference: 4096, most: 128, images: 4, repeats: 5 }
    }
}

/// A setting with its name, the group it competes in, and what it changes.
type Variant = (&'static str, &'static str, fn(&mut Settings));

const EXACT: &str = "exact layering";

const VARIANTS: [Variant; 13] = [
    (EXACT, "defaults", |_| ()),
    (EXACT, "uniform sheen, no light samples", |s| {
        s.lights = LightStrategy::ScatteringOnly;
        s.closure.sheen_sampling = SheenSampling::Uniform;
    }),
    (EXACT, "ltc sheen, no light samples", |s| s.lights = LightStrategy::ScatteringOnly),
    (EXACT, "light samples only", |s| s.lights = LightStrategy::LightsOnly),
    (EXACT, "uniform sheen", |s| s.closure.sheen_sampling = SheenSampling::Uniform),
    (EXACT, "cosine sheen", |s| s.closure.sheen_sampling = SheenSampling::Cosine),
    (EXACT, "half-vector sheen", |s| s.closure.sheen_sampling = SheenSampling::Normals),
    (EXACT, "roulette from bounce 1", |s| s.rr_depth = 1),
    (EXACT, "batches of 8 lanes", |s| s.batch_width = 8),
    (EXACT, "waves of 256 paths", |s| s.wave_size = 256),
    ("view layering", "layering: view", |s| s.closure.layering = Layering::View),
    ("kelemen layering", "layering: kelemen", |s| s.closure.layering = Layering::Kelemen),
    ("lossless layering", "layering: lossless", |s| s.closure.layering = Layering::Lossless),
];

/// The seed of the converged images, which no other image has.
const REFERENCE_SEED: u32 = 77_777;

/// Measures all settings on a scene; tells how many of how many are done.
///
/// Source: the mean squared error over pixels and channels against the converged image of the same layering rule, made with
/// another seed. `Err` when the scene cannot be rendered.
pub fn scene_figure(scene: &Scene, budget: &Budget, progress: &dyn Fn(usize, usize)) -> Result<Figure, String> {
    let base = Settings::default().with_options(&scene.options);
    let base = Settings { width: budget.size[0], height: budget.size[1], ..base };
    let settings = VARIANTS.map(|(_, _, change)| {
        let mut settings = base.clone();
        change(&mut settings);
        settings
    });
    let total = (budget.images * budget.repeats) as usize + 3;
    let references = references(scene, &settings, budget, &|done| progress(done, total))?;
    let mut points: Vec<Vec<Point>> = vec![Vec::new(); VARIANTS.len()];
    for image in 0..budget.images {
        let samples = (budget.most >> (2 * (budget.images - 1 - image))).max(1);
        let mut seen = vec![(0.0, Vec::new()); VARIANTS.len()];
        // The settings take turns, so that a slow moment of the machine strikes all of them.
        for repeat in 0..budget.repeats {
            progress((image * budget.repeats + repeat) as usize + 3, total);
            for ((settings, reference), (error, times)) in settings.iter().zip(&references).zip(&mut seen) {
                let settings = Settings { samples, seed: repeat, ..settings.clone() };
                let start = Instant::now();
                let made = render(scene, &settings, &Silent).map_err(|e| e.to_string())?;
                times.push(start.elapsed().as_secs_f64());
                *error += difference(&made, reference) / f64::from(budget.repeats);
            }
        }
        for (((_, name, _), (error, times)), points) in VARIANTS.iter().zip(seen).zip(&mut points) {
            // The fastest: others that use the machine can only slow a render down.
            let fastest = times.iter().copied().fold(f64::INFINITY, f64::min);
            let cost = Cost { median: fastest, ..summary(times) };
            let last = image + 1 == budget.images;
            let label = if last { label(name, error * cost.median) } else { String::new() };
            // A line is a setting, so the group that gives it its color is the setting.
            points.push(Point::new(name, &label, cost, error));
        }
    }
    let points: Vec<Point> = points.into_iter().flatten().collect();
    progress(total, total);
    Ok(Figure {
        name: "scene",
        title: format!("{}: error of the image against time", scene.name),
        cost: "seconds to render; at the right: 1 / (error x seconds)".to_owned(),
        error: "mean squared error of the image".to_owned(),
        meaning: format!(
            "Error: the mean squared error over pixels and channels ({} x {}) against an image of {} samples a pixel, another \
             seed and the same layering rule. One line a setting; the defaults are `ltc` sheen, light and scattering \
             samples combined, roulette from bounce 5, batches of {} lanes. Seconds are the fastest of {} \
             renders. The number after a name is the \
             efficiency 1 / (error x seconds) of the last image of its line.\n\n{}",
            base.width,
            base.height,
            budget.reference,
            base.batch_width,
            budget.repeats,
            equal_time(&points)
        ),
        join: Join::Lines,
        points,
    })
}

/// The converged image that belongs to each setting; settings of one group share it.
fn references(
    scene: &Scene,
    settings: &[Settings],
    budget: &Budget,
    progress: &dyn Fn(usize),
) -> Result<Vec<Arc<Image>>, String> {
    let mut made: Vec<(&str, Arc<Image>)> = Vec::new();
    let mut out = Vec::new();
    for (settings, (group, _, _)) in settings.iter().zip(&VARIANTS) {
        if !made.iter().any(|(g, _)| g == group) {
            progress(made.len());
            let converged = Settings { samples: budget.reference, seed: REFERENCE_SEED, ..settings.clone() };
            made.push((group, Arc::new(render(scene, &converged, &Silent).map_err(|e| e.to_string())?)));
        }
        out.extend(made.iter().find(|(g, _)| g == group).map(|(_, image)| Arc::clone(image)));
    }
    Ok(out)
}

/// Mean squared difference over pixels and channels.
fn difference(a: &Image, b: &Image) -> f64 {
    let squares = a.pixels.iter().zip(&b.pixels).map(|(x, y)| f64::from(x - y).powi(2));
    squares.sum::<f64>() / a.pixels.len().max(1) as f64
}

/// The name of a setting with its efficiency, which an image without error has not.
fn label(name: &str, error_seconds: f64) -> String {
    if error_seconds > 0.0 { format!("{name}: {}", short(1.0 / error_seconds)) } else { name.to_owned() }
}

/// The error of the defaults over that of uniform sampling without light samples, at equal time; empty when either is 0,
/// as for an image that is black.
///
/// The errors of a line fall as one over time, so the product of both compares settings at any time.
fn equal_time(points: &[Point]) -> String {
    let product = |name: &str| points.iter().rfind(|p| p.group == name).map(|p| p.cost * p.error);
    match (product("defaults"), product("uniform sheen, no light samples")) {
        (Some(ours), Some(plain)) if ours > 0.0 && plain > 0.0 => {
            format!(
                "At equal time the defaults have {} times the error of uniform sampling without light samples.",
                short(ours / plain)
            )
        }
        _ => String::new(),
    }
}
