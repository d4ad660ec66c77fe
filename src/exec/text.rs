//! Printing and formatting, lane by lane. What a batch prints comes out in lane order, whatever the order of execution.

use super::host::Report;
use super::machine::Run;
use crate::closure::print::closure_text;
use crate::ir::op::{PrintTo, TextArg, TextFormat};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::format::{FormatArg, format};
use velour_grammar::Span;

/// The value of one argument.
enum Value {
    Ints(Vec<i32>),
    Floats(Vec<f32>),
    Strings(Vec<&'static str>),
    Closure(String),
}

impl Run<'_> {
    fn text_of(&self, wanted: &TextFormat, src: &[Reg], lane: usize) -> String {
        let mut rest = src;
        let mut values = Vec::new();
        for arg in &wanted.args {
            let count = match arg {
                TextArg::Ints(n) | TextArg::Floats(n) | TextArg::Strings(n) => *n as usize,
                TextArg::Closure => 1,
            };
            let (own, others) = rest.split_at(count);
            rest = others;
            let pick = |column: &[i32]| if column.len() == 1 { column[0] } else { column[lane] };
            let pick_float = |column: &[f32]| if column.len() == 1 { column[0] } else { column[lane] };
            values.push(match arg {
                TextArg::Ints(_) => Value::Ints(own.iter().map(|&reg| pick(self.regs.i(reg))).collect()),
                TextArg::Floats(_) => Value::Floats(own.iter().map(|&reg| pick_float(self.regs.f(reg))).collect()),
                TextArg::Strings(_) => {
                    Value::Strings(own.iter().map(|&reg| Symbol(pick(self.regs.i(reg))).text()).collect())
                }
                TextArg::Closure => {
                    Value::Closure(closure_text(self.group.table(), self.tree, self.closure(own[0]), lane))
                }
            });
        }
        let args: Vec<FormatArg> = values
            .iter()
            .map(|value| match value {
                Value::Ints(v) => FormatArg::Int(v),
                Value::Floats(v) => FormatArg::Float(v),
                Value::Strings(v) => FormatArg::Str(v),
                Value::Closure(text) => FormatArg::Closure(text),
            })
            .collect();
        // The checker has compared the format with its arguments, so what is left to fail cannot.
        format(&wanted.text, &args).unwrap_or_default()
    }

    pub(super) fn print(&mut self, to: PrintTo, wanted: &TextFormat, src: &[Reg], span: Span) {
        let (file, values) = if to == PrintTo::File { src.split_at(1) } else { src.split_at(0) };
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let text = self.text_of(wanted, values, lane);
            let placed = |text: &str| format!("{}: {}", (self.group.locate)(span), text.trim_end());
            let report = match to {
                PrintTo::Output => Report::Output(text),
                PrintTo::File => {
                    let column = self.regs.i(file[0]);
                    let name = if column.len() == 1 { column[0] } else { column[lane] };
                    Report::File(Symbol(name).text().to_owned(), text)
                }
                PrintTo::Warning => Report::Warning(placed(&text)),
                PrintTo::Error => Report::Error(placed(&text)),
            };
            self.say(lane, report);
        }
    }

    pub(super) fn format(&mut self, wanted: &TextFormat, dst: Reg, src: &[Reg]) {
        for lane in 0..self.lanes_of(dst) {
            if self.lanes_of(dst) > 1 && self.s.mask[lane] == 0 {
                continue;
            }
            let text = self.text_of(wanted, src, lane);
            self.regs.ints[dst.0 as usize][lane] = Symbol::new(&text).0;
        }
    }

    /// Keeps a report until the batch ends.
    pub(super) fn say(&mut self, lane: usize, report: Report) {
        if self.s.texts.len() < self.n {
            self.s.texts.resize_with(self.n, Vec::new);
        }
        self.s.texts[lane].push(report);
    }

    /// Hands over what the lanes have printed.
    pub(super) fn flush(&mut self) {
        for lane in &mut self.s.texts {
            self.reports.append(lane);
        }
    }
}
