//! Random numbers of a path: Owen-scrambled Sobol points, four dimensions a call.
//!
//! Every pixel has a sequence of its own, by its own scramble. The dimensions of a path are handed out in sets of four,
//! the same ones at the same bounce whatever happened before, so that paths of a pixel stay stratified against each
//! other however they branch.

use sobol_burley::{NUM_DIMENSION_SETS_4D, parts};
use std::sync::LazyLock;

/// Sets of four dimensions that one bounce may use.
const SETS_PER_BOUNCE: u32 = 3;

/// The camera's set.
pub const CAMERA: u32 = 0;

/// Which set of a bounce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// x, y the point on a light; z which light; w the roulette.
    Light = 0,
    /// x, y the direction; z which lobe.
    Scatter = 1,
    /// x, y the direction toward the background.
    Sky = 2,
}

/// The set of dimensions for one use at one bounce.
pub fn dimension_set(bounce: u32, what: Use) -> u32 {
    1 + bounce.saturating_mul(SETS_PER_BOUNCE).saturating_add(what as u32)
}

/// The scramble of one pixel in one half of the film; half 0 is all there is when no error is asked for.
pub fn pixel_seed(seed: u32, x: u32, y: u32, half: u32) -> u32 {
    mix(mix(mix(seed ^ 0x9e37_79b9).wrapping_add(x)).wrapping_add(y)) ^ half.wrapping_mul(0xa511_e9b3)
}

/// Four numbers in [0, 1) of sample `index` of a pixel.
///
/// The Sobol points are good to 2^16 samples; each further block of as many gets a scramble of its own. Beyond the
/// dimensions the tables hold, some twenty bounces deep, plain hashing takes over: stratification gains nothing there.
#[inline]
pub fn sample(seed: u32, index: u32, set: u32) -> [f32; 4] {
    let block = index >> 16;
    let seed = if block == 0 { seed } else { mix(seed ^ block.wrapping_mul(0x85eb_ca6b)) };
    if set < NUM_DIMENSION_SETS_4D {
        return sobol(index & 0xffff, set, seed);
    }
    let mut state = mix(mix(seed ^ index).wrapping_add(set));
    std::array::from_fn(|_| {
        state = mix(state.wrapping_add(0x9e37_79b9));
        (state >> 8) as f32 * (1.0 / 16_777_216.0)
    })
}

/// Sums of the generator vectors for the four nibbles of a 16-bit index, 64 entries a set of dimensions.
///
/// A Sobol number is a sum (XOR) of one vector for each bit of its index. The crate walks the set bits, eight of them in
/// the mean, with a branch that cannot be predicted; four look-ups give the same number.
static NIBBLES: LazyLock<Vec<[u32; 4]>> = LazyLock::new(|| {
    let entry = |i: u32| {
        let (set, nibble, value) = (i / 64, i / 16 % 4, i % 16);
        <[u32; 4]>::from(parts::sobol_int4_rev(value << (28 - 4 * nibble), set))
    };
    (0..NUM_DIMENSION_SETS_4D * 64).map(entry).collect()
});

/// Same numbers as `sobol_burley::sample_4d`, which see for the scrambling.
#[inline]
fn sobol(index: u32, set: u32, seed: u32) -> [f32; 4] {
    let index = parts::owen_scramble_rev(index.reverse_bits(), parts::hash(seed ^ 0x79c6_8e4a));
    let table = &NIBBLES[set as usize * 64..set as usize * 64 + 64];
    let part = |nibble: u32| table[(nibble * 16 + ((index >> (28 - 4 * nibble)) & 15)) as usize];
    let (a, b, c, d) = (part(0), part(1), part(2), part(3));
    let sum: [u32; 4] = std::array::from_fn(|k| a[k] ^ b[k] ^ c[k] ^ d[k]);
    let common = seed.wrapping_mul(0x9c8f_2d3b) ^ set;
    let scramble = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].map(|k: u32| k ^ common);
    let scrambled = parts::owen_scramble_int4_rev(sum.into(), parts::hash_int4(scramble.into()));
    scrambled.reverse_bits().to_f32_norm()
}

/// A 32-bit mixer with low bias. Source: C. Wellons, hash-prospector, the two-round multiply-xorshift
/// 21f0aaad/d35a2d97.
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_in_range_at_any_depth_and_index() {
        for index in [0, 1, 65_535, 65_536, 1 << 24] {
            for set in [0, 1, NUM_DIMENSION_SETS_4D - 1, NUM_DIMENSION_SETS_4D, u32::MAX] {
                assert!(sample(pixel_seed(1, 2, 3, 0), index, set).iter().all(|x| (0.0..1.0).contains(x)));
            }
        }
    }

    #[test]
    fn the_tables_give_the_same_numbers_as_the_crate() {
        for (index, set, seed) in (0..2000).map(|i| (i * 31 % 65_536, i % NUM_DIMENSION_SETS_4D, mix(i))) {
            assert_eq!(sobol(index, set, seed), sobol_burley::sample_4d(index, set, seed));
        }
    }

    #[test]
    fn sixteen_samples_fill_sixteen_strata() {
        let seed = pixel_seed(7, 11, 13, 1);
        for dimension in 0..4 {
            let mut seen = [false; 16];
            (0..16).for_each(|i| seen[(sample(seed, i, 5)[dimension] * 16.0) as usize] = true);
            assert!(seen.iter().all(|s| *s));
        }
    }
}
