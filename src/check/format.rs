//! Format strings of printf and its relatives, checked against their arguments.

use super::context::Checker;
use super::typed::{Argument, ExprKind};
use crate::lang::types::{Base, Element};
use crate::ops::format::{FormatKind, check_format};
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    /// Reports a format string that does not fit the arguments of a call.
    pub(super) fn check_format(&mut self, name: &str, args: &[Argument], span: Span) {
        let at = match name {
            "printf" | "format" | "error" | "warning" => 0,
            "fprintf" => 1,
            _ => return,
        };
        let Some(Argument::In(format)) = args.get(at) else { return };
        let ExprKind::String(text) = &format.kind else {
            let message =
                format!("the format of this `{name}` is computed, so nothing tells whether its arguments fit");
            self.report(
                Diagnostic::warning("W0510", format.span, message).help("write the format as a literal string"),
            );
            return;
        };
        let kinds: Option<Vec<FormatKind>> = args[at + 1..].iter().map(format_kind).collect();
        let Some(kinds) = kinds else {
            self.error("E0511", span, "a struct cannot be formatted", "name its fields, each with a `%` of its own");
            return;
        };
        if let Err(problem) = check_format(text, &kinds, at + 2) {
            let diagnostic = Diagnostic::error("E0511", span, format!("`{name}` {problem}"));
            self.report(diagnostic.help("%d writes ints, %g floats, colors and matrices, %s strings and closures"));
        }
    }
}

fn format_kind(arg: &Argument) -> Option<FormatKind> {
    match &arg.ty().element {
        Element::Base(Base::Int) => Some(FormatKind::Int),
        Element::Base(Base::String) => Some(FormatKind::Str),
        Element::Base(Base::Closure) => Some(FormatKind::Closure),
        Element::Base(Base::Void) | Element::Struct(_) => None,
        Element::Base(_) => Some(FormatKind::Float),
    }
}
