//! The source map as editors read it: ranges of bytes in files, the tokens as written, and where macros and includes lead.

use crate::lexer;
use crate::preprocessor::scan::{self, Kind};
use crate::source::{NO_CALL, Place, SCRATCH, SourceFile, Sources};
use crate::span::Span;

/// A range of bytes in a file that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextRange {
    /// The number of the file, see [`Sources::name_of`].
    pub file: u32,
    /// The first byte.
    pub start: u32,
    /// The byte after the last one.
    pub end: u32,
}

/// The number of the file that was asked for.
pub const MAIN_FILE: u32 = 1;

/// A call of a macro.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MacroUse<'s> {
    /// The macro.
    pub name: &'s str,
    /// Where its name stands.
    pub place: TextRange,
    /// Where it is defined; nothing for what is built in or given by options.
    pub defined: Option<TextRange>,
}

/// What kind of thing a token of a text is, before anything is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RawKind {
    /// A name or a keyword.
    Name,
    /// A number.
    Number,
    /// A string, closed or not.
    Text,
    /// An operator, a bracket, or anything else.
    Sign,
}

/// A token of a text as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawToken {
    /// What it is.
    pub kind: RawKind,
    /// The first byte.
    pub start: usize,
    /// The byte after the last one.
    pub end: usize,
    /// It is part of a line that the preprocessor obeys.
    pub directive: bool,
}

/// The tokens of a text as written: nothing is expanded or left out but comments.
pub fn raw_tokens(text: &str) -> Vec<RawToken> {
    let mut directive = false;
    let token = |token: scan::PpToken| {
        if token.line_start {
            directive = token.kind == Kind::Hash;
        }
        let kind = match token.kind {
            Kind::Name => RawKind::Name,
            Kind::Number => RawKind::Number,
            Kind::Text | Kind::UnclosedText => RawKind::Text,
            _ => RawKind::Sign,
        };
        RawToken { kind, start: token.place.start as usize, end: token.place.end as usize, directive }
    };
    scan::scan(text, MAIN_FILE).into_iter().map(token).collect()
}

/// May a text be the name of a variable or function? Keywords and words that OSL keeps for itself may not.
pub fn is_free_name(text: &str) -> bool {
    let tokens = raw_tokens(text);
    let name = matches!(&tokens[..], [one] if one.kind == RawKind::Name && one.end - one.start == text.len());
    name && !lexer::is_taken(text)
}

impl Sources {
    /// The name of a file by its number: that of the file that was asked for is [`MAIN_FILE`]. A file that was read twice has two.
    pub fn name_of(&self, file: u32) -> &str {
        self.table.files.get(file as usize).map_or("", |file| &file.name)
    }

    /// The text of a file.
    pub fn text_of(&self, file: u32) -> &str {
        self.table.files.get(file as usize).map_or("", |file| &file.text)
    }

    /// The same places in another text of the file that was asked for, which has as many bytes: that of its author, where it was parsed
    /// with a slip mended.
    pub fn in_text(mut self, text: &str) -> Sources {
        let table = std::sync::Arc::make_mut(&mut self.table);
        if let Some(file) = table.files.get_mut(MAIN_FILE as usize).filter(|file| file.text.len() == text.len()) {
            *file = SourceFile::new(&file.name, text.into(), file.included_from);
        }
        self
    }

    /// Is this the text that macros make, which stands in no file?
    pub fn is_made(&self, file: u32) -> bool {
        file == SCRATCH
    }

    /// The `#include`s of a file: the place of each name, and the number of the file that it read.
    pub fn includes_of(&self, file: u32) -> Vec<(TextRange, u32)> {
        let files = self.table.files.iter().zip(0..);
        let included = files.filter_map(|(read, number)| read.included_from.map(|place| (range(place), number)));
        included.filter(|(place, _)| place.file == file).collect()
    }

    /// Where a span stands in a file: for what a macro made, where it is called. Nothing when it stands nowhere.
    pub fn written(&self, span: Span) -> Option<TextRange> {
        let outermost = |index| self.token(index).map(|t| self.table.outermost(t.place, t.call));
        let first = outermost(span.first)?;
        let last = outermost(span.last).unwrap_or(first);
        let joined = last.file == first.file && last.end >= first.end;
        Some(range(Place { end: if joined { last.end } else { first.end }, ..first }))
    }

    /// The place in the main file that led to another place: that of an `#include` in it.
    pub fn in_main(&self, mut place: TextRange) -> Option<TextRange> {
        // A file is read after the one that includes it, so this ends.
        while place.file != MAIN_FILE {
            place = range(self.table.files.get(place.file as usize)?.included_from?);
        }
        Some(place)
    }

    /// Where an expanded token is spelled, which may be the body of a macro.
    pub fn spelled(&self, token: u32) -> Option<TextRange> {
        self.token(token).filter(|token| !token.aside).map(|token| range(token.place))
    }

    /// The first expanded token that ends where a place ends, for people: what a macro made ends with its call.
    pub fn token_at(&self, place: TextRange) -> Option<u32> {
        let ends = |token: u32| {
            let written = self.written(Span { first: token, last: token });
            written.is_some_and(|there| there.file == place.file && there.end == place.end)
        };
        (0..self.token_count()).find(|token| self.token(*token).is_some_and(|token| !token.aside) && ends(*token))
    }

    /// Did a macro make an expanded token?
    pub fn is_expanded(&self, token: u32) -> bool {
        self.token(token).is_some_and(|token| token.call != NO_CALL)
    }

    /// The text of an expanded token.
    pub fn token_text(&self, token: u32) -> &str {
        self.token(token).map_or("", |token| self.spelling(token.place))
    }

    /// How many expanded tokens there are.
    pub fn token_count(&self) -> u32 {
        self.table.expanded.len() as u32
    }

    /// The token of a span that spells a name: parentheses around it belong to the span.
    pub fn name_token(&self, span: Span, name: &str) -> Option<u32> {
        if span == Span::NONE {
            return None;
        }
        (span.first..=span.last)
            .find(|index| self.token(*index).is_some_and(|t| !t.aside && self.spelling(t.place) == name))
    }

    /// All calls of macros.
    pub fn macro_uses(&self) -> impl Iterator<Item = MacroUse<'_>> {
        let calls = self.table.calls.iter();
        calls.map(|call| MacroUse { name: &call.name, place: range(call.place), defined: call.defined.map(range) })
    }
}

fn range(place: Place) -> TextRange {
    TextRange { file: place.file, start: place.start, end: place.end }
}
