//! Macros: what `#define` keeps.

use super::scan::PpToken;
use crate::Options;
use crate::source::Place;
use std::cell::Cell;
use std::fmt::Write;
use std::rc::Rc;

/// What a macro stands for.
#[derive(Debug, PartialEq, Eq, Clone, Copy)]
pub(super) enum Meaning {
    /// Its body.
    Body,
    /// `__FILE__`
    File,
    /// `__LINE__`
    Line,
}

/// A macro.
#[derive(Debug)]
pub(super) struct Macro {
    pub meaning: Meaning,
    /// Where its name was defined; `None` for those that are built in.
    pub place: Option<Place>,
    /// Names of the parameters; `None` for a macro without parentheses.
    pub params: Option<Vec<String>>,
    /// The last parameter takes all arguments that are left.
    pub variadic: bool,
    pub body: Vec<BodyToken>,
    /// Set while the macro is being expanded.
    pub off: Cell<bool>,
}

/// A token of a macro's body.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyToken {
    pub token: PpToken,
    /// The parameter it names.
    pub param: Option<usize>,
}

impl Macro {
    fn built_in(meaning: Meaning) -> Rc<Macro> {
        let off = Cell::new(false);
        Rc::new(Macro { meaning, place: None, params: None, variadic: false, body: Vec::new(), off })
    }

    /// `__FILE__`
    pub(super) fn file() -> Rc<Macro> {
        Self::built_in(Meaning::File)
    }

    /// `__LINE__`
    pub(super) fn line() -> Rc<Macro> {
        Self::built_in(Meaning::Line)
    }
}

/// The text that defines what is known before the first line: the version, and what the caller asks for.
pub(super) fn predefined(options: &Options) -> String {
    let mut text = String::from(
        "#define OSL_VERSION_MAJOR 1\n#define OSL_VERSION_MINOR 16\n#define OSL_VERSION_PATCH 0\n\
         #define OSL_VERSION 11600\n#define __VELOUR__ 1\n",
    );
    for (name, value) in &options.defines {
        let _ = writeln!(text, "#define {name} {}", value.replace(['\n', '\r'], " "));
    }
    for name in &options.undefines {
        let _ = writeln!(text, "#undef {name}");
    }
    text
}
