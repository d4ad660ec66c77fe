//! The loop: which stage follows which, bounce after bounce, and how the samples of a tile become sums.

use super::exact::SETTLE;
use super::film::TileSums;
use super::path::Path;
use super::stages::{background::background, camera, globals::show_globals, intersect::intersect};
use super::stages::{light::sample_light, scatter::scatter, shade::shade, shadow::trace_shadows, sort::sort};
use super::tile::Tile;
use super::wave::Wave;
use super::world::World;
use std::ops::Range;

/// Follows all paths of the wave to their end; false when `stop` has said so before.
fn trace(world: &World, wave: &mut Wave, stop: &dyn Fn() -> bool) -> bool {
    let mut bounce = 0;
    while !wave.active.is_empty() {
        if stop() {
            return false;
        }
        intersect(world, wave);
        if world.settings.alpha {
            leave_background_out(wave);
        }
        background(world, wave);
        sort(world, wave, bounce);
        for batch in 0..wave.sorted.batches.len() {
            if stop() {
                return false;
            }
            wave.take(batch, bounce);
            if world.settings.show_globals != 0 {
                show_globals(world, wave);
                continue;
            }
            shade(world, wave);
            // Paths that passed clear surfaces each have a count of their own.
            let counted = bounce < world.settings.max_bounces || world.plan.clear;
            if counted && world.plan.materials[wave.lanes.material].scatters {
                wave.lanes.gather(&wave.paths);
                wave.lanes.stop(&wave.crossings, world.settings.max_bounces);
                sample_light(world, wave);
                scatter(world, wave);
            }
        }
        trace_shadows(world, wave);
        // What a shader has left in the middle is worth nothing.
        if wave.shading.given_up() {
            return false;
        }
        wave.advance();
        bounce += 1;
    }
    true
}

/// With an alpha channel, the background behind nothing but clear surfaces is left to whatever the picture is laid over.
fn leave_background_out(wave: &mut Wave) {
    let Wave { paths, missed, .. } = wave;
    missed.retain(|&i| !paths[i as usize].clear);
}

/// Adds `samples` of each of the tile's pixels to `sums`, and gives one behind the last that was added: less than was asked for when
/// `stop` has said so, in the middle of anything, or `pause`, after a wave at the least.
///
/// Where the film has two halves, new samples go to the second; at each power of two all there is moves to the first, so that both
/// are evenly spread.
pub fn render_tile(
    world: &World,
    wave: &mut Wave,
    tile: &Tile,
    samples: Range<u32>,
    sums: &mut TileSums,
    [stop, pause]: [&dyn Fn() -> bool; 2],
) -> u32 {
    let halves = world.settings.halves();
    sums.open(tile, halves);
    wave.shading.go_on();
    let mut first = samples.start;
    while first < samples.end {
        let power = first.checked_add(1).and_then(u32::checked_next_power_of_two).unwrap_or(u32::MAX);
        let end = if halves > 1 { samples.end.min(power) } else { samples.end };
        let done = render_samples(world, wave, tile, first..end, sums, [stop, pause]);
        if done < end || pause() {
            return done;
        }
        first = end;
    }
    first
}

/// Adds `samples`, no power of two within them but the first, and gives one behind the last that was added.
///
/// Whole pixels are traced at a time when few samples make a wave, else as many samples of all pixels as fill it. What is begun when
/// `stop` says so is left out, for a sample that some pixels have and others do not could not be gone on from.
fn render_samples(
    world: &World,
    wave: &mut Wave,
    tile: &Tile,
    samples: Range<u32>,
    sums: &mut TileSums,
    [stop, pause]: [&dyn Fn() -> bool; 2],
) -> u32 {
    let wave_size = world.settings.wave_size.max(1) as u32;
    let count = tile.pixels();
    // Sums have room for so many before they are settled.
    let per_pixel = (wave_size / count).clamp(1, SETTLE.min(samples.len().max(1) as u32));
    let pixels_at_once = (wave_size / per_pixel).clamp(1, count);
    let half = world.settings.halves() - 1;
    let mut joins = half > 0 && samples.start.is_power_of_two();
    for first_sample in samples.clone().step_by(per_pixel as usize) {
        if first_sample > samples.start && pause() {
            return first_sample;
        }
        let range = first_sample..samples.end.min(first_sample.saturating_add(per_pixel));
        let before = (pixels_at_once < count).then(|| sums.clone());
        for first in (0..count).step_by(pixels_at_once as usize) {
            let end = count.min(first + pixels_at_once);
            wave.clear();
            for pixel in first..end {
                camera::start(world, wave, tile.x + pixel % tile.width, tile.y + pixel / tile.width, range.clone());
            }
            if !trace(world, wave, stop) {
                if let Some(before) = before {
                    *sums = before;
                }
                return first_sample;
            }
            // Not before there is something to come in its place, or the second half would be empty.
            if std::mem::take(&mut joins) {
                sums.join();
            }
            for sample in range.clone() {
                let (mut x, mut y) = (first % tile.width, first / tile.width);
                let paths = (sample - range.start) as usize..wave.paths.len();
                for path in paths.step_by(range.len()) {
                    let Path { radiance, alpha, .. } = wave.paths[path];
                    sums.add(half, [x, y], wave.positions[path], radiance.to_array(), alpha);
                    (x, y) = if x + 1 < tile.width { (x + 1, y) } else { (0, y + 1) };
                }
            }
        }
        range.for_each(|_| sums.count(half));
    }
    samples.end
}
