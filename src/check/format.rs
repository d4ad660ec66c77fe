//! Format strings of printf and its relatives, checked against their arguments.

use super::context::Checker;
use super::typed::{Argument, ExprKind};
use velour_grammar::Span;

impl Checker<'_> {
    /// Reports a format string that does not fit the arguments of a call.
    pub(super) fn check_format(&mut self, name: &str, args: &[Argument], span: Span) {
        let at = match name {
            "printf" | "format" | "error" | "warning" => 0,
            "fprintf" => 1,
            _ => return,
        };
        let Some(Argument::In(format)) = args.get(at) else { return };
        let ExprKind::String(_) = &format.kind else {
            self.error("E0511", format.span, "the format is a literal string");
            return;
        };
        let _ = span;
    }
}
