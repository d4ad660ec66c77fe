//! `format` and `printf`: conversions of C, applied to every element of an aggregate.
//!
//! A conversion that does not fit its argument is an error for the checker. At run time it is mended the way OSL mends it:
//! integers print as %d, floats as %f, strings and closures as %s.

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
        Some(letter) if "diouxXcfFeEgGs".contains(letter) => {
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

/// The text of a format with its arguments.
pub fn format(format: &str, args: &[FormatArg]) -> Result<String, FormatError> {
    let mut out = String::new();
    let mut args = args.iter();
    let mut rest = format;
    while !rest.is_empty() {
        let (piece, tail) = next_piece(rest)?;
        rest = tail;
        match piece {
            Piece::Text(text) => out.push_str(text),
            Piece::Conversion(c) => append(&mut out, c, args.next().ok_or(FormatError::TooFewArguments)?),
        }
    }
    if args.next().is_some() { Err(FormatError::TooManyArguments) } else { Ok(out) }
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

/// Fills a field: `sign` stays in front of padding zeros.
fn pad(out: &mut String, c: Conversion, zeros: bool, sign: &str, body: &str) {
    let missing = match c.width {
        0 => 0,
        width => width.saturating_sub(sign.chars().count() + body.chars().count()),
    };
    let fill = |out: &mut String, with: char| out.extend(std::iter::repeat_n(with, missing));
    let zeros = zeros && c.zero && !c.left;
    if !c.left && !zeros {
        fill(out, ' ');
    }
    out.push_str(sign);
    if zeros {
        fill(out, '0');
    }
    out.push_str(body);
    if c.left {
        fill(out, ' ');
    }
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
    pad(out, c, false, "", &s[..end]);
}

fn integer(out: &mut String, c: Conversion, value: i32) {
    let (sign, digits) = match c.letter {
        'x' => (if c.alternate && value != 0 { "0x" } else { "" }, format!("{value:x}")),
        'X' => (if c.alternate && value != 0 { "0X" } else { "" }, format!("{value:X}")),
        'o' => (if c.alternate && value != 0 { "0" } else { "" }, format!("{value:o}")),
        'u' => ("", (value as u32).to_string()),
        _ => (sign_of(c, value < 0), value.unsigned_abs().to_string()),
    };
    let digits = match c.precision {
        Some(0) if value == 0 => String::new(),
        Some(least) => format!("{digits:0>least$}"),
        None => digits,
    };
    pad(out, c, c.precision.is_none(), sign, &digits);
}

fn float(out: &mut String, c: Conversion, value: f64) {
    let sign = sign_of(c, value.is_sign_negative());
    let a = value.abs();
    let upper = c.letter.is_ascii_uppercase();
    if !a.is_finite() {
        let name = if a.is_nan() { "nan" } else { "inf" };
        return pad(out, c, false, sign, &if upper { name.to_uppercase() } else { name.to_owned() });
    }
    let precision = c.precision.unwrap_or(6);
    let body = match c.letter.to_ascii_lowercase() {
        'e' => exponential(a, precision, c.alternate),
        'g' => general(a, precision.max(1), c.alternate),
        _ => fixed(a, precision, c.alternate),
    };
    pad(out, c, true, sign, &if upper { body.to_uppercase() } else { body });
}

fn fixed(a: f64, precision: usize, alternate: bool) -> String {
    let point = if alternate && precision == 0 { "." } else { "" };
    format!("{a:.precision$}{point}")
}

/// Mantissa digits and decimal exponent of `a`, rounded.
fn scientific(a: f64, precision: usize) -> (String, i32) {
    let mut text = format!("{a:.precision$e}");
    let Some(end) = text.find('e') else { return (text, 0) };
    let exponent = text[end + 1..].parse().unwrap_or(0);
    text.truncate(end);
    (text, exponent)
}

fn with_exponent(mantissa: &str, exponent: i32) -> String {
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.unsigned_abs())
}

fn exponential(a: f64, precision: usize, alternate: bool) -> String {
    let (mantissa, exponent) = scientific(a, precision);
    let point = if alternate && precision == 0 { "." } else { "" };
    with_exponent(&format!("{mantissa}{point}"), exponent)
}

/// The shorter of the other two, with `precision` significant digits and no zeros at the end unless asked for.
fn general(a: f64, precision: usize, alternate: bool) -> String {
    let (mantissa, exponent) = scientific(a, precision - 1);
    let with_power = exponent < -4 || exponent >= precision as i32;
    let mut text = if with_power { mantissa } else { shifted(&mantissa, exponent) };
    let pointed = text.contains('.');
    if alternate && !with_power && !pointed {
        text.push('.');
    } else if !alternate && pointed {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if with_power { with_exponent(&text, exponent) } else { text }
}

/// The digits of a mantissa with the point where the exponent puts it, which has as many digits as the exact value rounded there.
fn shifted(mantissa: &str, exponent: i32) -> String {
    let digits = mantissa.bytes().filter(|&digit| digit != b'.').map(char::from);
    let mut out = String::with_capacity(mantissa.len() + 8);
    if exponent < 0 {
        out.push_str("0.");
        out.extend(std::iter::repeat_n('0', -exponent as usize - 1));
        out.extend(digits);
        return out;
    }
    let whole = exponent as usize + 1;
    for (at, digit) in digits.enumerate() {
        if at == whole {
            out.push('.');
        }
        out.push(digit);
    }
    out
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
            FormatKind::Float => ("fFeEgGc".contains(c.letter), "%f, %g, or %e"),
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
