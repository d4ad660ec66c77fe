//! What a program does not keep of what it promises, and where.

use crate::ir::op::{Input, Pair};
use crate::ir::program::*;
use crate::lang::closures::ClosureId;
use crate::limits::INSTRUCTIONS;
use std::fmt;

/// Why a program cannot be run.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifyError {
    /// The promise that is broken.
    pub problem: Problem,
    /// Where.
    pub place: Place,
}

/// A place in a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A register.
    Reg(Reg),
    /// An array.
    Array(ArrayId),
    /// A node of the body, counted from 0 in the order of the listing, branches and blocks included.
    Node(u32),
    /// The result.
    Result,
    /// An output, by its number.
    Output(usize),
}

/// A promise that is broken.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// There is no such register.
    NoRegister(Reg),
    /// There is no such array.
    NoArray(ArrayId),
    /// The array's elements have no such component.
    NoComponent(ArrayId, u32),
    /// There is no such scope.
    NoScope(ScopeId),
    /// There is no such closure in the table.
    NoClosure(ClosureId),
    /// The closure has no such keyword parameter.
    NoKeyword(ClosureId, u32),
    /// There is no such symbol.
    NoSymbol(i32),
    /// Points have no such input.
    NoInput(Input),
    /// There is no routine of this shape.
    NoRoutine(&'static str),
    /// There is no loop over lanes for the pair of operations.
    NoPair(Pair),
    /// A register or an array holds another kind than is wanted.
    WrongKind {
        /// What it holds.
        holds: Kind,
        /// What is wanted.
        wanted: Kind,
    },
    /// Another number of registers than is wanted.
    WrongCount {
        /// Of what.
        of: &'static str,
        /// How many there are.
        given: usize,
        /// How many are wanted.
        wanted: usize,
    },
    /// A register is read before it is written.
    Unwritten(Reg),
    /// An instruction writes a constant or an input, or a register that only moves may write.
    Unwritable(Reg),
    /// A register has a second place that writes it.
    WrittenTwice(Reg),
    /// A register is moved to itself.
    MovedToItself(Reg),
    /// A register keeps one number for all lanes, and what it is computed from differs from lane to lane.
    Varies(Reg),
    /// An array keeps one number for all lanes, and what is stored differs from lane to lane.
    VariesInArray(ArrayId),
    /// Some results of a routine keep one number for all lanes, and some do not.
    PartlyUniform,
    /// A scope is left from outside.
    LeftFromOutside(ScopeId),
    /// A scope is opened inside itself.
    OpenedTwice(ScopeId),
    /// Blocks are nested deeper than this.
    TooDeep(u32),
    /// The arrays together have more numbers than this.
    TooLarge(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Reg(reg) => write!(f, "register {}", reg.0),
            Place::Array(array) => write!(f, "array {}", array.0),
            Place::Node(number) => write!(f, "node {number}"),
            Place::Result => f.write_str("the result"),
            Place::Output(number) => write!(f, "output {number}"),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::NoRegister(reg) => write!(f, "there is no register {}", reg.0),
            Problem::NoArray(array) => write!(f, "there is no array {}", array.0),
            Problem::NoComponent(array, component) => write!(f, "array {} has no component {component}", array.0),
            Problem::NoScope(scope) => write!(f, "there is no scope {}", scope.0),
            Problem::NoClosure(closure) => write!(f, "there is no closure {}", closure.0),
            Problem::NoKeyword(closure, at) => write!(f, "closure {} has no keyword parameter {at}", closure.0),
            Problem::NoSymbol(number) => write!(f, "there is no symbol {number}"),
            Problem::NoInput(input) => write!(f, "there is no input {input:?}"),
            Problem::NoRoutine(name) => write!(f, "there is no `{name}` of this shape"),
            Problem::NoPair(pair) => write!(f, "there is no loop over lanes for {pair:?}"),
            Problem::WrongKind { holds, wanted } => write!(f, "a {holds:?} stands where a {wanted:?} is wanted"),
            Problem::WrongCount { of, given, wanted } => write!(f, "{given} {of} stand where {wanted} are wanted"),
            Problem::Unwritten(reg) => write!(f, "register {} is read before it is written", reg.0),
            Problem::Unwritable(reg) => write!(f, "register {} may not be written here", reg.0),
            Problem::WrittenTwice(reg) => write!(f, "register {} is written twice", reg.0),
            Problem::MovedToItself(reg) => write!(f, "register {} is moved to itself", reg.0),
            Problem::Varies(reg) => write!(f, "register {} keeps one number and its lanes differ", reg.0),
            Problem::VariesInArray(array) => write!(f, "array {} keeps one number and its lanes differ", array.0),
            Problem::PartlyUniform => f.write_str("some results keep one number for all lanes and some do not"),
            Problem::LeftFromOutside(scope) => write!(f, "scope {} is left from outside", scope.0),
            Problem::OpenedTwice(scope) => write!(f, "scope {} is opened inside itself", scope.0),
            Problem::TooDeep(most) => write!(f, "blocks are nested more than {most} deep"),
            Problem::TooLarge(most) => {
                write!(
                    f,
                    "its arrays have more than {most} numbers together, or its code more than {INSTRUCTIONS} instructions"
                )
            }
        }
    }
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.problem)
    }
}

impl std::error::Error for VerifyError {}
