//! What surrounds a place, by the tokens as they stand: the call it is an argument of, the string it is in, the brackets around it.

use super::study::Study;
use crate::check::notes::Meaning;
use crate::lang::types::{Base, Type};
use std::collections::HashMap;
use velour_grammar::places::{MAIN_FILE, RawKind, RawToken, TextRange};

/// The call that a place is an argument of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Call {
    /// The name before the bracket.
    pub name: String,
    /// Which argument it is, from 0.
    pub argument: usize,
    /// The string before this argument, when one stands there alone.
    pub word: Option<String>,
}

impl Study {
    /// The text of a token.
    pub(super) fn text_at(&self, token: &RawToken) -> &str {
        &self.text[token.start..token.end]
    }

    /// The tokens that end at or before a byte.
    pub(super) fn before(&self, offset: usize) -> &[RawToken] {
        &self.raw[..self.raw.partition_point(|token| token.end <= offset)]
    }

    /// The string that a byte lies in, its quotes left out.
    pub(super) fn string_at(&self, offset: usize) -> Option<&RawToken> {
        let at = self.raw.partition_point(|token| token.end < offset);
        let near = self.raw[at..].iter().take_while(|token| token.start < offset).find(|t| t.kind == RawKind::Text)?;
        let text = self.text_at(near);
        let closed = text.len() > 1 && text.ends_with('"');
        (offset < near.end || !closed).then_some(near)
    }

    /// Does a byte lie in a comment?
    pub(super) fn in_comment(&self, offset: usize) -> bool {
        let before = self.raw.partition_point(|token| token.start < offset);
        let last = before.checked_sub(1).map(|at| self.raw[at]);
        if last.is_some_and(|token| token.end >= offset) {
            return false;
        }
        let gap = &self.text[last.map_or(0, |token| token.end)..offset];
        let block = gap.rfind("/*").is_some_and(|open| gap.rfind("*/").is_none_or(|close| close < open));
        block || gap.rsplit('\n').next().is_some_and(|line| line.contains("//"))
    }

    /// The innermost call around a byte. A statement's end or a brace stops the search.
    pub(super) fn call_at(&self, offset: usize) -> Option<Call> {
        let tokens = self.before(offset);
        let (mut depth, mut argument) = (0usize, 0);
        let mut word: Option<String> = None;
        for at in (0..tokens.len()).rev() {
            match self.text_at(&tokens[at]) {
                ")" | "]" => depth += 1,
                "(" if depth == 0 => {
                    let name = tokens.get(at.checked_sub(1)?).filter(|token| token.kind == RawKind::Name)?;
                    return Some(Call { name: self.text_at(name).to_owned(), argument, word });
                }
                "[" if depth == 0 => return None,
                "(" | "[" => depth -= 1,
                "[[" => depth = depth.saturating_sub(2),
                ";" | "{" | "}" => return None,
                "," if depth == 0 => {
                    if argument == 0 {
                        let before = at.checked_sub(1).map(|before| tokens[before]);
                        let string = before.filter(|token| token.kind == RawKind::Text);
                        word = string.map(|token| self.text_at(&token).trim_matches('"').to_owned());
                    }
                    argument += 1;
                }
                _ => {}
            }
        }
        None
    }

    /// Name and number of each variable that the text itself declares.
    pub(super) fn own_variables(&self) -> Vec<(&str, usize)> {
        self.declared_variables().into_iter().map(|(name, var, _)| (name, var)).collect()
    }

    fn declared_variables(&self) -> Vec<(&str, usize, TextRange)> {
        let mut out = Vec::new();
        for used in self.notes.uses.iter().filter(|used| used.declares) {
            let Meaning::Variable(var) = used.meaning else { continue };
            let token = self.checked.sources.name_token(used.span, &used.name);
            let place = token.and_then(|token| self.position(token)).filter(|place| place.file == MAIN_FILE);
            out.extend(place.map(|place| (used.name.as_str(), var.0 as usize, place)));
        }
        out
    }

    /// Name and number of each variable of the text that may be used at a byte, the innermost last.
    pub(super) fn visible_variables(&self, offset: usize) -> Vec<(&str, usize)> {
        let pairs = self.pairs();
        let mut all = self.declared_variables();
        all.retain(|(_, _, place)| {
            let end = || self.scope_end(place.start as usize, &pairs);
            (place.end as usize) < offset && end().is_none_or(|end| offset <= end)
        });
        all.into_iter().map(|(name, var, _)| (name, var)).collect()
    }

