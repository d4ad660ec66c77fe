//! `format` and `printf`: conversions of C, applied to every element of an aggregate.
//!
//! A conversion that does not fit its argument is an error for the checker. At run time it is mended the way OSL mends it:
//! integers print as %d, floats as %f, strings and closures as %s.

use super::decimal::{Digits, rounded};
use smallvec::SmallVec;
use std::fmt::Write;

/// An argument, with all its elements: a triple has three, an array as many as it is long times those of its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormatArg<'a> {
    /// Integers.
    Int(&'a [i32]),
    /// Floats, also those of triples and matrices.
    Float(&'a [f32]),
    /// Strings.
    Str(&'a [&'a str]),
    /// The text of a closure.
    Closure(&'a str),
}

/// What a checker knows of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatKind {
    /// Integers.
    Int,
    /// Floats, triples, matrices.
    Float,
    /// Strings.
    Str,
    /// A closure.
    Closure,
}

/// Why a text could not be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FormatError {
    /// A conversion has no argument left.
    TooFewArguments,
    /// Arguments are left over.
    TooManyArguments,
    /// A percent sign begins no conversion that there is.
    UnknownConversion(String),
}

/// The widest field and longest precision; a shader must not ask for a text of gigabytes.
const WIDEST: usize = 4096;

/// A conversion such as `%-8.3f`.
#[derive(Clone, Copy, Debug, Default)]
struct Conversion {
    left: bool,
    plus: bool,
    space: bool,
    alternate: bool,
    zero: bool,
    width: usize,
    precision: Option<usize>,
    letter: char,
}

/// A piece of a format.
#[derive(Clone, Copy, Debug)]
enum Piece<'a> {
    Text(&'a str),
    Conversion(Conversion),
}

/// Cuts the next piece off a format that is not empty.
fn next_piece(format: &str) -> Result<(Piece<'_>, &str), FormatError> {
    let Some(spec) = format.strip_prefix('%') else {
        let end = format.find('%').unwrap_or(format.len());
        return Ok((Piece::Text(&format[..end]), &format[end..]));
    };
    if let Some(rest) = spec.strip_prefix('%') {
        return Ok((Piece::Text("%"), rest));
    }
    let mut c = Conversion::default();
    let mut rest = spec;
    while let Some(flag) = rest.chars().next().filter(|c| "-+ #0".contains(*c)) {
        match flag {
            '-' => c.left = true,
            '+' => c.plus = true,
            ' ' => c.space = true,
            '#' => c.alternate = true,
            _ => c.zero = true,
        }
        rest = &rest[1..];
    }
    (c.width, rest) = number(rest);
    if let Some(after) = rest.strip_prefix('.') {
        let (precision, after) = number(after);
        c.precision = Some(precision);
        rest = after;
    }
    // The length modifiers of C mean nothing here.
    rest = rest.trim_start_matches(['h', 'l']);
    match rest.chars().next() {
        Some(letter) if "diouxXcfFeEgGspvnm".contains(letter) => {
            c.letter = letter;
            Ok((Piece::Conversion(c), &rest[1..]))
        }
        other => Err(FormatError::UnknownConversion(other.map_or("%".to_owned(), |c| format!("%{c}")))),
    }
}

fn number(s: &str) -> (usize, &str) {
    let end = s.find(|c: char| !c.is_ascii_digit()).unwrap_or(s.len());
    let value = s[..end].bytes().fold(0, |n: usize, d| (n * 10 + (d - b'0') as usize).min(WIDEST));
    (value, &s[end..])
}

/// A format that was read: shaders use one for every lane of a batch.
#[derive(Debug)]
pub struct Format<'a> {
    pieces: SmallVec<[Piece<'a>; 8]>,
}

impl<'a> Format<'a> {
    /// Reads a format; only its conversions can be wrong.
    pub fn read(format: &'a str) -> Result<Self, FormatError> {
        let (mut pieces, mut rest) = (SmallVec::new(), format);
        while !rest.is_empty() {
            let (piece, tail) = next_piece(rest)?;
            pieces.push(piece);
            rest = tail;
        }
        Ok(Format { pieces })
    }

    /// Appends the text of the format with its arguments.
    pub fn write(&self, out: &mut String, args: &[FormatArg]) -> Result<(), FormatError> {
        let mut args = args.iter();
        for piece in &self.pieces {
            match piece {
                Piece::Text(text) => out.push_str(text),
                Piece::Conversion(c) => append(out, *c, args.next().ok_or(FormatError::TooFewArguments)?),
            }
        }
        if args.next().is_some() { Err(FormatError::TooManyArguments) } else { Ok(()) }
    }
}

