//! Sums of light that are the same bits in whatever order their terms come.
//!
//! Every term is rounded to a grid of a power of two before it is added, as an integer, so that no sum rounds. Source: pre-rounding,
//! Demmel and Nguyen 2013. One grid cannot hold both starlight and a sun, so there are tiers of grids, 2^30 apart; the largest
//! channel of a sample says which tier it goes to, and a tier takes memory from its first sample on. Nearly all pictures have one:
//! tier 0 takes what lies between 2^-19 and 2^11, in steps of 2^-36.
//!
//! Decision (2026-11-29): tiers that every sample finds by itself, instead of one grid chosen from the exposure of the picture,
//! because then parts of a picture need not agree on an exposure before they have seen it, and none is too bright or too dark.

use rayon::prelude::*;
use std::ops::Range;

/// Red, green, blue, alpha and weight.
pub const PARTS: usize = 5;

/// Which of them is alpha.
pub const ALPHA: usize = 3;

/// Which of them is the weight.
pub const WEIGHT: usize = 4;

/// Powers of two between the grids of two tiers.
const STEP: i32 = 30;

/// The grid of tier 0 is 2 to the minus this.
const FRACTION: i32 = 36;

/// The least power of two that is too large for tier 0: eleven bits above one leave 2^16 terms of 47 bits for a sum.
const TOP: i32 = 11;

/// The tiers that samples go to: from below the least single to above the largest.
const TIERS: Range<i32> = -5..5;

/// The places of digits: the tiers that samples go to, and two for what is carried from them.
const PLACES: usize = (TIERS.end - TIERS.start) as usize + 2;

/// Samples a pixel after which what a sum has above its tier is carried to the next: a sample adds to a pixel, from all pixels
/// around it, four times its light at the most.
pub const SETTLE: u32 = 1 << 12;

/// A double of this size has integers for its last bits, so that adding it rounds to one.
const ROUND: f64 = 1.5 * (1u64 << 52) as f64;

/// A row of sums, in one tier.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tier {
    /// Its number.
    pub number: i32,
    /// The sums in units of its grid.
    pub sums: Vec<[i64; PARTS]>,
}

/// A row of exact sums; tier 0 is first and always there.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    tiers: Vec<Tier>,
}

impl Sums {
    /// Makes room for `len` sums; what is there stays.
    pub fn open(&mut self, len: usize) {
        if self.tiers.is_empty() {
            self.tiers.push(Tier { number: 0, sums: vec![[0; PARTS]; len] });
        }
    }

    /// Adds light, alpha and a weight of one to the sums of two by two pixels: those at `first` and the next one, and of the row
    /// behind, `row` further; each multiplied by the weights of its column and row, 0..1.
    #[inline]
    pub fn splat(&mut self, first: usize, row: usize, columns: [f64; 2], rows: [f64; 2], light: [f32; 3], alpha: f32) {
        // What amplifies without end would make a sum of alpha overflow.
        let alpha = if alpha.is_nan() { 0.0 } else { f64::from(alpha.clamp(-2048.0, 2048.0)) };
        let place = Place { first, row, columns, rows };
        let most = light[0].abs().max(light[1].abs()).max(light[2].abs());
        let [r, g, b] = light.map(f64::from);
        // What is no number is no light; paths leave it out themselves.
        if !(light[0] + light[1] + light[2]).is_finite() {
            self.splat_elsewhere(&place, [r, g, b], alpha, most);
        } else if most == 0.0 || (most >= power(TOP - STEP) as f32 && most < power(TOP) as f32) {
            add(&mut self.tiers[0].sums, &place, [r, g, b, alpha, 1.0].map(|x| x * power(FRACTION)));
        } else {
            self.splat_elsewhere(&place, [r, g, b], alpha, most);
        }
    }

    /// How many sums there are.
    pub fn len(&self) -> usize {
        self.tiers.first().map_or(0, |tier| tier.sums.len())
    }

