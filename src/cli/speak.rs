//! How text reaches people: the only place that prints.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// True once standard output did not take what was printed.
static LOST: AtomicBool = AtomicBool::new(false);

/// True once standard output is a picture's, so that text goes elsewhere.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// Characters of a line of a message that are shown.
const LINE: usize = 4000;

/// Leaves standard output to a picture: what else is said goes to standard error.
pub fn leave_output() {
    TAKEN.store(true, Ordering::Relaxed);
}

/// Prints to standard output, without control characters. A pipe that closes early is no reason to complain; a full disk is, at the end.
pub fn say(text: &str) {
    say_as_it_is(visible(text).as_bytes());
}

/// The same for text that is data, such as the output of the preprocessor.
pub fn say_as_it_is(text: &[u8]) {
    if TAKEN.load(Ordering::Relaxed) {
        let _ = std::io::stderr().write_all(text);
        return;
    }
    let mut out = std::io::stdout();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => LOST.store(true, Ordering::Relaxed),
        _ => {}
    }
}

/// Did standard output lose what was printed?
pub fn lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

/// Prints to standard error, without control characters and without the ends of endless lines.
pub fn tell(text: &str) {
    let _ = std::io::stderr().write_all(shortened(&visible(text)).as_bytes());
}

/// The text with control characters as people read them: a terminal would obey those of a shader. Colors are ours, and stay where
/// messages have them.
fn visible(text: &str) -> Cow<'_, str> {
    let plain = |c: char| matches!(c, '\n' | '\t') || !(c.is_control() || is_hidden(c));
    if text.chars().all(plain) {
        return Cow::Borrowed(text);
    }
    let colors = colored();
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let color = if colors && c == '\u{1b}' { color_length(rest) } else { 0 };
        if color > 0 {
            out.push_str(&rest[..color]);
            rest = &rest[color..];
            continue;
        }
        rest = &rest[c.len_utf8()..];
        match c {
            '\r' if rest.starts_with('\n') => {}
            c if plain(c) => out.push(c),
            c => out.extend(c.escape_unicode()),
        }
    }
    Cow::Owned(out)
}

/// Marks that turn the direction of the text after them.
fn is_hidden(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The bytes of an escape that sets colors, if a text begins with one.
fn color_length(text: &str) -> usize {
    let Some(numbers) = text.strip_prefix("\u{1b}[") else { return 0 };
    match numbers.find(|c: char| !(c.is_ascii_digit() || c == ';')) {
        Some(end) if numbers[end..].starts_with('m') => end + 3,
        _ => 0,
    }
}

/// The text with lines of at most [`LINE`] characters.
fn shortened(text: &str) -> Cow<'_, str> {
    if text.split('\n').all(|line| line.len() <= LINE) {
        return Cow::Borrowed(text);
    }
    let short = |line: &str| match line.char_indices().nth(LINE) {
        Some((end, _)) => format!("{} ... and {} bytes more", &line[..end], line.len() - end),
        None => line.to_owned(),
    };
    Cow::Owned(text.split('\n').map(short).collect::<Vec<_>>().join("\n"))
}

/// True when messages may be coloured.
pub fn colored() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(visible("a\tb\r\nc"), "a\tb\nc");
        assert_eq!(visible("\u{1b}]0;x\u{7}\u{9b}2J\rz\u{202e}"), "\\u{1b}]0;x\\u{7}\\u{9b}2J\\u{d}z\\u{202e}");
        assert_eq!(color_length("\u{1b}[1;31mred"), 7);
        assert_eq!((color_length("\u{1b}[2J"), color_length("\u{1b}[0")), (0, 0));
        assert_eq!(shortened("short\n"), "short\n");
        assert_eq!(shortened(&"x".repeat(LINE + 3)), "x".repeat(LINE) + " ... and 3 bytes more");
    }
}
