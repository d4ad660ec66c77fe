//! A text by lines and UTF-16 units, as editors count.

use std::ops::Range;

/// A line and a column, both from 0; columns are UTF-16 units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// The line.
    pub line: u32,
    /// UTF-16 units before it on its line.
    pub column: u32,
}

/// A text and where its lines start. Lines end with `\n`, `\r\n` or `\r`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    text: String,
    starts: Vec<usize>,
}

impl Text {
    /// A text.
    pub fn new(text: impl Into<String>) -> Self {
        let text = text.into();
        let starts = starts(&text);
        Text { text, starts }
    }

    /// All of it.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// The bytes of a line, its end left out; nothing for a line that is not there.
    fn line(&self, line: u32) -> Option<Range<usize>> {
        let line = line as usize;
        let start = *self.starts.get(line)?;
        let end = self.starts.get(line + 1).copied().unwrap_or(self.text.len());
        let text = self.text[start..end].trim_end_matches(['\r', '\n']);
        Some(start..start + text.len())
    }

    /// The byte of a position. Beyond the end of a line it is that end, beyond the last line the end of the text, and between the two
    /// halves of a character its start.
    pub fn offset(&self, position: Position) -> usize {
        let Some(line) = self.line(position.line) else { return self.text.len() };
        let mut left = position.column as usize;
        for (at, c) in self.text[line.clone()].char_indices() {
            if left < c.len_utf16() {
                return line.start + at;
            }
            left -= c.len_utf16();
        }
        line.end
    }

    /// The position of a byte; that of the character it belongs to, and for one between `\r` and `\n` the end of the line.
    pub fn position(&self, offset: usize) -> Position {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        let range = self.line(line as u32).unwrap_or(0..0);
        let before = &self.text[range.start..offset.min(range.end).max(range.start)];
        Position { line: line as u32, column: before.encode_utf16().count() as u32 }
    }

    /// Puts a text in place of what lies between two positions, in whichever order they are.
    pub fn replace(&mut self, from: Position, to: Position, new: &str) {
        let (from, to) = (self.offset(from), self.offset(to));
        self.text.replace_range(from.min(to)..from.max(to), new);
        self.starts = starts(&self.text);
    }
}

fn starts(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let ends = |at: usize| match bytes[at] {
        b'\n' => true,
        b'\r' => bytes.get(at + 1) != Some(&b'\n'),
        _ => false,
    };
    std::iter::once(0).chain((0..bytes.len()).filter(|at| ends(*at)).map(|at| at + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, column: u32) -> Position {
        Position { line, column }
    }

    #[test]
    fn columns_are_utf_16_units() {
        let text = Text::new("a\u{1f9f5}é\tb\r\nc\rd\n");
        for (position, offset) in [
            (at(0, 0), 0),
            (at(0, 1), 1),
            (at(0, 3), 5),
            (at(0, 4), 7),
            (at(0, 5), 8),
            (at(0, 6), 9),
            (at(1, 0), 11),
            (at(1, 1), 12),
            (at(2, 0), 13),
            (at(2, 1), 14),
            (at(3, 0), 15),
        ] {
            assert_eq!((text.offset(position), text.position(offset)), (offset, position));
        }
        // Inside a character, beyond a line, beyond the text, between the halves of a line's end.
        assert_eq!((text.offset(at(0, 2)), text.position(3)), (1, at(0, 1)));
        assert_eq!((text.offset(at(0, 99)), text.offset(at(9, 0))), (9, 15));
        assert_eq!(text.position(10), at(0, 6));
    }

    #[test]
    fn replaced_ranges_may_be_turned_around_and_cross_lines() {
        let mut text = Text::new("one\r\ntwo\r\nthree");
        text.replace(at(2, 1), at(0, 2), "\u{1f9f5}");
        assert_eq!(text, Text::new("on\u{1f9f5}hree"));
        text.replace(at(0, 0), at(7, 7), "");
        assert_eq!((text.as_str(), text.position(0), text.offset(at(0, 5))), ("", at(0, 0), 0));
    }
}
