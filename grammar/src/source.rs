//! The source map: the files that were read, and where every expanded token came from.
//!
//! A [`Span`] counts expanded tokens. Each remembers where it is *spelled* and, when a macro made it, the call. A call
//! remembers where the macro's name stood, and the call that this name itself came out of. Following that chain to
//! its end gives the place in the text that the user wrote, which is where a message points first. A file remembers
//! the place of the `#include` that read it.

use crate::span::Span;
use std::sync::Arc;

/// Marks a token that no macro made.
pub(crate) const NO_CALL: u32 = u32::MAX;

/// The file that holds text made by the preprocessor: pasted names and strings made by `#`.
pub(crate) const SCRATCH: u32 = 0;

/// A range of bytes in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Index of the file.
    pub file: u32,
    /// The first byte.
    pub start: u32,
    /// The byte after the last one.
    pub end: u32,
}

/// One reading of a file. A file that is included twice is there twice; the text is shared.
#[derive(Clone, Debug)]
pub(crate) struct SourceFile {
    /// The name for messages.
    pub name: Arc<str>,
    /// The text.
    pub text: Arc<str>,
    /// The byte at which each line starts.
    pub line_starts: Arc<[u32]>,
    /// The `#include` that read it.
    pub included_from: Option<Place>,
}

impl SourceFile {
    /// A file and its line table.
    pub(crate) fn new(name: &str, text: Arc<str>, included_from: Option<Place>) -> Self {
        let after = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i as u32 + 1);
        let line_starts = std::iter::once(0).chain(after).collect();
        SourceFile { name: name.into(), text, line_starts, included_from }
    }

    /// The line of a byte, counted from 0.
    pub(crate) fn line(&self, byte: u32) -> usize {
        self.line_starts.partition_point(|start| *start <= byte) - 1
    }

    /// The bytes of a line, its newline included.
    pub(crate) fn line_range(&self, line: usize) -> Option<std::ops::Range<usize>> {
        let start = *self.line_starts.get(line)? as usize;
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |next| *next as usize);
        Some(start..end)
    }
}

/// One expanded token.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expanded {
    /// Where it is spelled.
    pub place: Place,
    /// The macro call it came out of, or [`NO_CALL`].
    pub call: u32,
    /// White space stands before it.
    pub space: bool,
    /// It is no token of the program but only a place that a message points at, as in a directive.
    pub aside: bool,
}

/// One call of a macro.
#[derive(Clone, Debug)]
pub(crate) struct MacroCall {
    /// The macro.
    pub name: Arc<str>,
    /// Where its name stood.
    pub place: Place,
    /// The call that this name came out of, or [`NO_CALL`].
    pub parent: u32,
    /// Where the macro is defined.
    pub defined: Option<Place>,
}

/// A place for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The name of the file.
    pub file: String,
    /// The line, from 1.
    pub line: u32,
    /// The column in characters, from 1.
    pub column: u32,
}

/// The files, tokens and calls while they are being gathered.
#[derive(Clone, Debug)]
pub(crate) struct SourceTable {
    pub files: Vec<SourceFile>,
    pub expanded: Vec<Expanded>,
    pub calls: Vec<MacroCall>,
    pub scratch: String,
    /// Lines, by file and from 0, of which no warnings are wanted: those after `#pragma osl nowarn`.
    pub quiet: Vec<(u32, usize)>,
}

impl SourceTable {
    /// A table with nothing but the scratch file.
    pub(crate) fn new() -> Self {
        let scratch = SourceFile::new("<made by macros>", Arc::from(""), None);
        SourceTable {
            files: vec![scratch],
            expanded: Vec::new(),
            calls: Vec::new(),
            scratch: String::new(),
            quiet: Vec::new(),
        }
    }

    /// The text of a place.
    pub(crate) fn text(&self, place: Place) -> &str {
        let text = if place.file == SCRATCH { &self.scratch } else { &*self.files[place.file as usize].text };
        text.get(place.start as usize..place.end as usize).unwrap_or("")
    }

