//! A program as text: one instruction a line, constants and inputs written in place, so that two listings can be compared.

use super::op::*;
use super::program::*;
use crate::lang::closures::ClosureTable;
use crate::lang::symbols::Symbol;
use std::fmt::{Display, Write};

/// The listing of a program.
pub fn listing(program: &Program, table: &ClosureTable) -> String {
    let mut out = String::new();
    let mut printer = Printer { program, table, names: vec![None; program.regs.len()], next: 0 };
    printer.block(&program.body, 0, &mut out);
    if let Some(reg) = program.result {
        let _ = writeln!(out, "Ci = {}", printer.reg(reg));
    }
    for output in &program.outputs {
        let value = match &output.value {
            OutputValue::Regs(regs) => printer.regs(regs),
            OutputValue::Array(id) => format!("array{}", id.0),
        };
        let _ = writeln!(out, "{}.{} = {value}", output.layer, output.name);
    }
    out
}

struct Printer<'p> {
    program: &'p Program,
    table: &'p ClosureTable,
    /// Registers are numbered in the order in which they appear, so that removed ones leave no gaps.
    names: Vec<Option<u32>>,
    next: u32,
}

impl Printer<'_> {
    fn reg(&mut self, reg: Reg) -> String {
        match self.program.regs[reg.0 as usize].source {
            Source::Const(Const::Float(value)) => format!("{value:?}"),
            Source::Const(Const::Int(value)) => value.to_string(),
            Source::Const(Const::String(value)) => format!("{:?}", Symbol(value).text()),
            Source::Const(Const::NoClosure) => "none".to_owned(),
            Source::Input(input) => input_name(input),
            Source::Code => self.numbered(reg),
        }
    }

    /// `%3`: a column; `$3`: one number for all lanes; `!` follows what is written more than once.
    fn numbered(&mut self, reg: Reg) -> String {
        let info = self.program.regs[reg.0 as usize];
        let number = *self.names[reg.0 as usize].get_or_insert_with(|| {
            self.next += 1;
            self.next - 1
        });
        format!("{}{number}{}", if info.uniform { '$' } else { '%' }, if info.mutable { "!" } else { "" })
    }

    fn regs(&mut self, regs: &[Reg]) -> String {
        let list: Vec<String> = regs.iter().map(|&reg| self.reg(reg)).collect();
        list.join(", ")
    }

    fn block(&mut self, block: &Block, depth: usize, out: &mut String) {
        for node in block {
            let line = match node {
                Node::Instr(instr) => self.instr(instr),
                Node::If(condition, ..) => format!("if {}", self.reg(*condition)),
                Node::Loop { .. } => "loop".to_owned(),
                Node::Scope(id, _) => format!("scope {}", id.0),
                Node::Leave(id) => format!("leave {}", id.0),
            };
            let indent = "  ".repeat(depth);
            let _ = writeln!(out, "{indent}{line}");
            match node {
                Node::If(_, a, b) => {
                    self.block(a, depth + 1, out);
                    if !b.is_empty() {
                        let _ = writeln!(out, "{indent}else");
                        self.block(b, depth + 1, out);
                    }
                }
                Node::Loop { head, condition, body, .. } => {
                    self.block(head, depth + 1, out);
                    let _ = writeln!(out, "{indent}while {}", self.reg(*condition));
                    self.block(body, depth + 1, out);
                }
                Node::Scope(_, body) => self.block(body, depth + 1, out),
                Node::Instr(_) | Node::Leave(_) => {}
            }
        }
    }

    fn instr(&mut self, instr: &Instr) -> String {
        let mut written = Vec::new();
        instr.writes(|reg| written.push(reg));
        let what = self.operation(instr);
        if written.is_empty() { what } else { format!("{} = {what}", self.regs(&written)) }
    }

    fn operation(&mut self, instr: &Instr) -> String {
        let word = |op: &dyn std::fmt::Debug| snake(&format!("{op:?}"));
        match instr {
            Instr::Unary(op, _, a) => format!("{} {}", word(op), self.reg(*a)),
            Instr::Binary(op, _, a, b) => format!("{} {}", word(op), self.regs(&[*a, *b])),
            Instr::Fused(op, _, abc) => self.pair(*op, *abc),
            Instr::Compare(op, _, a, b) => format!("{} {}", word(op), self.regs(&[*a, *b])),
            Instr::Test(op, _, a) => format!("is_{} {}", word(op), self.reg(*a)),
            Instr::IntUnary(op, _, a) => format!("int_{} {}", word(op), self.reg(*a)),
            Instr::IntBinary(op, _, a, b) => format!("int_{} {}", word(op), self.regs(&[*a, *b])),
            Instr::IntToFloat(_, a) => format!("float {}", self.reg(*a)),
            Instr::FloatToInt(_, a) => format!("int {}", self.reg(*a)),
            Instr::Select(_, c, a, b) => format!("select {}", self.regs(&[*c, *a, *b])),
            Instr::Move { src, masked, .. } => format!("{} {}", if *masked { "blend" } else { "move" }, self.reg(*src)),
            Instr::Derivative(_, a, along_y) => format!("{} {}", if *along_y { "dy" } else { "dx" }, self.reg(*a)),
            Instr::ArrayGet { array, component, index, .. } => {
                format!("array{}[{}].{component}", array.0, self.reg(*index))
            }
            Instr::ArraySet { array, component, index, src, .. } => {
                let index = self.reg(*index);
                format!("array{}[{index}].{component} = {}", array.0, self.reg(*src))
            }
            Instr::Call { routine, src, .. } => format!("{} {}", routine_name(routine), self.regs(src)),
            Instr::Leaf { closure, params, keywords, .. } => self.leaf(closure.0, params, keywords),
            Instr::ClosureAdd(_, a, b) => format!("closure_add {}", self.regs(&[*a, *b])),
            Instr::ClosureScale(_, a, w) => format!("closure_scale {}, {}", self.reg(*a), self.regs(w)),
            Instr::ClosureSelect(_, c, a, b) => format!("closure_select {}", self.regs(&[*c, *a, *b])),
            Instr::ClosureAbsent(_, a) => format!("closure_absent {}", self.reg(*a)),
        }
    }

    /// The first operation stands in parentheses where the second one has its result.
    fn pair(&mut self, op: Pair, [a, b, c]: [Reg; 3]) -> String {
        let word = |op: Binary| snake(&format!("{op:?}"));
        let (first, c) = (format!("({} {})", word(op.first), self.regs(&[a, b])), self.reg(c));
        let (left, right) = if op.swapped { (c, first) } else { (first, c) };
        format!("{} {left}, {right}", word(op.second))
    }

    fn leaf(&mut self, closure: u32, params: &[Reg], keywords: &[(u32, Vec<Reg>)]) -> String {
        let table = self.table;
        let spec = &table.specs[closure as usize];
        let mut text = format!("closure {}({})", spec.name, self.regs(params));
        for (at, regs) in keywords {
            let _ = write!(text, " {}({})", spec.keywords[*at as usize].name, self.regs(regs));
        }
        text
    }
}

