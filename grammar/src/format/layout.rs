//! Lines and their indentation: line ends stay where they are, all else is laid anew.

use super::frames::{Frame, Head, Kind};
use super::lines::Lines;
use super::pieces::{Part, Piece, STEP, advanced};
use super::spaces::{Before, begins_statement, ends_operand, is_prefix, is_type, is_word_operator, space};
use crate::preprocessor::scan::Kind as Token;
use std::collections::HashSet;

/// Conditions deeper than this no longer bring back the brackets that were open before their branches.
const MOST_BRANCHES: usize = 64;

/// Brackets deeper than this are not kept for the branches of a condition.
const MOST_KEPT: usize = 512;

/// Where the program stands.
#[derive(Clone, Debug)]
struct State<'t> {
    frames: Vec<Frame>,
    before: Option<Before<'t>>,
}

/// Lays out a text.
pub(super) struct Layout<'t> {
    parts: &'t [Part<'t>],
    /// The index of the next token of the program after each part.
    next: Vec<usize>,
    quoting: &'t HashSet<&'t str>,
    state: State<'t>,
    /// The state before the first branch of each open condition.
    branches: Vec<Option<State<'t>>>,
    lines: Lines,
    /// Nothing stands on the last line yet.
    empty: bool,
}

/// The text of parts, laid anew.
pub(super) fn lay_out<'t>(parts: &'t [Part<'t>], quoting: &'t HashSet<&'t str>) -> String {
    let mut next = vec![parts.len(); parts.len()];
    for at in (1..parts.len()).rev() {
        next[at - 1] = if matches!(parts[at].piece, Piece::Token(_)) { at } else { next[at] };
    }
    let state = State { frames: vec![Frame::new(Kind::File, 0)], before: None };
    let (branches, lines) = (Vec::new(), Lines::default());
    let mut layout = Layout { parts, next, quoting, state, branches, lines, empty: true };
    for (at, part) in parts.iter().enumerate() {
        let new_line = at == 0 || part.newlines > 0 || parts[at - 1].piece == Piece::Directive;
        match part.piece {
            Piece::Directive => layout.directive(part),
            Piece::LineComment | Piece::BlockComment => layout.comment(at, part, new_line),
            Piece::Token(kind) => layout.token(at, part, kind, new_line),
        }
    }
    layout.lines.finish()
}

/// The text without white space at its end, unless a backslash would then join lines.
fn trimmed(text: &str) -> &str {
    let short = text.trim_end();
    if short.ends_with('\\') { text } else { short }
}

impl<'t> Layout<'t> {
    fn frame(&mut self) -> &mut Frame {
        if self.state.frames.is_empty() {
            self.state.frames.push(Frame::new(Kind::File, 0));
        }
        let last = self.state.frames.len() - 1;
        &mut self.state.frames[last]
    }

