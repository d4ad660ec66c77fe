//! A text that is being written: everything there is to say about it, though it does not parse.

use super::compiler::{Checked, Compiler};
use super::shader::Shader;
use crate::check::check_noting;
use crate::check::notes::Notes;
use std::collections::HashSet;
use std::sync::Arc;
use velour_grammar::places::MAIN_FILE;
use velour_grammar::{Diagnostic, Diagnostics, Parsed, Sources, Span, parse};

impl Compiler {
    /// Says everything there is to say about a text that is being written: what is wrong beside a syntax error too, and what its names
    /// stand for.
    pub fn study(&self, name: &str, text: &str) -> (Checked, Notes) {
        self.study_closely(parse(name, text, &self.options), name, text, true)
    }

    /// What is wrong with a text that does not parse, the mistakes beside those of syntax too.
    pub(super) fn check_around(&self, parsed: Parsed, name: &str, text: &str) -> Checked {
        self.study_closely(parsed, name, text, false).0
    }

    fn study_closely(&self, parsed: Parsed, name: &str, text: &str, closely: bool) -> (Checked, Notes) {
        let parsed = self.parse_on(parsed, name, text);
        let syntax = parsed.diagnostics.has_errors();
        let mut diagnostics = parsed.diagnostics;
        let (typed, mut more, notes) = check_noting(&parsed.file, self.closures.table());
        if syntax {
            drop_echoes(&mut more, &notes, &parsed.sources);
        }
        diagnostics.append(more);
        if let Some(typed) = typed.as_ref().filter(|_| closely) {
            let mut odd = crate::check::unused(typed);
            odd.list.retain(|d| parsed.sources.written(d.span).is_some_and(|at| at.file == MAIN_FILE));
            diagnostics.append(odd);
        }
        let shader = typed.filter(|_| !syntax).map(|typed| Shader {
            typed: Arc::new(typed),
            sources: parsed.sources.clone(),
            closures: self.closures.clone(),
        });
        let mut checked = Checked { shader, diagnostics, sources: parsed.sources, tree: parsed.file };
        checked.drop_quiet();
        (checked, notes)
    }

    /// A parsed text; where statements lack only their `;` as if it were there, because what does not parse takes the block around it along.
    fn parse_on(&self, parsed: Parsed, name: &str, text: &str) -> Parsed {
        let missing: Vec<&Diagnostic> = parsed.diagnostics.list.iter().filter(|d| d.code == "E0302").collect();
        let mut mended = text.as_bytes().to_vec();
        let mut places = Vec::new();
        for diagnostic in missing {
            let Some(place) = parsed.sources.written(diagnostic.span).filter(|place| place.file == MAIN_FILE) else {
                continue;
            };
            // In place of white space, so that all else stays where it is.
            if let Some(byte) = mended.get_mut(place.end as usize).filter(|byte| matches!(**byte, b' ' | b'\t' | b'\n'))
            {
                *byte = b';';
                places.push((place, diagnostic.clone()));
            }
        }
        let Some(mended) = String::from_utf8(mended).ok().filter(|_| !places.is_empty()) else { return parsed };
        let mut again = parse(name, &mended, &self.options);
        let errors = |parsed: &Parsed| {
            parsed.diagnostics.list.iter().filter(|d| d.severity == velour_grammar::Severity::Error).count()
        };
        if errors(&again) + places.len() > errors(&parsed) {
            return parsed;
        }
        for (place, diagnostic) in places {
            let token = again.sources.token_at(place).unwrap_or(Span::NONE.first);
            again.diagnostics.push(Diagnostic { span: Span { first: token, last: token }, ..diagnostic });
        }
        again.diagnostics.list.sort_by_key(|d| d.span.first);
        again.sources = again.sources.in_text(text);
        again
    }
}

/// Drops what is said only because the tree lacks what did not parse: a shader, a `return`, or a name that stands where nobody knows
/// what it is.
fn drop_echoes(diagnostics: &mut Diagnostics, notes: &Notes, sources: &Sources) {
    let missing = |code: &str| matches!(code, "E0403" | "E0405" | "E0407");
    let known: HashSet<u32> = notes.uses.iter().filter_map(|used| sources.name_token(used.span, &used.name)).collect();
    let told: HashSet<u32> =
        diagnostics.list.iter().filter(|d| missing(d.code)).flat_map(|d| d.span.first..=d.span.last).collect();
    let lost = (0..sources.token_count()).filter(|token| !known.contains(token) && !told.contains(token));
    let word = |text: &&str| text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let lost: HashSet<&str> = lost.map(|token| sources.token_text(token)).filter(word).collect();
    let echo = |d: &Diagnostic| match d.code {
        "E0402" | "E0409" | "E0508" => true,
        code => missing(code) && (d.span.first..=d.span.last).any(|token| lost.contains(sources.token_text(token))),
    };
    diagnostics.list.retain(|d| !echo(d));
}
