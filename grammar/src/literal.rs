//! The values of literals: integers, floats and strings.

/// What a number's text stands for.
#[derive(Debug, PartialEq)]
pub(crate) enum Number {
    /// An integer that fits.
    Int(i32),
    /// 2^31 in decimal, which wraps around; behind a minus it is the least integer.
    Wrapped(i32),
    /// An integer that does not fit.
    TooLarge,
    /// A float.
    Float(f32),
    /// A float that rounds to infinity.
    Infinite(f32),
    /// No number.
    Malformed,
}

/// Reads a number. Hexadecimal integers use all 32 bits.
pub(crate) fn number(text: &str) -> Number {
    if let Some(hex) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        return match u64::from_str_radix(hex, 16) {
            Ok(value) => u32::try_from(value).map_or(Number::TooLarge, |v| Number::Int(v as i32)),
            Err(_) if !hex.is_empty() && hex.bytes().all(|b| b.is_ascii_hexdigit()) => Number::TooLarge,
            Err(_) => Number::Malformed,
        };
    }
    if text.bytes().all(|b| b.is_ascii_digit()) {
        return match text.parse::<u64>() {
            Ok(value) if value <= i32::MAX as u64 => Number::Int(value as i32),
            Ok(0x8000_0000) => Number::Wrapped(i32::MIN),
            _ => Number::TooLarge,
        };
    }
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b".eE+-".contains(&b));
    match text.parse::<f32>() {
        Ok(value) if plain && value.is_infinite() => Number::Infinite(value),
        Ok(value) if plain => Number::Float(value),
        _ => Number::Malformed,
    }
}

/// Resolves the escapes between the quotes of a string literal. Each unknown escape is handed to `unknown` as its
/// range of bytes in `text` and then stands for the character after the backslash.
pub(crate) fn string(text: &str, mut unknown: impl FnMut(usize, usize)) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.char_indices().peekable();
    while let Some((start, c)) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        let Some((at, c)) = chars.next() else { break };
        match c {
            'n' => out.push('\n'),
            't' => out.push('\t'),
            'r' => out.push('\r'),
            'a' => out.push('\u{7}'),
            'b' => out.push('\u{8}'),
            'f' => out.push('\u{c}'),
            'v' => out.push('\u{b}'),
            '\\' | '"' | '\'' | '?' => out.push(c),
            // A line that goes on: both characters vanish.
            '\n' => {}
            '\r' => drop(chars.next_if(|(_, c)| *c == '\n')),
            '0'..='7' => out.push(code(&mut chars, c.to_digit(8).unwrap_or(0), 8, 2)),
            'x' if chars.peek().is_some_and(|(_, c)| c.is_ascii_hexdigit()) => out.push(code(&mut chars, 0, 16, 2)),
            _ => {
                unknown(start, at + c.len_utf8());
                out.push(c);
            }
        }
    }
    out
}

/// A character by its number: at most `most` more digits.
fn code(chars: &mut std::iter::Peekable<std::str::CharIndices<'_>>, first: u32, radix: u32, most: usize) -> char {
    let mut value = first;
    for _ in 0..most {
        let Some((_, digit)) = chars.next_if(|(_, c)| c.is_digit(radix)) else {
            break;
        };
        value = value * radix + digit.to_digit(radix).unwrap_or(0);
    }
    char::from(value as u8)
}