    /// The text of the next token of the program.
    fn next_text(&self, at: usize) -> &'t str {
        self.next.get(at).and_then(|next| self.parts.get(*next)).map_or("", |part| part.text)
    }

    fn directive(&mut self, part: &Part<'t>) {
        self.lines.begin(0, part.newlines > 1);
        self.lines.push(trimmed(part.text));
        let word = part.text.trim_start_matches(['#', ' ', '\t']);
        if word.starts_with("if") {
            let small = self.branches.len() < MOST_BRANCHES && self.state.frames.len() < MOST_KEPT;
            self.branches.push(small.then(|| self.state.clone()));
        } else if word.starts_with("el") {
            if let Some(Some(state)) = self.branches.last() {
                self.state = state.clone();
            }
        } else if word.starts_with("endif") {
            self.branches.pop();
        }
        self.empty = true;
    }

    fn comment(&mut self, at: usize, part: &Part<'t>, new_line: bool) {
        let last = self.parts.get(at + 1).is_none_or(|next| next.newlines > 0);
        let text = if last { trimmed(part.text) } else { part.text };
        if new_line {
            let indent = self.indent_of_comment(at);
            let below = self.lines.comment_column() == Some(part.column);
            self.lines.begin(indent, part.newlines > 1);
            // A comment that goes on the one above, at the end of its line.
            if below && part.newlines == 1 && part.column > indent && part.piece == Piece::LineComment {
                return self.lines.comment(text, part.column);
            }
            self.empty = false;
        } else if last && !text.contains('\n') {
            return self.lines.comment(text, part.column);
        } else if part.space {
            self.lines.push(" ");
        }
        let shift = self.lines.column() as isize - part.column as isize;
        self.lines.push(&shifted(text, shift));
    }

    /// The indentation of a comment on its own line: that of what follows.
    fn indent_of_comment(&mut self, at: usize) -> usize {
        let brace = self.next_text(at) == "{";
        let frame = self.frame();
        match (frame.is_block(), frame.fresh) {
            (true, true) => frame.statement(brace),
            (true, false) if brace => frame.start,
            (true, false) => frame.start + STEP,
            (false, _) => frame.inner(),
        }
    }

    fn token(&mut self, at: usize, part: &Part<'t>, kind: Token, new_line: bool) {
        let before = self.state.before;
        if self.begins_anew(part, kind, new_line) {
            self.frame().end_statement(part.text);
        }
        let prefix = self.frame().is_block() && self.frame().fresh || is_prefix(kind, before.as_ref());
        let prefix = prefix && is_prefix(kind, None);
        if new_line {
            let indent = self.indent_of(part, kind);
            self.lines.begin(indent, part.newlines > 1);
        } else if !self.empty {
            let closing = self.frame().kind == Kind::Metadata;
            let wanted = match before {
                _ if self.parts[at - 1].piece == Piece::BlockComment => part.space,
                Some(_) if self.frame().exact => part.space,
                Some(before) => space(&before, part, prefix, closing),
                None => part.space,
            };
            if wanted {
                self.lines.push(&" ".repeat(part.drawn.max(1)));
            }
        }
        self.empty = false;
        let column = self.lines.column();
        let frame = self.frame();
        let aligning =
            |b: Before<'_>| if frame.is_block() { assigns(&b) } else { opens(b.kind) && frame.align.is_none() };
        if !new_line && before.is_some_and(aligning) {
            frame.align = Some((part.column, column));
        }
        self.lines.push(part.text);
        let prior = Before { kind, text: part.text, prefix, cast: false, condition: false, metadata: false };
        self.state.before = Some(prior);
        self.after(at, part, kind, before, new_line);
    }

    /// Does a line begin a statement though the one before has not ended, as after a macro that brings its own end?
    fn begins_anew(&mut self, part: &Part<'t>, kind: Token, new_line: bool) -> bool {
        let Some(before) = self.state.before else { return false };
        let frame = self.frame();
        if !new_line || frame.fresh || !frame.is_block() || kind != Token::Name || is_word_operator(part.text) {
            return new_line && !frame.fresh && part.text == "return" && before.kind == Token::ParenClose;
        }
        match before.kind {
            Token::ParenClose => frame.head.is_none(),
            Token::Name => begins_statement(part.text) && !begins_statement(before.text) && ends_operand(&before),
            _ => false,
        }
    }

    /// The indentation of a line that begins with this token.
    fn indent_of(&mut self, part: &Part<'t>, kind: Token) -> usize {
        let frame = self.frame();
        let closes = matches!(kind, Token::BraceClose | Token::ParenClose | Token::BracketClose);
        if closes && frame.kind != Kind::File {
            return frame.base;
        }
        if frame.is_block() {
            let names = matches!(kind, Token::Name | Token::ParenOpen | Token::ParenClose);
            return match frame.fresh {
                true => frame.statement(kind == Token::BraceOpen),
                false if kind == Token::BraceOpen => frame.start,
                false if frame.kind == Kind::File && names => frame.start,
                false => frame.aligned(part.column).unwrap_or(frame.start + STEP),
            };
        }
        match frame.aligned(part.column) {
            Some(written) => written,
            _ if !frame.fresh && frame.first => frame.start + STEP,
            _ => frame.inner(),
        }
    }

    /// Goes on behind a token.
    fn after(&mut self, at: usize, part: &Part<'t>, kind: Token, before: Option<Before<'t>>, new_line: bool) {
        let line = self.lines.indent();
        let frame = self.frame();
        let fresh = std::mem::replace(&mut frame.fresh, false);
        let resumed = frame.resumed.take();
        let after_else = matches!(frame.waiting.last(), Some((Head::Else, _))) && !new_line;
        let own = match frame.waiting.last() {
            Some((_, indent)) if after_else => *indent,
            _ => resumed.unwrap_or(line),
        };
        if fresh {
            (frame.start, frame.first) = (own, new_line);
        }
        if fresh && frame.is_block() {
            frame.align = None;
        }
        match kind {
            Token::BraceOpen | Token::ParenOpen | Token::BracketOpen | Token::MetaOpen => {
                self.open(at, kind, before, fresh, new_line);
            }
            Token::BraceClose | Token::ParenClose | Token::BracketClose => self.close(at, kind),
            Token::Semicolon if frame.is_block() => {
                let next = self.next_text(at);
                self.frame().end_statement(next);
            }
            Token::Semicolon | Token::Comma if !frame.is_block() => frame.fresh = true,
            Token::Name if fresh && frame.is_block() => match part.text {
                "if" => frame.head = Some((Head::If, own)),
                "for" => frame.head = Some((Head::Loop, own)),
                "while" if frame.head.is_none() => frame.head = Some((Head::Loop, own)),
                "else" | "do" => {
                    let head = if part.text == "do" { Head::Do } else { Head::Else };
                    frame.waiting.push((head, own));
                    frame.fresh = true;
                }
                _ => {}
            },
            _ => {}
        }
    }

    fn open(&mut self, at: usize, kind: Token, before: Option<Before<'t>>, fresh: bool, new_line: bool) {
        let line = self.lines.indent();
        let cast = is_type(self.next_text(at)) && {
            let second = self.next.get(at).copied().unwrap_or(self.parts.len());
            self.next_text(second) == ")" && !before.as_ref().is_some_and(ends_operand)
        };
        let exact = before.is_some_and(|b| b.kind == Token::Name && self.quoting.contains(b.text));
        let frame = self.frame();
        let outer_exact = frame.exact;
        let mut inner = match kind {
            Token::MetaOpen => Frame::new(Kind::Metadata, line),
            Token::BraceOpen if frame.is_block() && !lists(before.as_ref()) => {
                let base = match frame.waiting.last() {
                    Some((_, indent)) if fresh => *indent,
                    _ if fresh && new_line => line,
                    _ => frame.start,
                };
                Frame::new(Kind::Block, base)
            }
            _ => Frame::new(Kind::List, line),
        };
        if kind == Token::ParenOpen && frame.is_block() {
            inner.condition = frame.head.is_some();
            // What goes on over lines is told from the statement below it.
            inner.steps += usize::from(inner.condition);
        }
        inner.cast = kind == Token::ParenOpen && cast;
        inner.exact = outer_exact || kind == Token::ParenOpen && exact;
        self.state.frames.push(inner);
    }

    fn close(&mut self, at: usize, kind: Token) {
        let frame = self.frame();
        if frame.kind == Kind::Metadata && kind == Token::BracketClose && !frame.half_closed {
            frame.half_closed = true;
            return;
        }
        let (closed, condition, cast) = (frame.kind, frame.condition, frame.cast);
        if closed == Kind::File {
            return;
        }
        self.state.frames.pop();
        let next = self.next_text(at);
        let frame = self.frame();
        if kind == Token::BraceClose && frame.is_block() && closed == Kind::Block {
            frame.end_statement(next);
        }
        let head = if condition { frame.head.take() } else { None };
        if let Some((head, indent)) = head.filter(|(head, _)| *head != Head::DoEnd) {
            frame.waiting.push((head, indent));
            frame.fresh = true;
        }
        if let Some(before) = &mut self.state.before {
            (before.cast, before.condition) = (cast, condition);
            before.metadata = closed == Kind::Metadata;
        }
    }
}

