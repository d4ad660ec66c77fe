//! Calls that make or write text.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind};
use crate::ir::op::{PrintTo, Routine, TextArg, TextFormat};
use crate::ir::program::{Kind, Reg};
use velour_grammar::Span;

impl Lower<'_> {
    /// `printf`, `fprintf`, `error`, `warning` and `format`.
    pub(super) fn text_call(&mut self, name: &str, args: &[Argument], span: Span) -> Value {
        let exprs: Vec<&Expr> = args.iter().filter_map(Argument::read).collect();
        let (file, list) = exprs.split_at((name == "fprintf") as usize);
        let text = match list.first().map(|expr| &expr.kind) {
            Some(ExprKind::String(text)) => Some(text.clone()),
            _ => None,
        };
        let values = self.operands(&exprs);
        let (file, values) = values.split_at(file.len());
        let mut src: Vec<Reg> = file.iter().flat_map(|value| self.regs(value)).collect();
        let mut format = TextFormat { computed: text.is_none(), text: text.unwrap_or_default(), args: Vec::new() };
        if let (true, Some(computed)) = (format.computed, values.first()) {
            src.extend(self.regs(computed));
        }
        for value in values.iter().skip(1) {
            let before = src.len();
            self.flat(value, &mut src);
            let count = (src.len() - before) as u32;
            format.args.push(match src.get(before).map(|&reg| self.b.program.kind(reg)) {
                Some(Kind::Float) => TextArg::Floats(count),
                Some(Kind::String) => TextArg::Strings(count),
                Some(Kind::Closure) => TextArg::Closure,
                Some(Kind::Int) | None => TextArg::Ints(count),
            });
        }
        self.at(span);
        let span = self.span;
        let to = match name {
            "format" => {
                return Value::Regs(self.b.call(Routine::Format(format), src, span));
            }
            "printf" => PrintTo::Output,
            "fprintf" => PrintTo::File,
            "warning" => PrintTo::Warning,
            _ => PrintTo::Error,
        };
        self.b.call(Routine::Print(to, format), src, span);
        Value::Regs(Vec::new())
    }

    /// All numbers of a value, in order.
    fn flat(&mut self, value: &Value, out: &mut Vec<Reg>) {
        match value {
            Value::Regs(_) | Value::Item { .. } => out.extend(self.regs(value)),
            Value::Array { .. } => {
                for element in self.elements(value) {
                    self.flat(&element, out);
                }
            }
            Value::Struct(fields) => fields.iter().for_each(|field| self.flat(field, out)),
        }
    }
}
