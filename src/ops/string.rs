//! Strings: sequences of bytes, as in OSL, that print as text.

use std::borrow::Cow;

/// The text of some bytes; what is not UTF-8, as after a cut in the middle of a character, becomes the replacement character.
fn text(bytes: &[u8]) -> String {
    match String::from_utf8_lossy(bytes) {
        Cow::Borrowed(s) => s.to_owned(),
        Cow::Owned(s) => s,
    }
}

/// The length in bytes.
pub fn strlen(s: &str) -> i32 {
    i32::try_from(s.len()).unwrap_or(i32::MAX)
}

/// The byte at an index, as a signed char; 0 outside the string.
pub fn getchar(s: &str, index: i32) -> i32 {
    let byte = usize::try_from(index).ok().and_then(|i| s.as_bytes().get(i));
    byte.map_or(0, |b| *b as i8 as i32)
}

/// 1 when `s` begins with `prefix`, else 0.
pub fn startswith(s: &str, prefix: &str) -> i32 {
    s.starts_with(prefix) as i32
}

/// 1 when `s` ends with `suffix`, else 0.
pub fn endswith(s: &str, suffix: &str) -> i32 {
    s.ends_with(suffix) as i32
}

/// `length` bytes from `start` on; a negative start counts from the end; what lies outside the string is left out.
pub fn substr(s: &str, start: i32, length: i32) -> String {
    let count = s.len() as i64;
    let from = if start < 0 { start as i64 + count } else { start as i64 }.clamp(0, count);
    let to = (from + (length as i64).clamp(0, count)).min(count);
    text(&s.as_bytes()[from as usize..to as usize])
}

/// The two strings, one after the other.
pub fn concat(a: &str, b: &str) -> String {
    [a, b].concat()
}

/// The integer that a string begins with, after white space; 0 without one; saturates.
pub fn stoi(s: &str) -> i32 {
    let s = s.trim_start();
    let (negative, digits) = match s.as_bytes().first() {
        Some(b'-') => (true, &s[1..]),
        Some(b'+') => (false, &s[1..]),
        _ => (false, s),
    };
    let magnitude = digits
        .bytes()
        .take_while(u8::is_ascii_digit)
        .fold(0i64, |n, digit| (n * 10 + (digit - b'0') as i64).min(1 << 40));
    let signed = if negative { -magnitude } else { magnitude };
    signed.clamp(i32::MIN as i64, i32::MAX as i64) as i32
}

/// The float that a string begins with, after white space; 0 without one.
pub fn stof(s: &str) -> f32 {
    let s = s.trim_start();
    let mut end = s.bytes().take_while(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b)).count();
    // The longest beginning that is a number; Rust's grammar of floats is that of C without hexadecimal.
    while end > 0 {
        if let Ok(value) = s[..end].parse() {
            return value;
        }
        end -= 1;
    }
    0.0
}

/// The pieces of `s` between separators, at most `most` of them, the last one with all that is left.
///
/// An empty separator means runs of white space. A caller with an array of `n` strings passes at most `n`.
pub fn split<'s>(s: &'s str, separator: &str, most: i32) -> Vec<&'s str> {
    let most = usize::try_from(most).unwrap_or(0);
    if most == 0 || s.is_empty() {
        return Vec::new();
    }
    if !separator.is_empty() {
        return s.splitn(most, separator).collect();
    }
    let mut pieces = Vec::new();
    let mut rest = s.trim_start();
    while !rest.is_empty() {
        let end = if pieces.len() + 1 == most { None } else { rest.find(char::is_whitespace) };
        let (piece, tail) = rest.split_at(end.unwrap_or(rest.len()));
        pieces.push(piece);
        rest = tail.trim_start();
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_strings() {
        assert_eq!(strlen("grüß"), 6);
        assert_eq!(getchar("Ab", 1), 98);
        assert_eq!(getchar("Ab", 2), 0);
        assert_eq!(getchar("Ab", -1), 0);
        assert_eq!(getchar("ü", 0), -61);
        assert_eq!(substr("hello", 1, 3), "ell");
        assert_eq!(substr("hello", -3, 2), "ll");
        assert_eq!(substr("hello", -30, 2), "he");
        assert_eq!(substr("hello", 3, i32::MAX), "lo");
        assert_eq!(substr("hello", 9, 1), "");
        assert_eq!(substr("hello", 1, -1), "");
        assert_eq!(substr("", i32::MIN, i32::MIN), "");
        assert_eq!(substr("ü", 0, 1), "\u{fffd}");
        assert_eq!((startswith("abc", "ab"), startswith("abc", ""), startswith("a", "ab")), (1, 1, 0));
        assert_eq!((endswith("abc", "bc"), endswith("abc", ""), endswith("c", "bc")), (1, 1, 0));
        assert_eq!(concat("a", "b"), "ab");
    }

    #[test]
    fn numbers_from_strings() {
        assert_eq!((stoi("  -12abc"), stoi("+7"), stoi("x"), stoi("")), (-12, 7, 0, 0));
        assert_eq!((stoi("99999999999999999999"), stoi("-99999999999")), (i32::MAX, i32::MIN));
        assert_eq!((stof(" 3.5e2xyz"), stof("-.5"), stof("1e"), stof("abc")), (350.0, -0.5, 1.0, 0.0));
        assert_eq!(stof("1.2.3"), 1.2);
        assert_eq!(stof("inf"), f32::INFINITY);
    }

    #[test]
    fn split_keeps_the_rest_in_the_last_piece() {
        assert_eq!(split(" a  b c ", "", 9), ["a", "b", "c"]);
        assert_eq!(split("a b  c d", "", 2), ["a", "b  c d"]);
        assert_eq!(split("a,b,,c", ",", 9), ["a", "b", "", "c"]);
        assert_eq!(split("a,b,,c", ",", 2), ["a", "b,,c"]);
        assert_eq!(split("a", ",", 0), Vec::<&str>::new());
        assert_eq!(split("", "", 3), Vec::<&str>::new());
        assert_eq!(split("", ",", 3), Vec::<&str>::new());
    }
}
