//! States what a program promises: a verified program cannot fail.
//!
//! Every number that names a register, an array, a scope, a closure, a symbol or a keyword names one that is there. Every register
//! that is read is a constant, an input, or written before on every way to the reader; one that is not mutable has one place
//! that writes it. Operands are as many and of the kinds that their instruction, their routine's declaration or their
//! closure's specification says. What keeps one number for all lanes is computed from nothing that differs between them.
//! Scopes are left only from inside. Nesting and the size of all arrays are bounded.
//!
//! Decision (2026-11-29): every program is verified when a group is made of it, the compiler's own as well, because that is one
//! walk, 0.3 of the 175 ms that three thousand statements take to compile, and a mistake of the compiler is then an error with a
//! place and no wrong picture; instead of a check in debug builds alone.

mod error;
mod operands;

pub use error::{Place, Problem, VerifyError};

use super::program::*;
use crate::lang::closures::ClosureTable;
use crate::lang::symbols::Symbol;
use crate::limits::NUMBERS;

/// How deep blocks may be nested: the machine calls itself once a level, and a thread's stack is two megabytes.
pub const MAX_DEPTH: u32 = 2_000;

/// Checks a program that calls the closures of a table.
///
/// # Errors
/// The first promise that is broken.
pub fn verify(program: &Program, table: &ClosureTable) -> Result<(), VerifyError> {
    let written = program.regs.iter().map(|info| info.source != Source::Code || info.mutable).collect();
    let (trail, open) = (Vec::new(), vec![false; program.scopes.min(MAX_SCOPES) as usize]);
    let mut walk = Walk { program, table, written, trail, open, node: 0, depth: 0 };
    walk.registers()?;
    walk.arrays()?;
    walk.block(&program.body)?;
    walk.results()
}

/// Panics in debug builds when a pass of the compiler broke a promise, so that the mistake is found where it was made. A program that
/// is only too large is no mistake; making a group of it is an error.
pub fn debug_verify(program: &Program, table: &ClosureTable) {
    if cfg!(debug_assertions)
        && let Err(error) = verify(program, table)
        && !matches!(error.problem, Problem::TooDeep(_) | Problem::TooLarge(_))
    {
        panic!("the compiler broke a promise: {error}");
    }
}

/// Scopes beyond this number are none: memory is set aside for each.
const MAX_SCOPES: u32 = 1 << 20;

/// The walk through a program.
struct Walk<'p> {
    program: &'p Program,
    table: &'p ClosureTable,
    /// The registers that hold something here.
    written: Vec<bool>,
    /// The registers written in the open blocks, in order, so that a block's end forgets its own in as many steps.
    trail: Vec<Reg>,
    /// The scopes that are open here.
    open: Vec<bool>,
    /// How many nodes have been met.
    node: u32,
    depth: u32,
}

