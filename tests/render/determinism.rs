//! One scene, seed and sample count make one image, bit for bit.

use super::materials::picture;
use super::speed::FIGURE1;
use velour::render::Settings;

fn bits(change: impl FnOnce(&mut Settings)) -> Vec<u32> {
    let image = picture(FIGURE1, |s| {
        (s.width, s.height, s.samples) = (80, 32, 8);
        change(s);
    });
    image.pixels.iter().map(|p| p.to_bits()).collect()
}

/// Holds that threads, batches, waves and tiles do not show in the bits of a picture.
pub fn same_however_it_is_cut(bits: impl Fn(&dyn Fn(&mut Settings)) -> Vec<u32>) {
    let reference = bits(&|s| s.threads = 1);
    assert!(reference == bits(&|s| s.threads = 2), "threads");
    for width in [1, 8, 127, 128, 511] {
        assert!(reference == bits(&|s| s.batch_width = width), "batch width {width}");
    }
    for size in [1, 7, 64] {
        assert!(reference == bits(&|s| s.tile_size = size), "tile size {size}");
    }
    for size in [1, 100, 100_000] {
        assert!(reference == bits(&|s| s.wave_size = size), "wave size {size}");
    }
}

#[test]
fn threads_batches_waves_and_tiles_do_not_show() {
    same_however_it_is_cut(|change| bits(change));
}

#[test]
fn another_seed_makes_another_image() {
    assert!(bits(|_| ()) != bits(|s| s.seed = 1));
}
