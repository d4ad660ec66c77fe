//! Whole renders of figure 1 at low resolution, shaders and files included: `cargo bench --bench render`.

use divan::Bencher;
use divan::counter::ItemsCount;
use std::path::PathBuf;
use velour::render::{Settings, Silent, World, render};
use velour::scene::{Scene, ShaderFiles};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/scenes/figure1.xml");

fn main() {
    divan::main();
}

fn figure1() -> Scene {
    let folders: Vec<PathBuf> = Vec::new();
    Scene::load(SCENE, &folders, &ShaderFiles::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn settings(threads: usize) -> Settings {
    Settings { width: 160, height: 64, samples: 16, threads, ..Settings::default() }
}

/// Paths a second, by threads.
#[divan::bench(args = [1, 2])]
fn paths(bencher: Bencher, threads: usize) {
    let scene = figure1();
    let settings = settings(threads).with_options(&scene.options);
    let paths = u64::from(settings.width) * u64::from(settings.height) * u64::from(settings.samples);
    bencher.counter(ItemsCount::new(paths)).bench(|| render(&scene, &settings, &Silent));
}

/// From the scene's file to compiled groups.
#[divan::bench]
fn load() -> Scene {
    figure1()
}

/// From compiled groups to a world that rays can be sent into.
#[divan::bench]
fn prepare(bencher: Bencher) {
    let scene = figure1();
    let settings = settings(1).with_options(&scene.options);
    bencher.bench(|| World::new(&scene, &settings).lights.is_empty());
}
