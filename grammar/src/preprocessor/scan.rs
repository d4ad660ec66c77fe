//! Text to preprocessing tokens: the only place where bytes are looked at.
//!
//! White space and comments leave only two flags behind: whether something stood before a token, and whether the
//! token is the first of its line. A backslash at the end of a line joins it with the next one, between tokens and
//! inside strings and line comments.

use crate::source::{NO_CALL, Place};
use logos::{Filter, Lexer, Logos};

/// The kinds of preprocessing token. Keywords are names here: macros may be called like keywords.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(skip r"([ \t\r\x0b\x0c\u{feff}]|\\\r?\n)+")]
#[logos(skip(r"//([^\\\n]|\\\r?\n|\\[^\r\n])*\\?", allow_greedy = true))]
#[allow(missing_docs)] // the spelling beside each variant says it all
pub(crate) enum Kind {
    #[token("\n")]
    Newline,
    #[regex("[A-Za-z_][A-Za-z0-9_]*")]
    Name,
    #[regex(r"\.?[0-9][0-9.]*([eE][+-]?[0-9]+)?[A-Za-z0-9_.]*")]
    Number,
    #[regex(r#""([^"\\\n]|\\[^\r\n]|\\\r?\n)*""#)]
    Text,
    #[regex(r#""([^"\\\n]|\\[^\r\n]|\\\r?\n)*"#, priority = 1)]
    UnclosedText,
    #[token("/*", block_comment)]
    UnclosedComment,
    #[token("#")]
    Hash,
    #[token("##")]
    Paste,
    #[token("...")]
    Ellipsis,
    #[token("(")]
    ParenOpen,
    #[token(")")]
    ParenClose,
    #[token("[")]
    BracketOpen,
    #[token("]")]
    BracketClose,
    #[token("[[")]
    MetaOpen,
    #[token("{")]
    BraceOpen,
    #[token("}")]
    BraceClose,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    #[token(".")]
    Dot,
    #[token("?")]
    Question,
    #[token(":")]
    Colon,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("%")]
    Percent,
    #[token("<<")]
    Shl,
    #[token(">>")]
    Shr,
    #[token("<")]
    Less,
    #[token("<=")]
    LessEqual,
    #[token(">")]
    Greater,
    #[token(">=")]
    GreaterEqual,
    #[token("==")]
    EqualEqual,
    #[token("!=")]
    NotEqual,
    #[token("&")]
    And,
    #[token("^")]
    Caret,
    #[token("|")]
    Pipe,
    #[token("&&")]
    AndAnd,
    #[token("||")]
    OrOr,
    #[token("!")]
    Not,
    #[token("~")]
    Tilde,
    #[token("++")]
    Increment,
    #[token("--")]
    Decrement,
    #[token("=")]
    Assign,
    #[token("+=")]
    AddAssign,
    #[token("-=")]
    SubAssign,
    #[token("*=")]
    MulAssign,
    #[token("/=")]
    DivAssign,
    #[token("&=")]
    AndAssign,
    #[token("|=")]
    OrAssign,
    #[token("^=")]
    XorAssign,
    #[token("<<=")]
    ShlAssign,
    #[token(">>=")]
    ShrAssign,
    /// A character of C, which conditions count as its code.
    #[regex(r"'([^'\\\r\n]|\\[^\r\n])'")]
    Character,
    /// A character that starts no token.
    Stray,
    /// Text for which a message has been reported.
    Broken,
}

/// Skips a comment that is closed; gives a token for one that is not.
fn block_comment(lexer: &mut Lexer<'_, Kind>) -> Filter<()> {
    let rest = lexer.remainder();
    match rest.find("*/") {
        Some(end) => {
            lexer.bump(end + 2);
            Filter::Skip
        }
        None => {
            lexer.bump(rest.len());
            Filter::Emit(())
        }
    }
}

/// A preprocessing token.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PpToken {
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
pub(crate) fn scan(text: &str, file: u32) -> Vec<PpToken> {
    let mut tokens = Vec::with_capacity(text.len() / 4);
    let mut lexer = Kind::lexer(text);
    let (mut line_start, mut previous_end) = (true, 0);
    while let Some(kind) = lexer.next() {
        let range = lexer.span();
        let kind = kind.unwrap_or(Kind::Stray);
        if kind == Kind::Newline {
            line_start = true;
            continue;
        }
        let place = Place { file, start: range.start as u32, end: range.end as u32 };
        let space = range.start > previous_end;
        tokens.push(PpToken { kind, space, line_start, painted: false, place, call: NO_CALL });
        line_start = false;
        previous_end = range.end;
    }
    tokens
}
