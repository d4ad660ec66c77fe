//! Parts of a picture merge into the picture, bit for bit, whoever made them and in whatever order.

use super::materials::scene_with;
use super::speed::FIGURE1;
use velour::render::part::{self, Part, PartError};
use velour::render::{Progress, Renderer, Settings, Silent};
use velour::scene::Scene;

/// A scene with a sun, starlight and light that is taken away: sums of all sizes and of both signs.
const SIZES: &str = "surface sizes(float x = 1) {
    float bright = noise(P * 9);
    Ci = (bright > .7 ? 3e9 * bright : bright > .5 ? 1e-9 * bright : bright > .4 ? -.2 : bright) * emission();
}";

fn settings(first_sample: u32, samples: u32) -> Settings {
    Settings { width: 80, height: 32, first_sample, samples, ..Settings::default() }
}

/// Figure 1 with other cloth, where a shader is given for it.
fn figure(shaders: &[&str]) -> Scene {
    let sizes = FIGURE1.replace("shader cloth l1", "shader sizes l1").replace("float rough", "float x");
    scene_with(if shaders.is_empty() { FIGURE1 } else { &sizes }, shaders)
}

fn render(scene: &Scene, settings: &Settings) -> Part {
    let mut renderer = Renderer::new(scene, settings).unwrap();
    renderer.finish(&Silent).unwrap();
    renderer.part()
}

fn bytes(part: &Part) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.exr");
    part::write(part, &path).unwrap();
    std::fs::read(path).unwrap()
}

/// Merges parts that were written and read again.
fn merged(parts: impl IntoIterator<Item = Part>) -> Part {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.exr");
    let mut parts = parts.into_iter().map(|part| {
        part::write(&part, &path).unwrap();
        part::read(&path).unwrap()
    });
    let mut all = parts.next().unwrap();
    parts.for_each(|part| all.merge(part).unwrap());
    all
}

#[test]
fn two_halves_are_the_whole() {
    for shaders in [&[][..], &[SIZES]] {
        let scene = figure(shaders);
        let whole = render(&scene, &settings(0, 128));
        let halves = merged([render(&scene, &settings(64, 128)), render(&scene, &settings(0, 64))]);
        assert!(bytes(&whole) == bytes(&halves));
        assert_eq!(halves.summary(), "samples 0..128");
        // The picture of the parts is that of a plain render.
        let plain = velour::render::render(&scene, &settings(0, 128), &Silent).unwrap();
        let bits = |pixels: &[f32]| pixels.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(bits(&plain.pixels) == bits(&halves.picture().pixels));
    }
}

#[test]
fn seven_uneven_parts_are_the_whole_in_any_order_threads_and_batches() {
    let scene = figure(&[SIZES]);
    let whole = bytes(&render(&scene, &settings(0, 40)));
    let ends = [0, 1, 3, 8, 9, 20, 33, 40];
    let part = |i: usize, change: &dyn Fn(&mut Settings)| {
        let mut settings = settings(ends[i], ends[i + 1]);
        change(&mut settings);
        render(&scene, &settings)
    };
    let changes: [&dyn Fn(&mut Settings); 5] = [
        &|s| s.threads = 1,
        &|s| s.threads = 2,
        &|s| s.batch_width = 1,
        &|s| (s.batch_width, s.wave_size) = (8, 100),
        &|_| (),
    ];
    for (turn, change) in changes.into_iter().enumerate() {
        let parts = (0..7).map(|i| part((i * 3 + turn) % 7, change));
        assert!(whole == bytes(&merged(parts)), "change {turn}");
    }
}

/// Stops a round when so many tiles are done.
struct Until(usize, std::sync::atomic::AtomicUsize);

