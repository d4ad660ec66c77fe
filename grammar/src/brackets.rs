//! Brackets before parsing: what closes what, where items end, and how deep a tree may become.
//!
//! The parser keeps its stack on the heap, but everyone who walks the tree recurses. So the depth of the tree is
//! bounded here, in terms of the text: brackets nest at most [`MAX_BRACKETS`] deep, statements hang on each other
//! without braces (`if … else if …`) at most [`MAX_CHAIN`] long, and between two separators stand at most
//! [`MAX_RUN`] tokens, counting those around an open bracket. An expression tree is therefore never deeper than
//! [`MAX_RUN`], and reaches a great depth only by a chain of operators such as `a + b + c + …`.

use crate::diagnostic::Diagnostic;
use crate::lexer::Spanned;
use crate::source::Sources;
use crate::span::Span;
use crate::token::{Sym, Token};

/// How deep brackets of any kind may nest.
pub(crate) const MAX_BRACKETS: usize = 256;
/// How many statements may hang on each other without braces.
pub(crate) const MAX_CHAIN: usize = 2_000;
/// How many tokens a statement or a list element may have, nested ones included.
pub(crate) const MAX_RUN: usize = 50_000;

/// A bracket that is never closed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unclosed {
    /// The bracket.
    pub bracket: Sym,
    /// Its token.
    pub span: Span,
}

/// Marks the braces and semicolons that end items, and gives the brackets that are never closed.
pub(crate) fn mark_items(tokens: &mut [Spanned<'_>], sources: &Sources) -> Vec<Unclosed> {
    let unclosed = pair(tokens, |_| false);
    if unclosed.is_empty() {
        return unclosed;
    }
    // A bracket is missing somewhere. People write the last brace of an item at the left margin: trusting that
    // keeps one missing bracket from swallowing the rest of the file.
    pair(tokens, |index| {
        sources.token(index).is_some_and(|t| t.call == crate::source::NO_CALL && sources.location(t.place).column == 1)
    })
}

/// Pairs brackets; a closing brace for which `ends_item` holds closes everything. What stays open comes in the order
/// of the text.
fn pair(tokens: &mut [Spanned<'_>], ends_item: impl Fn(u32) -> bool) -> Vec<Unclosed> {
    let mut open: Vec<Unclosed> = Vec::new();
    let mut lost = Vec::new();
    for (first, token, last) in tokens {
        let Token::Sym(symbol) = token else { continue };
        let here = Unclosed { bracket: *symbol, span: Span { first: *first, last: *last } };
        match symbol {
            Sym::ParenOpen | Sym::BracketOpen | Sym::BraceOpen => open.push(here),
            Sym::MetaOpen => open.extend([here, here]),
            Sym::ParenClose => close(&mut open, &mut lost, |b| b == Sym::ParenOpen),
            Sym::BracketClose => close(&mut open, &mut lost, |b| matches!(b, Sym::BracketOpen | Sym::MetaOpen)),
            Sym::BraceClose | Sym::ItemClose => {
                close(&mut open, &mut lost, |b| b == Sym::BraceOpen);
                if ends_item(*first) {
                    lost.append(&mut open);
                }
                *symbol = if open.is_empty() { Sym::ItemClose } else { Sym::BraceClose };
            }
            Sym::Semicolon | Sym::ItemEnd => {
                *symbol = if open.is_empty() { Sym::ItemEnd } else { Sym::Semicolon };
            }
            _ => {}
        }
    }
    lost.append(&mut open);
    lost.sort_by_key(|u| u.span.first);
    lost
}

/// Takes off the innermost bracket of a kind and all inside it. A brace is closed by nothing but a brace.
fn close(open: &mut Vec<Unclosed>, lost: &mut Vec<Unclosed>, matches: impl Fn(Sym) -> bool) {
    let wall = open.iter().rposition(|u| u.bracket == Sym::BraceOpen).unwrap_or(0);
    if let Some(at) = open.iter().rposition(|u| matches(u.bracket)).filter(|at| *at >= wall) {
        lost.extend(open.drain(at + 1..));
        open.pop();
    }
}

/// How far the current statement or list element has come.
#[derive(Clone, Copy, Default)]
struct Run {
    /// Tokens since the last separator, and those of the runs around it.
    tokens: usize,
    /// Statements hanging on each other.
    chain: usize,
}

/// Finds the first place where the text would make too deep a tree.
pub(crate) fn too_deep(tokens: &[Spanned<'_>]) -> Option<Diagnostic> {
    // For each open bracket the run around it and the run at its last separator.
    let mut stack: Vec<(Run, Run)> = Vec::new();
    let (mut run, mut base) = (Run::default(), Run::default());
    for (i, (first, token, last)) in tokens.iter().enumerate() {
        let span = Span { first: *first, last: *last };
        run.tokens += 1;
        let Token::Sym(symbol) = token else { continue };
        let goes_on = matches!(tokens.get(i + 1), Some((_, Token::Sym(Sym::Else), _)));
        match symbol {
            Sym::ParenOpen | Sym::BracketOpen | Sym::BraceOpen | Sym::MetaOpen => {
                if stack.len() >= MAX_BRACKETS {
                    return Some(nested(span));
                }
                stack.push((run, base));
                base = run;
                // `[[` is closed by two brackets.
                if *symbol == Sym::MetaOpen {
                    stack.push((run, base));
                }
            }
            Sym::ParenClose | Sym::BracketClose | Sym::BraceClose | Sym::ItemClose => {
                let tokens = run.tokens;
                (run, base) = stack.pop().unwrap_or_default();
                // What stands in brackets is one operand: it adds to the length but not to the depth.
                run.tokens += usize::from(tokens > 0);
                if matches!(symbol, Sym::BraceClose | Sym::ItemClose) && !goes_on {
                    run = base;
                }
            }
            Sym::Semicolon | Sym::ItemEnd | Sym::Comma if !goes_on => run = base,
            Sym::If | Sym::Else | Sym::While | Sym::For | Sym::Do => run.chain += 1,
            _ => {}
        }
        if run.tokens > MAX_RUN || run.chain > MAX_CHAIN {
            return Some(too_long(span, run));
        }
    }
    None
}

fn nested(span: Span) -> Diagnostic {
    Diagnostic::error("E0207", span, format!("nested more than {MAX_BRACKETS} levels deep"))
        .label("parsing stops here")
        .help("write intermediate results to variables, or move inner blocks to functions")
}

fn too_long(span: Span, run: Run) -> Diagnostic {
    let message = if run.chain > MAX_CHAIN {
        format!("more than {MAX_CHAIN} statements hang on each other without braces")
    } else {
        format!("a single statement or expression of more than {MAX_RUN} tokens")
    };
    Diagnostic::error("E0208", span, message)
        .label("parsing stops here")
        .help("split it: assign parts to variables, or put parts into functions")
}
