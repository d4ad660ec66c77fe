//! Text to preprocessing tokens: the only place where bytes are looked at.
//!
//! White space and comments leave only two flags behind: whether something stood before a token, and whether the
//! token is the first of its line. A backslash at the end of a line joins it with the next one, between tokens and
//! inside strings and line comments.

use crate::source::{NO_CALL, Place};

/// The kinds of preprocessing token. Keywords are names here: macros may be called like keywords.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // `symbol` has the spellings
pub enum Kind {
    Name,
    Number,
    Text,
    UnclosedText,
    UnclosedComment,
    Hash,
    Paste,
    Ellipsis,
    ParenOpen,
    ParenClose,
    BracketOpen,
    BracketClose,
    MetaOpen,
    BraceOpen,
    BraceClose,
    Semicolon,
    Comma,
    Dot,
    Question,
    Colon,
    Plus,
    Minus,
    Star,
    Slash,
    Percent,
    Shl,
    Shr,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    EqualEqual,
    NotEqual,
    And,
    Caret,
    Pipe,
    AndAnd,
    OrOr,
    Not,
    Tilde,
    Increment,
    Decrement,
    Assign,
    AddAssign,
    SubAssign,
    MulAssign,
    DivAssign,
    AndAssign,
    OrAssign,
    XorAssign,
    ShlAssign,
    ShrAssign,
    /// A character that starts no token.
    Stray,
    /// Text for which a message has been reported.
    Broken,
}

/// A preprocessing token.
#[derive(Clone, Copy, Debug)]
pub struct PpToken {
    /// What it is.
    pub kind: Kind,
    /// White space or a comment stands before it.
    pub space: bool,
    /// It is the first token of its line.
    pub line_start: bool,
    /// A macro name that must never be expanded again, because it came out of its own expansion.
    pub painted: bool,
    /// Where it is spelled.
    pub place: Place,
    /// The macro call it came out of, or [`NO_CALL`].
    pub call: u32,
}

/// All tokens of a text.
pub fn scan(text: &str, file: u32) -> Vec<PpToken> {
    let bytes = text.as_bytes();
    let mut tokens = Vec::with_capacity(text.len() / 4);
    let (mut line_start, mut previous_end, mut at) = (true, 0, 0);
    while at < bytes.len() {
        let rest = &bytes[at..];
        if rest[0] == b'\n' {
            line_start = true;
            at += 1;
            continue;
        }
        let skipped = skipped(rest);
        if skipped > 0 {
            at += skipped;
            continue;
        }
        let (kind, length) = token(rest);
        let place = Place { file, start: at as u32, end: (at + length) as u32 };
        tokens.push(PpToken { kind, space: at > previous_end, line_start, painted: false, place, call: NO_CALL });
        line_start = false;
        at += length;
        previous_end = at;
    }
    tokens
}

/// The length of the white space, joined line or comment that bytes begin with; 0 for none.
fn skipped(bytes: &[u8]) -> usize {
    match bytes {
        [b' ' | b'\t' | b'\r' | 0x0b | 0x0c, ..] => 1,
        // The mark that some editors write in front of a text.
        [0xef, 0xbb, 0xbf, ..] => 3,
        [b'\\', rest @ ..] => newline(rest).map_or(0, |length| 1 + length),
        [b'/', b'/', rest @ ..] => 2 + run(rest, b'\n'),
        [b'/', b'*', rest @ ..] => rest.windows(2).position(|pair| pair == b"*/").map_or(0, |end| end + 4),
        _ => 0,
    }
}

/// The length of the line end that bytes begin with.
fn newline(bytes: &[u8]) -> Option<usize> {
    match bytes {
        [b'\n', ..] => Some(1),
        [b'\r', b'\n', ..] => Some(2),
        _ => None,
    }
}

/// The length of what a string or line comment holds: up to `end`, a line end or the end of the text. A backslash takes
/// the character or line end after it along.
fn run(bytes: &[u8], end: u8) -> usize {
    let mut at = 0;
    while at < bytes.len() && bytes[at] != end && bytes[at] != b'\n' {
        at += match &bytes[at..] {
            [b'\\', rest @ ..] => match (newline(rest), rest.first()) {
                (Some(length), _) => 1 + length,
                (None, None | Some(b'\r')) => break,
                // The bytes after the first of a longer character end nothing.
                (None, Some(_)) => 2,
            },
            _ => 1,
        };
    }
    at
}

/// The token that bytes begin with, and its length.
fn token(bytes: &[u8]) -> (Kind, usize) {
    let word = |from: usize, dot: bool| {
        let belongs = |c: &u8| c.is_ascii_alphanumeric() || *c == b'_' || (dot && *c == b'.');
        from + bytes[from..].iter().take_while(|c| belongs(c)).count()
    };
    match bytes {
        [b'a'..=b'z' | b'A'..=b'Z' | b'_', ..] => (Kind::Name, word(1, false)),
        [b'0'..=b'9', ..] | [b'.', b'0'..=b'9', ..] => {
            let digits = bytes.iter().take_while(|c| c.is_ascii_digit() || **c == b'.').count();
            let exponent = match &bytes[digits..] {
                [b'e' | b'E', b'0'..=b'9', ..] => 2,
                [b'e' | b'E', b'+' | b'-', b'0'..=b'9', ..] => 3,
                _ => 0,
            };
            // What hangs on a number belongs to it, so that a message can show all of `1.5f` or `3rd`.
            (Kind::Number, word(digits + exponent, true))
        }
        [b'"', rest @ ..] => {
            let inside = run(rest, b'"');
            let closed = rest.get(inside) == Some(&b'"');
            if closed { (Kind::Text, inside + 2) } else { (Kind::UnclosedText, inside + 1) }
        }
        [b'/', b'*', ..] => (Kind::UnclosedComment, bytes.len()),
        _ => symbol(bytes).unwrap_or((Kind::Stray, character(bytes[0]))),
    }
}