    /// [`splat`](Sums::splat) for light that is too strong or too weak for tier 0.
    #[cold]
    fn splat_elsewhere(&mut self, place: &Place, [r, g, b]: [f64; 3], alpha: f64, most: f32) {
        add(&mut self.tiers[0].sums, place, [0.0, 0.0, 0.0, alpha, 1.0].map(|x| x * power(FRACTION)));
        if !(r + g + b).is_finite() || most == 0.0 {
            return;
        }
        let number = (exponent(most) - (TOP - STEP)).div_euclid(STEP).clamp(TIERS.start, TIERS.end - 1);
        let scale = power(FRACTION - STEP * number);
        add(&mut self.tier(number).sums, place, [r, g, b, 0.0, 0.0].map(|x| x * scale));
    }

    /// The tier of a number, made where there is none.
    fn tier(&mut self, number: i32) -> &mut Tier {
        let at = self.tiers.iter().position(|tier| tier.number == number).unwrap_or_else(|| {
            let len = self.len();
            self.tiers.push(Tier { number, sums: vec![[0; PARTS]; len] });
            self.tiers.len() - 1
        });
        &mut self.tiers[at]
    }

    /// Carries what a sum has above its tier to the next one, so that there is room for more.
    pub fn settle(&mut self) {
        for number in TIERS.start..=TIERS.end {
            let Some(at) = self.tiers.iter().position(|tier| tier.number == number) else { continue };
            let full = |sum: &i64| sum.unsigned_abs() >= 1 << (STEP - 1);
            if !self.tiers[at].sums.as_flattened().iter().any(full) {
                continue;
            }
            self.tier(number + 1);
            let next = self.tiers.iter().position(|tier| tier.number == number + 1).unwrap_or(at);
            if let Ok([below, above]) = self.tiers.get_disjoint_mut([at, next]) {
                below.sums.iter_mut().zip(&mut above.sums).for_each(|(sum, above)| {
                    plus(above, &sum.each_mut().map(carry));
                });
            }
        }
    }

    /// Adds what `other`, of the same length, holds, and empties it.
    pub fn drain(&mut self, other: &mut Sums) {
        for tier in &mut other.tiers {
            let sums = &mut self.tier(tier.number).sums;
            sums.iter_mut().zip(&mut tier.sums).for_each(|(sum, more)| plus(sum, &std::mem::take(more)));
        }
    }

    /// One sum as numbers: a function of its exact value alone.
    pub fn value(&self, i: usize) -> [f64; PARTS] {
        std::array::from_fn(|part| match self.plain(i, part) {
            Some(sum) if sum.unsigned_abs() < 1 << 53 => sum as f64 * power(-FRACTION),
            _ => self.value_of(i, part),
        })
    }

    /// What a sum has in tier 0, where it has nothing elsewhere, as nearly all have.
    #[inline]
    fn plain(&self, i: usize, part: usize) -> Option<i64> {
        let [zeroth, others @ ..] = &self.tiers[..] else { return None };
        others.iter().all(|tier| tier.sums[i][part] == 0).then(|| zeroth.sums[i][part])
    }

    /// Sums of `len` in the tiers of `numbers`, with more for each piece of `piece` of them: `fill` is told the number of the tier and of
    /// the piece, and runs on all threads.
    pub fn gather(
        &mut self,
        len: usize,
        piece: usize,
        numbers: impl Iterator<Item = i32>,
        fill: impl Fn(i32, usize, &mut [[i64; PARTS]]) + Sync,
    ) {
        self.open(len);
        for number in numbers {
            self.tier(number);
        }
        for tier in &mut self.tiers {
            let pieces = tier.sums.par_chunks_mut(piece).enumerate();
            pieces.for_each(|(place, sums)| fill(tier.number, place, sums));
        }
    }

    /// The tiers there are, by number.
    pub fn numbers(&self) -> impl Iterator<Item = i32> {
        self.tiers.iter().map(|tier| tier.number)
    }

    /// The sums of a tier, where there is one of this number.
    pub fn of_tier(&self, number: i32) -> Option<&[[i64; PARTS]]> {
        self.tiers.iter().find(|tier| tier.number == number).map(|tier| &tier.sums[..])
    }

