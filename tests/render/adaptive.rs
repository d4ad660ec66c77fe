//! Renders that stop by themselves: at a noise that is what they say it is, or at a time.

use super::materials::{picture, scene_with};
use super::speed::FIGURE1;
use velour::render::{Image, RenderError, Settings, Silent, render};

const SIZE: (u32, u32) = (80, 32);

fn figure(change: impl FnOnce(&mut Settings)) -> Image {
    picture(FIGURE1, |s| {
        (s.width, s.height) = SIZE;
        change(s);
    })
}

/// Mean square of the differences of two pictures.
fn square_difference(a: &Image, b: &Image) -> f64 {
    let sum: f64 = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    sum / a.pixels.len() as f64
}

/// A picture of `samples` that estimates its own error; no tile ever gets below the noise.
fn estimated(samples: u32, seed: u32) -> Image {
    figure(|s| (s.samples, s.noise, s.seed) = (samples, Some(1e-9), seed))
}

/// What is told is an upper estimate: the halves of one sequence fill each other's gaps.
#[test]
fn the_error_is_what_it_is_said_to_be() {
    let truth = figure(|s| (s.samples, s.seed) = (2048, 77));
    let mut ratio = [0.0; 2];
    for seed in 0..4 {
        let image = estimated(32, seed);
        assert_eq!(image.about.taken, [32, 32]);
        let said = image.about.noise.unwrap().powi(2);
        ratio[0] += said / square_difference(&image, &truth) / 4.0;
        // The control: the estimate of half as many samples must not pass for that of these.
        ratio[1] += estimated(16, seed).about.noise.unwrap().powi(2) / square_difference(&image, &truth) / 4.0;
    }
    assert!((1.0..2.2).contains(&ratio[0]), "said / true = {}", ratio[0]);
    assert!(!(1.0..2.2).contains(&ratio[1]), "control: {}", ratio[1]);
}

#[test]
fn a_picture_that_knows_its_error_is_as_good_as_one_that_does_not() {
    for samples in [16, 24, 33, 64] {
        let plain = figure(|s| (s.samples, s.seed) = (samples, 3));
        let off = square_difference(&estimated(samples, 3), &plain);
        assert!(off < 1e-12, "{samples}: {off}");
    }
}

#[test]
fn a_noise_is_reached_with_no_more_samples_than_a_tile_needs() {
    let image = figure(|s| (s.samples, s.noise) = (4096, Some(0.006)));
    let [fewest, most] = image.about.taken;
    assert!(16 <= fewest && fewest < most && most < 4096, "{fewest} to {most}");
    assert!(image.about.noise.unwrap() <= 0.006);
    let tighter = figure(|s| (s.samples, s.noise) = (4096, Some(0.003)));
    assert!(tighter.about.taken[1] > most && tighter.about.noise.unwrap() <= 0.003);
    assert!(tighter.about.paths > image.about.paths);
}

#[test]
fn a_noise_that_cannot_be_reached_stops_at_the_most_samples() {
    let image = estimated(24, 0);
    assert_eq!(image.about.taken, [24, 24]);
    assert!(image.about.noise.unwrap() > 1e-9);
}

#[test]
fn threads_and_waves_do_not_show_in_a_render_that_stops_by_noise() {
    let with = |threads, wave_size| {
        figure(|s| (s.samples, s.noise, s.threads, s.wave_size) = (256, Some(0.006), threads, wave_size)).pixels
    };
    assert!(with(1, 4096) == with(2, 100));
}

#[test]
fn a_render_stops_at_its_time_and_has_a_picture() {
    let start = std::time::Instant::now();
    let image = figure(|s| (s.samples, s.seconds) = (1 << 20, Some(2.0)));
    // Generous, for a machine with other things to do; without the limit this would take hours.
    assert!(start.elapsed().as_secs_f64() < 30.0);
    assert!(image.about.taken[0] >= 1 && image.about.taken[1] >= 2 && image.about.noise.is_some());
    assert!(image.pixels.iter().all(|p| p.is_finite()) && image.mean()[0] > 0.1);
    let scene = scene_with(FIGURE1, &[]);
    let settings = Settings { seconds: Some(1e-6), ..Settings::default() };
    assert_eq!(render(&scene, &settings, &Silent).unwrap_err(), RenderError::Late);
    // With a time that is not up, a few samples are taken as without one.
    let all = figure(|s| (s.samples, s.seconds) = (8, Some(1e6)));
    assert_eq!((all.about.taken, all.pixels), ([8, 8], estimated(8, 0).pixels));
}

#[test]
fn nonsense_is_refused() {
    for noise in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(
            Settings { noise: Some(noise), ..Settings::default() }.check().unwrap_err().to_string().contains("0.01")
        );
    }
    for seconds in [0.0, -1.0, f64::NAN] {
        assert!(Settings { seconds: Some(seconds), ..Settings::default() }.check().is_err());
    }
}

#[test]
fn uneven_tiles_meet_without_a_seam() {
    let truth = figure(|s| (s.samples, s.seed) = (2048, 77));
    let uneven = figure(|s| (s.samples, s.noise, s.tile_size) = (2048, Some(0.004), 8));
    let [fewest, most] = uneven.about.taken;
    assert!(most >= 4 * fewest, "{fewest} to {most}");
    let said = uneven.about.noise.unwrap();
    let (mut edges, mut count) = (0.0, 0.0);
    for y in 0..SIZE.1 {
        for x in (0..SIZE.0).filter(|x| x % 8 == 0 || x % 8 == 7) {
            let (a, b) = (uneven.pixel(x, y), truth.pixel(x, y));
            edges += a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
            count += 3.0;
        }
    }
    // Sums that counted by samples alone would move the edges of tiles by up to half a pixel.
    assert!((edges / count).sqrt() < 1.5 * said, "{} at the edges, {said} in all", (edges / count).sqrt());
}

#[test]
fn small_and_odd_pictures_are_whole() {
    for size in [(1, 1), (1, 33), (17, 2)] {
        for noise in [None, Some(0.05)] {
            let image = figure(|s| ((s.width, s.height), s.samples, s.noise, s.alpha) = (size, 33, noise, true));
            assert_eq!(image.pixels.len(), (size.0 * size.1 * 4) as usize);
            assert!(image.pixels.iter().all(|p| p.is_finite()));
            assert!(image.pixels.chunks(4).all(|p| (0.0..=1.0).contains(&p[3])));
        }
    }
    let one = figure(|s| (s.samples, s.noise) = (1, Some(0.05)));
    assert_eq!((one.about.noise, one.about.taken), (None, [1, 1]), "one sample tells nothing of its error");
}

#[test]
fn a_noise_and_a_time_stop_at_whichever_comes_first() {
    let image = figure(|s| (s.samples, s.noise, s.seconds) = (1 << 20, Some(0.05), Some(1e4)));
    assert!(image.about.noise.unwrap() <= 0.05);
    let image = figure(|s| (s.samples, s.noise, s.seconds) = (1 << 20, Some(1e-9), Some(2.0)));
    assert!(image.about.noise.unwrap() > 1e-9);
}
