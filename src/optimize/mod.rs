//! Program to program: derivatives where they are read, dead code out, uniform values found, operations in pairs.
//!
//! Differs from OSL: where OSL's derivatives have the wrong sign (`atan2`), velour's are the mathematical ones, and asking for a
//! derivative never changes the value (OSL's `pow(0, 0)` becomes 0 when its derivative is read).

mod dead;
mod derive;
mod flow;
mod fuse;
mod uniform;

use crate::ir::program::Program;
use crate::ir::verify::debug_verify;
use crate::lang::closures::ClosureTable;

/// Which passes run besides the ones a program cannot do without.
#[derive(Clone, Copy, Debug)]
pub struct OptimizeOptions {
    /// Remove what no result needs.
    pub dead_code: bool,
    /// Keep values that all lanes share as one number.
    pub uniform: bool,
    /// Run two operations as one instruction where one is there for the other alone.
    pub fuse: bool,
}

impl Default for OptimizeOptions {
    fn default() -> Self {
        OptimizeOptions { dead_code: true, uniform: true, fuse: true }
    }
}

/// Prepares a lowered program, which calls the closures of a table, for the machine. In debug builds each pass is held to what a program promises.
pub fn optimize(mut program: Program, table: &ClosureTable, options: OptimizeOptions) -> Program {
    debug_verify(&program, table);
    program.lowered = program.instructions();
    if options.dead_code {
        dead::remove(&mut program);
        debug_verify(&program, table);
    }
    derive::expand(&mut program);
    debug_verify(&program, table);
    if options.dead_code {
        dead::remove(&mut program);
    }
    uniform::mark(&mut program, options.uniform);
    debug_verify(&program, table);
    // Last, because the passes before it know single operations only.
    if options.fuse {
        fuse::pairs(&mut program);
        debug_verify(&program, table);
    }
    program
}
