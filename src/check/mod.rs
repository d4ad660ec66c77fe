//! Syntax tree to typed shader: names, types, overloads. Every mistake a user can make ends here, as a diagnostic.
//!
//! The checker goes on after a mistake: a wrong expression becomes a stand-in that no later message complains about.
//!
//! Decision (2026-11-22): a literal index outside its array and a function defined twice are warnings, because OSL runs
//! such shaders (the nearest element is taken, the later function is called), instead of errors that would refuse them.
//!
//! Decision (2026-11-22): functions are expanded in place and may not expand beyond a fixed amount of text, instead of
//! calls at run time, because then values bind without moves and constants fold through calls.

mod call;
mod candidate;
pub mod codes;
pub mod compared;
mod constant;
mod context;
mod convert;
mod declare;
mod expr;
mod format;
mod initial;
pub mod notes;
mod operator;
mod parts;
mod place;
mod rank;
mod statement;
pub mod typed;
mod unused;

#[cfg(feature = "lsp")]
pub(crate) use call::{NOISES, TEXTURE_OPTIONS};
pub use constant::{Constant, constants};
pub use unused::unused;

use crate::lang::closures::ClosureTable;
use context::Checker;
use velour_grammar::ast::{File, Item};
use velour_grammar::{Diagnostic, Diagnostics, Span};

/// Checks one translation unit. Gives the shader when there is no error, and all messages in any case.
pub fn check(file: &File, closures: &ClosureTable) -> (Option<typed::Shader>, Diagnostics) {
    let mut checker = Checker::new(closures);
    let shader = items(&mut checker, file);
    checker.finish(shader)
}

/// The same, with what was found out about names.
pub fn check_noting(file: &File, closures: &ClosureTable) -> (Option<typed::Shader>, Diagnostics, notes::Notes) {
    let mut checker = Checker::new(closures);
    checker.notes = Some(Box::default());
    let shader = items(&mut checker, file);
    let notes = checker.take_notes();
    let (shader, diagnostics) = checker.finish(shader);
    (shader, diagnostics, notes)
}

fn items(checker: &mut Checker<'_>, file: &File) -> Option<typed::Shader> {
    let mut shader = None;
    for item in &file.items {
        match item {
            Item::Struct(decl) => checker.declare_struct(decl),
            Item::Function(decl) => checker.declare_function(decl),
            Item::Shader(decl) => {
                if let Some((_, first)) = &shader {
                    let diagnostic =
                        Diagnostic::error("E0401", decl.span, "a file holds one shader, this is the second");
                    checker.report(diagnostic.also(*first, "the first one").help("move it to a file of its own"));
                } else {
                    shader = Some((checker.declare_shader(decl), decl.span));
                }
            }
        }
    }
    if shader.is_none() {
        let message = "there is no shader in this file";
        checker.report(Diagnostic::error("E0402", Span::NONE, message).help("write `surface name() { … }`"));
    }
    shader.map(|(shader, _)| shader)
}