impl Progress for Until {
    fn tiles(&self, done: usize, _total: usize) {
        self.1.store(done, std::sync::atomic::Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.1.load(std::sync::atomic::Ordering::Relaxed) >= self.0
    }
}

#[test]
fn a_render_that_was_stopped_goes_on_to_the_same_bits() {
    let scene = figure(&[]);
    let whole = bytes(&render(&scene, &settings(0, 50)));
    for stop in [0, 1, 4] {
        let mut renderer = Renderer::new(&scene, &settings(0, 50)).unwrap();
        renderer.round(&Until(stop, 0.into())).unwrap();
        let part = merged([renderer.part()]);
        assert!(part.counts()[0] < 50, "{}", part.summary());
        let mut renderer = Renderer::new(&scene, &settings(0, 50)).unwrap();
        renderer.resume(part).unwrap();
        while renderer.round_of(7, &Silent).unwrap() {}
        assert!(whole == bytes(&renderer.part()), "stopped after {stop} tiles");
    }
}

#[test]
fn a_render_that_is_stopped_in_the_middle_of_a_wave_goes_on_in_the_same_process() {
    let scene = figure(&[]);
    let whole = bytes(&render(&scene, &settings(0, 500)));
    let mut renderer = Renderer::new(&scene, &settings(0, 500)).unwrap();
    let mut stops = 0;
    while {
        let stop = renderer.stop().clone();
        let stopper = std::thread::spawn({
            let stop = stop.clone();
            move || {
                std::thread::sleep(std::time::Duration::from_millis(7));
                stop.store(true, std::sync::atomic::Ordering::Relaxed);
            }
        });
        let left = renderer.round(&Silent).unwrap();
        stopper.join().unwrap();
        stop.store(false, std::sync::atomic::Ordering::Relaxed);
        stops += u32::from(left);
        left && stops < 40
    } {}
    renderer.finish(&Silent).unwrap();
    assert!(stops > 1, "never stopped");
    assert!(whole == bytes(&renderer.part()));
}

#[test]
fn a_hole_in_the_samples_is_filled() {
    let scene = figure(&[]);
    let whole = bytes(&render(&scene, &settings(0, 30)));
    let mut renderer = Renderer::new(&scene, &settings(0, 30)).unwrap();
    renderer.resume(merged([render(&scene, &settings(3, 9)), render(&scene, &settings(20, 21))])).unwrap();
    renderer.finish(&Silent).unwrap();
    assert!(whole == bytes(&renderer.part()));
}

#[test]
fn what_is_of_another_picture_is_refused() {
    let scene = figure(&[]);
    let part = render(&scene, &settings(0, 2));
    let other = |change: &dyn Fn(&mut Settings), scene: &Scene| {
        let mut settings = settings(2, 4);
        change(&mut settings);
        let mut renderer = Renderer::new(scene, &settings).unwrap();
        renderer.resume(part.clone())
    };
    assert_eq!(other(&|_| (), &scene), Ok(()));
    let changes: [&dyn Fn(&mut Settings); 5] =
        [&|s| s.seed = 1, &|s| s.width = 81, &|s| s.max_bounces = 3, &|s| s.alpha = true, &|s| {
            s.closure.softening = false
        }];
    for (i, change) in changes.iter().enumerate() {
        assert!(matches!(other(change, &scene), Err(PartError::OfAnother(_))), "change {i}");
    }
    let mut moved = scene.clone();
    moved.camera.eye.x += 1e-3;
    assert!(matches!(other(&|_| (), &moved), Err(PartError::OfAnother(_))));
    let shaded = figure(&[SIZES]);
    assert!(matches!(other(&|_| (), &shaded), Err(PartError::OfAnother(_))));
    let mut all = part.clone();
    let twice = all.merge(render(&scene, &settings(1, 3)));
    assert!(matches!(twice, Err(PartError::Twice { ref samples, .. }) if samples.to_string() == "1..2"), "{twice:?}");
    assert_eq!(other(&|s| (s.first_sample, s.noise) = (0, Some(0.1)), &scene), Err(PartError::Adapts));
}

#[test]
fn files_that_are_broken_are_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.exr");
    let part = render(&figure(&[]), &settings(0, 2));
    let (whole, picture) = (bytes(&part), part.picture());
    let mut state = 1u32;
    let mut random = move |n: usize| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as usize % n
    };
    for turn in 0..60 {
        let mut bytes = whole.clone();
        match turn % 3 {
            0 => bytes.truncate(random(whole.len())),
            // The header, where the text of the part is.
            1 => (0..8).for_each(|_| bytes[random(2000)] = random(256) as u8),
            _ => (0..8).for_each(|_| bytes[random(whole.len())] = random(256) as u8),
        }
        std::fs::write(&path, bytes).unwrap();
        // What is still read is what was written: the change was in the picture, or in what nobody reads.
        if let Ok(part) = part::read(&path) {
            assert!(part.picture().pixels == picture.pixels, "turn {turn}");
        }
    }
    for text in ["", "not a picture"] {
        std::fs::write(&path, text).unwrap();
        assert!(matches!(part::read(&path), Err(PartError::Unreadable { .. })));
    }
    assert!(matches!(part::read(&folder.path().join("none.exr")), Err(PartError::Unreadable { .. })));
}