fn input_name(input: Input) -> String {
    let part = |name: &dyn Display, component: u8, global: crate::lang::globals::Global| {
        let components = global.ty().base().map_or(1, crate::lang::types::Base::components);
        if components == 1 { name.to_string() } else { format!("{name}.{}", ["x", "y", "z"][component as usize % 3]) }
    };
    match input {
        Input::Global(g, c) => part(&g.name(), c, g),
        Input::GlobalDx(g, c) => part(&format!("dx({})", g.name()), c, g),
        Input::GlobalDy(g, c) => part(&format!("dy({})", g.name()), c, g),
        Input::SurfaceArea => "surfacearea".to_owned(),
        Input::Backfacing => "backfacing".to_owned(),
    }
}

fn routine_name(routine: &Routine) -> String {
    match routine {
        Routine::Noise(noise) => {
            let Noise { kind, dims, outputs, periodic, gradient, filtered } = noise;
            let words = [(periodic, " periodic"), (gradient, " gradient"), (filtered, " filtered")];
            let words: String = words.iter().filter(|(on, _)| **on).map(|(_, word)| *word).collect();
            format!("noise {}{dims}x{outputs}{words}", snake(&format!("{kind:?}")))
        }
        Routine::Format(format) => format!("format {:?}", format.text),
        Routine::Print(to, format) => format!("print {} {:?}", snake(&format!("{to:?}")), format.text),
        other => other.name().to_owned(),
    }
}

/// `InverseSqrt` as `inverse_sqrt`.
fn snake(name: &str) -> String {
    let mut out = String::new();
    for (at, c) in name.chars().enumerate() {
        if c.is_uppercase() && at > 0 && !out.ends_with(['(', '_']) {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}
