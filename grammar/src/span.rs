//! Spans: where a piece of syntax came from, in a form small enough to copy everywhere.
//!
//! A span names a range of *expanded* tokens, after macros and includes. [`crate::Sources`] turns it into files,
//! lines and columns, so a span of a macro's body still leads to the line that called the macro.

/// A range of expanded tokens, `first..=last`. [`Span::NONE`] points nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// Index of the first token.
    pub first: u32,
    /// Index of the last token, inclusive.
    pub last: u32,
}

impl Span {
    /// A span that points nowhere (for what the compiler makes up itself).
    pub const NONE: Span = Span { first: u32::MAX, last: u32::MAX };

    /// The smallest span that covers both.
    pub fn to(self, other: Span) -> Span {
        if self == Span::NONE {
            return other;
        }
        if other == Span::NONE {
            return self;
        }
        Span { first: self.first.min(other.first), last: self.last.max(other.last) }
    }
}
