//! What can be wrong with an OBJ file.

use std::fmt;

/// What a corner of a face has an index for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// The variants say all there is to say.
#[allow(missing_docs)]
#[non_exhaustive]
pub enum Attribute {
    Position,
    Uv,
    Normal,
}

impl Attribute {
    /// The statement that gives one.
    pub fn statement(self) -> &'static str {
        match self {
            Attribute::Position => "v",
            Attribute::Uv => "vt",
            Attribute::Normal => "vn",
        }
    }
}

/// What is wrong with one line.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LineFlaw {
    /// A number is missing.
    TooFewNumbers {
        /// The statement.
        statement: &'static str,
        /// How many numbers there are.
        found: usize,
        /// How many it needs.
        needed: usize,
    },
    /// A word that should be a number.
    NotANumber {
        /// The word.
        word: String,
    },
    /// A number that is infinite, too large for a single, or no number.
    NotFinite {
        /// As written.
        word: String,
    },
    /// A corner of a face that is no index.
    NotAnIndex {
        /// As written.
        word: String,
    },
    /// An index of something that is not there.
    OutOfRange {
        /// Of what.
        attribute: Attribute,
        /// As written.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// A face with fewer than three corners.
    TooFewCorners {
        /// How many it has.
        count: usize,
    },
    /// A face with more corners than can be cut to triangles in good time.
    TooManyCorners {
        /// How many it has.
        count: usize,
        /// The most there may be.
        most: usize,
    },
    /// More vertices or corners than 32 bits can count.
    TooMuch,
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ObjFlaw {
    /// There is no text in it.
    NotText,
    /// One line is wrong.
    Line {
        /// The line, from 1.
        line: u32,
        /// What is wrong.
        flaw: LineFlaw,
    },
}

impl fmt::Display for LineFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LineFlaw::TooFewNumbers { statement, found, needed } => {
                let were = if *found == 1 { "number" } else { "numbers" };
                write!(f, "`{statement}` has {found} {were}, {needed} are needed")
            }
            LineFlaw::NotANumber { word } => write!(f, "`{word}` is not a number"),
            LineFlaw::NotFinite { word } => write!(f, "`{word}` is not a finite number"),
            LineFlaw::NotAnIndex { word } => write!(f, "`{word}` is not an index; write V, V/T, V//N or V/T/N"),
            LineFlaw::OutOfRange { index: 0, .. } => {
                f.write_str("an index is 0; the first vertex is 1, the last one -1")
            }
            LineFlaw::OutOfRange { attribute, index, count } => {
                let statement = attribute.statement();
                write!(f, "a face names `{statement}` {index}; there are {count}")
            }
            LineFlaw::TooFewCorners { count } => {
                let were = if *count == 1 { "corner" } else { "corners" };
                write!(f, "a face has {count} {were}, three are needed")
            }
            LineFlaw::TooManyCorners { count, most } => {
                write!(f, "a face has {count} corners, {most} are the most; cut it to smaller ones")
            }
            LineFlaw::TooMuch => f.write_str("there are more than 4,294,967,294 vertices or corners up to here"),
        }
    }
}

impl fmt::Display for ObjFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ObjFlaw::NotText => f.write_str("it is not text, so it is no OBJ file"),
            ObjFlaw::Line { line, flaw } => write!(f, "line {line}: {flaw}"),
        }
    }
}
