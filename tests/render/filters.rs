//! How samples count for pixels, and pictures that are cut out of a frame.

use super::materials::scene_with;
use super::speed::FIGURE1;
use velour::render::{Filter, Frame, Image, LightStrategy, Settings, Silent, render};

const FILTERS: [Filter; 3] = [Filter::Tent, Filter::Box, Filter::BlackmanHarris];

/// A noisy picture of figure 1: lamps are met by chance.
fn noisy(filter: Filter, seed: u32) -> Image {
    let lights = LightStrategy::ScatteringOnly;
    let settings = Settings { width: 160, height: 64, samples: 16, seed, filter, lights, ..Settings::default() };
    render(&scene_with(FIGURE1, &[]), &settings, &Silent).unwrap()
}

/// Correlation of the noise of pixels beside and below each other.
fn correlation(filter: Filter) -> [f64; 2] {
    let images = [1, 2].map(|seed| noisy(filter, seed));
    // The square root keeps a lamp that was met from being all that counts.
    let at = |x: u32, y: u32| {
        let [a, b] = images.each_ref().map(|image| f64::from(image.pixel(x, y)[1]).max(0.0).sqrt());
        a - b
    };
    let (mut square, mut beside, mut below) = (0.0, 0.0, 0.0);
    for (x, y) in (0..63).flat_map(|y| (0..159).map(move |x| (x, y))) {
        square += at(x, y) * at(x, y);
        beside += at(x, y) * at(x + 1, y);
        below += at(x, y) * at(x, y + 1);
    }
    [beside / square, below / square]
}

#[test]
fn a_box_leaves_no_two_pixels_noise_in_common_and_a_tent_does() {
    // Ten thousand pixels: a standard deviation of .01.
    for filter in [Filter::Box, Filter::BlackmanHarris] {
        let found = correlation(filter);
        assert!(found.iter().all(|r| r.abs() < 0.05), "{filter:?}: {found:?}");
    }
    let found = correlation(Filter::Tent);
    assert!(found.iter().all(|r| *r > 0.12), "a tent: {found:?}");
}

#[test]
fn filters_keep_the_light() {
    let mean = |filter| {
        let settings = Settings { width: 160, height: 64, samples: 64, filter, ..Settings::default() };
        render(&scene_with(FIGURE1, &[]), &settings, &Silent).unwrap().mean()
    };
    let [tent, others @ ..] = FILTERS.map(mean);
    for other in others {
        assert!((0..3).all(|k| (other[k] / tent[k] - 1.0).abs() < 3e-3), "{other:?} {tent:?}");
    }
}

#[test]
fn a_picture_that_is_cut_out_has_the_pixels_of_its_frame() {
    // A shader that reads where it is in the frame, and a footprint.
    let shader = "surface sizes(float x = 1) { point p = transform(\"NDC\", P); Ci = color(p[0], p[1], filterwidth(u)) * emission() + diffuse(N); }";
    let xml = FIGURE1.replace("shader cloth l1", "shader sizes l1").replace("float rough", "float x");
    let scene = scene_with(&xml, &[shader]);
    for filter in FILTERS {
        let whole = Settings { width: 90, height: 40, samples: 8, filter, ..Settings::default() };
        let (size, at) = ([90, 40], [21, 5]);
        let part = Settings { width: 37, height: 30, frame: Some(Frame { size, at }), ..whole.clone() };
        let [whole, part] = [whole, part].map(|settings| render(&scene, &settings, &Silent).unwrap());
        let rim = u32::from(filter == Filter::Tent);
        for (x, y) in (rim..30 - rim).flat_map(|y| (rim..37 - rim).map(move |x| (x, y))) {
            assert_eq!(part.pixel(x, y), whole.pixel(x + 21, y + 5), "{filter:?} {x} {y}");
        }
    }
    let outside =
        Settings { width: 37, height: 30, frame: Some(Frame { size: [90, 40], at: [60, 5] }), ..Settings::default() };
    assert!(render(&scene, &outside, &Silent).is_err());
}
