//! A text in pieces: tokens as written, comments and directives, each with what stood before it.

use crate::preprocessor::scan::{Kind, PpToken, scan};
use std::collections::HashSet;

/// Columns from one tab stop to the next, and of one step of indentation.
pub(super) const STEP: usize = 4;

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// A token of the program.
    Token(Kind),
    /// `// …`
    LineComment,
    /// `/* … */`
    BlockComment,
    /// A line that the preprocessor obeys, with the lines it goes on over and its comments.
    Directive,
}

/// A piece of text with its surroundings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'t> {
    /// What it is.
    pub piece: Piece,
    /// As written.
    pub text: &'t str,
    /// Ends of lines before it.
    pub newlines: usize,
    /// White space before it.
    pub space: bool,
    /// Columns of white space before it that draw it into line with a token above or below; 0 for none.
    pub drawn: usize,
    /// Its column in the text, from 0, tabs counted to their stops.
    pub column: usize,
}

/// The column after a text that begins at a column.
pub(super) fn advanced(column: usize, text: &str) -> usize {
    text.chars().fold(column, |column, c| match c {
        '\n' => 0,
        '\t' => (column / STEP + 1) * STEP,
        _ => column + 1,
    })
}

/// Cuts a text, whose lines end with `\n`, into its parts; and the macros that make a string of an argument, as the spaces in their
/// arguments count.
pub(super) fn parts(text: &str) -> (Vec<Part<'_>>, HashSet<&str>) {
    let tokens = scan(text, 0);
    let mut cutter = Cutter {
        text,
        at: 0,
        ended: 0,
        measured: 0,
        column: 0,
        newlines: 0,
        space: false,
        line: 0,
        places: Vec::new(),
        out: Vec::new(),
    };
    let (mut i, mut quoting) = (0, HashSet::new());
    while let Some(token) = tokens.get(i) {
        let start = token.place.start as usize;
        cutter.gap(start);
        if !(token.line_start && token.kind == Kind::Hash) {
            cutter.push(Piece::Token(token.kind), start, token.place.end as usize);
            i += 1;
            continue;
        }
        let rest = &tokens[i + 1..];
        let length = rest.iter().position(|t| t.line_start).unwrap_or(rest.len());
        let line = &rest[..length];
        quoting.extend(quoting_macro(text, line));
        let last = line.last().unwrap_or(token).place.end as usize;
        let next = rest.get(length).map_or(text.len(), |t| t.place.start as usize);
        cutter.push(Piece::Directive, start, end_of_line(text, last, next));
        i += 1 + length;
    }
    cutter.gap(text.len());
    let mut parts = cutter.out;
    draw(&mut parts, &cutter.places);
    (parts, quoting)
}

/// Keeps only those wide spaces that draw their token into line.
fn draw(parts: &mut [Part<'_>], places: &[(usize, usize)]) {
    for (part, (line, column)) in parts.iter_mut().zip(places) {
        let there = |line: usize| places.binary_search(&(line, *column)).is_ok();
        if part.drawn < 2 || !(there(line + 1) || line.checked_sub(1).is_some_and(there)) {
            part.drawn = 0;
        }
    }
}

/// The name of the macro that a directive defines, when its body has `#`.
fn quoting_macro<'t>(text: &'t str, line: &[PpToken]) -> Option<&'t str> {
    let spelled = |token: &PpToken| &text[token.place.start as usize..token.place.end as usize];
    let (word, rest) = line.split_first()?;
    let (name, body) = rest.split_first()?;
    let quotes = spelled(word) == "define" && body.iter().any(|token| token.kind == Kind::Hash);
    quotes.then(|| spelled(name))
}

/// Where the line ends that goes on after a token; comments belong to it.
fn end_of_line(text: &str, from: usize, most: usize) -> usize {
    let (mut at, mut end) = (from, from);
    while at < most {
        let rest = &text[at..most];
        if let Some(length) = comment_length(rest) {
            at += length;
            end = at;
        } else if rest.starts_with('\n') {
            break;
        } else if let Some(length) = joint_length(rest) {
            at += length;
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    end
}

/// The length of a comment that a text begins with.
fn comment_length(rest: &str) -> Option<usize> {
    if let Some(inner) = rest.strip_prefix("/*") {
        return Some(inner.find("*/").map_or(rest.len(), |end| end + 4));
    }
    if !rest.starts_with("//") {
        return None;
    }
    let bytes = rest.as_bytes();
    let mut at = 2;
    while at < bytes.len() && bytes[at] != b'\n' {
        at += joint_length(&rest[at..]).unwrap_or_else(|| rest[at..].chars().next().map_or(1, char::len_utf8));
    }
    Some(at)
}

/// The length of a backslash and the end of a line, with which a text may begin.
fn joint_length(rest: &str) -> Option<usize> {
    ["\\\n", "\\\r\n"].iter().find(|joint| rest.starts_with(**joint)).map(|joint| joint.len())
}

struct Cutter<'t> {
    text: &'t str,
    /// How far the text has been cut.
    at: usize,
    /// The end of the last part.
    ended: usize,
    /// How far columns have been counted, and the column there.
    measured: usize,
    column: usize,
    newlines: usize,
    space: bool,
    line: usize,
    /// Line and column of each part.
    places: Vec<(usize, usize)>,
    out: Vec<Part<'t>>,
}

impl<'t> Cutter<'t> {
    /// Goes over white space and comments.
    fn gap(&mut self, end: usize) {
        while self.at < end {
            let rest = &self.text[self.at..end];
            if let Some(length) = comment_length(rest) {
                let piece = if rest.starts_with("//") { Piece::LineComment } else { Piece::BlockComment };
                self.push(piece, self.at, self.at + length);
            } else if let Some(length) = joint_length(rest) {
                self.newlines += 1;
                self.at += length;
            } else {
                let c = rest.chars().next().unwrap_or('\n');
                self.newlines += usize::from(c == '\n');
                self.space = true;
                self.at += c.len_utf8();
            }
        }
    }

    fn push(&mut self, piece: Piece, start: usize, end: usize) {
        let before = advanced(self.column, &self.text[self.measured..self.ended]);
        self.line += self.text[self.measured..start].matches('\n').count();
        self.column = advanced(before, &self.text[self.ended..start]);
        self.measured = start;
        let (newlines, space) = (self.newlines, self.space);
        let drawn = if newlines == 0 { self.column.saturating_sub(before) } else { 0 };
        self.places.push((self.line, self.column));
        self.out.push(Part { piece, text: &self.text[start..end], newlines, space, drawn, column: self.column });
        (self.at, self.ended, self.newlines, self.space) = (end, end, 0, false);
    }
}
