//! The directives: one line that starts with `#`.

use super::scan::{Kind, PpToken};
use super::state::{Conditional, Preprocessor};
use crate::diagnostic::Diagnostic;
use crate::source::Place;

const KNOWN: &[&str] = &[
    "define", "undef", "include", "if", "ifdef", "ifndef", "elif", "else", "endif", "error", "warning", "line",
    "pragma",
];

impl Preprocessor<'_> {
    /// Obeys the directive whose `#` has just been taken.
    pub(super) fn directive(&mut self, hash: PpToken) {
        let Some(input) = self.inputs.last_mut() else {
            return;
        };
        let tokens = input.tokens.clone();
        let rest = &tokens[input.cursor..];
        let length = rest.iter().position(|t| t.line_start).unwrap_or(rest.len());
        input.cursor += length;
        let active = input.active();
        // `#` alone on its line does nothing, and `# 12 "file"` is how other preprocessors mark lines.
        let Some((name, arguments)) = rest[..length].split_first() else {
            return;
        };
        if name.kind == Kind::Number {
            return;
        }
        let (name, arguments) = (*name, arguments);
        let word = self.text(name).to_string();
        match word.as_str() {
            "if" => self.open_condition(hash, name, active, |s| s.condition(name, arguments)),
            "ifdef" => self.open_condition(hash, name, active, |s| s.defined(name, arguments)),
            "ifndef" => self.open_condition(hash, name, active, |s| !s.defined(name, arguments)),
            "elif" => self.alternative(name, Some(arguments)),
            "else" => self.alternative(name, None),
            "endif" => self.end_condition(name),
            _ if !active => {}
            "define" => self.define(name, arguments),
            "undef" => self.undefine(name, arguments),
            "include" => self.include(name, arguments),
            "error" => self.stop_directive(name, arguments),
            "warning" => self.warning_directive(name, arguments),
            "pragma" => self.pragma(arguments),
            "line" => {}
            _ => self.unknown(name, &word),
        }
    }

    /// `#if` and its kin. The condition is looked at only where the text is read at all.
    fn open_condition(&mut self, hash: PpToken, name: PpToken, live: bool, test: impl FnOnce(&mut Self) -> bool) {
        let active = live && test(self);
        let place = Place { end: name.place.end, ..hash.place };
        if let Some(input) = self.inputs.last_mut() {
            input.conditions.push(Conditional { place, active, done: active || !live, in_else: false });
        }
    }

    /// The value of `#ifdef NAME`.
    fn defined(&mut self, name: PpToken, arguments: &[PpToken]) -> bool {
        match self.macro_name(name, arguments) {
            Some(token) => self.macros.contains_key(self.text(token)),
            None => false,
        }
    }

    /// The macro's name that must follow a directive.
    pub(super) fn macro_name(&mut self, name: PpToken, arguments: &[PpToken]) -> Option<PpToken> {
        match arguments.first() {
            Some(token) if token.kind == Kind::Name => Some(*token),
            other => {
                let word = self.text(name).to_string();
                let span = self.span(*other.unwrap_or(&name));
                self.diagnostics.push(
                    Diagnostic::error("E0102", span, format!("#{word} needs the name of a macro"))
                        .label("no name here")
                        .help(format!("write `#{word} NAME`")),
                );
                None
            }
        }
    }

    /// `#elif` (with its expression) or `#else`.
    fn alternative(&mut self, name: PpToken, expression: Option<&[PpToken]>) {
        let state = self.inputs.last().and_then(|i| i.conditions.last()).map(|c| (c.done, c.in_else));
        let Some((done, false)) = state else {
            return self.stray(name);
        };
        let active = !done && expression.is_none_or(|e| self.condition(name, e));
        if let Some(open) = self.inputs.last_mut().and_then(|i| i.conditions.last_mut()) {
            open.active = active;
            open.done |= active;
            open.in_else = expression.is_none();
        }
    }

    /// `#endif`
    fn end_condition(&mut self, name: PpToken) {
        if self.inputs.last_mut().is_none_or(|i| i.conditions.pop().is_none()) {
            self.stray(name);
        }
    }

    /// A part of a condition that belongs to none.
    fn stray(&mut self, name: PpToken) {
        let word = self.text(name).to_string();
        let after_else = self.inputs.last().is_some_and(|i| !i.conditions.is_empty());
        let span = self.span(name);
        let message = if after_else { format!("#{word} after #else") } else { format!("#{word} without #if") };
        self.diagnostics.push(
            Diagnostic::error("E0106", span, message)
                .label("belongs to no condition")
                .help("every #if, #ifdef and #ifndef has at most one #else, and one #endif"),
        );
    }

    /// `#error`
    fn stop_directive(&mut self, name: PpToken, arguments: &[PpToken]) {
        let text = self.line_text(arguments);
        let span = self.span(name);
        let help = "the text asks for this: look at the conditions around the directive";
        self.diagnostics.push(Diagnostic::error("E0113", span, format!("#error {text}").trim_end()).help(help));
    }

    /// `#warning`
    fn warning_directive(&mut self, name: PpToken, arguments: &[PpToken]) {
        let text = self.line_text(arguments);
        let span = self.span(name);
        self.diagnostics.push(Diagnostic::warning("W0101", span, format!("#warning {text}").trim_end()));
    }

    /// `#pragma once`, `#pragma error "…"`, `#pragma warning "…"`, `#pragma osl nowarn`; all others are none of our business.
    fn pragma(&mut self, arguments: &[PpToken]) {
        if let Some((word, rest)) = arguments.split_first() {
            match self.text(*word) {
                "error" => return self.stop_directive(*word, rest),
                "warning" => return self.warning_directive(*word, rest),
                "osl" if rest.first().is_some_and(|t| self.text(*t) == "nowarn") => {
                    let line = self.table.files[word.place.file as usize].line(word.place.start);
                    self.table.quiet.push((word.place.file, line + 1));
                    return;
                }
                _ => {}
            }
        }
        if arguments.first().is_some_and(|t| self.text(*t) == "once")
            && let Some(input) = self.inputs.last()
        {
            let name = self.table.files[input.file as usize].name.clone();
            self.once.insert(super::include::key(&*name));
        }
    }

    /// A directive that does not exist.
    fn unknown(&mut self, name: PpToken, word: &str) {
        let close = KNOWN.iter().min_by_key(|known| distance(word, known)).copied().unwrap_or("include");
        let help = if distance(word, close) <= 2 {
            format!("did you mean `#{close}`?")
        } else {
            format!("the directives are: {}", KNOWN.join(", "))
        };
        let span = self.span(name);
        self.diagnostics.push(
            Diagnostic::error("E0101", span, format!("there is no directive #{word}")).label("unknown").help(help),
        );
    }

    /// The text of a line of tokens as it was written.
    pub(super) fn line_text(&self, tokens: &[PpToken]) -> String {
        match (tokens.first(), tokens.last()) {
            (Some(a), Some(b)) => self.table.text(Place { end: b.place.end, ..a.place }).to_string(),
            _ => String::new(),
        }
    }
}

/// How many letters must be added, removed or changed to turn one word into another.
fn distance(a: &str, b: &str) -> usize {
    if a.len() > 20 {
        return usize::MAX;
    }
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for j in 0..b.len() {
            let changed = diagonal + usize::from(b[j] != x);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
