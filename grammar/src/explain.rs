//! Parse errors in human words: what was expected, what was found, what to do.

use crate::ast::Item;
use crate::brackets::Unclosed;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Sources;
use crate::span::Span;
use crate::token::{Sym, Token};
use lalrpop_util::{ErrorRecovery, ParseError};
use std::collections::HashSet;

/// What the parser gives when it has skipped over a mistake.
pub(crate) type Recovery<'s> = ErrorRecovery<u32, Token<'s>, ()>;

/// What stood where something else was expected.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Found {
    End,
    /// Text that has a message already.
    Broken,
    Name,
    Literal,
    Kind,
    Sym(Sym),
}

/// A parse error without the tokens' lifetime.
#[derive(Debug)]
pub(crate) struct Failure {
    found: Found,
    span: Span,
    expected: Vec<String>,
    /// The last token that was skipped to recover.
    resumed_after: u32,
}

impl From<Recovery<'_>> for Failure {
    fn from(recovery: Recovery<'_>) -> Self {
        let dropped = recovery.dropped_tokens.last().map_or(0, |(_, _, last)| *last);
        let mut failure = Failure::from(recovery.error);
        failure.resumed_after = dropped.max(failure.span.last);
        failure
    }
}

impl From<ParseError<u32, Token<'_>, ()>> for Failure {
    fn from(error: ParseError<u32, Token<'_>, ()>) -> Self {
        let (token, expected, end) = match error {
            ParseError::UnrecognizedToken { token, expected } => (Some(token), expected, 0),
            ParseError::ExtraToken { token } => (Some(token), Vec::new(), 0),
            ParseError::UnrecognizedEof { location, expected } => (None, expected, location),
            ParseError::InvalidToken { location } => (None, Vec::new(), location),
            ParseError::User { .. } => (None, Vec::new(), 0),
        };
        let (found, span) = match token {
            None => (Found::End, Span { first: end, last: end }),
            Some((first, token, last)) => (kind(&token), Span { first, last }),
        };
        let expected = expected.iter().map(|e| e.trim_matches('"').to_string()).collect();
        Failure { found, span, expected, resumed_after: span.last }
    }
}

fn kind(token: &Token<'_>) -> Found {
    match token {
        Token::Ident(_) => Found::Name,
        Token::Int(_) | Token::Float(_) | Token::Str(_) => Found::Literal,
        Token::Kind(_) => Found::Kind,
        Token::Sym(symbol) => Found::Sym(*symbol),
        Token::Error => Found::Broken,
    }
}

/// How near to the last mistake another one is taken for its consequence, in tokens.
const ECHO: u32 = 3;

/// How many syntax errors are shown.
const MAX_SHOWN: usize = 100;

/// Turns failures into messages. One that follows closely on another, or on a message of the lexer, is its echo and
/// left out.
pub(crate) fn explain(failures: &[Failure], unclosed: &[Unclosed], sources: &Sources, diagnostics: &mut Diagnostics) {
    let reported: Vec<u32> =
        diagnostics.list.iter().filter(|d| d.code.starts_with("E02")).map(|d| d.span.first).collect();
    let mut quiet_until = None;
    let mut shown = 0;
    let mut brackets_seen = HashSet::new();
    let mut headless = false;
    for failure in failures {
        let at = failure.span.first;
        let echo = quiet_until.is_some_and(|quiet| at <= quiet)
            || near(&reported, at)
            || failure.found == Found::Broken
            || (headless && failure.is_among_items());
        quiet_until = Some(failure.resumed_after.saturating_add(ECHO));
        if echo {
            continue;
        }
        if shown == MAX_SHOWN {
            let message = format!("more than {MAX_SHOWN} syntax errors");
            diagnostics.push(
                Diagnostic::error("E0305", failure.span, message)
                    .label("this one and the rest are not shown")
                    .help("mend the first ones: others may follow from them"),
            );
            break;
        }
        let message = failure.message(unclosed, sources);
        // One bracket can upset the parser several times.
        if message.code != "E0303" || brackets_seen.insert(message.span) {
            diagnostics.push(message);
            shown += 1;
        }
        headless |= failure.loses_a_body();
    }
}

/// True when one of the ascending places lies at or shortly before a token.
fn near(reported: &[u32], at: u32) -> bool {
    let before = reported.partition_point(|r| *r <= at);
    before.checked_sub(1).is_some_and(|i| at - reported[i] <= ECHO)
}

impl Failure {
    /// Is what follows a body without its head, whose statements then stand where only shaders, functions and structs may?
    fn loses_a_body(&self) -> bool {
        self.has("{") && !self.has("return") && !self.has("int literal")
    }

    /// Does it stand where only shaders, functions and structs may? A variable there looks like a function without its parenthesis.
    fn is_among_items(&self) -> bool {
        let variable = matches!(
            self.found,
            Found::Sym(Sym::Assign | Sym::Semicolon | Sym::ItemEnd | Sym::Comma | Sym::BracketOpen)
        );
        self.has("kind") || (variable && self.expected == ["("])
    }