/// Does a bracket open with this token?
fn opens(kind: Token) -> bool {
    matches!(kind, Token::BraceOpen | Token::ParenOpen | Token::BracketOpen | Token::MetaOpen)
}

/// Is a token followed by the value of a statement?
fn assigns(before: &Before<'_>) -> bool {
    before.kind == Token::Assign || before.text == "return"
}

/// Does a brace after this token hold values?
fn lists(before: Option<&Before<'_>>) -> bool {
    before.is_some_and(|before| match before.kind {
        Token::Name => before.text == "return",
        Token::ParenClose | Token::BracketClose | Token::BraceOpen | Token::BraceClose | Token::Semicolon => false,
        _ => true,
    })
}

/// A comment of several lines whose later lines are moved as the first one is.
fn shifted(text: &str, shift: isize) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, line) in text.split('\n').enumerate() {
        if i == 0 {
            out.push_str(if text.contains('\n') { line.trim_end() } else { line });
            continue;
        }
        out.push('\n');
        let body = line.trim_start_matches([' ', '\t']);
        let column = advanced(0, &line[..line.len() - body.len()]) as isize + shift;
        let body = body.trim_end();
        if !body.is_empty() {
            out.extend(std::iter::repeat_n(' ', column.max(0) as usize));
            out.push_str(body);
        }
    }
    out
}