    /// The tiers in which settled sums may have anything.
    pub fn settled_tiers(&self) -> Range<i32> {
        let first = self.numbers().min().unwrap_or(0);
        first..self.numbers().max().map_or(0, above)
    }

    /// Tells of one sum what it has in each tier when it is settled, where that is anything: tier, part and sum, which are a function
    /// of its exact value.
    #[inline]
    pub fn settled(&self, i: usize, mut each: impl FnMut(i32, usize, i64)) {
        for part in 0..PARTS {
            if let Some(mut sum) = self.plain(i, part) {
                let mut number = 0;
                while sum != 0 {
                    let above = carry(&mut sum);
                    if sum != 0 {
                        each(number, part, sum);
                    }
                    (sum, number) = (above, number + 1);
                }
                continue;
            }
            let (digits, places) = self.digits(i, part);
            for place in places {
                if digits[place] != 0 {
                    each(TIERS.start + place as i32, part, digits[place]);
                }
            }
        }
    }

    /// Sums of settled tiers, all of one length.
    pub fn of(tiers: Vec<Tier>) -> Option<Self> {
        let [first, rest @ ..] = &tiers[..] else { return None };
        let numbers = tiers.iter().map(|tier| tier.number);
        let even = rest.iter().all(|tier| tier.sums.len() == first.sums.len());
        let known = numbers.clone().all(is_tier);
        let apart =
            numbers.clone().enumerate().all(|(i, number)| numbers.clone().skip(i + 1).all(|other| other != number));
        // What is settled is half a step at the most; above the last tier that samples go to there are but carries.
        let most = |tier: &Tier| if tier.number > TIERS.end { 1u64 << 40 } else { 1 << (STEP - 1) };
        let room = tiers.iter().all(|tier| tier.sums.iter().flatten().all(|sum| sum.unsigned_abs() <= most(tier)));
        let at = tiers.iter().position(|tier| tier.number == 0)?;
        let mut sums = Sums { tiers };
        sums.tiers.swap(0, at);
        (even && known && apart && room).then_some(sums)
    }

    /// The digits of a sum, from the highest on, in as many roundings as there are digits.
    fn value_of(&self, i: usize, part: usize) -> f64 {
        let (digits, places) = self.digits(i, part);
        let least = TIERS.start + places.start as i32;
        let value = places.rev().fold(0.0, |value, place| value * power(STEP) + digits[place] as f64);
        value * power(STEP * least - FRACTION)
    }

    /// The digits of a sum, tier by tier from the least on, and the places of those that are not zero for want of a tier.
    #[inline]
    fn digits(&self, i: usize, part: usize) -> ([i64; PLACES], Range<usize>) {
        let mut digits = [0i64; PLACES];
        let (mut first, mut end) = (PLACES, 0);
        for tier in &self.tiers {
            let place = (tier.number - TIERS.start) as usize;
            digits[place] = tier.sums[i][part];
            (first, end) = (first.min(place), end.max((above(tier.number) - TIERS.start) as usize));
        }
        for place in first..end.saturating_sub(1) {
            digits[place + 1] += carry(&mut digits[place]);
        }
        (digits, first.min(end)..end)
    }
}

/// Is there a tier of this number: one that samples go to, or one of the two for what is carried from them?
pub fn is_tier(number: i32) -> bool {
    (TIERS.start..=TIERS.end + 1).contains(&number)
}

/// One behind the last tier that what is in a tier may be carried to: a sum of 64 bits reaches the second one above.
fn above(number: i32) -> i32 {
    (number + 3).min(TIERS.end + 2)
}

/// The tier that is for carries alone, above the one that may have samples as well.
pub fn last_tier() -> i32 {
    TIERS.end + 1
}

/// Where a sample goes.
struct Place {
    first: usize,
    row: usize,
    columns: [f64; 2],
    rows: [f64; 2],
}

