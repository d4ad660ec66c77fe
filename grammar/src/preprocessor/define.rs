//! `#define` and `#undef`.

use super::macros::{BodyToken, Macro, Meaning};
use super::scan::{Kind, PpToken};
use super::state::Preprocessor;
use crate::diagnostic::Diagnostic;
use std::cell::Cell;
use std::rc::Rc;

impl Preprocessor<'_> {
    /// `#define NAME body` or `#define NAME(a, b) body`
    pub(super) fn define(&mut self, directive: PpToken, arguments: &[PpToken]) {
        let Some(name) = self.macro_name(directive, arguments) else {
            return;
        };
        let text = self.text(name).to_string();
        if text == "defined" || text == "__VA_ARGS__" || self.is_built_in(&text) {
            let span = self.span(name);
            self.diagnostics.push(
                Diagnostic::error("E0109", span, format!("{text} cannot be defined"))
                    .label("has a fixed meaning")
                    .help("choose another name"),
            );
            return;
        }
        let mut rest = &arguments[1..];
        let mut params = None;
        let mut variadic = false;
        if rest.first().is_some_and(|t| t.kind == Kind::ParenOpen && !t.space) {
            let Some((names, all, length)) = self.parameters(rest) else {
                return;
            };
            (params, variadic) = (Some(names), all);
            rest = &rest[length..];
        }
        let Some(body) = self.body(rest, params.as_deref()) else {
            return;
        };
        let place = Some(name.place);
        let new = Macro { meaning: Meaning::Body, place, params, variadic, body, off: Cell::new(false) };
        if let Some(old) = self.macros.get(&text).cloned()
            && !self.same(&old, &new)
        {
            self.redefined(&text, name, &old);
        }
        self.macros.insert(text, Rc::new(new));
    }

    fn is_built_in(&self, name: &str) -> bool {
        self.macros.get(name).is_some_and(|m| m.meaning != Meaning::Body)
    }

    /// The names between the parentheses, whether the last one takes the rest, and how many tokens that was.
    fn parameters(&mut self, tokens: &[PpToken]) -> Option<(Vec<String>, bool, usize)> {
        let mut names: Vec<String> = Vec::new();
        let mut i = 1;
        if tokens.get(1).is_some_and(|t| t.kind == Kind::ParenClose) {
            return Some((names, false, 2));
        }
        loop {
            let token = tokens.get(i).copied();
            let mut variadic = false;
            match token {
                Some(t) if t.kind == Kind::Ellipsis => {
                    names.push("__VA_ARGS__".into());
                    variadic = true;
                }
                Some(t) if t.kind == Kind::Name && !names.iter().any(|n| n == self.text(t)) => {
                    names.push(self.text(t).to_string());
                    if tokens.get(i + 1).is_some_and(|t| t.kind == Kind::Ellipsis) {
                        variadic = true;
                        i += 1;
                    }
                }
                _ => return self.bad_parameters(token.unwrap_or(tokens[0])),
            }
            match tokens.get(i + 1) {
                Some(t) if t.kind == Kind::ParenClose => return Some((names, variadic, i + 2)),
                Some(t) if t.kind == Kind::Comma && !variadic => i += 2,
                other => return self.bad_parameters(*other.unwrap_or(&tokens[0])),
            }
        }
    }

    fn bad_parameters<T>(&mut self, token: PpToken) -> Option<T> {
        let span = self.span(token);
        self.diagnostics.push(
            Diagnostic::error("E0109", span, "the parameters of this macro are malformed")
                .label("not expected here")
                .help("write different names separated by commas: `#define NAME(a, b) …`"),
        );
        None
    }

    /// The body with its parameters found.
    fn body(&mut self, tokens: &[PpToken], params: Option<&[String]>) -> Option<Vec<BodyToken>> {
        let find = |s: &Self, t: PpToken| params.and_then(|p| p.iter().position(|name| name == s.text(t)));
        let body: Vec<BodyToken> = tokens
            .iter()
            .map(|t| BodyToken { token: *t, param: if t.kind == Kind::Name { find(self, *t) } else { None } })
            .collect();
        let at_edge = [body.first(), body.last()].into_iter().flatten().find(|b| b.token.kind == Kind::Paste);
        if let Some(edge) = at_edge {
            let span = self.span(edge.token);
            self.diagnostics.push(
                Diagnostic::error("E0109", span, "`##` stands at an end of the macro's body")
                    .label("joins nothing")
                    .help("put a token on both sides of `##`"),
            );
            return None;
        }
        let lonely = |i: usize| body[i].token.kind == Kind::Hash && body.get(i + 1).is_none_or(|b| b.param.is_none());
        if let Some(i) = (0..body.len()).find(|i| params.is_some() && lonely(*i)) {
            let span = self.span(body[i].token);
            self.diagnostics.push(
                Diagnostic::error("E0109", span, "`#` is not followed by a parameter of the macro")
                    .label("makes a string of nothing")
                    .help("name one of the parameters after `#`"),
            );
            return None;
        }
        Some(body)
    }

    /// True when two macros are written alike, spaces aside.
    fn same(&self, a: &Macro, b: &Macro) -> bool {
        a.params == b.params
            && a.variadic == b.variadic
            && a.body.len() == b.body.len()
            && a.body.iter().zip(&b.body).all(|(x, y)| self.text(x.token) == self.text(y.token))
    }

    fn redefined(&mut self, text: &str, name: PpToken, old: &Macro) {
        let span = self.span(name);
        let mut message =
            Diagnostic::warning("W0102", span, format!("macro {text} is defined again with another body"))
                .label("this one is used from here on")
                .help(format!("write `#undef {text}` before it if that is meant"));
        if let Some(place) = old.place {
            message = message.also(self.table.aside(place, crate::source::NO_CALL), "first defined here");
        }
        self.diagnostics.push(message);
    }

    /// `#undef NAME`
    pub(super) fn undefine(&mut self, directive: PpToken, arguments: &[PpToken]) {
        let Some(name) = self.macro_name(directive, arguments) else {
            return;
        };
        let text = self.text(name).to_string();
        if !self.is_built_in(&text) {
            self.macros.remove(&text);
        }
    }
}
