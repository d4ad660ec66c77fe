//! Renders scenes: a wavefront path tracer over tiles.
//!
//! [`render`] prepares a [`world::World`] (hierarchy, lights, background, plan), then threads take tile after tile. Each
//! has one `Wave` of scratch, in which the tile's paths advance together: intersect, sort by material, shade in
//! batches, trace shadows, scatter. Shaders and closures are met in one file, `shading`.
//!
//! Where the time goes (perf, figure 1, one thread): ray tests 15 %, choosing points of lights and weighing them 11 %,
//! random numbers 7 %, camera rays 4 %, sorting 4 %, the film 4 %, scattering's bookkeeping 4 %; shaders and closures are
//! some 30 %, spread thin. There is no hot spot left.
//!
//! Decision (2026-11-22): what is done for every lane (random numbers, camera rays, positions and normals of hits, points
//! of lights, their weights) is done for a block of sixteen lanes by loops that become SIMD, instead of path by path,
//! because path by path it was two thirds of the time: with the early way out for spheres that a whole block misses,
//! figure 1 went from 2.8 to 4.4 million camera samples a second on one thread of a 2-core AMD EPYC with AVX2
//! (`velour render shaders/scenes/figure1.xml -o x.exr --res 640 256 --spp 64 -t 1`).
//!
//! Decision (2026-11-22): a wave has 8192 paths, because the batches of late bounces are fuller then: user seconds for 5.2
//! million samples of figure 1, best of three, 2.02, 1.75, 1.63, 1.57 with 1024, 2048, 4096, 8192.
//!
//! An image depends on scene, seed and sample count. It does not depend on thread count, batch width, wave size or tile
//! order: a path draws its numbers by pixel, sample and bounce, adds up its own light in order, and a pixel adds up its
//! samples in order. The size of a tile shows as good as never, see `film`. A render that stops at a noise depends on
//! the tile size as well, one that stops at a time on the machine.

pub mod accel;
mod block;
mod bounce;
mod camera;
mod explain;
mod few;
mod film;
mod host;
mod image;
mod lanes;
pub mod light;
pub mod output;
mod plan;
mod progress;
pub mod random;
mod rounds;
mod settings;
mod shading;
mod shadow;
mod sky;
mod surface;
mod tile;
mod wave;
mod world;

pub use explain::{Explanation, MaterialNeeds, Saving};
pub use image::{About, Image};
pub use plan::Plan;
pub use progress::{Progress, Silent};
pub use settings::{LightStrategy, Settings};
pub use world::World;

use crate::exec::{Report, ReportPlace};
use crate::scene::Scene;
use film::{Film, Sums};
use rounds::{Rounds, Task};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;
use tile::Tile;
use wave::{Dropped, Wave};

/// What the threads put together.
struct Shared {
    film: Film,
    rounds: Rounds,
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
    let shared = Mutex::new(Shared {
        film: Film::new(settings),
        rounds: Rounds::new(settings, start),
        dropped: Dropped::default(),
        rays: 0,
        reports: world.reports.clone(),
    });
    let failed = AtomicBool::new(world.reports.iter().any(|report| report.is_fatal()));
    let start = Instant::now();
    trace(&world, &pool, &shared, &failed, progress)?;
    let shared = shared.into_inner().map_err(|_| "a thread has failed".to_owned())?;
    let about = about(&world, shared.rounds, shared.rays, [seconds_preparing, start.elapsed().as_secs_f64()]);
    if let Some(fatal) = shared.reports.iter().find(|report| report.is_fatal()) {
        return Err(fatal.to_string());
    }
    let about = About { reports: reports(scene, shared.reports, &shared.dropped), ..about };
    let channels = if settings.alpha { 4 } else { 3 };
    let pixels = shared.film.picture(settings, 0..settings.halves(), channels);
    Ok(Image { width: settings.width, height: settings.height, channels, pixels, about })
}

