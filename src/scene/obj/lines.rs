//! The lines of OBJ and MTL files as bytes, and their words.

use std::borrow::Cow;

/// The lines of a text, each with its number from 1. A line that ends in `\` and has no comment goes on in the next one.
///
/// Line ends are those of Unix, of Windows and of the old Macintosh; a byte order mark is no part of the first line.
pub struct Lines<'t> {
    rest: &'t [u8],
    number: u32,
}

impl<'t> Lines<'t> {
    /// The lines of `text`.
    pub fn new(text: &'t [u8]) -> Self {
        Lines { rest: text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text), number: 0 }
    }

    /// One line of the file, without its end.
    #[inline]
    fn physical(&mut self) -> Option<&'t [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number = self.number.saturating_add(1);
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, after) = self.rest.split_at(end);
        self.rest = match after {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => &[],
        };
        Some(line)
    }

    /// The rest of a line that ends in `\`.
    #[cold]
    fn go_on(&mut self, first: &'t [u8]) -> Vec<u8> {
        let mut whole = first.to_vec();
        while whole.last() == Some(&b'\\') {
            whole.pop();
            // The mark parts words, as a space does.
            whole.push(b' ');
            match self.physical() {
                Some(next) => whole.extend_from_slice(next.trim_ascii_end()),
                None => break,
            }
        }
        whole
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (u32, Cow<'t, [u8]>);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let line = self.physical()?;
        let number = self.number;
        let trimmed = line.trim_ascii();
        match trimmed.last() {
            Some(b'\\') if !trimmed.contains(&b'#') => Some((number, Cow::Owned(self.go_on(trimmed)))),
            _ => Some((number, Cow::Borrowed(trimmed))),
        }
    }
}

/// The words of a line, up to a comment.
#[derive(Clone)]
pub struct Words<'l> {
    rest: &'l [u8],
}

impl<'l> Words<'l> {
    /// The words of `line`.
    pub fn new(line: &'l [u8]) -> Self {
        Words { rest: line }
    }

    /// What is left of the line as one name, which may have spaces in it; a comment begins at a `#` after a space.
    pub fn name(self) -> String {
        let rest = self.rest.trim_ascii();
        let comment = (0..rest.len()).find(|&i| rest[i] == b'#' && (i == 0 || is_space(rest[i - 1])));
        text(rest[..comment.unwrap_or(rest.len())].trim_ascii())
    }
}

impl<'l> Iterator for Words<'l> {
    type Item = &'l [u8];

    #[inline]
    fn next(&mut self) -> Option<&'l [u8]> {
        let start = self.rest.iter().position(|&b| !is_space(b))?;
        let rest = &self.rest[start..];
        if rest[0] == b'#' {
            self.rest = &[];
            return None;
        }
        let end = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

#[inline]
fn is_space(b: u8) -> bool {
    b == b' ' || b == b'\t' || b == b'\x0b' || b == b'\x0c'
}

/// Bytes as text: UTF-8, or else Latin-1.
pub fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}

/// A word for a message: its beginning, without control characters.
pub fn shown(word: &[u8]) -> String {
    let whole = text(&word[..word.len().min(200)]);
    let mut short: String = whole.chars().filter(|c| !c.is_control()).take(32).collect();
    if short.len() < whole.len() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(u32, String)> {
        Lines::new(text).map(|(number, line)| (number, super::text(&line))).collect()
    }

    #[test]
    fn lines_end_as_on_every_system_and_go_on_after_a_backslash() {
        let found = lines(b"\xef\xbb\xbfa\nb\r\nc\rd \\\n e \\\r\nf\n# g \\\nh\\");
        let expected = [(1, "a"), (2, "b"), (3, "c"), (4, "d   e  f"), (7, "# g \\"), (8, "h ")];
        assert_eq!(found, expected.map(|(number, line)| (number, line.to_owned())));
        assert!(lines(b"").is_empty());
    }

    #[test]
    fn words_end_at_a_comment_and_names_keep_a_sign_inside() {
        let words: Vec<&[u8]> = Words::new(b"f 1 \t2 3#4 # 5 6").collect();
        assert_eq!(words, [b"f".as_slice(), b"1", b"2", b"3#4"]);
        let name = |line: &[u8]| {
            let mut words = Words::new(line);
            words.next();
            words.name()
        };
        assert_eq!(name(b"usemtl  red wool#2  # the second"), "red wool#2");
        assert_eq!(name(b"usemtl gr\xfcn"), "gr\u{fc}n", "Latin-1");
        assert_eq!(name("usemtl gr\u{fc}n".as_bytes()), "gr\u{fc}n", "UTF-8");
        assert_eq!(name(b"usemtl"), "");
        assert_eq!(shown(b"a\x1bb"), "ab\u{2026}");
    }
}
