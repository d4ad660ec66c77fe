//! Printing and formatting, lane by lane. What a batch prints comes out in lane order, whatever the order of execution.

use super::report::{Report, ReportKind, ReportPlace};
use super::run::Run;
use crate::closure::print::closure_text;
use crate::ir::op::{PrintTo, TextArg, TextFormat};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::format::{FormatArg, format};
use smallvec::SmallVec;
use std::sync::Arc;
use velour_grammar::Span;

/// The value of one argument.
enum Value<'r> {
    Ints(SmallVec<[i32; 4]>),
    Floats(SmallVec<[f32; 4]>),
    Strings(SmallVec<[&'r str; 2]>),
    Closure(String),
}

impl Run<'_> {
    fn text_of(&self, wanted: &TextFormat, src: &[Reg], lane: usize) -> String {
        let mut rest = src;
        let mut values: SmallVec<[Value; 4]> = SmallVec::new();
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
                    Value::Strings(own.iter().map(|&reg| self.symbol_text(pick(self.regs.i(reg)))).collect())
                }
                TextArg::Closure => {
                    Value::Closure(closure_text(self.group.table(), self.tree, self.closure(own[0]), lane))
                }
            });
        }
        let args: SmallVec<[FormatArg; 4]> = values
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

    fn symbol_text(&self, symbol: i32) -> &str {
        self.tree.strings.text(Symbol(symbol))
    }

    pub(super) fn print(&mut self, to: PrintTo, wanted: &TextFormat, src: &[Reg], span: Span) {
        let (file, values) = if to == PrintTo::File { src.split_at(1) } else { src.split_at(0) };
        let place = self.place(span);
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let text = self.text_of(wanted, values, lane);
            let (kind, text) = match to {
                PrintTo::Output => (ReportKind::Output, text),
                PrintTo::File => {
                    let column = self.regs.i(file[0]);
                    let name = if column.len() == 1 { column[0] } else { column[lane] };
                    (ReportKind::File(self.symbol_text(name).to_owned()), text)
                }
                PrintTo::Warning => (ReportKind::Warning, text.trim_end().to_owned()),
                PrintTo::Error => (ReportKind::Error, text.trim_end().to_owned()),
            };
            self.say(Report { kind, place: place.clone(), lane, text });
        }
    }

    pub(super) fn format(&mut self, wanted: &TextFormat, dst: Reg, src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst);
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            let text = self.text_of(wanted, src, lane);
            let symbol = self.tree.strings.symbol(&text);
            self.regs.ints[dst.0 as usize][lane] = symbol.0;
        }
        self.check_strings(span);
    }

    fn place(&self, span: Span) -> Arc<ReportPlace> {
        Arc::new((self.group.locate)(span))
    }

    /// Reports a mistake that shading survives, once a batch, among what its lane prints.
    pub(super) fn report_once(&mut self, lane: usize, span: Span, text: String) {
        let mistake = (span, text);
        if !self.s.said.contains(&mistake) {
            let (kind, place, text) = (ReportKind::Mistake, self.place(span), mistake.1.clone());
            self.say(Report { kind, place, lane, text });
            self.s.said.push(mistake);
        }
    }

    /// Gives the batch up.
    pub(super) fn fatal(&mut self, span: Span, what: &str) {
        if !self.stopped {
            let (place, lane) = (self.place(span), self.first_active());
            self.reports.push(Report { kind: ReportKind::Fatal, place, lane, text: what.to_owned() });
            self.stopped = true;
        }
    }

    /// Keeps a report until the batch ends.
    fn say(&mut self, report: Report) {
        if self.s.texts.len() < self.n {
            self.s.texts.resize_with(self.n, Vec::new);
        }
        self.s.texts[report.lane].push(report);
    }

    /// Hands over what the lanes have said.
    pub(super) fn flush(&mut self) {
        for lane in &mut self.s.texts {
            self.reports.append(lane);
        }
        if !self.reports.is_empty() {
            self.host.hear(self.reports);
        }
    }
}
