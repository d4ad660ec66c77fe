//! The C preprocessor: files in, expanded tokens out, each knowing where it came from.
//!
//! Tokens are *pulled*. Below lies a stack of files; above it a stack of frames, each the replacement of one macro
//! call. A macro is switched off while its frame is on the stack, and a name that is pulled while its macro is off
//! is painted: it will never be expanded again. That is the whole recursion guard. Everything that can multiply text
//! is paid for from one budget, so that no input, however clever, runs for long.

mod condition;
mod define;
mod directive;
mod expand;
mod include;
mod macros;
mod output;
pub(crate) mod scan;
mod state;

use crate::Options;
use crate::diagnostic::Diagnostics;
use crate::source::SourceTable;
use macros::Macro;
use scan::Kind;
use state::Preprocessor;
use std::sync::Arc;

pub(crate) use output::to_text;

/// The result: the tokens with their indices in the table.
pub(crate) struct Preprocessed {
    /// The tokens.
    pub tokens: Vec<Terminal>,
    /// The files, the table and the calls.
    pub table: SourceTable,
    /// What was wrong.
    pub diagnostics: Diagnostics,
    /// A limit ended the run: the tokens are not all there are.
    pub stopped: bool,
}

/// A token after macros; the rest of it is in the table.
#[derive(Clone, Copy)]
pub(crate) struct Terminal {
    /// What it is.
    pub kind: Kind,
    /// It was the first of its line.
    pub line_start: bool,
    /// Its index in the table of expanded tokens.
    pub index: u32,
}

/// Runs the preprocessor over the prelude and a text.
pub(crate) fn run(name: &str, text: &str, options: &Options) -> Preprocessed {
    let mut state = Preprocessor::new(options);
    // A stack: what is to be read first goes on last.
    state.open(name, Arc::from(text), None);
    if let Some((name, text)) = &options.prelude {
        state.open(name, Arc::from(text.as_str()), None);
    }
    state.open("<predefined>", Arc::from(macros::predefined(options)), None);
    state.macros.insert("__FILE__".into(), Macro::file());
    state.macros.insert("__LINE__".into(), Macro::line());
    let count = state.inputs.iter().map(|input| input.tokens.len()).sum();
    let mut tokens = Vec::with_capacity(count);
    state.table.expanded.reserve(count);
    while let Some(token) = state.pull() {
        if let Some(token) = state.expand(token) {
            let index = state.table.expanded.len() as u32;
            state.table.expanded.push(crate::source::Expanded {
                place: token.place,
                call: token.call,
                space: token.space || token.line_start,
                aside: false,
            });
            tokens.push(Terminal { kind: token.kind, line_start: token.line_start, index });
        }
    }
    Preprocessed { tokens, table: state.table, diagnostics: state.diagnostics, stopped: state.stopped }
}