/// Runs round after round; within one, each thread takes the next tile until none is left.
fn trace(
    world: &World,
    pool: &rayon::ThreadPool,
    shared: &Mutex<Shared>,
    failed: &AtomicBool,
    progress: &dyn Progress,
) -> Result<(), String> {
    let settings = world.settings;
    let scratch: Vec<Mutex<Option<(Wave, Sums)>>> = (0..pool.current_num_threads()).map(|_| Mutex::new(None)).collect();
    let stop = || progress.cancelled() || failed.load(Ordering::Relaxed);
    let lost = || "a thread has failed".to_owned();
    while !stop() {
        let tasks = {
            let Shared { film, rounds, .. } = &mut *shared.lock().map_err(|_| lost())?;
            rounds.next(settings, film)
        };
        if tasks.is_empty() {
            break;
        }
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        pool.broadcast(|thread| {
            let Ok(mut scratch) = scratch[thread.index()].lock() else { return };
            let (wave, sums) = scratch.get_or_insert_with(|| (Wave::new(world), Sums::default()));
            while let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| !stop()) {
                let tile = Tile::number(settings, task.tile);
                tile.render(world, wave, task.first..task.end, sums);
                failed.fetch_or(wave.shading.failed(), Ordering::Relaxed);
                let Ok(mut shared) = shared.lock() else { return };
                keep(&mut shared, world, task, &tile, wave, sums);
                if shared.rounds.late() {
                    next.store(tasks.len(), Ordering::Relaxed);
                }
                drop(shared);
                progress.tiles(done.fetch_add(1, Ordering::Relaxed) + 1, tasks.len());
            }
        });
    }
    Ok(())
}

/// Adds what a thread has found out of one tile to what all have.
fn keep(shared: &mut Shared, world: &World, task: &Task, tile: &Tile, wave: &mut Wave, sums: &Sums) {
    shared.film.add(task.tile, tile, sums, world.settings.halves(), task.first..task.end);
    shared.rounds.done(task);
    shared.dropped.merge(&std::mem::take(&mut wave.dropped));
    shared.rays += std::mem::take(&mut wave.rays);
    shared.reports.extend(wave.shading.take_reports());
}

/// What is known of a render but its reports.
fn about(world: &World, rounds: Rounds, rays: u64, [seconds_preparing, seconds_tracing]: [f64; 2]) -> About {
    let settings = world.settings;
    let pixels = |number: usize| {
        let tile = Tile::number(settings, number);
        u64::from(tile.width) * u64::from(tile.height)
    };
    let taken = rounds.taken();
    About {
        scene: world.scene.name.clone(),
        samples: settings.samples,
        taken: [taken.iter().copied().min().unwrap_or(0), taken.iter().copied().max().unwrap_or(0)],
        noise: rounds.noise().filter(|_| settings.adapts()),
        seed: settings.seed,
        paths: taken.iter().enumerate().map(|(number, n)| pixels(number) * u64::from(*n)).sum(),
        rays,
        seconds_preparing,
        seconds_tracing,
        reports: Vec::new(),
    }
}

/// Each report once, in an order that does not depend on threads.
///
/// Differs from OSL: what shaders print while rendering comes out sorted and each text once, since lanes, tiles and
/// threads have no order of their own. `velour tree` prints as written.
fn reports(scene: &Scene, mut reports: Vec<Report>, dropped: &Dropped) -> Vec<Report> {
    reports.sort_by_key(Report::key);
    reports.dedup_by_key(|report| report.key());
    if dropped.count > 0 {
        let material = dropped.material.checked_sub(1).and_then(|m| scene.materials.get(m));
        let (file, name) = material.map_or((String::new(), "?"), |m| (m.place.to_string(), m.name.as_str()));
        let what = "gave light that is not a finite number";
        let text = format!("shader group `{name}` {what}; {} contributions were dropped", dropped.count);
        reports.push(Report::mistake(ReportPlace { file, ..ReportPlace::default() }, text));
    }
    reports
}
