//! The C preprocessor: files in, expanded tokens out, each knowing where it came from.
//!
//! Tokens are *pulled*. Below lies a stack of files; above it a stack of frames, each the replacement of one macro
//! call. A macro is switched off while its frame is on the stack, and a name that is pulled while its macro is off
//! is painted: it will never be expanded again. That is the whole recursion guard. Everything that can multiply text
//! is paid for from one budget, so that no input, however clever, runs for long.

mod condition;
mod directive;
mod expand;
mod include;
mod macros;
mod output;
pub mod scan;

use crate::Options;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Place, SourceFile, SourceTable};
use crate::span::Span;
use macros::Macro;
use scan::{Kind, PpToken, scan};
use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

pub(crate) use output::to_text;

/// How many tokens files and macros may produce together.
const BUDGET: usize = 4_000_000;

/// The result: the tokens with their indices in the table.
pub(crate) struct Preprocessed {
    /// The tokens, each with its index in the table of expanded tokens.
    pub tokens: Vec<(PpToken, u32)>,
    /// The files, the table and the calls.
    pub table: SourceTable,
    /// What was wrong.
    pub diagnostics: Diagnostics,
    /// A limit ended the run: the tokens are not all there are.
    pub stopped: bool,
}

/// The FNV-1a hash: every name is looked up once, and names are short.
#[derive(Clone, Copy)]
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

/// A file that is being read.
struct Input {
    tokens: Rc<[PpToken]>,
    cursor: usize,
    file: u32,
    conditions: Vec<Conditional>,
    /// Where `#include "…"` looks first; `None` for text that has no folder.
    folder: Option<PathBuf>,
}

/// An `#if` that is open.
struct Conditional {
    place: Place,
    /// Its tokens are read now.
    active: bool,
    /// One of its branches has been read, or none may be because it stands in a dead branch itself.
    done: bool,
    /// Its `#else` has been passed.
    in_else: bool,
}

impl Input {
    fn active(&self) -> bool {
        self.conditions.last().is_none_or(|c| c.active)
    }
}

/// A piece of text that is read before the files.
struct Frame {
    tokens: Vec<PpToken>,
    cursor: usize,
    /// The macro to switch on again at the end.
    owner: Option<Rc<Macro>>,
    /// Nothing below is read until this one has been taken off explicitly.
    barrier: bool,
}

/// The state of one run.
pub(crate) struct Preprocessor<'o> {
    options: &'o Options,
    table: SourceTable,
    diagnostics: Diagnostics,
    macros: HashMap<String, Rc<Macro>, BuildHasherDefault<Fnv>>,
    inputs: Vec<Input>,
    frames: Vec<Frame>,
    /// Keys of the files that said `#pragma once`.
    once: HashSet<PathBuf>,
    budget: usize,
    /// Set when the budget is spent: nothing more is read.
    stopped: bool,
    /// Set while the arguments of a macro call are gathered: the end of a file ends them.
    gathering: bool,
    /// How many argument expansions are nested.
    depth: usize,
}

/// Runs the preprocessor over the prelude and a text.
pub(crate) fn run(name: &str, text: &str, options: &Options) -> Preprocessed {
    let mut state = Preprocessor {
        options,
        table: SourceTable::new(),
        diagnostics: Diagnostics::default(),
        macros: HashMap::default(),
        inputs: Vec::new(),
        frames: Vec::new(),
        once: HashSet::new(),
        budget: BUDGET,
        stopped: false,
        gathering: false,
        depth: 0,
    };
    // A stack: what is to be read first goes on last.
    state.open(name, Arc::from(text), None);
    if let Some((name, text)) = &options.prelude {
        state.open(name, Arc::from(text.as_str()), None);
    }
    state.open("<predefined>", Arc::from(macros::predefined(options)), None);
    state.macros.insert("__FILE__".into(), Macro::file());
    state.macros.insert("__LINE__".into(), Macro::line());
    let mut tokens = Vec::new();
    while let Some(token) = state.pull() {
        if let Some(token) = state.expand(token) {
            let index = state.table.expanded.len() as u32;
            state.table.expanded.push(crate::source::Expanded {
                place: token.place,
                call: token.call,
                space: token.space || token.line_start,
                aside: false,
            });
            tokens.push((token, index));
        }
    }
    Preprocessed { tokens, table: state.table, diagnostics: state.diagnostics, stopped: state.stopped }
}

impl Preprocessor<'_> {
    /// Puts a text on the stack of files.
    fn open(&mut self, name: &str, text: Arc<str>, included_from: Option<Place>) {
        let file = self.table.files.len() as u32;
        let tokens: Rc<[PpToken]> = scan(&text, file).into();
        let place = tokens.first().map(|t| t.place);
        self.table.files.push(SourceFile::new(name, text, included_from));
        let folder = std::path::Path::new(name).parent().map(PathBuf::from);
        let cost = tokens.len() + 16;
        self.inputs.push(Input { tokens, cursor: 0, file, conditions: Vec::new(), folder });
        self.spend(cost, included_from.or(place));
    }

    /// Pays for tokens. When nothing is left the run ends with one message.
    fn spend(&mut self, tokens: usize, place: Option<Place>) {
        if self.stopped {
            return;
        }
        match self.budget.checked_sub(tokens) {
            Some(left) => self.budget = left,
            None => {
                self.stopped = true;
                self.frames.clear();
                self.inputs.clear();
                let span = place.map_or(Span::NONE, |p| self.table.aside(p, crate::source::NO_CALL));
                self.diagnostics.push(
                    Diagnostic::error("E0114", span, format!("macros and includes produce more than {BUDGET} tokens"))
                        .label("the limit was passed here")
                        .help("look for macros that repeat their argument and call each other, or a file that includes itself"),
                );
            }
        }
    }

    /// The next token before expansion, from the frames or else from the files. `None` at a barrier or at the end.
    fn pull(&mut self) -> Option<PpToken> {
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
    fn drop_frame(&mut self) {
        if let Some(owner) = self.frames.pop().and_then(|f| f.owner) {
            owner.off.set(false);
        }
    }

    /// The next token of the files; directives are obeyed on the way.
    fn pull_from_file(&mut self) -> Option<PpToken> {
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
    fn close(&mut self) {
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
    fn paren_follows(&self) -> bool {
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
    fn text(&self, token: PpToken) -> &str {
        self.table.text(token.place)
    }

    /// A span for a token of a directive or a macro call.
    fn span(&mut self, token: PpToken) -> Span {
        self.table.aside(token.place, token.call)
    }
}
