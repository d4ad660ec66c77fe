//! Decimal digits of floats, rounded exactly: half to even, as C does.
//!
//! A float is m 2^e with m < 2^24, so over all magnitudes that shaders print the rounded quotient fits into whole numbers of
//! 128 bits. What does not fit goes through the standard library, which gives the same digits more slowly.

/// The most significant digits that [`Digits`] holds.
pub const MOST_DIGITS: usize = 17;

/// 10^0 to 10^38, all that fit.
const POWERS: [u128; 39] = {
    let mut powers = [1; 39];
    let mut at = 1;
    while at < powers.len() {
        powers[at] = powers[at - 1] * 10;
        at += 1;
    }
    powers
};

/// `a` times 10^`places` as a whole number, rounded half to even; none when it takes numbers of more than 128 bits.
///
/// `a` is finite and not negative.
pub fn rounded(a: f64, places: i32) -> Option<u128> {
    let bits = a.to_bits();
    let exponent = (bits >> 52) as i32;
    if exponent == 0 {
        return if a == 0.0 { Some(0) } else { None };
    }
    let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
    // The numbers are floats widened to doubles, so most of the mantissa's bits are zero.
    let spare = mantissa.trailing_zeros();
    let (whole, power) = (mantissa >> spare, exponent - 1075 + spare as i32);
    if let Some(short) = rounded_short(whole, power, places) {
        return Some(u128::from(short));
    }
    let whole = u128::from(whole);
    let up = POWERS.get(places.max(0) as usize)?;
    let down = *POWERS.get(places.min(0).unsigned_abs() as usize)?;
    let mut above = whole.checked_mul(*up)?;
    if power >= 0 {
        above = (power < above.leading_zeros() as i32).then(|| above << power)?;
        return Some(divided(above, down));
    }
    let shift = power.unsigned_abs();
    if down > 1 {
        return (shift < down.leading_zeros()).then(|| divided(above, down << shift));
    }
    if shift > 127 {
        return None;
    }
    let (quotient, half) = (above >> shift, 1 << (shift - 1));
    let rest = above - (quotient << shift);
    Some(quotient + u128::from(rest > half || (rest == half && quotient & 1 == 1)))
}

/// The same where 64 bits do, as for most numbers that are printed.
fn rounded_short(whole: u64, power: i32, places: i32) -> Option<u64> {
    if !(0..=12).contains(&places) || !(-63..=-1).contains(&power) || whole >= 1 << 24 {
        return None;
    }
    let (above, shift) = (whole * POWERS[places as usize] as u64, power.unsigned_abs());
    let (quotient, half) = (above >> shift, 1 << (shift - 1));
    let rest = above - (quotient << shift);
    Some(quotient + u64::from(rest > half || (rest == half && quotient & 1 == 1)))
}

fn divided(above: u128, below: u128) -> u128 {
    let (quotient, rest) = (above / below, above % below);
    let other = below - rest;
    quotient + u128::from(rest > other || (rest == other && quotient & 1 == 1))
}

/// Significant digits of a number, and the power of ten of the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    digits: [u8; MOST_DIGITS],
    count: usize,
    /// The decimal exponent of the first digit.
    pub exponent: i32,
}

impl Digits {
    /// `count` significant digits (1 to [`MOST_DIGITS`]) of a finite number that is not negative; none when that takes more
    /// than 128 bits.
    pub fn of(a: f64, count: usize) -> Option<Digits> {
        if count == 0 || count > MOST_DIGITS {
            return None;
        }
        let mut out = Digits { digits: [b'0'; MOST_DIGITS], count, exponent: 0 };
        if a == 0.0 {
            return Some(out);
        }
        // log10 of the power of two: at most one too small, as the mantissa is below 2.
        let power_of_two = (a.to_bits() >> 52) as i32 - 1023;
        let mut exponent = (power_of_two * 78913) >> 18;
        let least = POWERS[count - 1];
        let mut value = rounded(a, count as i32 - 1 - exponent)?;
        if value >= 10 * least {
            // One digit too many; rounding the rounded number once more would be wrong.
            exponent += 1;
            value = rounded(a, count as i32 - 1 - exponent)?;
        }
        if value == 10 * least {
            exponent += 1;
            value = least;
        }
        out.exponent = exponent;
        let mut left = u64::try_from(value).ok()?;
        let mut pairs = out.digits[..count].rchunks_exact_mut(2);
        for pair in &mut pairs {
            let two = (left % 100) as u8;
            (pair[0], pair[1]) = (b'0' + two / 10, b'0' + two % 10);
            left /= 100;
        }
        if let [first] = pairs.into_remainder() {
            *first = b'0' + left as u8;
        }
        Some(out)
    }

    /// The digits, as text.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.digits[..self.count]).unwrap_or("")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The digits that the standard library gives.
    fn expected(a: f64, count: usize) -> (String, i32) {
        let text = format!("{a:.*e}", count - 1);
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        (digits.replace('.', ""), exponent.parse().unwrap_or(0))
    }

    fn floats() -> impl Iterator<Item = f64> {
        let mut state = 1u64;
        let random = (0..200_000).map(move |_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            f32::from_bits((state >> 33) as u32) as f64
        });
        // Ties and the ends of decades, where rounding is decided.
        let ties = (0..4000).map(|k| f64::from(k as f32 * 0.125));
        let ends =
            (-30..30).flat_map(|e| [0.999_999_9f32, 1.0, 9.999_999, 9.5, 4.5].map(|m| f64::from(m * 10f32.powi(e))));
        random.chain(ties).chain(ends).filter(|a| a.is_finite()).map(f64::abs)
    }

    #[test]
    fn digits_are_those_of_the_standard_library() {
        let mut held = 0;
        for a in floats() {
            for count in [1, 2, 6, 7, 9, 17] {
                let Some(digits) = Digits::of(a, count) else { continue };
                held += 1;
                let (text, exponent) = expected(a, count);
                assert_eq!((digits.text(), digits.exponent), (text.as_str(), exponent), "{a:e} to {count}");
            }
        }
        assert!(held > 600_000, "{held}");
        for a in [1e-9f32, 0.1, 1.0, 123.456, 1e9] {
            assert!(Digits::of(a.into(), 9).is_some(), "{a} takes the short way");
        }
    }

    #[test]
    fn fixed_places_are_those_of_the_standard_library() {
        for a in floats() {
            for places in [0, 1, 3, 6] {
                if let Some(value) = rounded(a, places) {
                    let text = format!("{a:.*}", places as usize).replace('.', "");
                    assert_eq!(value, text.parse().unwrap_or(u128::MAX), "{a:e} to {places}");
                }
            }
        }
    }
}
