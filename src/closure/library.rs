//! All closures that shaders may call, with what they do: velour's own and those that a host registers.

use super::arguments::Arguments;
use super::definition::{ClosureDef, Prepare};
use super::families;
use super::leaf::{Leaf, LeafMaker};
use super::tree::{Node, Tree};
use crate::lang::closures::{ClosureId, ClosureSpec, ClosureTable};
use std::fmt;
use std::sync::Arc;

/// The closures of a session. A compiler holds one, and everything that it compiles refers to it.
#[derive(Clone, Default)]
pub struct Library {
    table: ClosureTable,
    /// One entry a spec.
    prepare: Vec<Arc<Prepare>>,
}

impl Library {
    /// The closures velour renders.
    pub fn standard() -> Self {
        let mut library = Library::default();
        for definition in families::all() {
            library.push(definition);
        }
        library
    }

    /// The declarations.
    pub fn table(&self) -> &ClosureTable {
        &self.table
    }

    /// The declarations, in the order of their ids.
    pub fn specs(&self) -> &[ClosureSpec] {
        &self.table.specs
    }

    /// The declaration of a closure.
    pub fn get(&self, id: ClosureId) -> &ClosureSpec {
        self.table.get(id)
    }

    /// All closures of a name (overloads stand side by side).
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (ClosureId, &'a ClosureSpec)> + 'a {
        self.table.named(name)
    }

    /// Adds a closure of the host and gives its id. A name that is known already becomes an overload.
    ///
    /// # Errors
    /// The name, or that of a parameter, cannot be written in a shader, or a call could not be told from another.
    pub fn register(&mut self, definition: ClosureDef) -> Result<ClosureId, RegisterError> {
        let spec = &definition.spec;
        if !is_name(spec.name) {
            return Err(RegisterError::NoName(spec.name));
        }
        let parameters = || spec.params.iter().chain(&spec.keywords).map(|param| param.name);
        if let Some(wrong) = parameters().find(|name| !is_name(name)) {
            return Err(RegisterError::NoName(wrong));
        }
        if let Some((_, twice)) = parameters().enumerate().find(|(at, name)| parameters().take(*at).any(|n| n == *name))
        {
            return Err(RegisterError::Twice { closure: spec.name, parameter: twice });
        }
        let kinds = |spec: &ClosureSpec| spec.params.iter().map(|param| param.kind).collect::<Vec<_>>();
        if self.named(spec.name).any(|(_, other)| kinds(other) == kinds(spec)) {
            return Err(RegisterError::Known(spec.name));
        }
        Ok(self.push(definition))
    }

    fn push(&mut self, definition: ClosureDef) -> ClosureId {
        let ClosureDef { spec, prepare } = definition;
        self.table.specs.push(spec);
        self.prepare.push(prepare);
        ClosureId(self.prepare.len() as u32 - 1)
    }

    /// Makes a leaf of the tree ready; `begin` has its closure's name.
    pub(super) fn leaf<'a>(
        &self,
        tree: &'a Tree,
        node: &Node,
        begin: impl FnOnce(&'static str) -> LeafMaker<'a>,
    ) -> Leaf {
        let Node::Leaf { closure, first_param, param_count, first_keyword, keyword_count } = *node else {
            return Leaf::default();
        };
        let (first, last) = (first_param as usize, (first_param + param_count) as usize);
        let (first_word, last_word) = (first_keyword as usize, (first_keyword + keyword_count) as usize);
        let arguments = Arguments::new(tree, &tree.params[first..last], &tree.keywords[first_word..last_word]);
        let spec = self.get(closure);
        let mut maker = begin(spec.name);
        self.prepare[closure.0 as usize](&arguments, &mut maker);
        let mut leaf = maker.finish();
        (leaf.emits, leaf.hole) = (spec.emits, spec.holds_out);
        if !spec.scatters {
            // A plan has been made for none.
            leaf.parts.clear();
        }
        leaf
    }
}

impl fmt::Debug for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Library").field("table", &self.table).finish_non_exhaustive()
    }
}

/// Why a closure was not registered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RegisterError {
    /// This is no name of the language.
    NoName(&'static str),
    /// Two parameters have one name.
    Twice {
        /// The closure.
        closure: &'static str,
        /// The name.
        parameter: &'static str,
    },
    /// There is a closure of this name that takes the same types.
    Known(&'static str),
}

impl fmt::Display for RegisterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RegisterError::NoName(name) => write!(f, "`{name}` is no name of the language"),
            RegisterError::Twice { closure, parameter } => write!(f, "`{closure}` has two parameters `{parameter}`"),
            RegisterError::Known(name) => write!(f, "there is a closure `{name}` that takes the same types"),
        }
    }
}

impl std::error::Error for RegisterError {}

/// Can a shader write this name?
fn is_name(text: &str) -> bool {
    let word = |c: char| c == '_' || c.is_ascii_alphanumeric();
    !text.is_empty() && text.chars().all(word) && !text.starts_with(|c: char| c.is_ascii_digit())
}