    fn has(&self, terminal: &str) -> bool {
        self.expected.iter().any(|e| e == terminal)
    }

    fn message(&self, unclosed: &[Unclosed], sources: &Sources) -> Diagnostic {
        if self.found == Found::End {
            return self.at_end(unclosed);
        }
        if let Some(message) = self.missing_semicolon(sources).or_else(|| self.stray_bracket(unclosed)) {
            return message;
        }
        let (wanted, found) = (self.wanted(), self.found_text(sources));
        let message = match wanted.as_str() {
            "" => format!("{found} does not belong here"),
            _ => format!("expected {wanted}, found {found}"),
        };
        let label = if wanted.is_empty() { "not expected".to_string() } else { format!("expected {wanted}") };
        let mut message = Diagnostic::error("E0301", self.span, message).label(label).help(self.help(sources));
        if self.found == Found::Kind
            && let Some(brace) =
                unclosed.iter().rev().find(|u| u.bracket == Sym::BraceOpen && u.span.first < self.span.first)
        {
            message = message.also(brace.span, "this brace is not closed");
        }
        message
    }

    /// The text ends too early.
    fn at_end(&self, unclosed: &[Unclosed]) -> Diagnostic {
        let Some(open) = unclosed.last() else {
            let wanted = self.wanted();
            return Diagnostic::error("E0301", self.span, format!("expected {wanted}, found the end of the text"))
                .label("the text ends after this")
                .help("something is missing at the end");
        };
        never_closed(*open)
    }

    /// The semicolon is missing when one would do and the next line, or something that starts a statement, follows.
    fn missing_semicolon(&self, sources: &Sources) -> Option<Diagnostic> {
        // Where a statement or an item may start, a semicolon would do but is not what is missing.
        let starting = self.has("return") && !self.has("*") || self.has("kind");
        if starting || !(self.has(";") || self.has(";0")) {
            return None;
        }
        let previous = previous(self.span.first, sources)?;
        let place = |index| sources.token(index).map(|t| sources.table.outermost(t.place, t.call));
        let (a, b) = (sources.location(place(previous)?), sources.location(place(self.span.first)?));
        let starts_statement = matches!(
            self.found,
            Found::Kind
                | Found::Sym(
                    Sym::BraceClose
                        | Sym::ItemClose
                        | Sym::If
                        | Sym::For
                        | Sym::While
                        | Sym::Do
                        | Sym::Return
                        | Sym::Break
                        | Sym::Continue
                        | Sym::Else
                        | Sym::FloatType
                        | Sym::IntType
                        | Sym::Struct
                )
        );
        let operator = matches!(self.found, Found::Sym(Sym::ParenClose | Sym::BracketClose | Sym::Colon));
        if operator || !(starts_statement || a.line != b.line || a.file != b.file) {
            return None;
        }
        let span = Span { first: previous, last: previous };
        let text = sources.text(span);
        let message = format!("missing `;` after `{}`", shortened(&text));
        let mut message = Diagnostic::error("E0302", span, message).label("add `;` here");
        message = message.help("every statement ends with `;`");
        Some(message)
    }

    /// A closing bracket that closes nothing, or the wrong thing.
    fn stray_bracket(&self, unclosed: &[Unclosed]) -> Option<Diagnostic> {
        let Found::Sym(found) = self.found else {
            return None;
        };
        let opener = match found {
            Sym::ParenClose => Sym::ParenOpen,
            Sym::BracketClose => Sym::BracketOpen,
            Sym::BraceClose | Sym::ItemClose => Sym::BraceOpen,
            _ => return None,
        };
        // A brace inside a function that ends the whole item closes more than it should.
        let too_much = found == Sym::ItemClose && self.has("}");
        let before = unclosed.partition_point(|u| u.span.first < self.span.first);
        let inner = unclosed[..before].iter().rev().take(16).find(|u| u.bracket != opener || too_much);
        if let Some(open) = inner {
            return Some(never_closed(*open).also(self.span, format!("found `{}` instead", found.text())));
        }
        let closes_nothing = found == Sym::ItemClose && self.has("kind");
        closes_nothing.then(|| {
            Diagnostic::error("E0303", self.span, format!("this `{}` closes nothing", found.text()))
                .label("no matching bracket")
                .help("remove it, or look for a brace too many above")
        })
    }

