//! Printing and formatting, lane by lane. What a batch prints comes out in lane order, whatever the order of execution.

use super::lane::Lane;
use super::report::{Mistake, Report, ReportKind, ReportPlace};
use super::run::Run;
use crate::closure::print::closure_text;
use crate::ir::op::{PrintTo, TextArg, TextFormat};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::limits::{SAID_BYTES, SAID_LENGTH, SAID_TEXTS};
use crate::ops::format::{Format, FormatArg};
use smallvec::SmallVec;
use std::sync::Arc;
use velour_grammar::Span;

/// The arguments of one lane, one kind after the other.
#[derive(Default)]
struct Values<'r> {
    ints: SmallVec<[i32; 8]>,
    floats: SmallVec<[f32; 16]>,
    strings: SmallVec<[&'r str; 4]>,
    closures: SmallVec<[String; 1]>,
}

impl Values<'_> {
    /// Appends the text of a format with these arguments, which `wanted` puts in order; false where they do not fit.
    fn write(&self, format: &Format, wanted: &TextFormat, out: &mut String) -> bool {
        let (mut ints, mut floats, mut strings) = (&*self.ints, &*self.floats, &*self.strings);
        let mut closures = self.closures.iter();
        let args: SmallVec<[FormatArg; 4]> = wanted
            .args
            .iter()
            .map(|arg| match arg {
                TextArg::Ints(n) => FormatArg::Int(cut(&mut ints, *n)),
                TextArg::Floats(n) => FormatArg::Float(cut(&mut floats, *n)),
                TextArg::Strings(n) => FormatArg::Str(cut(&mut strings, *n)),
                TextArg::Closure => FormatArg::Closure(closures.next().map_or("", String::as_str)),
            })
            .collect();
        // The checker has compared a literal format with its arguments, so only a computed one can fail.
        format.write(out, &args).is_ok()
    }
}

/// What is said of a computed format that its arguments do not fit.
const MISFIT: &str = "the arguments do not fit this computed format";

/// The most different mistakes that a batch tells of.
const MOST_MISTAKES: usize = 256;

/// Takes the first `n` off.
fn cut<'v, T>(values: &mut &'v [T], n: u32) -> &'v [T] {
    let (own, rest) = values.split_at(n as usize);
    *values = rest;
    own
}

