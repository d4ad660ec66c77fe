//! Macro expansion: arguments, substitution, `#` and `##`.

use super::macros::{BodyToken, Macro, Meaning};
use super::scan::{Kind, PpToken, scan};
use super::state::{Frame, Preprocessor};
use crate::diagnostic::Diagnostic;
use crate::source::{MacroCall, NO_CALL, Place};
use std::rc::Rc;

/// How deep macro calls may be nested in each other's arguments.
const MAX_DEPTH: usize = 200;

/// An argument as written, and expanded once that is asked for.
struct Argument {
    raw: Vec<PpToken>,
    expanded: Option<Vec<PpToken>>,
}

impl Preprocessor<'_> {
    /// Expands a token if it calls a macro: then the replacement is put where tokens are pulled from and nothing is
    /// given back. Any other token is given back as it is.
    pub(super) fn expand(&mut self, token: PpToken) -> Option<PpToken> {
        if token.kind != Kind::Name || token.painted {
            return Some(self.checked(token));
        }
        let Some(found) = self.macros.get(self.table.text(token.place)) else {
            return Some(token);
        };
        let found = found.clone();
        if found.off.get() {
            return Some(PpToken { painted: true, ..token });
        }
        match found.meaning {
            Meaning::File | Meaning::Line => Some(self.position(token, found.meaning)),
            Meaning::Body if found.params.is_none() => {
                self.replace(token, &found, Vec::new());
                None
            }
            Meaning::Body => {
                if !self.paren_follows() {
                    return Some(token);
                }
                match self.arguments(token, &found) {
                    Some(arguments) => {
                        self.replace(token, &found, arguments);
                        None
                    }
                    None => Some(PpToken { kind: Kind::Broken, ..token }),
                }
            }
        }
    }

    /// Reports a comment without end, which the scanner can only pass on.
    fn checked(&mut self, token: PpToken) -> PpToken {
        if token.kind != Kind::UnclosedComment {
            return token;
        }
        let span = self.span(PpToken { place: Place { end: token.place.start + 2, ..token.place }, ..token });
        self.diagnostics.push(
            Diagnostic::error("E0116", span, "this comment is never closed")
                .label("the comment starts here")
                .help("add `*/` where it ends"),
        );
        PpToken { kind: Kind::Broken, ..token }
    }

    /// Expands a list of tokens on its own.
    pub(super) fn expand_all(&mut self, tokens: Vec<PpToken>) -> Vec<PpToken> {
        if self.depth >= MAX_DEPTH {
            if let Some(first) = tokens.first() {
                self.too_deep(*first);
            }
            return tokens;
        }
        self.depth += 1;
        let gathering = std::mem::replace(&mut self.gathering, false);
        self.frames.push(Frame { tokens, cursor: 0, owner: None, barrier: true });
        let base = self.frames.len();
        let mut out = Vec::new();
        while let Some(token) = self.pull() {
            out.extend(self.expand(token));
            // A spent budget clears all frames, the barrier among them: what follows is not ours to read.
            if self.frames.len() < base {
                break;
            }
        }
        if self.frames.len() >= base {
            self.drop_frame();
        }
        self.gathering = gathering;
        self.depth -= 1;
        out
    }

    fn too_deep(&mut self, token: PpToken) {
        let span = self.span(token);
        self.diagnostics.push(
            Diagnostic::error("E0115", span, format!("macro calls are nested more than {MAX_DEPTH} deep"))
                .label("not expanded further")
                .help("write intermediate results to variables"),
        );
        self.stopped = true;
        self.frames.clear();
        self.inputs.clear();
    }

    /// `__FILE__` or `__LINE__`: the place where the user's text made it.
    fn position(&mut self, token: PpToken, meaning: Meaning) -> PpToken {
        let place = self.table.outermost(token.place, token.call);
        let file = &self.table.files[place.file as usize];
        let (kind, text) = match meaning {
            Meaning::File => (Kind::Text, format!("\"{}\"", escaped(&file.name))),
            _ => (Kind::Number, (file.line(place.start) + 1).to_string()),
        };
        self.spend(1 + text.len() / 8, Some(place));
        let call = self.call(token, None);
        PpToken { kind, place: self.table.invent(&text), call, ..token }
    }

    /// Notes a call of a macro.
    fn call(&mut self, name: PpToken, defined: Option<Place>) -> u32 {
        let text = self.text(name).into();
        self.table.calls.push(MacroCall { name: text, place: name.place, parent: name.call, defined });
        self.table.calls.len() as u32 - 1
    }

    /// Reads the arguments of a call whose `(` is next. `None` after a mistake, which has been reported.
    fn arguments(&mut self, name: PpToken, called: &Rc<Macro>) -> Option<Vec<Argument>> {
        let outer = std::mem::replace(&mut self.gathering, true);
        let lists = self.gather(called);
        self.gathering = outer;
        let Some(mut lists) = lists else {
            if !self.stopped {
                let text = self.text(name).to_string();
                let span = self.span(name);
                self.diagnostics.push(
                    Diagnostic::error("E0111", span, format!("this call of macro {text} is never closed"))
                        .label("called here")
                        .help("add the missing `)`"),
                );
            }
            return None;
        };
        let wanted = called.params.as_ref().map_or(0, Vec::len);
        if wanted == 0 && lists.len() == 1 && lists[0].is_empty() {
            lists.clear();
        }
        if called.variadic && lists.len() + 1 == wanted {
            lists.push(Vec::new());
        }
        if lists.len() != wanted {
            self.wrong_count(name, called, lists.len());
            return None;
        }
        Some(lists.into_iter().map(|raw| Argument { raw, expanded: None }).collect())
    }

    /// The tokens between the parentheses, split at the commas of the outer level.
    fn gather(&mut self, called: &Macro) -> Option<Vec<Vec<PpToken>>> {
        let most = called.params.as_ref().map_or(0, Vec::len);
        let (mut lists, mut depth) = (vec![Vec::new()], 0usize);
        loop {
            let mut token = self.pull()?;
            token.space |= token.line_start;
            token.line_start = false;
            match token.kind {
                Kind::ParenOpen => depth += 1,
                Kind::ParenClose => depth = depth.saturating_sub(1),
                _ => {}
            }
            let rest = called.variadic && lists.len() >= most;
            match token.kind {
                Kind::ParenOpen if depth == 1 => {}
                Kind::ParenClose if depth == 0 => return Some(lists),
                Kind::Comma if depth == 1 && !rest => lists.push(Vec::new()),
                // A name whose macro is off here must stay unexpanded when the argument is read again later.
                Kind::Name if self.is_off(token) => lists.last_mut()?.push(PpToken { painted: true, ..token }),
                _ => lists.last_mut()?.push(token),
            }
        }
    }

    fn is_off(&self, token: PpToken) -> bool {
        self.macros.get(self.table.text(token.place)).is_some_and(|m| m.off.get())
    }

    fn wrong_count(&mut self, name: PpToken, called: &Macro, given: usize) {
        let params = called.params.as_deref().unwrap_or_default();
        let wanted = params.len();
        let text = self.text(name).to_string();
        let span = self.span(name);
        let (least, plural) = if called.variadic { ("at least ", wanted - 1) } else { ("", wanted) };
        let message =
            format!("macro {text} takes {least}{plural} argument{}, not {given}", if plural == 1 { "" } else { "s" });
        let mut message = Diagnostic::error("E0110", span, message)
            .label("called here")
            .help(format!("its parameters are ({})", params.join(", ")));
        if let Some(place) = called.place {
            message = message.also(self.table.aside(place, NO_CALL), "defined here");
        }
        self.diagnostics.push(message);
    }

    /// Puts the replacement of a call where tokens are pulled from, and switches the macro off.
    fn replace(&mut self, name: PpToken, called: &Rc<Macro>, mut arguments: Vec<Argument>) {
        let call = self.call(name, called.place);
        let mut tokens = self.substitute(called, &mut arguments, call);
        if let Some(first) = tokens.first_mut() {
            first.space = name.space;
            first.line_start = name.line_start;
        }
        self.spend(tokens.len() + 1, Some(name.place));
        if !self.stopped {
            called.off.set(true);
            self.frames.push(Frame { tokens, cursor: 0, owner: Some(called.clone()), barrier: false });
        }
    }

    /// The body with arguments put in, `#` and `##` done.
    fn substitute(&mut self, called: &Macro, arguments: &mut [Argument], call: u32) -> Vec<PpToken> {
        let body = &called.body;
        let mut out: Vec<PpToken> = Vec::with_capacity(body.len());
        let mut i = 0;
        while i < body.len() && !self.stopped {
            // Most tokens stand for themselves: they need no list of their own.
            let (here, next) = (body[i], body.get(i + 1));
            let plain = here.param.is_none() && here.token.kind != Kind::Hash;
            if plain && next.is_none_or(|b| b.token.kind != Kind::Paste) {
                out.push(PpToken { call, line_start: false, ..here.token });
                i += 1;
                continue;
            }
            let (piece, next) = self.operand(body, i, arguments, call, called.params.is_some());
            let pasted = body.get(next).is_some_and(|b| b.token.kind == Kind::Paste);
            if !pasted {
                match piece {
                    Some(tokens) => out.extend(tokens),
                    None => self.argument(body[i], arguments, &mut out),
                }
                i = next;
                continue;
            }
            let mut left = piece.unwrap_or_else(|| raw(body[i], arguments));
            i = next;
            while body.get(i).is_some_and(|b| b.token.kind == Kind::Paste) && i + 1 < body.len() {
                let right_at = body[i + 1];
                let (piece, next) = self.operand(body, i + 1, arguments, call, called.params.is_some());
                let right = piece.unwrap_or_else(|| raw(right_at, arguments));
                let rest = called.variadic && right_at.param == Some(arguments.len() - 1);
                self.paste(&mut left, right, call, rest);
                i = next;
            }
            out.append(&mut left);
        }
        out
    }

    /// What stands at a place of the body: tokens, or `None` for a parameter; and where the next thing stands.
    fn operand(
        &mut self,
        body: &[BodyToken],
        i: usize,
        arguments: &[Argument],
        call: u32,
        parameters: bool,
    ) -> (Option<Vec<PpToken>>, usize) {
        let here = body[i];
        if parameters
            && here.token.kind == Kind::Hash
            && let Some(param) = body.get(i + 1).and_then(|b| b.param)
        {
            return (Some(vec![self.stringise(&arguments[param].raw, here.token, call)]), i + 2);
        }
        if here.param.is_some() {
            return (None, i + 1);
        }
        let token = PpToken { call, line_start: false, ..here.token };
        (Some(vec![token]), i + 1)
    }

    /// Adds an expanded argument.
    fn argument(&mut self, at: BodyToken, arguments: &mut [Argument], out: &mut Vec<PpToken>) {
        let Some(argument) = at.param.and_then(|p| arguments.get_mut(p)) else {
            return;
        };
        if argument.expanded.is_none() {
            argument.expanded = Some(self.expand_all(argument.raw.clone()));
        }
        let tokens = argument.expanded.as_deref().unwrap_or_default();
        let start = out.len();
        self.spend(tokens.len(), tokens.first().map(|t| t.place));
        if !self.stopped {
            out.extend_from_slice(tokens);
        }
        if let Some(first) = out.get_mut(start) {
            first.space = at.token.space;
        }
    }

    /// `#parameter`: the argument's text as a string.
    fn stringise(&mut self, tokens: &[PpToken], hash: PpToken, call: u32) -> PpToken {
        let mut text = String::from("\"");
        for (i, token) in tokens.iter().enumerate() {
            if token.space && i > 0 {
                text.push(' ');
            }
            let spelled = self.text(*token);
            match token.kind {
                Kind::Text => text.push_str(&escaped(spelled)),
                _ => text.push_str(spelled),
            }
        }
        text.push('"');
        self.spend(1 + text.len() / 8, Some(hash.place));
        PpToken { kind: Kind::Text, place: self.table.invent(&text), call, line_start: false, ..hash }
    }

    /// `left ## right`, where either may be empty.
    fn paste(&mut self, left: &mut Vec<PpToken>, mut right: Vec<PpToken>, call: u32, rest: bool) {
        // `, ## __VA_ARGS__`: the comma goes when there are no arguments left, and nothing is joined when there are.
        if rest && left.last().is_some_and(|t| t.kind == Kind::Comma) {
            if right.is_empty() {
                left.pop();
            }
            left.append(&mut right);
            return;
        }
        let (Some(a), Some(b)) = (left.last().copied(), right.first().copied()) else {
            left.append(&mut right);
            return;
        };
        let text = format!("{}{}", self.text(a), self.text(b));
        self.spend(1 + text.len() / 8 + right.len(), Some(a.place));
        let made = scan(&text, crate::source::SCRATCH);
        let [one] = made[..] else {
            let at = self.table.outermost(a.place, call);
            let span = self.table.aside(at, NO_CALL);
            self.diagnostics.push(
                Diagnostic::error("E0112", span, format!("`##` makes `{text}`, which is not one token"))
                    .label("in this macro call")
                    .help("`##` joins parts of names or numbers; leave it out to put tokens side by side"),
            );
            left.append(&mut right);
            return;
        };
        let place = self.table.invent(&text);
        left.pop();
        left.push(PpToken { kind: one.kind, place, call, painted: false, ..a });
        left.extend(right.into_iter().skip(1));
    }
}

/// An argument as it was written.
fn raw(at: BodyToken, arguments: &[Argument]) -> Vec<PpToken> {
    at.param.and_then(|p| arguments.get(p)).map(|a| a.raw.clone()).unwrap_or_default()
}

/// Text for the inside of a string literal.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}