    /// What was expected, in at most three alternatives.
    fn wanted(&self) -> String {
        let expression = self.has("int literal") && self.has("(");
        let statement = self.has("return");
        let mut list: Vec<String> = Vec::new();
        let mut phrase = |when: bool, text: &str| {
            if when && list.len() < 3 {
                list.push(text.to_string());
            }
        };
        phrase(self.has("kind"), "a shader, a function or a struct");
        phrase(statement, "a statement");
        phrase(expression && !statement, "an expression");
        phrase(self.has("int literal") && !expression, "an integer literal");
        let a_type = self.has("float") && !expression && !self.has("kind");
        phrase(a_type, "a type");
        phrase(self.has("name") && !expression && !a_type && !self.has("kind"), "a name");
        if expression || statement || self.has("kind") {
            return list.join(" or ");
        }
        let operators = self.has("*");
        for terminal in [";", ";0", ")", "]", "}", "}0", ":", "(", "{", "=", ",", "[[", "while"] {
            let shown = format!("`{}`", terminal.trim_end_matches('0'));
            // Among operators `=` and `(` are possible but hardly ever what was forgotten.
            let unlikely = operators && matches!(terminal, "=" | "(" | "[[");
            if self.has(terminal) && !unlikely && list.len() < 3 && !list.contains(&shown) {
                list.push(shown);
            }
        }
        if operators && list.len() < 3 {
            list.push("an operator".into());
        }
        match list.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
            _ => list.join(""),
        }
    }

    fn found_text(&self, sources: &Sources) -> String {
        let text = shortened(&sources.text(self.span));
        match self.found {
            Found::Sym(symbol)
                if symbol.text().starts_with(|c: char| c.is_ascii_alphabetic()) && Sym::keyword(&text).is_some() =>
            {
                format!("the keyword `{text}`")
            }
            _ => format!("`{text}`"),
        }
    }

    fn help(&self, sources: &Sources) -> String {
        let text = sources.text(self.span);
        let statement = self.has("return");
        match self.found {
            Found::Kind if statement => {
                "a shader cannot stand inside a function or another shader: is a `}` missing above?".into()
            }
            Found::Sym(Sym::Struct) if statement => "declare structs outside of functions".into(),
            Found::Sym(Sym::Else) => "an `else` must directly follow the statement of its `if`".into(),
            Found::Sym(Sym::Assign) if self.has("*") => {
                "only a variable, an element or a field can be assigned to; compare with `==`".into()
            }
            Found::Sym(_) if self.has("name") && !self.has("int literal") && Sym::keyword(&text).is_some() => {
                format!("`{text}` is a keyword and cannot be a name: choose another one")
            }
            _ if self.after_elseif(sources) => "OSL has no such word: write `else if`".into(),
            _ if self.has("int literal") && !self.has("(") => {
                "the length of an array is an integer literal (a macro may stand for it)".into()
            }
            Found::Name | Found::Literal if self.has("*") && self.has(")") => {
                "is an operator, a comma or a bracket missing before it?".into()
            }
            _ if self.has("kind") => {
                "at this level stand shaders, functions and structs; statements belong inside of them".into()
            }
            _ if self.has("int literal") => "a value is missing before it, or something here is too much".into(),
            _ if self.has("*") => "is an operator or a bracket missing before it?".into(),
            _ if self.has("name") => "a declaration is written `type name`".into(),
            _ => "look at what stands just before it".into(),
        }
    }

    /// Does the statement begin with what other languages write for `else if`?
    fn after_elseif(&self, sources: &Sources) -> bool {
        let before = (0..self.span.first).rev().filter_map(|at| sources.token(at)).filter(|token| !token.aside);
        let mut words =
            before.map(|token| sources.spelling(token.place)).take_while(|word| !matches!(*word, ";" | "{" | "}"));
        words.any(|word| matches!(word, "elseif" | "elif" | "elsif"))
    }
}

fn never_closed(open: Unclosed) -> Diagnostic {
    let (text, closer) = match open.bracket {
        Sym::ParenOpen => ("(", ")"),
        Sym::BracketOpen => ("[", "]"),
        Sym::MetaOpen => ("[[", "]]"),
        _ => ("{", "}"),
    };
    Diagnostic::error("E0303", open.span, format!("this `{text}` is never closed"))
        .label("opened here")
        .help(format!("add the missing `{closer}`"))
}

/// Reports structs without the semicolon, which the grammar lets pass so that what follows is read.
pub(crate) fn check_structs(items: &[Item], sources: &Sources, diagnostics: &mut Diagnostics) {
    for item in items {
        let Item::Struct(decl) = item else { continue };
        let next = (decl.span.last + 1..).map_while(|i| sources.token(i)).find(|t| !t.aside);
        if next.is_none_or(|t| sources.spelling(t.place) != ";") {
            let span = Span { first: decl.span.last, last: decl.span.last };
            diagnostics.push(
                Diagnostic::error("E0302", span, "missing `;` after `}`")
                    .label("add `;` here")
                    .help("a struct declaration ends with `;`"),
            );
        }
    }
}

/// The token of the program before another one.
fn previous(index: u32, sources: &Sources) -> Option<u32> {
    (0..index).rev().find(|i| sources.token(*i).is_some_and(|t| !t.aside))
}

/// The first line of a text, and not much of that.
fn shortened(text: &str) -> String {
    let line = text.lines().next().unwrap_or("");
    match line.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_string(),
    }
}
