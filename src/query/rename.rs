//! Another name for a variable, function, parameter, field or struct.

use super::study::{Found, Study, Symbol};
use crate::check::notes::Meaning;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;
use velour_grammar::places::{MAIN_FILE, is_free_name};

/// Why something is not renamed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RenameError {
    /// It has no name of its own, or is a macro or a file.
    Nothing,
    /// It comes with the language.
    BuiltIn,
    /// It stands in this file.
    Elsewhere(String),
    /// A macro makes its name.
    Made,
    /// The text does not parse, so that places might be missed.
    Broken,
    /// This cannot be a name.
    NoName(String),
    /// With this name the program would be another one.
    Collides(String),
}

impl fmt::Display for RenameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RenameError::Nothing => f.write_str("there is no variable, function, field or struct here"),
            RenameError::BuiltIn => f.write_str("what is built in keeps its name"),
            RenameError::Elsewhere(file) => write!(f, "it also stands in {file}, which is not renamed in"),
            RenameError::Made => f.write_str("a macro makes this name"),
            RenameError::Broken => f.write_str("the text does not parse, and what that hides would keep the old name"),
            RenameError::NoName(name) => write!(f, "`{name}` cannot be a name"),
            RenameError::Collides(name) => write!(f, "`{name}` means something else where this would stand"),
        }
    }
}

impl std::error::Error for RenameError {}

impl Study {
    /// The places of the text that a new name would be written to.
    ///
    /// # Errors
    /// Nothing here can be renamed.
    pub fn renamable(&self, found: &Found) -> Result<Vec<Range<usize>>, RenameError> {
        let Symbol::Named(meaning) = found.symbol else { return Err(RenameError::Nothing) };
        let global = |var: usize| self.notes.variables.get(var).is_none_or(|variable| variable.global.is_some());
        match meaning {
            Meaning::Builtin(_) | Meaning::Closure(_) => return Err(RenameError::BuiltIn),
            Meaning::Variable(var) if global(var.0 as usize) => return Err(RenameError::BuiltIn),
            _ if !self.is_whole() => return Err(RenameError::Broken),
            _ => {}
        }
        let sources = &self.checked.sources;
        let mut ranges = BTreeSet::new();
        for token in self.tokens_of(meaning, false) {
            let Some(place) = sources.spelled(token) else { continue };
            if sources.is_made(place.file) {
                return Err(RenameError::Made);
            }
            if place.file != MAIN_FILE {
                let name = sources.name_of(place.file);
                let own = self.comes_with_velour(name);
                return Err(if own { RenameError::BuiltIn } else { RenameError::Elsewhere(name.to_owned()) });
            }
            ranges.insert((place.start as usize, place.end as usize));
        }
        Ok(ranges.into_iter().map(|(start, end)| start..end).collect())
    }

    /// The places where a new name is to be written: with it everything means what it did before.
    ///
    /// # Errors
    /// Nothing here can be renamed, or not to this.
    pub fn rename(&self, found: &Found, new: &str) -> Result<Vec<Range<usize>>, RenameError> {
        let ranges = self.renamable(found)?;
        let global = self.notes.variables.iter().any(|variable| variable.global.is_some() && variable.name == *new);
        let builtin = global || matches!(self.by_name(new), Some(Meaning::Builtin(_) | Meaning::Closure(_)));
        if !is_free_name(new) {
            return Err(RenameError::NoName(new.to_owned()));
        }
        if builtin {
            return Err(RenameError::Collides(new.to_owned()));
        }
        let mut text = self.text.clone();
        for range in ranges.iter().rev() {
            text.replace_range(range.clone(), new);
        }
        let renamed = Study::new(&self.compiler, &self.name, &text);
        if renamed.meanings() != self.meanings() || renamed.codes() != self.codes() {
            return Err(RenameError::Collides(new.to_owned()));
        }
        Ok(ranges)
    }

    /// What each token stands for.
    fn meanings(&self) -> Vec<(u32, Meaning)> {
        self.noted().map(|(token, used)| (token, used.meaning)).collect()
    }

    /// What is said, and where.
    fn codes(&self) -> Vec<(&'static str, velour_grammar::Span)> {
        self.checked.diagnostics.list.iter().map(|d| (d.code, d.span)).collect()
    }
}