    /// Puts made-up text into the scratch file.
    pub(crate) fn invent(&mut self, text: &str) -> Place {
        let start = self.scratch.len() as u32;
        self.scratch.push_str(text);
        self.scratch.push('\n');
        Place { file: SCRATCH, start, end: start + text.len() as u32 }
    }

    /// A span for a place that no token of the program has.
    pub(crate) fn aside(&mut self, place: Place, call: u32) -> Span {
        let index = self.expanded.len() as u32;
        self.expanded.push(Expanded { place, call, space: true, aside: true });
        Span { first: index, last: index }
    }

    /// The place in the user's text: that of the outermost macro call.
    pub(crate) fn outermost(&self, mut place: Place, mut call: u32) -> Place {
        while let Some(c) = self.calls.get(call as usize) {
            (place, call) = (c.place, c.parent);
        }
        place
    }

    /// The finished map.
    pub(crate) fn finish(mut self) -> Sources {
        let text = Arc::from(std::mem::take(&mut self.scratch));
        self.files[SCRATCH as usize] = SourceFile::new("<made by macros>", text, None);
        Sources { table: Arc::new(self) }
    }
}

/// The finished source map: turns a [`Span`] into files, lines and columns. Cloning it is cheap.
#[derive(Clone, Debug)]
pub struct Sources {
    pub(crate) table: Arc<SourceTable>,
}

impl Sources {
    /// The names of the files that were read, each once, in order; the first is the one that was asked for unless a header goes
    /// before it.
    pub fn files(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for file in self.table.files.iter().skip(1) {
            if !names.contains(&&*file.name) {
                names.push(&file.name);
            }
        }
        names
    }
}

impl Default for Sources {
    fn default() -> Self {
        SourceTable::new().finish()
    }
}

impl Sources {
    /// Where a span starts: for a token out of a macro, where the outermost macro call stands.
    pub fn locate(&self, span: Span) -> Option<Location> {
        let token = self.token(span.first)?;
        Some(self.location(self.table.outermost(token.place, token.call)))
    }

    /// Is a warning at this place unwanted, by `#pragma osl nowarn` on the line before?
    pub fn is_quiet(&self, span: Span) -> bool {
        let Some(token) = self.token(span.first) else { return false };
        let place = self.table.outermost(token.place, token.call);
        let line = self.table.files[place.file as usize].line(place.start);
        self.table.quiet.contains(&(place.file, line))
    }

    /// The text of the tokens of a span, after macros, with one space wherever the text had any.
    pub fn text(&self, span: Span) -> String {
        let mut out = String::new();
        if self.token(span.first).is_none() {
            return out;
        }
        let last = (span.last as usize).min(self.table.expanded.len() - 1);
        for token in &self.table.expanded[span.first as usize..=last.max(span.first as usize)] {
            if token.aside && span.first != span.last {
                continue;
            }
            if token.space && !out.is_empty() {
                out.push(' ');
            }
            out.push_str(self.spelling(token.place));
        }
        out
    }

    /// The expanded token of an index.
    pub(crate) fn token(&self, index: u32) -> Option<&Expanded> {
        self.table.expanded.get(index as usize)
    }

    /// The text of a place.
    pub(crate) fn spelling(&self, place: Place) -> &str {
        let text = &self.table.files[place.file as usize].text;
        text.get(place.start as usize..place.end as usize).unwrap_or("")
    }

    /// File, line and column of a place.
    pub(crate) fn location(&self, place: Place) -> Location {
        let file = &self.table.files[place.file as usize];
        let line = file.line(place.start);
        let start = file.line_starts[line] as usize;
        let column = file.text.get(start..place.start as usize).map_or(0, |s| s.chars().count());
        Location { file: file.name.to_string(), line: line as u32 + 1, column: column as u32 + 1 }
    }
}
