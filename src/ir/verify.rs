//! States what a program promises: a verified program cannot fail.
//!
//! Every register that is read is a constant, an input, or written before on every way to the reader; operands are of
//! the kinds their instruction takes; a register that is not mutable has one place that writes it; scopes are left only
//! from inside.

use super::program::*;

/// Panics in debug builds when a program breaks a promise: that would be a mistake of the compiler, not of a user.
pub fn debug_verify(program: &Program) {
    if cfg!(debug_assertions)
        && let Err(problem) = verify(program)
    {
        panic!("the compiler broke a promise: {problem}");
    }
}

/// Checks a program.
///
/// # Errors
/// The first promise that is broken.
pub fn verify(program: &Program) -> Result<(), String> {
    let written = program.regs.iter().map(|info| info.source != Source::Code || info.mutable).collect();
    let mut walk = Walk { program, written, open: Vec::new() };
    walk.block(&program.body)?;
    program.result.iter().try_for_each(|&reg| walk.read(reg))
}

struct Walk<'p> {
    program: &'p Program,
    written: Vec<bool>,
    open: Vec<ScopeId>,
}

impl Walk<'_> {
    fn read(&self, reg: Reg) -> Result<(), String> {
        if self.written[reg.0 as usize] { Ok(()) } else { Err(format!("r{} is read before it is written", reg.0)) }
    }

    fn block(&mut self, block: &Block) -> Result<(), String> {
        for node in block {
            match node {
                Node::Instr(instr) => self.instr(instr)?,
                Node::If(condition, a, b) => {
                    self.condition(*condition)?;
                    let before = self.written.clone();
                    self.block(a)?;
                    self.written.clone_from(&before);
                    self.block(b)?;
                    self.written = before;
                }
                Node::Loop { head, condition, body, .. } => {
                    self.block(head)?;
                    self.condition(*condition)?;
                    let before = self.written.clone();
                    self.block(body)?;
                    self.written = before;
                }
                Node::Scope(id, body) => {
                    self.open.push(*id);
                    let before = self.written.clone();
                    self.block(body)?;
                    self.written = before;
                    self.open.pop();
                }
                Node::Leave(id) if self.open.contains(id) => {}
                Node::Leave(id) => return Err(format!("scope {} is left from outside", id.0)),
            }
        }
        Ok(())
    }

    fn condition(&self, reg: Reg) -> Result<(), String> {
        self.read(reg)?;
        self.kinds(&[reg], Kind::Int)
    }

    fn kinds(&self, regs: &[Reg], kind: Kind) -> Result<(), String> {
        match regs.iter().find(|&&reg| self.program.kind(reg) != kind) {
            None => Ok(()),
            Some(reg) => Err(format!("r{} is {:?}, not {kind:?}", reg.0, self.program.kind(*reg))),
        }
    }

    fn instr(&mut self, instr: &Instr) -> Result<(), String> {
        let mut result = Ok(());
        instr.reads(|reg| {
            if result.is_ok() {
                result = self.read(reg);
            }
        });
        result?;
        self.operands(instr)?;
        let mut writes = Vec::new();
        instr.writes(|reg| writes.push(reg));
        for reg in writes {
            let info = self.program.regs[reg.0 as usize];
            let moved = matches!(instr, Instr::Move { .. });
            if info.source != Source::Code || (info.mutable && !moved) {
                return Err(format!("r{} may not be written by {instr:?}", reg.0));
            }
            if !info.mutable && self.written[reg.0 as usize] {
                return Err(format!("r{} is written twice", reg.0));
            }
            self.written[reg.0 as usize] = true;
        }
        Ok(())
    }

    fn operands(&self, instr: &Instr) -> Result<(), String> {
        match instr {
            Instr::Unary(_, d, a) | Instr::Derivative(d, a, _) => self.kinds(&[*d, *a], Kind::Float),
            Instr::Binary(_, d, a, b) => self.kinds(&[*d, *a, *b], Kind::Float),
            Instr::Fused(op, ..) if !op.has_loop() => Err(format!("{op:?} has no loop over lanes")),
            Instr::Fused(_, d, [a, b, c]) => self.kinds(&[*d, *a, *b, *c], Kind::Float),
            Instr::Compare(_, d, a, b) => self.kinds(&[*a, *b], Kind::Float).and(self.kinds(&[*d], Kind::Int)),
            Instr::IntToFloat(d, a) => self.kinds(&[*d], Kind::Float).and(self.kinds(&[*a], Kind::Int)),
            Instr::FloatToInt(d, a) => self.kinds(&[*d], Kind::Int).and(self.kinds(&[*a], Kind::Float)),
            Instr::Select(d, c, a, b) => {
                let kind = self.program.kind(*d);
                self.kinds(&[*c], Kind::Int).and(self.kinds(&[*a, *b], kind))
            }
            Instr::Move { dst, src, .. } if dst == src => Err(format!("r{} is moved to itself", dst.0)),
            Instr::Move { dst, src, .. } => self.kinds(&[*src], self.program.kind(*dst)),
            Instr::ClosureAdd(d, a, b) => self.kinds(&[*d, *a, *b], Kind::Closure),
            Instr::ClosureScale(d, a, w) => self.kinds(&[*d, *a], Kind::Closure).and(self.kinds(w, Kind::Float)),
            Instr::ClosureAbsent(d, a) => self.kinds(&[*d], Kind::Int).and(self.kinds(&[*a], Kind::Closure)),
            Instr::ClosureSelect(d, c, a, b) => {
                self.kinds(&[*c], Kind::Int).and(self.kinds(&[*d, *a, *b], Kind::Closure))
            }
            _ => Ok(()),
        }
    }
}