impl Walk<'_> {
    fn registers(&self) -> Result<(), VerifyError> {
        for (number, info) in self.program.regs.iter().enumerate() {
            let place = Place::Reg(Reg(number as u32));
            register(info).map_err(|problem| VerifyError { problem, place })?;
        }
        Ok(())
    }

    fn arrays(&self) -> Result<(), VerifyError> {
        let varying = |info: &&RegInfo| !info.uniform && info.kind != Kind::Closure;
        let mut numbers = self.program.regs.iter().filter(varying).count() as u64;
        // A long shader has many registers; what counts is that arrays do not add up.
        numbers = numbers.saturating_sub(NUMBERS / 2);
        for (number, info) in self.program.arrays.iter().enumerate() {
            let place = Place::Array(ArrayId(number as u32));
            if info.kind == Kind::Closure && info.components != 1 {
                let (given, wanted) = (info.components as usize, 1);
                let problem = Problem::WrongCount { of: "components of a closure", given, wanted };
                return Err(VerifyError { problem, place });
            }
            numbers = numbers.saturating_add(u64::from(info.len) * u64::from(info.components));
            if numbers > NUMBERS {
                return Err(VerifyError { problem: Problem::TooLarge(NUMBERS), place });
            }
        }
        Ok(())
    }

    fn results(&self) -> Result<(), VerifyError> {
        if let Some(reg) = self.program.result {
            let found = self.read(reg).and_then(|()| self.kind(reg, Kind::Closure));
            found.map_err(|problem| VerifyError { problem, place: Place::Result })?;
        }
        for (number, output) in self.program.outputs.iter().enumerate() {
            let place = Place::Output(number);
            self.output(output).map_err(|problem| VerifyError { problem, place })?;
        }
        Ok(())
    }

    fn here<T>(&self, found: Result<T, Problem>) -> Result<T, VerifyError> {
        found.map_err(|problem| VerifyError { problem, place: Place::Node(self.node) })
    }

    /// A block whose writes do not count after it, as not all lanes run it.
    fn inner(&mut self, block: &Block) -> Result<(), VerifyError> {
        let start = self.trail.len();
        self.block(block)?;
        for reg in self.trail.drain(start..) {
            self.written[reg.0 as usize] = false;
        }
        Ok(())
    }

    fn block(&mut self, block: &Block) -> Result<(), VerifyError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return self.here(Err(Problem::TooDeep(MAX_DEPTH)));
        }
        for node in block {
            match node {
                Node::Instr(instr) => {
                    let found = self.instr(instr);
                    self.here(found)?;
                    self.node += 1;
                }
                Node::If(condition, a, b) => {
                    self.condition(*condition)?;
                    self.node += 1;
                    self.inner(a)?;
                    self.inner(b)?;
                }
                Node::Loop { head, condition, body, .. } => {
                    self.node += 1;
                    self.block(head)?;
                    self.condition(*condition)?;
                    self.inner(body)?;
                }
                Node::Scope(id, body) => {
                    let found =
                        self.scope(*id).and_then(|open| if open { Err(Problem::OpenedTwice(*id)) } else { Ok(()) });
                    self.here(found)?;
                    self.node += 1;
                    self.open[id.0 as usize] = true;
                    self.inner(body)?;
                    self.open[id.0 as usize] = false;
                }
                Node::Leave(id) => {
                    let found =
                        self.scope(*id).and_then(|open| if open { Ok(()) } else { Err(Problem::LeftFromOutside(*id)) });
                    self.here(found)?;
                    self.node += 1;
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    /// Is a scope open here?
    fn scope(&self, id: ScopeId) -> Result<bool, Problem> {
        self.open.get(id.0 as usize).copied().ok_or(Problem::NoScope(id))
    }

    fn condition(&self, reg: Reg) -> Result<(), VerifyError> {
        self.here(self.read(reg).and_then(|()| self.kind(reg, Kind::Int)))
    }

    /// A register that has to hold something here.
    fn read(&self, reg: Reg) -> Result<(), Problem> {
        match self.written.get(reg.0 as usize) {
            None => Err(Problem::NoRegister(reg)),
            Some(false) => Err(Problem::Unwritten(reg)),
            Some(true) => Ok(()),
        }
    }

    /// A register that has to be of a kind.
    fn kind(&self, reg: Reg, wanted: Kind) -> Result<(), Problem> {
        let info = self.program.regs.get(reg.0 as usize).ok_or(Problem::NoRegister(reg))?;
        if info.kind == wanted { Ok(()) } else { Err(Problem::WrongKind { holds: info.kind, wanted }) }
    }

    fn array(&self, array: ArrayId) -> Result<&ArrayInfo, Problem> {
        self.program.arrays.get(array.0 as usize).ok_or(Problem::NoArray(array))
    }

    fn instr(&mut self, instr: &Instr) -> Result<(), Problem> {
        let mut found = Ok(());
        instr.reads(|reg| {
            if found.is_ok() {
                found = self.read(reg);
            }
        });
        found?;
        self.operands(instr)?;
        self.uniform(instr)?;
        let moved = matches!(instr, Instr::Move { .. });
        let mut found = Ok(());
        instr.writes(|reg| {
            if found.is_ok() {
                found = self.write(reg, moved);
            }
        });
        found
    }

    fn write(&mut self, reg: Reg, moved: bool) -> Result<(), Problem> {
        let info = self.program.regs.get(reg.0 as usize).ok_or(Problem::NoRegister(reg))?;
        if info.source != Source::Code || (info.mutable && !moved) {
            return Err(Problem::Unwritable(reg));
        }
        if info.mutable {
            return Ok(());
        }
        if std::mem::replace(&mut self.written[reg.0 as usize], true) {
            return Err(Problem::WrittenTwice(reg));
        }
        self.trail.push(reg);
        Ok(())
    }
}

/// Does what a register gets suit it?
fn register(info: &RegInfo) -> Result<(), Problem> {
    let holds = match info.source {
        Source::Code => return Ok(()),
        Source::Const(Const::Float(_)) => Kind::Float,
        Source::Const(Const::Int(_)) => Kind::Int,
        Source::Const(Const::NoClosure) => Kind::Closure,
        Source::Const(Const::String(number)) => match Symbol(number).exists() {
            true => Kind::String,
            false => return Err(Problem::NoSymbol(number)),
        },
        // Every input differs from lane to lane.
        Source::Input(input) if !input.exists() || info.uniform => return Err(Problem::NoInput(input)),
        Source::Input(input) => input.kind(),
    };
    if info.kind == holds { Ok(()) } else { Err(Problem::WrongKind { holds, wanted: info.kind }) }
}