impl Run<'_> {
    /// Appends the text of a format in one lane; false for a computed one that its arguments do not fit.
    fn text_of(&self, format: &Format, wanted: &TextFormat, src: &[Reg], lane: usize, out: &mut String) -> bool {
        let mut rest = src;
        if wanted.computed {
            cut(&mut rest, 1);
        }
        let mut values = Values::default();
        let pick = |reg: &Reg| {
            let column = self.regs.i(*reg);
            if column.len() == 1 { column[0] } else { column[lane] }
        };
        let pick_float = |reg: &Reg| {
            let column = self.regs.f(*reg);
            if column.len() == 1 { column[0] } else { column[lane] }
        };
        for arg in &wanted.args {
            match arg {
                TextArg::Ints(n) => values.ints.extend(cut(&mut rest, *n).iter().map(pick)),
                TextArg::Floats(n) => values.floats.extend(cut(&mut rest, *n).iter().map(pick_float)),
                TextArg::Strings(n) => {
                    values.strings.extend(cut(&mut rest, *n).iter().map(|reg| self.symbol_text(pick(reg))));
                }
                TextArg::Closure => {
                    let closure = self.closure(cut(&mut rest, 1)[0]);
                    values.closures.push(closure_text(self.group.table(), self.tree, closure, lane, |name| {
                        self.host.prints_label(name)
                    }));
                }
            }
        }
        if !wanted.computed {
            return values.write(format, wanted, out);
        }
        let column = self.regs.i(src[0]);
        let text = self.symbol_text(if column.len() == 1 { column[0] } else { column[lane] });
        Format::read(text).is_ok_and(|format| values.write(&format, wanted, out))
    }

    fn symbol_text(&self, symbol: i32) -> &str {
        self.tree.strings.text(Symbol(symbol))
    }

    pub(super) fn print(&mut self, to: PrintTo, wanted: &TextFormat, src: &[Reg], span: Span) {
        let (file, values) = if to == PrintTo::File { src.split_at(1) } else { src.split_at(0) };
        let place = self.place(span);
        let Ok(format) = Format::read(&wanted.text) else { return };
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            if self.s.said.texts >= SAID_TEXTS || self.s.said.bytes >= SAID_BYTES {
                self.s.said.left_out += 1;
                continue;
            }
            let mut text = String::new();
            if !self.text_of(&format, wanted, values, lane, &mut text) {
                self.report_once(lane, span, Mistake::Other, MISFIT.to_owned());
            }
            if to == PrintTo::UnknownNoise {
                let name = Lane { run: self, src: values, lane }.s(0).to_owned();
                self.report_once(lane, span, Mistake::Noise { name }, text);
                continue;
            }
            let (kind, text) = match to {
                PrintTo::Output => (ReportKind::Output, text),
                PrintTo::File => {
                    let column = self.regs.i(file[0]);
                    let name = if column.len() == 1 { column[0] } else { column[lane] };
                    (ReportKind::File(self.symbol_text(name).to_owned()), text)
                }
                PrintTo::Warning => (ReportKind::Warning, text.trim_end().to_owned()),
                PrintTo::Error | PrintTo::UnknownNoise => (ReportKind::Error, text.trim_end().to_owned()),
            };
            self.say(Report { kind, place: place.clone(), lane, text });
        }
    }

    pub(super) fn format(&mut self, wanted: &TextFormat, dst: Reg, src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst);
        let Ok(format) = Format::read(&wanted.text) else { return };
        let mut text = String::new();
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            text.clear();
            if !self.text_of(&format, wanted, src, lane, &mut text) {
                self.report_once(lane, span, Mistake::Other, MISFIT.to_owned());
            }
            // Numbers of thousands of digits are computed digit by digit.
            self.read.set(self.read.get() + 4 * text.len() as u64);
            let symbol = self.tree.strings.symbol(&text);
            self.regs.ints[dst.0 as usize][lane] = symbol.0;
        }
        self.check_strings(span);
    }

    fn place(&self, span: Span) -> Arc<ReportPlace> {
        Arc::new((self.group.locate)(span))
    }

    /// Is there room for another mistake?
    pub(super) fn tells_mistakes(&self) -> bool {
        self.s.mistakes.len() < MOST_MISTAKES
    }

    /// Reports a mistake that shading survives, once a batch, among what its lane prints.
    pub(super) fn report_once(&mut self, lane: usize, span: Span, mistake: Mistake, text: String) {
        let known = (span, text);
        self.charge(10);
        if self.tells_mistakes() && !self.s.mistakes.contains(&known) {
            let (kind, place, text) = (ReportKind::Mistake(mistake), self.place(span), known.1.clone());
            self.say(Report { kind, place, lane, text });
            self.s.mistakes.push(known);
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
    fn say(&mut self, mut report: Report) {
        let length = report.text.len();
        if length > SAID_LENGTH {
            let end = (0..=SAID_LENGTH).rev().find(|&end| report.text.is_char_boundary(end)).unwrap_or(0);
            report.text.truncate(end);
            report.text += &format!("... and {} bytes more\n", length - end);
        }
        self.s.said.texts += 1;
        self.s.said.bytes += report.text.len();
        self.read.set(self.read.get() + length as u64);
        if self.s.texts.len() < self.n {
            self.s.texts.resize_with(self.n, Vec::new);
        }
        self.s.texts[report.lane].push(report);
    }

    /// Hands over what the lanes have said.
    pub(super) fn flush(&mut self) {
        for lane in &mut self.s.texts {
            let room = SAID_TEXTS.saturating_sub(self.reports.len());
            self.s.said.left_out += lane.len().saturating_sub(room) as u64;
            self.reports.extend(lane.drain(..).take(room));
        }
        if self.s.said.left_out > 0 {
            let text = format!("a batch says more than is kept: {} texts are left out", self.s.said.left_out);
            self.reports.push(Report::warning(text));
        }
        if !self.reports.is_empty() {
            self.host.hear(self.reports);
        }
    }
}
