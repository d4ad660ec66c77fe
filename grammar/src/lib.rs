//! Open Shading Language text to syntax tree: source map, preprocessor, lexer, grammar, messages, printer.
//!
//! ```text
//! text ── preprocessor ──> expanded tokens ── lexer ──> terminals ── brackets ──> osl.lalrpop ──> ast::File
//!              └─ files, macro calls ──> Sources  <── Span ── every node and every message
//! ```
//!
//! [`parse`] never fails and never panics: it gives a tree, which lacks what did not parse, and messages.
//!
//! **Depth of the tree.** Brackets nest at most 256 deep, statements without braces hang on each other at most
//! 2,000 long, and an expression is at most 50,000 nodes deep (a chain `a + b + …` of 20,000 terms is fine). Text
//! beyond that ends in one message and an empty tree. Dropping an expression does not recurse; whoever walks one must
//! be ready for that depth.

#![warn(unreachable_pub)]

pub mod ast;
mod brackets;
pub mod codes;
mod decode;
mod depth;
pub mod diagnostic;
mod explain;
pub mod files;
mod format;
mod lexer;
pub mod limits;
mod literal;
pub mod names;
pub mod places;
mod preprocessor;
pub mod print;
mod render;
mod source;
pub mod span;
mod token;
mod tree;

// Generated text: its style is not ours to judge.
#[rustfmt::skip]
#[allow(clippy::all, missing_docs, unused, unreachable_pub)]
#[path = "../generated/osl.rs"]
mod osl;

pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use format::{FormatError, format, format_bytes};
pub use render::{Format, json};
pub use source::{Location, Sources};
pub use span::Span;

use std::path::PathBuf;
use std::sync::Arc;

/// What the preprocessor is told from outside.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Folders that `#include` looks in, after that of the current file.
    pub include_dirs: Vec<PathBuf>,
    /// Macros to define: name (or `name(parameters)`) and body.
    pub defines: Vec<(String, String)>,
    /// Macros to undefine, after the definitions.
    pub undefines: Vec<String>,
    /// Files kept in memory, name and text, which `#include` finds when the disk has none.
    pub virtual_files: Vec<(String, String)>,
    /// Files kept in memory, name and text, which `#include` finds before those of `include_dirs`: headers that come with the
    /// compiler.
    pub own_files: Vec<(String, String)>,
    /// Texts that stand for files of these paths, links followed, whatever the disk has: what an editor has open and has not saved.
    pub buffers: Vec<(PathBuf, Arc<str>)>,
    /// Name and text of a file that is read before the user's: the standard header.
    pub prelude: Option<(String, String)>,
    /// Which files `#include` may read.
    pub access: files::Access,
}

/// What parsing gives.
#[derive(Clone, Debug, Default)]
pub struct Parsed {
    /// The tree. It lacks what did not parse.
    pub file: ast::File,
    /// The source map that the spans refer to.
    pub sources: Sources,
    /// What is wrong or doubtful.
    pub diagnostics: Diagnostics,
}

/// Parses a text.
pub fn parse(name: &str, text: &str, options: &Options) -> Parsed {
    if text.contains('\0') || u32::try_from(text.len()).is_err() {
        return not_text(name);
    }
    let done = preprocessor::run(name, text, options);
    let sources = done.table.finish();
    let mut diagnostics = done.diagnostics;
    if done.stopped {
        return Parsed { file: ast::File::default(), sources, diagnostics };
    }
    let mut tokens = lexer::lex(&done.tokens, &sources, &mut diagnostics);
    drop(done.tokens);
    if let Some(message) = brackets::too_deep(&tokens) {
        diagnostics.push(message);
        return Parsed { file: ast::File::default(), sources, diagnostics };
    }
    let unclosed = brackets::mark_items(&mut tokens, &sources);
    let mut context = tree::Context::default();
    let result = osl::FileParser::new().parse(&mut context, tokens.into_iter().map(Ok));
    if let Err(error) = result {
        context.failures.push(error.into());
    }
    diagnostics.append(context.diagnostics);
    explain::explain(&context.failures, &unclosed, &sources, &mut diagnostics);
    explain::check_structs(&context.items, &sources, &mut diagnostics);
    diagnostics.list.sort_by_key(|d| d.span.first);
    Parsed { file: ast::File { items: context.items }, sources, diagnostics }
}

/// Parses the bytes of a file: UTF-8, or Latin-1 inside strings and comments.
pub fn parse_bytes(name: &str, bytes: &[u8], options: &Options) -> Parsed {
    match decode::decode(bytes) {
        Some(text) => parse(name, &text, options),
        None => not_text(name),
    }
}

/// Runs the preprocessor alone: the text with all macros expanded, and `#line` where it changes file.
pub fn preprocess(name: &str, text: &str, options: &Options) -> (String, Diagnostics, Sources) {
    let done = preprocessor::run(name, text, options);
    let text = preprocessor::to_text(&done.tokens, &done.table);
    (text, done.diagnostics, done.table.finish())
}

/// The answer to a file that is no text.
fn not_text(name: &str) -> Parsed {
    let mut diagnostics = Diagnostics::default();
    diagnostics.push(
        Diagnostic::error("E0105", Span::NONE, format!("{name} is not a text file"))
            .help("give the source of a shader, not a compiled one or an image"),
    );
    Parsed { diagnostics, ..Parsed::default() }
}

/// The block of the README, as a documentation test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