#[inline(always)]
fn add(sums: &mut [[i64; PARTS]], place: &Place, value: [f64; PARTS]) {
    for (wy, start) in place.rows.into_iter().zip([place.first, place.first + place.row]) {
        for (wx, sum) in place.columns.into_iter().zip(&mut sums[start..start + 2]) {
            let weight = wx * wy;
            for k in 0..PARTS {
                let rounded = (weight * value[k] + ROUND).to_bits();
                sum[k] = sum[k].wrapping_add(rounded.wrapping_sub(ROUND.to_bits()) as i64);
            }
        }
    }
}

/// Adds sums to others.
pub fn plus(sum: &mut [i64; PARTS], more: &[i64; PARTS]) {
    (0..PARTS).for_each(|k| sum[k] += more[k]);
}

/// Leaves what is nearest to zero and gives the rest in units of the next tier. So small sums of either sign carry nothing.
fn carry(sum: &mut i64) -> i64 {
    let above = (*sum + (1 << (STEP - 1))) >> STEP;
    *sum -= above << STEP;
    above
}

/// Two to the power of `k`, which is between -1022 and 1023.
const fn power(k: i32) -> f64 {
    f64::from_bits(((1023 + k) as u64) << 52)
}

/// The power of two of a positive single.
fn exponent(x: f32) -> i32 {
    (f64::from(x).to_bits() >> 52) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of four, of whose light a share of one goes to the first.
    fn sum(lights: impl IntoIterator<Item = f32>) -> Sums {
        let mut sums = Sums::default();
        sums.open(4);
        lights.into_iter().for_each(|x| sums.splat(0, 2, [1.0, 0.0], [1.0, 0.0], [x, -x, 0.5 * x], 1.0));
        sums
    }

    /// Lights of all sizes, from the least singles to the largest, with both signs.
    fn wild(count: u32) -> Vec<f32> {
        let number = |i: u32| {
            let bits = i.wrapping_mul(0x9e37_79b9) ^ (i << 7);
            let exponent = bits % 254;
            f32::from_bits((bits & 0x807f_ffff) | (exponent << 23))
        };
        (1..=count).map(number).collect()
    }

    #[test]
    fn the_order_of_terms_does_not_show_at_any_size() {
        let lights = wild(3000);
        let forward = sum(lights.iter().copied()).value(0);
        let backward = sum(lights.iter().rev().copied()).value(0);
        assert_eq!(forward.map(f64::to_bits), backward.map(f64::to_bits));
        // Sums of doubles, the control, do show it.
        let add = |sum: f64, x: &f32| sum + f64::from(*x);
        let tame: Vec<f32> = (1..3000u32).map(|i| (i as f32).powi(-3)).collect();
        assert_ne!(tame.iter().fold(0.0, add), tame.iter().rev().fold(0.0, add));
    }

    #[test]
    fn parts_and_carries_do_not_show_either() {
        let lights = wild(3000);
        let whole = sum(lights.iter().copied());
        let mut parts = sum(std::iter::empty());
        for part in lights.chunks(700).rev() {
            let mut part = sum(part.iter().copied());
            part.settle();
            parts.drain(&mut part);
            assert_eq!(part.value(0), [0.0; PARTS]);
            parts.settle();
        }
        assert_eq!(whole.value(0).map(f64::to_bits), parts.value(0).map(f64::to_bits));
        // One tier alone, with and without carries.
        let mut bright = sum((0..4096).map(|i| 2000.0 + i as f32 / 100.0));
        let before = bright.value(0);
        bright.settle();
        assert_eq!(before.map(f64::to_bits), bright.value(0).map(f64::to_bits));
    }

    #[test]
    fn a_sum_is_as_exact_at_any_exposure() {
        for exponent in [-140, -120, -60, -30, -19, 0, 10, 11, 40, 100, 120] {
            let scale = power(exponent);
            let lights: Vec<f32> = (0..100).map(|i| (f64::from(i % 7 + 1) / 8.0 * scale) as f32).collect();
            let expected: f64 = lights.iter().map(|x| f64::from(*x)).sum();
            let found = sum(lights).value(0);
            let off = (found[0] - expected).abs() / expected;
            assert!(off < 1e-5 && found[4] == 100.0, "2^{exponent}: {off:e}");
        }
    }
}