    /// The innermost variable of a name that may be used at a byte.
    pub(super) fn variable(&self, name: &str, offset: usize) -> Option<usize> {
        let own = self.visible_variables(offset).into_iter().rev().find(|(known, _)| *known == name);
        let global = || self.notes.variables.iter().position(|v| v.global.is_some() && v.name == *name);
        own.map(|(_, var)| var).or_else(global)
    }

    /// The brackets of the text: from each to the one that closes it.
    fn pairs(&self) -> HashMap<usize, usize> {
        let (mut open, mut pairs): (Vec<(usize, &str)>, _) = (Vec::new(), HashMap::new());
        for (at, token) in self.raw.iter().enumerate().filter(|(_, token)| !token.directive) {
            let wanted = match self.text_at(token) {
                text @ ("{" | "(" | "[" | "[[") => {
                    open.push((at, text));
                    continue;
                }
                "}" => "{",
                ")" => "(",
                "]" => "[",
                _ => continue,
            };
            // A bracket that is missing is taken to be missing inside.
            if let Some(last) = open.iter().rposition(|(_, text)| *text == wanted) {
                pairs.insert(open[last].0, at);
                open.truncate(last);
            }
        }
        pairs
    }

    /// Where a variable that is declared at a byte ends to be; nothing for the end of the text.
    fn scope_end(&self, declared: usize, pairs: &HashMap<usize, usize>) -> Option<usize> {
        let at = self.raw.partition_point(|token| token.start < declared);
        let around = (0..at).rev().find(|open| {
            matches!(self.text_at(&self.raw[*open]), "{" | "(") && pairs.get(open).is_none_or(|close| *close > at)
        })?;
        let close = pairs.get(&around).copied();
        if self.text_at(&self.raw[around]) == "{" {
            return close.map(|close| self.raw[close].end);
        }
        // Parameters live on in the body, and what a `for` declares in its loop.
        let mut next = close? + 1;
        let metadata = |next: usize| self.raw.get(next).is_some_and(|token| self.text_at(token) == "[[");
        if metadata(next) {
            next = (next..self.raw.len()).find(|at| matches!(self.text_at(&self.raw[*at]), "{" | ";"))?;
        }
        let end = match self.raw.get(next).map(|token| self.text_at(token)) {
            Some("{") => pairs.get(&next).copied(),
            _ => (next..self.raw.len()).find(|at| self.text_at(&self.raw[*at]) == ";"),
        };
        end.map(|end| self.raw[end].end)
    }

    /// The type of what stands before a dot: a variable, and the fields and elements taken of it.
    pub(super) fn type_before_dot(&self, offset: usize) -> Option<Type> {
        let tokens = self.before(offset);
        let tokens = match tokens.split_last() {
            Some((last, rest)) if last.kind == RawKind::Name => rest,
            _ => tokens,
        };
        let (dot, mut rest) = tokens.split_last()?;
        if self.text_at(dot) != "." {
            return None;
        }
        let mut steps: Vec<Option<&str>> = Vec::new();
        loop {
            let (last, before) = rest.split_last()?;
            if self.text_at(last) == "]" {
                let open = before.iter().rposition(|token| self.text_at(token) == "[")?;
                steps.push(None);
                rest = &before[..open];
                continue;
            }
            if last.kind != RawKind::Name {
                return None;
            }
            match before.split_last() {
                Some((dot, outer)) if self.text_at(dot) == "." => {
                    steps.push(Some(self.text_at(last)));
                    rest = outer;
                }
                _ => {
                    let var = self.variable(self.text_at(last), offset)?;
                    let ty = self.notes.variables.get(var)?.ty.clone();
                    return steps.iter().rev().try_fold(ty, |ty, step| part(&ty, *step));
                }
            }
        }
    }
}

/// A field, or an element, of a value.
fn part(ty: &Type, step: Option<&str>) -> Option<Type> {
    match step {
        None if ty.is_array() => Some(ty.element_type()),
        None => ty.base().filter(|base| base.is_triple()).map(|_| Type::FLOAT),
        Some(name) => {
            let structure = ty.structure().filter(|_| !ty.is_array())?;
            structure.fields.iter().find(|(field, _)| field == name).map(|(_, ty)| ty.clone())
        }
    }
}

/// The names after a dot, with their types.
pub(super) fn members(ty: &Type) -> Vec<(String, Type)> {
    if let Some(structure) = ty.structure().filter(|_| !ty.is_array()) {
        return structure.fields.clone();
    }
    let names: &[&str] = match ty.base() {
        Some(Base::Color) => &["r", "g", "b"],
        Some(base) if base.is_triple() => &["x", "y", "z"],
        _ => &[],
    };
    names.iter().map(|name| ((*name).to_owned(), Type::FLOAT)).collect()
}
