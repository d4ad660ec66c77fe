//! The state of a run: the stack of files, the stack of frames above it, and where the next token comes from.

use super::macros::Macro;
use super::scan::{Kind, PpToken, scan};
use crate::Options;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::limits::TOKENS;
use crate::names::NameMap;
use crate::source::{Place, SourceFile, SourceTable};
use crate::span::Span;
use std::collections::HashSet;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// A file that is being read.
pub(super) struct Input {
    pub(super) tokens: Rc<Vec<PpToken>>,
    pub(super) cursor: usize,
    pub(super) file: u32,
    pub(super) conditions: Vec<Conditional>,
    /// Where `#include "…"` looks first; `None` for text that has no folder.
    pub(super) folder: Option<PathBuf>,
}

/// An `#if` that is open.
pub(super) struct Conditional {
    pub(super) place: Place,
    /// Its tokens are read now.
    pub(super) active: bool,
    /// One of its branches has been read, or none may be because it stands in a dead branch itself.
    pub(super) done: bool,
    /// Its `#else` has been passed.
    pub(super) in_else: bool,
}

impl Input {
    pub(super) fn active(&self) -> bool {
        self.conditions.last().is_none_or(|c| c.active)
    }
}

/// A piece of text that is read before the files.
pub(super) struct Frame {
    pub(super) tokens: Vec<PpToken>,
    pub(super) cursor: usize,
    /// The macro to switch on again at the end.
    pub(super) owner: Option<Rc<Macro>>,
    /// Nothing below is read until this one has been taken off explicitly.
    pub(super) barrier: bool,
}

/// The state of one run.
pub(super) struct Preprocessor<'o> {
    pub(super) options: &'o Options,
    pub(super) table: SourceTable,
    pub(super) diagnostics: Diagnostics,
    pub(super) macros: NameMap<String, Rc<Macro>>,
    pub(super) inputs: Vec<Input>,
    pub(super) frames: Vec<Frame>,
    /// Keys of the files that said `#pragma once`.
    pub(super) once: HashSet<PathBuf>,
    pub(super) budget: usize,
    /// Bytes of the files that were read.
    pub(super) bytes: u64,
    /// Set when the budget is spent: nothing more is read.
    pub(super) stopped: bool,
    /// Set while the arguments of a macro call are gathered: the end of a file ends them.
    pub(super) gathering: bool,
    /// How many argument expansions are nested.
    pub(super) depth: usize,
}

impl<'o> Preprocessor<'o> {
    /// Nothing read yet.
    pub(super) fn new(options: &'o Options) -> Self {
        Preprocessor {
            options,
            table: SourceTable::new(),
            diagnostics: Diagnostics::default(),
            macros: NameMap::default(),
            inputs: Vec::new(),
            frames: Vec::new(),
            once: HashSet::new(),
            budget: TOKENS,
            bytes: 0,
            stopped: false,
            gathering: false,
            depth: 0,
        }
    }
}

impl Preprocessor<'_> {
    /// Puts a text on the stack of files.
    pub(super) fn open(&mut self, name: &str, text: Arc<str>, included_from: Option<Place>) {
        let file = self.table.files.len() as u32;
        let tokens = Rc::new(scan(&text, file));
        let place = tokens.first().map(|t| t.place);
        self.table.files.push(SourceFile::new(name, text, included_from));
        let folder = std::path::Path::new(name).parent().map(PathBuf::from);
        let cost = tokens.len() + 16;
        self.inputs.push(Input { tokens, cursor: 0, file, conditions: Vec::new(), folder });
        self.spend(cost, included_from.or(place));
    }

    /// Ends the run: nothing more is read.
    pub(super) fn stop(&mut self) {
        self.stopped = true;
        self.frames.clear();
        self.inputs.clear();
    }

    /// Pays for tokens. When nothing is left the run ends with one message.
    pub(super) fn spend(&mut self, tokens: usize, place: Option<Place>) {
        if self.stopped {
            return;
        }
        match self.budget.checked_sub(tokens) {
            Some(left) => self.budget = left,
            None => {
                self.stop();
                let span = place.map_or(Span::NONE, |p| self.table.aside(p, crate::source::NO_CALL));
                self.diagnostics.push(
                    Diagnostic::error("E0114", span, format!("macros and includes produce more than {TOKENS} tokens"))
                        .label("the limit was passed here")
                        .help("look for macros that repeat their argument and call each other, or a file that includes itself"),
                );
            }
        }
    }

    /// The next token before expansion, from the frames or else from the files. `None` at a barrier or at the end.
    pub(super) fn pull(&mut self) -> Option<PpToken> {
        while let Some(frame) = self.frames.last_mut() {
            if let Some(token) = frame.tokens.get(frame.cursor) {
                frame.cursor += 1;
                return Some(*token);
            }
            if frame.barrier {
                return None;
            }
            self.drop_frame();
        }
        self.pull_from_file()
    }

    /// Takes the top frame off and switches its macro on again.
    pub(super) fn drop_frame(&mut self) {
        if let Some(owner) = self.frames.pop().and_then(|f| f.owner) {
            owner.off.set(false);
        }
    }

    /// The next token of the files; directives are obeyed on the way.
    pub(super) fn pull_from_file(&mut self) -> Option<PpToken> {
        loop {
            let input = self.inputs.last_mut()?;
            let Some(token) = input.tokens.get(input.cursor).copied() else {
                if self.gathering {
                    return None;
                }
                self.close();
                continue;
            };
            input.cursor += 1;
            if token.line_start && token.kind == Kind::Hash {
                self.directive(token);
            } else if input.active() {
                return Some(token);
            }
        }
    }

    /// Takes the top file off the stack.
    pub(super) fn close(&mut self) {
        let Some(input) = self.inputs.pop() else {
            return;
        };
        for open in input.conditions {
            let span = self.table.aside(open.place, crate::source::NO_CALL);
            self.diagnostics.push(
                Diagnostic::error("E0107", span, "this condition has no #endif")
                    .label("opened here")
                    .help("add `#endif` before the end of the file"),
            );
        }
    }

    /// True when the next token is `(`, without taking it. This may look past the end of macros, never of files.
    pub(super) fn paren_follows(&self) -> bool {
        for frame in self.frames.iter().rev() {
            if let Some(token) = frame.tokens.get(frame.cursor) {
                return token.kind == Kind::ParenOpen;
            }
            if frame.barrier {
                return false;
            }
        }
        let next = self.inputs.last().and_then(|input| input.tokens.get(input.cursor));
        next.is_some_and(|token| token.kind == Kind::ParenOpen)
    }

    /// The text of a token.
    pub(super) fn text(&self, token: PpToken) -> &str {
        self.table.text(token.place)
    }

    /// A span for a token of a directive or a macro call.
    pub(super) fn span(&mut self, token: PpToken) -> Span {
        self.table.aside(token.place, token.call)
    }
}