/// The length of the character of UTF-8 that begins with a byte.
fn character(first: u8) -> usize {
    match first {
        0xf0.. => 4,
        0xe0.. => 3,
        0xc0.. => 2,
        _ => 1,
    }
}

/// The operator or bracket that bytes begin with, and its length: the longest there is.
fn symbol(bytes: &[u8]) -> Option<(Kind, usize)> {
    Some(match bytes {
        [b'.', b'.', b'.', ..] => (Kind::Ellipsis, 3),
        [b'<', b'<', b'=', ..] => (Kind::ShlAssign, 3),
        [b'>', b'>', b'=', ..] => (Kind::ShrAssign, 3),
        [b'#', b'#', ..] => (Kind::Paste, 2),
        [b'[', b'[', ..] => (Kind::MetaOpen, 2),
        [b'<', b'<', ..] => (Kind::Shl, 2),
        [b'>', b'>', ..] => (Kind::Shr, 2),
        [b'<', b'=', ..] => (Kind::LessEqual, 2),
        [b'>', b'=', ..] => (Kind::GreaterEqual, 2),
        [b'=', b'=', ..] => (Kind::EqualEqual, 2),
        [b'!', b'=', ..] => (Kind::NotEqual, 2),
        [b'&', b'&', ..] => (Kind::AndAnd, 2),
        [b'|', b'|', ..] => (Kind::OrOr, 2),
        [b'+', b'+', ..] => (Kind::Increment, 2),
        [b'-', b'-', ..] => (Kind::Decrement, 2),
        [b'+', b'=', ..] => (Kind::AddAssign, 2),
        [b'-', b'=', ..] => (Kind::SubAssign, 2),
        [b'*', b'=', ..] => (Kind::MulAssign, 2),
        [b'/', b'=', ..] => (Kind::DivAssign, 2),
        [b'&', b'=', ..] => (Kind::AndAssign, 2),
        [b'|', b'=', ..] => (Kind::OrAssign, 2),
        [b'^', b'=', ..] => (Kind::XorAssign, 2),
        [b'#', ..] => (Kind::Hash, 1),
        [b'(', ..] => (Kind::ParenOpen, 1),
        [b')', ..] => (Kind::ParenClose, 1),
        [b'[', ..] => (Kind::BracketOpen, 1),
        [b']', ..] => (Kind::BracketClose, 1),
        [b'{', ..] => (Kind::BraceOpen, 1),
        [b'}', ..] => (Kind::BraceClose, 1),
        [b';', ..] => (Kind::Semicolon, 1),
        [b',', ..] => (Kind::Comma, 1),
        [b'.', ..] => (Kind::Dot, 1),
        [b'?', ..] => (Kind::Question, 1),
        [b':', ..] => (Kind::Colon, 1),
        [b'+', ..] => (Kind::Plus, 1),
        [b'-', ..] => (Kind::Minus, 1),
        [b'*', ..] => (Kind::Star, 1),
        [b'/', ..] => (Kind::Slash, 1),
        [b'%', ..] => (Kind::Percent, 1),
        [b'<', ..] => (Kind::Less, 1),
        [b'>', ..] => (Kind::Greater, 1),
        [b'&', ..] => (Kind::And, 1),
        [b'^', ..] => (Kind::Caret, 1),
        [b'|', ..] => (Kind::Pipe, 1),
        [b'!', ..] => (Kind::Not, 1),
        [b'~', ..] => (Kind::Tilde, 1),
        [b'=', ..] => (Kind::Assign, 1),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kind and text of each token.
    fn tokens(text: &str) -> Vec<(Kind, &str)> {
        scan(text, 0).iter().map(|t| (t.kind, &text[t.place.start as usize..t.place.end as usize])).collect()
    }

    #[test]
    fn the_longest_token_wins() {
        use Kind::*;
        assert_eq!(tokens("a<<=[[..."), [(Name, "a"), (ShlAssign, "<<="), (MetaOpen, "[["), (Ellipsis, "...")]);
        assert_eq!(tokens(".5e-3f-1e+x"), [(Number, ".5e-3f"), (Minus, "-"), (Number, "1e"), (Plus, "+"), (Name, "x")]);
        assert_eq!(tokens("..1.2.3"), [(Dot, "."), (Number, ".1.2.3")]);
        assert_eq!(tokens("é\\x"), [(Stray, "é"), (Stray, "\\"), (Name, "x")]);
    }

    #[test]
    fn a_backslash_joins_lines_everywhere() {
        use Kind::*;
        let joined = "a \\\r\nb // c \\\n d\n\"e \\\" \\\n f\" \"g\\";
        let expected = [(Name, "a"), (Name, "b"), (Text, "\"e \\\" \\\n f\""), (UnclosedText, "\"g"), (Stray, "\\")];
        assert_eq!(tokens(joined), expected);
        let starts: Vec<bool> = scan(joined, 0).iter().map(|t| t.line_start).collect();
        assert_eq!(starts, [true, false, true, false, false]);
    }

    #[test]
    fn comments_are_space_unless_they_never_end() {
        use Kind::*;
        assert_eq!(
            tokens("a/* * / */b/**/c/*/ d"),
            [(Name, "a"), (Name, "b"), (Name, "c"), (UnclosedComment, "/*/ d")]
        );
        assert!(scan("a/**/b", 0)[1].space && !scan("a+b", 0)[1].space);
    }
}
