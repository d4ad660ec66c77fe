//! Where a space goes between two tokens of a line.

use super::pieces::{Part, Piece};
use crate::preprocessor::scan::Kind;
use logos::Logos;

/// The last token, as far as the next one's space depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before<'t> {
    /// What it is.
    pub kind: Kind,
    /// As written.
    pub text: &'t str,
    /// An operator of one operand that follows.
    pub prefix: bool,
    /// The `)` of a cast: an operand follows.
    pub cast: bool,
    /// The `)` of a condition: a statement follows.
    pub condition: bool,
    /// The end of metadata.
    pub metadata: bool,
}

/// Words that name types.
const TYPES: &[&str] =
    &["int", "float", "color", "point", "vector", "normal", "matrix", "string", "void", "closure", "struct", "output"];

/// Words that begin statements.
const STATEMENTS: &[&str] = &["if", "for", "while", "do", "else", "return", "break", "continue"];

/// Does a word name a type?
pub(super) fn is_type(word: &str) -> bool {
    TYPES.contains(&word)
}

/// Does a word begin a declaration or a statement?
pub(super) fn begins_statement(word: &str) -> bool {
    is_type(word) || STATEMENTS.contains(&word)
}

/// Is a word an operator, or one before which no operand ends?
pub(super) fn is_word_operator(word: &str) -> bool {
    matches!(word, "and" | "or" | "not" | "return" | "else" | "do")
}

/// Does an operand end with this token?
pub(super) fn ends_operand(before: &Before<'_>) -> bool {
    match before.kind {
        Kind::Name => !is_word_operator(before.text),
        Kind::Number | Kind::Text | Kind::Character | Kind::BracketClose => true,
        Kind::ParenClose => !(before.cast || before.condition),
        Kind::Increment | Kind::Decrement => !before.prefix,
        _ => false,
    }
}

/// Is an operator at this place one of a single operand?
pub(super) fn is_prefix(kind: Kind, before: Option<&Before<'_>>) -> bool {
    match kind {
        Kind::Not | Kind::Tilde => true,
        Kind::Minus | Kind::Plus | Kind::Increment | Kind::Decrement => !before.is_some_and(ends_operand),
        _ => false,
    }
}

/// Does a space go before a token? `closing` says that it ends the metadata that it stands in.
pub(super) fn space(before: &Before<'_>, next: &Part<'_>, prefix: bool, closing: bool) -> bool {
    let Piece::Token(kind) = next.piece else { return next.space };
    let wanted = wanted(before, kind, prefix, closing).unwrap_or(next.space);
    // Two tokens that would read as others keep the space that parts them.
    wanted || next.space && !stay_apart(before.text, next.text)
}

fn wanted(before: &Before<'_>, next: Kind, prefix: bool, closing: bool) -> Option<bool> {
    use Kind::*;
    let odd = |kind| matches!(kind, Stray | Broken | Character | Hash | Paste | Ellipsis | UnclosedText);
    if odd(before.kind) || odd(next) {
        return None;
    }
    Some(match (before.kind, next) {
        (BracketClose, BracketClose) if closing => false,
        (_, BracketClose) if closing => true,
        (MetaOpen, _) | (_, MetaOpen) => true,
        (BraceOpen, BraceClose) => false,
        (ParenOpen | BracketOpen | Dot, _) => false,
        (_, ParenClose | BracketClose | Comma | Semicolon | Dot) => false,
        (BraceOpen | BraceClose | Comma | Semicolon, _) | (_, BraceOpen | BraceClose) => true,
        _ if before.prefix => false,
        (_, Increment | Decrement) => prefix,
        (Name, ParenOpen) => is_word_operator(before.text) || matches!(before.text, "if" | "for" | "while"),
        (ParenClose, _) if before.cast => false,
        (ParenClose, ParenOpen) => before.condition,
        (BracketClose, ParenOpen) => before.metadata,
        (Name | ParenClose | BracketClose, BracketOpen) => false,
        _ => true,
    })
}

/// Do two tokens stay what they are when nothing stands between them?
fn stay_apart(before: &str, next: &str) -> bool {
    let joined = [before, next].concat();
    let mut lexer = Kind::lexer(&joined);
    lexer.next().is_some()
        && lexer.span().end == before.len()
        && lexer.next().is_some()
        && lexer.span().start == before.len()
}
