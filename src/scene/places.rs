//! Where a byte of a scene's text is, by line and column, found in the same time wherever it is.

use super::error::Place;
use std::sync::Arc;

/// A text with the places that lookups start from: every line, and every so many bytes of a long one.
///
/// Decision (2026-11-29): an index made in one pass, instead of the XML parser's own lookup, which counts from the start of
/// the text: 16,000 spheres took 5 s to load, nearly all of it spent on their places.
#[derive(Debug)]
pub struct Places<'t> {
    file: Arc<str>,
    text: &'t str,
    marks: Vec<Mark>,
}

/// A byte whose place is known.
#[derive(Clone, Copy, Debug)]
struct Mark {
    offset: usize,
    line: u32,
    column: u32,
}

/// Bytes from one mark of a line to the next.
const STEP: usize = 256;

impl<'t> Places<'t> {
    /// The places of `text`, which is in `file`.
    pub fn new(file: &Arc<str>, text: &'t str) -> Self {
        let mut marks = vec![Mark { offset: 0, line: 1, column: 1 }];
        let mut last = marks[0];
        let (mut line, mut column) = (1u32, 1u32);
        for (offset, &byte) in text.as_bytes().iter().enumerate() {
            if offset >= last.offset + STEP && is_start(byte) {
                last = Mark { offset, line, column };
                marks.push(last);
            }
            column = column.saturating_add(u32::from(is_start(byte)));
            if byte == b'\n' {
                (line, column) = (line.saturating_add(1), 1);
                last = Mark { offset: offset + 1, line, column };
                marks.push(last);
            }
        }
        Places { file: file.clone(), text, marks }
    }

    /// The place of a byte; beyond the end it is the end's.
    pub fn at(&self, offset: usize) -> Place {
        let offset = offset.min(self.text.len());
        let after = self.marks.partition_point(|mark| mark.offset <= offset);
        let mark = self.marks[after.saturating_sub(1)];
        let between = &self.text.as_bytes()[mark.offset..offset];
        let column = mark.column + between.iter().filter(|&&byte| is_start(byte)).count() as u32;
        Place { file: self.file.clone(), line: mark.line, column }
    }
}

/// True for a byte that begins a character.
fn is_start(byte: u8) -> bool {
    byte & 0xc0 != 0x80
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_where_counting_finds_it() {
        let long = "\u{e9}x".repeat(700);
        let text = format!("<a>\n\n{long}\u{20ac}</a>\r\n{long}\n");
        let places = Places::new(&"f".into(), &text);
        for (offset, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let before = &text[..offset];
            let line = before.matches('\n').count() as u32 + 1;
            let column = before.chars().rev().take_while(|c| *c != '\n').count() as u32 + 1;
            let place = places.at(offset);
            assert_eq!((place.line, place.column), (line, column), "{offset}");
        }
        assert_eq!(places.at(usize::MAX), places.at(text.len()));
    }
}
