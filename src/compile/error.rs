//! Why there is no shader, or no group: each kind with a stable code.

use crate::ir::verify::VerifyError;
use crate::lang::types::Type;
use std::fmt;
use velour_grammar::{Diagnostics, Format, Sources};

/// Why a shader could not be made.
#[derive(Debug)]
#[non_exhaustive]
pub enum CompileError {
    /// Its text is wrong.
    Text {
        /// All messages.
        diagnostics: Diagnostics,
        /// The text they refer to.
        sources: Sources,
    },
    /// Its file could not be read.
    File {
        /// The file.
        name: String,
        /// Why.
        error: std::io::Error,
    },
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CompileError::Text { diagnostics, sources } => {
                f.write_str(sources.render(diagnostics, Format::Full, false).trim_end())
            }
            CompileError::File { name, error } => write!(f, "{name}: error: {error}"),
        }
    }
}

impl std::error::Error for CompileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            CompileError::Text { .. } => None,
            CompileError::File { error, .. } => Some(error),
        }
    }
}

/// Why a group could not be made: what is wrong with a parameter or a connection.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GroupError {
    /// What is wrong; its text is one clause.
    pub problem: Box<GroupProblem>,
    /// The way out.
    pub help: String,
    /// What is wrong, by the names it was given with; a host that knows where those were written can name the place.
    pub subject: GroupSubject,
}

/// What is wrong with a parameter or a connection of a group.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GroupProblem {
    /// G0101: a connection of a layer that is not there.
    NoLayer {
        /// Its name.
        layer: String,
    },
    /// G0102: a connection from a later layer to an earlier one, or to itself.
    LayerOrder {
        /// Where it begins.
        source: String,
        /// Where it ends.
        target: String,
    },
    /// G0201: the shader has no such parameter.
    NoParam {
        /// The shader.
        shader: String,
        /// The parameter as given.
        path: String,
    },
    /// G0202: the path to a part of a parameter is not written as one.
    NotAPath {
        /// The parameter as given.
        path: String,
    },
    /// G0203: the parameter has no such part.
    NoPart {
        /// The parameter as given.
        path: String,
        /// Why not.
        reason: String,
    },
    /// G0301: a value of another kind than the parameter takes.
    WrongType {
        /// The parameter as given.
        path: String,
        /// What it takes.
        wanted: Type,
        /// What was given, such as `a string`.
        given: String,
    },
    /// G0302: more values than the parameter holds.
    TooMany {
        /// The parameter as given.
        path: String,
        /// What it takes.
        wanted: Type,
        /// How many numbers or strings it holds.
        room: usize,
        /// What was given, such as `4 numbers`.
        given: String,
    },
    /// G0306: some of the numbers of a color, point, vector, normal or matrix, which takes all or one.
    TooFew {
        /// The parameter as given.
        path: String,
        /// What it takes.
        wanted: Type,
        /// How many numbers it needs.
        room: usize,
        /// How many were given, such as `2 numbers`.
        given: String,
    },
    /// G0303: a number that stands for an int and is none.
    NotAnInt {
        /// The parameter as given.
        path: String,
        /// What it takes.
        wanted: Type,
        /// The number.
        value: f64,
    },
    /// G0304: an output whose type the parameter does not take.
    CannotFeed {
        /// The parameter as given.
        path: String,
        /// What it takes.
        wanted: Type,
        /// What the output is.
        given: Type,
    },
    /// G0305: a parameter that its shader lets nothing feed, by `[[int allowconnect = 0]]`.
    NotConnectable {
        /// The parameter as given.
        path: String,
    },
    /// G0401: the program of the group is more than the machine takes, or breaks another promise.
    CannotRun {
        /// Which.
        error: VerifyError,
    },
}

impl GroupProblem {
    /// A stable code, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            GroupProblem::NoLayer { .. } => "G0101",
            GroupProblem::LayerOrder { .. } => "G0102",
            GroupProblem::NoParam { .. } => "G0201",
            GroupProblem::NotAPath { .. } => "G0202",
            GroupProblem::NoPart { .. } => "G0203",
            GroupProblem::WrongType { .. } => "G0301",
            GroupProblem::TooMany { .. } => "G0302",
            GroupProblem::TooFew { .. } => "G0306",
            GroupProblem::NotAnInt { .. } => "G0303",
            GroupProblem::CannotFeed { .. } => "G0304",
            GroupProblem::NotConnectable { .. } => "G0305",
            GroupProblem::CannotRun { .. } => "G0401",
        }
    }
}

impl fmt::Display for GroupProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GroupProblem::NoLayer { layer } => write!(f, "there is no layer `{layer}`"),
            GroupProblem::LayerOrder { source, target } => {
                write!(f, "layer `{source}` does not come before layer `{target}`")
            }
            GroupProblem::NoParam { shader, path } => write!(f, "shader `{shader}` has no parameter `{path}`"),
            GroupProblem::NotAPath { path } => {
                write!(f, "`{path}` is no part of a parameter: write `name.field` or `name[0]`")
            }
            GroupProblem::NoPart { path, reason } => write!(f, "there is no `{path}`: {reason}"),
            GroupProblem::WrongType { path, wanted, given } => {
                write!(f, "parameter `{path}` is {}, not {given}", wanted.named())
            }
            GroupProblem::TooMany { path, wanted, room, given } => {
                write!(f, "parameter `{path}` is {} and holds {room}, not {given}", wanted.named())
            }
            GroupProblem::TooFew { path, wanted, room, given } => {
                write!(f, "parameter `{path}` is {} and takes {room} numbers, or one, not {given}", wanted.named())
            }
            GroupProblem::NotAnInt { path, wanted, value } => {
                write!(f, "parameter `{path}` is {}, and {value} is no int", wanted.named())
            }
            GroupProblem::CannotFeed { path, wanted, given } => {
                write!(f, "a {given} cannot feed the {wanted} `{path}`")
            }
            GroupProblem::NotConnectable { path } => {
                write!(f, "`{path}` cannot be fed: its shader says so with `allowconnect`")
            }
            GroupProblem::CannotRun { error } => write!(f, "the shader cannot be run: {error}"),
        }
    }
}

/// What a [`GroupError`] is about.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GroupSubject {
    /// A parameter of a layer.
    Param {
        /// The layer.
        layer: String,
        /// The parameter as given.
        name: String,
    },
    /// A layer as a whole.
    Layer(String),
}

impl fmt::Display for GroupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}\n  help: {}", self.problem, self.help)
    }
}

impl std::error::Error for GroupError {}
