//! What the checker finds out about names, for those who ask where one is declared and used.

use super::typed::{FunctionId, VarId, Variable};
use crate::lang::closures::ClosureId;
use crate::lang::types::{Struct, Type};
use std::sync::Arc;
use velour_grammar::Span;
use velour_grammar::names::Name;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// A variable, parameter or global: an index into [`Notes::variables`].
    Variable(VarId),
    /// A function of the text or of a header: an index into [`Notes::functions`].
    Function(FunctionId),
    /// A function that is built in.
    Builtin(&'static str),
    /// A closure.
    Closure(ClosureId),
    /// A struct: an index into [`Notes::structs`].
    Struct(u32),
    /// A field of a struct, both by position.
    Field(u32, u32),
    /// The shader.
    Shader,
}

/// A place where a name stands.
#[derive(Clone, Debug)]
pub struct Use {
    /// The name, perhaps in parentheses.
    pub span: Span,
    /// The name as it is spelled there.
    pub name: Name,
    /// What it stands for.
    pub meaning: Meaning,
    /// True where it is declared.
    pub declares: bool,
}

/// A function of the text or of a header.
#[derive(Clone, Debug, Default)]
pub struct NotedFunction {
    /// Its name.
    pub name: String,
    /// What it returns.
    pub returns: Type,
    /// Types of its parameters, and whether each is written.
    pub formals: Vec<(Type, bool)>,
    /// Names of its parameters.
    pub names: Vec<Name>,
}

/// What is known of the names of a text, as far as it could be checked.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// The places of names. Of two for the same place the later one is right.
    pub uses: Vec<Use>,
    /// Every variable.
    pub variables: Vec<Variable>,
    /// Every function.
    pub functions: Vec<NotedFunction>,
    /// Every struct.
    pub structs: Vec<Arc<Struct>>,
}

impl Notes {
    /// The number of a struct.
    pub fn number_of(&self, structure: &Arc<Struct>) -> Option<u32> {
        let at = self.structs.iter().rposition(|known| Arc::ptr_eq(known, structure));
        at.and_then(|at| u32::try_from(at).ok())
    }

    /// The candidates of a name's uses: where something of this meaning is declared.
    pub fn declarations(&self, meaning: Meaning) -> impl Iterator<Item = &Use> {
        self.uses.iter().filter(move |place| place.declares && place.meaning == meaning)
    }
}
