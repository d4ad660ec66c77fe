//! One scene, seed and sample count make one image, bit for bit.

use super::materials::{picture, picture_with};
use super::speed::FIGURE1;
use velour::math::instruction_set::InstructionSet;
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

/// A shader of most kinds of lobes, with noise for their arguments.
const MANY: &str = "surface many(float x = 1) {
    color c = noise(P * 3); normal n = normalize(N + .2 * (normal) snoise(P * 2));
    float r = mix(.1, .9, noise(u * 7, v * 5));
    Ci = c * diffuse(n) + .1 * oren_nayar(N, r) + .1 * translucent(N) + .1 * ward(N, dPdu, r, r * .5)
        + .1 * ashikhmin_shirley(N, dPdu, 20, 90, color(.3), color(.4)) + .1 * ashikhmin_velvet(N, r) + .05 * transparent()
        + .1 * conductor_bsdf(n, dPdu, r, r, color(.2, .9, 1.1), color(3, 2.4, 1.9), \"beckmann\");
    Ci = layer(dielectric_bsdf(N, dPdu, color(1), color(0), r, r, 1.5, \"ggx\"), Ci);
    Ci = coat(sheen(Ci, n, c, r), N, 0, 1.4, color(.1), 1);
}";

#[test]
fn instruction_sets_do_not_show() {
    let many = FIGURE1.replace("shader cloth l1", "shader many l1").replace("float rough", "float x");
    let bits = |set| {
        // Another test may not turn it down: this is the only one that does.
        assert_eq!(InstructionSet::most(set), set.min(InstructionSet::detected()));
        let image = picture_with(&many, &[MANY], |s| (s.width, s.height, s.samples) = (80, 32, 8));
        image.pixels.iter().map(|p| p.to_bits()).collect::<Vec<_>>()
    };
    let [baseline, avx2, avx512] = InstructionSet::ALL.map(bits);
    assert!(baseline.iter().any(|&p| p != baseline[0]), "the picture is empty");
    assert!(baseline == avx2, "AVX2");
    assert!(baseline == avx512, "AVX-512");
}

#[test]
fn another_seed_makes_another_image() {
    assert!(bits(|_| ()) != bits(|s| s.seed = 1));
}