/// The text of a format with its arguments.
pub fn format(format: &str, args: &[FormatArg]) -> Result<String, FormatError> {
    let mut out = String::new();
    Format::read(format)?.write(&mut out, args)?;
    Ok(out)
}

/// Appends all elements of an argument, single spaces between them.
fn append(out: &mut String, c: Conversion, arg: &FormatArg) {
    match arg {
        FormatArg::Int(values) => each(out, values, |out, value| integer(out, c, *value)),
        FormatArg::Float(values) => each(out, values, |out, value| float(out, c, *value as f64)),
        FormatArg::Str(values) => each(out, values, |out, value| string(out, c, value)),
        FormatArg::Closure(text) => string(out, c, text),
    }
}

fn each<T>(out: &mut String, values: &[T], mut write: impl FnMut(&mut String, &T)) {
    for (at, value) in values.iter().enumerate() {
        if at > 0 {
            out.push(' ');
        }
        write(out, value);
    }
}

/// Widens to its field what was written from `start` on: `sign` bytes of it stay in front of padding zeros.
fn pad(out: &mut String, c: Conversion, zeros: bool, start: usize, sign: usize) {
    if c.width == 0 {
        return;
    }
    let missing = c.width.saturating_sub(out[start..].chars().count());
    let zeros = zeros && c.zero && !c.left;
    let (at, with) = match (c.left, zeros) {
        (true, _) => (out.len(), " "),
        (false, true) => (start + sign, "0"),
        (false, false) => (start, " "),
    };
    out.insert_str(at, &with.repeat(missing));
}

fn sign_of(c: Conversion, negative: bool) -> &'static str {
    match (negative, c.plus, c.space) {
        (true, ..) => "-",
        (_, true, _) => "+",
        (.., true) => " ",
        _ => "",
    }
}

fn string(out: &mut String, c: Conversion, s: &str) {
    // Precision counts bytes in C; a character is never cut in two here.
    let mut end = c.precision.unwrap_or(s.len()).min(s.len());
    while !s.is_char_boundary(end) {
        end -= 1;
    }
    let start = out.len();
    out.push_str(&s[..end]);
    pad(out, c, false, start, 0);
}

fn integer(out: &mut String, c: Conversion, value: i32) {
    let sign = match c.letter {
        'x' if c.alternate && value != 0 => "0x",
        'X' if c.alternate && value != 0 => "0X",
        'o' if c.alternate && value != 0 => "0",
        'x' | 'X' | 'o' | 'u' => "",
        _ => sign_of(c, value < 0),
    };
    let start = out.len();
    out.push_str(sign);
    let digits = out.len();
    // Writing into a text cannot fail.
    let _ = match c.letter {
        _ if value == 0 && c.precision == Some(0) => Ok(()),
        'x' => write!(out, "{value:x}"),
        'X' => write!(out, "{value:X}"),
        'o' => write!(out, "{value:o}"),
        'u' => write!(out, "{}", value as u32),
        _ => write!(out, "{}", value.unsigned_abs()),
    };
    let missing = c.precision.unwrap_or(0).saturating_sub(out.len() - digits);
    if missing > 0 {
        out.insert_str(digits, &"0".repeat(missing));
    }
    pad(out, c, c.precision.is_none(), start, sign.len());
}

fn float(out: &mut String, c: Conversion, value: f64) {
    let start = out.len();
    // Which sign a not-a-number has is defined nowhere.
    let sign = sign_of(c, value.is_sign_negative() && !value.is_nan());
    let a = value.abs();
    out.push_str(sign);
    let precision = c.precision.unwrap_or(6);
    match c.letter.to_ascii_lowercase() {
        _ if a.is_nan() => out.push_str("nan"),
        _ if a.is_infinite() => out.push_str("inf"),
        'e' => exponential(out, a, precision, c.alternate),
        'g' => general(out, a, precision.max(1), c.alternate),
        _ => fixed(out, a, precision, c.alternate),
    }
    if c.letter.is_ascii_uppercase() {
        out[start..].make_ascii_uppercase();
    }
    pad(out, c, a.is_finite(), start, sign.len());
}

