//! Random numbers of a path: Owen-scrambled Sobol points, four dimensions a call.
//!
//! Every pixel has a sequence of its own, by its own scramble. The dimensions of a path are handed out in sets of four,
//! the same ones at the same bounce whatever happened before, so that paths of a pixel stay stratified against each
//! other however they branch.

use super::block::{Row, WIDTH};
use crate::lanes;
use sobol_burley::{NUM_DIMENSION_SETS_4D, parts};
use std::sync::LazyLock;

/// Sets of four dimensions that one bounce may use.
const SETS_PER_BOUNCE: u32 = 3;

/// The camera's set.
pub const CAMERA: u32 = 0;

/// Which set of a bounce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// x, y the point on a light; z which light, and w what z leaves open among many.
    Light = 0,
    /// x which lobe, and with y the direction; z what else a lobe chooses; w the roulette.
    Scatter = 1,
    /// x, y the direction toward the background.
    Sky = 2,
}

/// The set of dimensions for one use at one bounce.
pub fn dimension_set(bounce: u32, what: Use) -> u32 {
    1 + bounce.saturating_mul(SETS_PER_BOUNCE).saturating_add(what as u32)
}

/// The scramble of one pixel.
pub fn pixel_seed(seed: u32, x: u32, y: u32) -> u32 {
    mix(mix(mix(seed ^ 0x9e37_79b9).wrapping_add(x)).wrapping_add(y))
}

/// Up to four numbers in [0, 1) a lane, a column each: of sample `indices[i]` of the pixel of `seeds[i]`; all of one
/// length.
///
/// The Sobol points are good to 2^16 samples; each further block of as many gets a scramble of its own. Beyond the
/// dimensions the tables hold, some twenty bounces deep, plain hashing takes over: stratification gains nothing there.
pub fn fill(seeds: &[u32], indices: &[u32], set: u32, out: &mut [Vec<f32>]) {
    match VECTORS.get(set as usize) {
        Some(vectors) => sobol_lanes(seeds, indices, set, vectors, out),
        None => hash_lanes(seeds, indices, set, out),
    }
}

/// The four numbers of one sample.
pub fn sample(seed: u32, index: u32, set: u32) -> [f32; 4] {
    let mut out = [const { Vec::new() }; 4];
    out.iter_mut().for_each(|column| column.push(0.0));
    fill(&[seed], &[index], set, &mut out);
    out.map(|column| column[0])
}

/// Generator vectors, bits reversed, of the sixteen bits of an index; for each set of four dimensions.
type Vectors = [[u32; 4]; 16];

/// A Sobol number is a sum (XOR) of one vector for each bit of its index.
static VECTORS: LazyLock<Vec<Vectors>> = LazyLock::new(|| {
    let vector = |set, bit: usize| parts::sobol_int4_rev(1 << (31 - bit), set).into();
    (0..NUM_DIMENSION_SETS_4D).map(|set| std::array::from_fn(|bit| vector(set, bit))).collect()
});

lanes! {
    /// Same numbers as `sobol_burley::sample_4d`, which see for the scrambling; lanes in blocks, so that a block's sums stay
    /// in registers.
    fn sobol_lanes(seeds: &[u32], indices: &[u32], set: u32, vectors: &Vectors, out: &mut [Vec<f32>]) {
        for start in (0..seeds.len()).step_by(WIDTH) {
            let len = WIDTH.min(seeds.len() - start);
            let (mut seed, mut index) = ([0; WIDTH], [0; WIDTH]);
            seed[..len].copy_from_slice(&seeds[start..start + len]);
            index[..len].copy_from_slice(&indices[start..start + len]);
            for i in 0..WIDTH {
                let other = mix(seed[i] ^ (index[i] >> 16).wrapping_mul(0x85eb_ca6b));
                seed[i] = if index[i] >> 16 == 0 { seed[i] } else { other };
                let shuffle = parts::hash(seed[i] ^ 0x79c6_8e4a);
                index[i] = parts::owen_scramble_rev((index[i] & 0xffff).reverse_bits(), shuffle);
            }
            const KEYS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
            for (k, (column, key)) in out.iter_mut().zip(KEYS).enumerate() {
                let mut sum = [0; WIDTH];
                for (bit, vector) in vectors.iter().enumerate() {
                    for i in 0..WIDTH {
                        sum[i] ^= vector[k] & (((index[i] << bit) as i32 >> 31) as u32);
                    }
                }
                let mut block: Row = [0.0; WIDTH];
                for i in 0..WIDTH {
                    let scramble = parts::hash(seed[i].wrapping_mul(0x9c8f_2d3b) ^ set ^ key);
                    block[i] = unit(parts::owen_scramble_rev(sum[i], scramble).reverse_bits());
                }
                column[start..start + len].copy_from_slice(&block[..len]);
            }
        }
    }
}

/// Numbers without any order, for sets beyond the tables.
fn hash_lanes(seeds: &[u32], indices: &[u32], set: u32, out: &mut [Vec<f32>]) {
    for i in 0..seeds.len() {
        let mut state = mix(mix(seeds[i] ^ indices[i]).wrapping_add(set));
        for column in out.iter_mut() {
            state = mix(state.wrapping_add(0x9e37_79b9));
            column[i] = unit(state);
        }
    }
}

/// The upper 23 bits as a number in [0, 1).
#[inline(always)]
fn unit(bits: u32) -> f32 {
    f32::from_bits((bits >> 9) | 0x3f80_0000) - 1.0
}

/// A 32-bit mixer with low bias. Source: C. Wellons, hash-prospector, the two-round multiply-xorshift
/// 21f0aaad/d35a2d97.
#[inline(always)]
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
                assert!(sample(pixel_seed(1, 2, 3), index, set).iter().all(|x| (0.0..1.0).contains(x)));
            }
        }
    }

    #[test]
    fn lanes_give_the_same_numbers_as_the_crate() {
        let cases: Vec<(u32, u32)> = (0..2000).map(|i| (mix(i), i * 31 % 65_536)).collect();
        let (seeds, indices): (Vec<u32>, Vec<u32>) = cases.into_iter().unzip();
        for set in 0..NUM_DIMENSION_SETS_4D {
            let mut out = [const { Vec::new() }; 4];
            out.iter_mut().for_each(|column: &mut Vec<f32>| column.resize(77, 0.0));
            let from = set as usize * 7;
            let (seeds, indices) = (&seeds[from..from + 77], &indices[from..from + 77]);
            fill(seeds, indices, set, &mut out);
            for i in 0..77 {
                assert_eq!(out.each_ref().map(|column| column[i]), sobol_burley::sample_4d(indices[i], set, seeds[i]));
            }
        }
    }

    #[test]
    fn sixteen_samples_fill_sixteen_strata() {
        let seed = pixel_seed(7, 11, 13);
        for dimension in 0..4 {
            let mut seen = [false; 16];
            (0..16).for_each(|i| seen[(sample(seed, i, 5)[dimension] * 16.0) as usize] = true);
            assert!(seen.iter().all(|s| *s));
        }
    }
}
