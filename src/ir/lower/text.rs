//! Calls that make or write text.

use super::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind};
use crate::ir::op::{PrintTo, Routine, TextArg, TextFormat};
use crate::ir::program::{Kind, Reg};
use velour_grammar::Span;

impl Lower<'_> {
    /// `printf`, `fprintf`, `error`, `warning` and `format`.
    pub(super) fn text_call(&mut self, name: &str, args: &[Argument], span: Span) -> Value {
        let mut src = Vec::new();
        let mut list = args;
        if name == "fprintf" {
            if let Argument::In(file) = &args[0] {
                src.push(self.reg(file));
            }
            list = &args[1..];
        }
        let text = match &list[0] {
            Argument::In(Expr { kind: ExprKind::String(text), .. }) => text.clone(),
            _ => String::new(),
        };
        let mut format = TextFormat { text, args: Vec::new() };
        for arg in &list[1..] {
            if let Argument::In(expr) = arg {
                let value = self.expr(expr);
                let mut regs = Vec::new();
                self.flat(&value, &mut regs);
                let steady: Vec<Reg> = regs.into_iter().map(|reg| self.fixed(reg)).collect();
                let count = steady.len() as u32;
                format.args.push(match steady.first().map(|&reg| self.b.program.kind(reg)) {
                    Some(Kind::Float) => TextArg::Floats(count),
                    Some(Kind::String) => TextArg::Strings(count),
                    Some(Kind::Closure) => TextArg::Closure,
                    _ => TextArg::Ints(count),
                });
                src.extend(steady);
            }
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