fn fixed(out: &mut String, a: f64, precision: usize, alternate: bool) {
    match rounded(a, precision as i32).and_then(|value| u64::try_from(value).ok()) {
        Some(value) if precision <= 17 => {
            let power = 10u64.pow(precision as u32);
            let _ = write!(out, "{}", value / power);
            if precision > 0 {
                let _ = write!(out, ".{:0precision$}", value % power);
            }
        }
        _ => {
            let _ = write!(out, "{a:.precision$}");
        }
    }
    if alternate && precision == 0 {
        out.push('.');
    }
}

/// Appends significant digits of `a`, rounded and without a point, and gives the decimal exponent of the first.
fn significant(out: &mut String, a: f64, count: usize) -> i32 {
    if let Some(digits) = Digits::of(a, count) {
        out.push_str(digits.text());
        return digits.exponent;
    }
    let text = format!("{a:.*e}", count - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    out.extend(mantissa.chars().filter(|c| *c != '.'));
    exponent.parse().unwrap_or(0)
}

fn push_exponent(out: &mut String, exponent: i32) {
    let _ = write!(out, "e{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.unsigned_abs());
}

fn exponential(out: &mut String, a: f64, precision: usize, alternate: bool) {
    let start = out.len();
    let exponent = significant(out, a, precision + 1);
    if precision > 0 || alternate {
        out.insert(start + 1, '.');
    }
    push_exponent(out, exponent);
}

/// The shorter of the other two, with `precision` significant digits and no zeros at the end unless asked for.
fn general(out: &mut String, a: f64, precision: usize, alternate: bool) {
    let start = out.len();
    let exponent = significant(out, a, precision);
    let with_power = exponent < -4 || exponent >= precision as i32;
    if !alternate {
        let kept = out[start + 1..].trim_end_matches('0').len();
        out.truncate(start + 1 + kept);
    }
    let digits = out.len() - start;
    if !with_power && exponent < 0 {
        // The exponent is -4 at least, or it would be written.
        out.insert_str(start, &"0.000"[..1 + exponent.unsigned_abs() as usize]);
        return;
    }
    let whole = if with_power { 1 } else { exponent as usize + 1 };
    out.extend(std::iter::repeat_n('0', whole.saturating_sub(digits)));
    if digits > whole || alternate && !with_power {
        out.insert(start + whole, '.');
    }
    if with_power {
        push_exponent(out, exponent);
    }
}

/// Checks a format against the kinds of its arguments; `first` is the number by which the message calls the first of them.
///
/// The messages are those of OSL's compiler and begin after the name of the function.
pub fn check_format(format: &str, kinds: &[FormatKind], first: usize) -> Result<(), String> {
    const MISMATCH: &str = "has mismatched format string and arguments";
    let mut rest = format;
    let mut used = 0;
    while !rest.is_empty() {
        let (piece, tail) = next_piece(rest).map_err(|e| match e {
            FormatError::UnknownConversion(c) => format!("has the unknown conversion '{c}' in its format string"),
            _ => MISMATCH.to_owned(),
        })?;
        rest = tail;
        let Piece::Conversion(c) = piece else { continue };
        let kind = kinds.get(used).ok_or_else(|| format!("{MISMATCH} (not enough args)"))?;
        let (fits, needs) = match kind {
            FormatKind::Int => ("diouxX".contains(c.letter), "%d, %i, %o, %x, or %X"),
            // OSL takes the first letters of its types too, and writes numbers.
            FormatKind::Float => ("fFeEgGcpvnm".contains(c.letter), "%f, %g, or %e"),
            FormatKind::Str | FormatKind::Closure => (c.letter == 's', "%s"),
        };
        if !fits {
            return Err(format!("{MISMATCH} (arg {} needs {needs})", first + used));
        }
        used += 1;
    }
    if used < kinds.len() { Err(format!("{MISMATCH} (too many args)")) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::FormatArg::*;
    use super::*;

    fn f(spec: &str, value: f32) -> String {
        format(spec, &[Float(&[value])]).unwrap_or_default()
    }

    fn d(spec: &str, value: i32) -> String {
        format(spec, &[Int(&[value])]).unwrap_or_default()
    }

    #[test]
    fn floats_print_as_in_c() {
        assert_eq!(f("%f", 1.5), "1.500000");
        assert_eq!(f("%.0f", 2.5), "2");
        assert_eq!(f("%8.3f|", -1.0), "  -1.000|");
        assert_eq!(f("%-8.2f|", 1.0), "1.00    |");
        assert_eq!(f("%08.3f", -1.5), "-001.500");
        assert_eq!(f("%+g", 1.0), "+1");
        assert_eq!(f("%g", 0.1), "0.1");
        assert_eq!(f("%g", 100000.0), "100000");
        assert_eq!(f("%g", 1000000.0), "1e+06");
        assert_eq!(f("%g", 0.0001), "0.0001");
        assert_eq!(f("%g", 0.00001), "1e-05");
        assert_eq!(f("%g", 1234567.0), "1.23457e+06");
        assert_eq!(f("%g", 999999.5), "1e+06");
        assert_eq!(f("%g", 0.0), "0");
        assert_eq!(f("%g", -0.0), "-0");
        assert_eq!(f("%#g", 1.0), "1.00000");
        assert_eq!(f("%.3g", 1.23456), "1.23");
        assert_eq!(f("%e", 12345.678), "1.234568e+04");
        assert_eq!(f("%.2E", 0.00012), "1.20E-04");
        assert_eq!(f("%G", 1e10), "1E+10");
        assert_eq!(f("%g", f32::INFINITY), "inf");
        assert_eq!(f("%06.1f", f32::NEG_INFINITY), "  -inf");
        assert_eq!(f("%f", f32::NAN), "nan");
        assert_eq!(f("%4g", -f32::NAN), " nan");
        assert_eq!(f("%d", 1.0), "1.000000");
    }

    #[test]
    fn integers_print_as_in_c() {
        assert_eq!(d("%d", -5), "-5");
        assert_eq!(d("%5d|%%", 42), "   42|%");
        assert_eq!(d("%-5i|", 42), "42   |");
        assert_eq!(d("%05d", -42), "-0042");
        assert_eq!(d("%.4d", 42), "0042");
        assert_eq!(d("%x", -1), "ffffffff");
        assert_eq!(d("%#X", 255), "0XFF");
        assert_eq!(d("%#08x", 255), "0x0000ff");
        assert_eq!(d("%o", 8), "10");
        assert_eq!(d("%u", -1), "4294967295");
        assert_eq!(d("%f", 3), "3");
        assert_eq!(d("%d", i32::MIN), "-2147483648");
        assert_eq!(d("%99999999999d", 1).len(), WIDEST);
    }

    #[test]
    fn aggregates_print_every_element() {
        assert_eq!(format("<%g>", &[Float(&[1.0, 2.0, 3.5])]).as_deref(), Ok("<1 2 3.5>"));
        assert_eq!(format("%d %s", &[Int(&[1, 2]), Str(&["a", "b"])]).as_deref(), Ok("1 2 a b"));
        assert_eq!(
            format("%s", &[Closure("(1, 1, 1) * diffuse ((0, 0, 1))")]).as_deref(),
            Ok("(1, 1, 1) * diffuse ((0, 0, 1))")
        );
        assert_eq!(
            format("%6s|%-6s|%.2s", &[Str(&["ab"]), Str(&["ab"]), Str(&["abc"])]).as_deref(),
            Ok("    ab|ab    |ab")
        );
    }

    #[test]
    fn mistakes_are_named() {
        assert_eq!(format("%d", &[]), Err(FormatError::TooFewArguments));
        assert_eq!(format("x", &[Int(&[1])]), Err(FormatError::TooManyArguments));
        assert_eq!(format("%y", &[Int(&[1])]), Err(FormatError::UnknownConversion("%y".into())));
        assert_eq!(format("%", &[]), Err(FormatError::UnknownConversion("%".into())));
        assert_eq!(format("ü%ü", &[]), Err(FormatError::UnknownConversion("%ü".into())));
    }

    #[test]
    fn the_check_says_what_is_needed() {
        use FormatKind::*;
        assert_eq!(check_format("%d %g %s %s", &[Int, Float, Str, Closure], 2), Ok(()));
        let says = |format, kinds: &[FormatKind], text: &str| {
            assert!(check_format(format, kinds, 2).is_err_and(|e| e.ends_with(text)), "{format}: {text}");
        };
        says("%d", &[Float], "(arg 2 needs %f, %g, or %e)");
        says("%s %s", &[Str, Int], "(arg 3 needs %d, %i, %o, %x, or %X)");
        says("%g", &[Str], "(arg 2 needs %s)");
        says("%g", &[], "(not enough args)");
        says("%%", &[Int], "(too many args)");
        says("%q", &[Int], "unknown conversion '%q' in its format string");
    }
}
