//! Numbers and indices of OBJ and MTL files.

use super::flaw::LineFlaw;
use super::lines::shown;

/// A finite single.
///
/// # Errors
/// The word is no number, or none that a single can hold.
#[inline]
pub fn number(word: &[u8]) -> Result<f32, LineFlaw> {
    match short_decimal(word) {
        Some(value) => Ok(value),
        None => any_number(word),
    }
}

/// Digits with or without a sign and a point, few enough for an exact quotient: nearly all numbers of meshes. The same
/// single as by the standard library, in a third of its time.
#[inline]
fn short_decimal(word: &[u8]) -> Option<f32> {
    const TENS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        _ => (false, word),
    };
    // With the point, fifteen digits: less than 2^53.
    if digits.len() > 16 {
        return None;
    }
    let (mut whole, mut point, mut seen) = (0u64, None, 0);
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            (whole, seen) = (whole * 10 + u64::from(digit), seen + 1);
        } else if byte == b'.' && point.is_none() {
            point = Some(seen);
        } else {
            return None;
        }
    }
    if seen == 0 || seen > 15 {
        return None;
    }
    let exact = whole as f64 / TENS[point.map_or(0, |at| seen - at)];
    // Half way between two singles it matters on which side of it the quotient was rounded.
    if exact.to_bits() << 35 == 1 << 63 {
        return None;
    }
    let value = exact as f32;
    Some(if negative { -value } else { value })
}

fn any_number(word: &[u8]) -> Result<f32, LineFlaw> {
    match std::str::from_utf8(word).ok().and_then(|text| text.parse::<f32>().ok()) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(LineFlaw::NotFinite { word: shown(word) }),
        // What C's printf writes for no number.
        None if starts_as(word, b"nan") || starts_as(word, b"1.#") => Err(LineFlaw::NotFinite { word: shown(word) }),
        None => Err(LineFlaw::NotANumber { word: shown(word) }),
    }
}

/// True when a word begins, after its sign, with `start` in small or large letters.
fn starts_as(word: &[u8], start: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    word.get(..start.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(start))
}

/// The whole number that a word begins with, with or without a sign, and what follows it.
#[inline]
pub fn index(word: &[u8]) -> Option<(i64, &[u8])> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        _ => (false, word),
    };
    let (mut value, mut count) = (0i64, 0);
    while let Some(&byte) = digits.get(count)
        && byte.is_ascii_digit()
    {
        // Eighteen digits fit for certain.
        if count == 18 {
            return None;
        }
        value = value * 10 + i64::from(byte - b'0');
        count += 1;
    }
    (count > 0).then_some((if negative { -value } else { value }, &digits[count..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_finite_or_refused() {
        for (word, value) in [("1", 1.0), ("-.5", -0.5), ("+2.", 2.0), ("1e-3", 1e-3), ("1E+2", 100.0), ("1e-99", 0.0)]
        {
            assert_eq!(number(word.as_bytes()), Ok(value), "{word}");
        }
        for word in ["nan", "NaN", "-inf", "1e99", "-nan(ind)", "1.#QNAN", "-1.#IND"] {
            assert!(matches!(number(word.as_bytes()), Err(LineFlaw::NotFinite { .. })), "{word}");
        }
        for word in ["", "x", "1,5", "1f", "0x1", "--1", "\u{663}"] {
            assert!(matches!(number(word.as_bytes()), Err(LineFlaw::NotANumber { .. })), "{word}");
        }
    }

    #[test]
    fn short_decimals_are_the_singles_of_the_standard_library() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 11
        };
        // Half way between two singles, and one digit beside it.
        let mut words = vec!["16777217".to_owned(), "16777217.0".into(), "16777217.1".into(), "16777216.9".into()];
        for _ in 0..200_000 {
            let (digits, places) = ((next() % 10u64.pow(1 + (next() % 15) as u32)).to_string(), next() as usize % 16);
            let at = digits.len().saturating_sub(places);
            words.push(format!("{}.{}", &digits[..at], &digits[at..]));
        }
        for word in words.iter().filter(|word| *word != ".") {
            assert_eq!(number(word.as_bytes()), Ok(word.parse().unwrap()), "{word}");
        }
    }

    #[test]
    fn indices_are_whole_numbers() {
        let rest = |at: i64, rest: &'static str| Some((at, rest.as_bytes()));
        let long = "999999999999999999";
        let cases = [
            ("12", rest(12, "")),
            ("-7/3", rest(-7, "/3")),
            ("+3", rest(3, "")),
            (long, rest(999_999_999_999_999_999, "")),
        ];
        for (word, value) in cases {
            assert_eq!(index(word.as_bytes()), value);
        }
        assert_eq!(index(b"1.5"), rest(1, ".5"));
        for word in ["", "-", "a", "9999999999999999999"] {
            assert_eq!(index(word.as_bytes()), None, "{word}");
        }
    }
}
