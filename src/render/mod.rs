//! Renders scenes: a wavefront path tracer over tiles.
//!
//! [`render`] prepares a [`world::World`] (hierarchy, lights, background, plan), then threads take tile after tile. Each
//! has one `Wave` of scratch, in which the tile's paths advance together: intersect, sort by material, shade in
//! batches, trace shadows, scatter. Shaders and closures are met in one file, `shading`.
//!
//! An image depends on scene, seed and sample count. It does not depend on thread count, batch width, wave size, tile
//! size or tile order: a path draws its numbers by pixel, sample and bounce, adds up its own light in order, and a
//! pixel adds up its samples in order.

pub mod accel;
mod bounce;
mod camera;
mod few;
mod host;
mod image;
pub mod light;
pub mod output;
mod plan;
mod progress;
pub mod random;
mod settings;
mod shading;
mod shadow;
mod sky;
mod surface;
mod tile;
mod wave;
mod world;

pub use image::{About, Image};
pub use plan::Plan;
pub use progress::{Progress, Silent};
pub use settings::{LightStrategy, Settings};
pub use world::World;

use crate::exec::Report;
use crate::scene::Scene;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;
use tile::Tile;
use wave::{Dropped, Wave};

/// What the threads put together.
struct Shared {
    pixels: Vec<f32>,
    dropped: Dropped,
    rays: u64,
    reports: Vec<Report>,
}

/// Renders `scene`; tells `progress` of every finished tile.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Image, String> {
    settings.check()?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .map_err(|e| format!("the threads could not be started: {e}"))?;
    let start = Instant::now();
    let world = pool.install(|| World::new(scene, settings));
    let seconds_preparing = start.elapsed().as_secs_f64();
    let channels = if settings.alpha { 4 } else { 3 };
    let pixels = vec![0.0; settings.width as usize * settings.height as usize * channels];
    let shared = Mutex::new(Shared { pixels, dropped: Dropped::default(), rays: 0, reports: Vec::new() });
    let (next, done, total) = (AtomicUsize::new(0), AtomicUsize::new(0), Tile::count(settings));
    let failed = AtomicBool::new(world.reports.iter().any(|report| matches!(report, Report::Fatal(_))));
    let start = Instant::now();
    pool.broadcast(|_| {
        let mut wave = Wave::new(&world);
        let mut sums = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= total || progress.cancelled() || failed.load(Ordering::Relaxed) {
                break;
            }
            let tile = Tile::number(settings, number);
            tile.render(&world, &mut wave, &mut sums);
            failed.fetch_or(wave.shading.failed(), Ordering::Relaxed);
            if let Ok(mut shared) = shared.lock() {
                store(&mut shared.pixels, &tile, settings, channels, &sums);
            }
            progress.tiles(done.fetch_add(1, Ordering::Relaxed) + 1, total);
        }
        if let Ok(mut shared) = shared.lock() {
            shared.dropped.merge(&wave.dropped);
            shared.rays += wave.rays;
            shared.reports.extend(wave.shading.take_reports());
        }
    });
    let seconds_tracing = start.elapsed().as_secs_f64();
    let mut shared = shared.into_inner().map_err(|_| "a thread has failed".to_owned())?;
    shared.reports.extend(world.reports.iter().cloned());
    if let Some(Report::Fatal(message)) = shared.reports.iter().find(|report| matches!(report, Report::Fatal(_))) {
        return Err(message.clone());
    }
    let about = About {
        scene: scene.name.clone(),
        samples: settings.samples,
        seed: settings.seed,
        paths: u64::from(settings.width) * u64::from(settings.height) * u64::from(settings.samples),
        rays: shared.rays,
        seconds_preparing,
        seconds_tracing,
        reports: reports(scene, shared.reports, &shared.dropped),
    };
    Ok(Image { width: settings.width, height: settings.height, channels, pixels: shared.pixels, about })
}

/// Writes a tile's means into the image.
fn store(pixels: &mut [f32], tile: &Tile, settings: &Settings, channels: usize, sums: &[[f64; 4]]) {
    let scale = 1.0 / f64::from(settings.samples);
    for (i, sum) in sums.iter().enumerate() {
        let (x, y) = (tile.x + i as u32 % tile.width, tile.y + i as u32 / tile.width);
        let start = (y as usize * settings.width as usize + x as usize) * channels;
        (0..channels).for_each(|c| pixels[start + c] = (sum[c] * scale) as f32);
    }
}

/// Each report once, in an order that does not depend on threads.
///
/// Differs from OSL: what shaders print while rendering comes out sorted and each text once, since lanes, tiles and
/// threads have no order of their own. `velour tree` prints as written.
fn reports(scene: &Scene, mut reports: Vec<Report>, dropped: &Dropped) -> Vec<Report> {
    reports.sort_by_key(|report| format!("{report:?}"));
    reports.dedup();
    if dropped.count > 0 {
        let material = dropped.material.checked_sub(1).and_then(|m| scene.materials.get(m));
        let (place, name) = material.map_or((String::new(), "?"), |m| (format!("{}: ", m.place), m.name.as_str()));
        reports.push(Report::Error(format!(
            "{place}error: shader group `{name}` gave light that is not a finite number; {} contributions were dropped",
            dropped.count
        )));
    }
    reports
}
