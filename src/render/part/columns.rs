//! Sums as columns of words, as a file keeps them.

use super::super::exact::{ALPHA, PARTS, Sums, Tier, WEIGHT, is_tier, last_tier};
use rayon::prelude::*;

/// Pixels that a thread takes at a time.
const PIECE: usize = 1 << 14;

/// A word of one number of the sums of a tier, of all pixels. Settled sums are integers of 32 bits; what the last tier carries has a
/// second word.
#[derive(Clone, Debug)]
pub struct Column {
    /// The tier, which of the numbers, and whether this is its second word: the order in which they count.
    pub of: (i32, usize, bool),
    /// A word a pixel.
    pub words: Vec<u32>,
}

/// The columns of sums that are not all zero, and that of the weights, without which nothing is known; the same for sums of the same
/// values. Those of alpha only if somebody asks.
pub fn columns(sums: &Sums, alpha: bool) -> Vec<Column> {
    let tiers = sums.settled_tiers();
    let count = tiers.len() * PARTS;
    let words = |tier: i32| if tier == last_tier() { 2 } else { 1 };
    let all = tiers.clone().flat_map(|tier| (0..PARTS).map(move |part| (tier, part)));
    let all = all.flat_map(|(tier, part)| (0..words(tier)).map(move |word| (tier, part, word == 1)));
    let mut columns: Vec<Column> = all.map(|of| Column { of, words: vec![0; sums.len()] }).collect();
    // First words come first, so that they are found by tier and number.
    columns.sort_by_key(|column| column.of.2);
    let mut pieces: Vec<Vec<&mut [u32]>> = (0..sums.len().div_ceil(PIECE)).map(|_| Vec::new()).collect();
    for column in &mut columns {
        pieces.iter_mut().zip(column.words.chunks_mut(PIECE)).for_each(|(piece, words)| piece.push(words));
    }
    pieces.into_par_iter().enumerate().for_each(|(piece, mut columns)| {
        for at in 0..columns.first().map_or(0, |words| words.len()) {
            sums.settled(piece * PIECE + at, |tier, part, sum| {
                columns[(tier - tiers.start) as usize * PARTS + part][at] = sum as u32;
                if tier == last_tier() {
                    columns[count + part][at] = (sum >> 32) as u32;
                }
            });
        }
    });
    columns.retain(|column| match column.of.1 {
        ALPHA if !alpha => false,
        WEIGHT if column.of == (0, WEIGHT, false) => true,
        _ => column.words.par_iter().any(|word| *word != 0),
    });
    columns.sort_by_key(|column| column.of);
    columns
}

/// The sums of so many pixels that have these columns.
pub fn sums(columns: &[Column], pixels: usize) -> Option<Sums> {
    let fits = |column: &Column| column.words.len() == pixels && column.of.1 < PARTS && is_tier(column.of.0);
    columns.iter().all(fits).then_some(())?;
    let mut tiers: Vec<Tier> = Vec::new();
    for (number, _, _) in columns.iter().map(|column| column.of) {
        if tiers.last().is_none_or(|tier| tier.number != number) {
            tiers.push(Tier { number, sums: vec![[0; PARTS]; pixels] });
        }
    }
    for Tier { number, sums } in &mut tiers {
        for Column { of: (_, part, high), words } in columns.iter().filter(|column| column.of.0 == *number) {
            let both = sums.par_iter_mut().zip(words);
            // A second word comes after the first, whose sign it replaces.
            both.for_each(|(sum, word)| match high {
                false => sum[*part] = i64::from(*word as i32),
                true => sum[*part] = (i64::from(*word as i32) << 32) | (sum[*part] & 0xffff_ffff),
            });
        }
    }
    Sums::of(tiers)
}

/// A number that changes when a bit of the columns does.
pub fn checked(columns: &[Column]) -> u64 {
    let hash = |words: &[u32]| {
        let bytes: Vec<u32> = words.iter().map(|word| word.to_le()).collect();
        farmhash::fingerprint64(bytemuck::cast_slice(&bytes))
    };
    let column = |column: &Column| {
        let (tier, part, high) = column.of;
        let pieces: Vec<u64> = column.words.par_chunks(PIECE).map(hash).collect();
        let numbers = [tier as u64, part as u64, u64::from(high)].into_iter().chain(pieces);
        farmhash::fingerprint64(&numbers.flat_map(u64::to_le_bytes).collect::<Vec<u8>>())
    };
    columns.iter().map(column).fold(0, |sum, hash| sum.rotate_left(1) ^ hash)
}
