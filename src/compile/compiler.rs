//! What all shaders of a session share, and the way from text to a shader.

use super::error::CompileError;
use super::recipe::Recipe;
use super::shader::Shader;
use crate::check::check;
use crate::closure::Library;
use crate::limits::SHADER_BYTES;
use std::path::Path;
use std::sync::Arc;
use velour_grammar::{Diagnostics, Options, Severity, Sources, parse, parse_bytes};

/// The standard header, kept in the binary so that nothing has to be installed.
pub const STDOSL: &str = include_str!("../../shaders/stdosl.osl");

/// The name under which messages speak of the built-in header.
const STDOSL_NAME: &str = "stdosl.osl";

/// The headers that come with velour, by the names OSL gives them. The standard one is always read first, so including it again
/// adds nothing.
const HEADERS: &[(&str, &str)] = &[
    ("stdosl.h", ""),
    (STDOSL_NAME, ""),
    ("vector2.h", include_str!("../../shaders/headers/vector2.h")),
    ("vector4.h", include_str!("../../shaders/headers/vector4.h")),
    ("color2.h", include_str!("../../shaders/headers/color2.h")),
    ("color4.h", include_str!("../../shaders/headers/color4.h")),
    ("matrix33.h", include_str!("../../shaders/headers/matrix33.h")),
    ("oslutil.h", include_str!("../../shaders/headers/oslutil.h")),
];

/// What all shaders of a session share.
#[derive(Clone, Debug)]
pub struct Compiler {
    /// Include folders, macros, files in memory, and the standard header as prelude.
    pub options: Options,
    /// The closures that shaders may call.
    pub closures: Arc<Library>,
}

/// What checking a text gives.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The shader, when there is no error.
    pub shader: Option<Shader>,
    /// All messages.
    pub diagnostics: Diagnostics,
    /// The text they refer to.
    pub sources: Sources,
    /// What was parsed. Whoever ends after this need not take the time to free it.
    pub tree: velour_grammar::ast::File,
}

impl Checked {
    /// Drops the warnings that the text has asked to be left out.
    pub(super) fn drop_quiet(&mut self) {
        let sources = &self.sources;
        self.diagnostics.list.retain(|d| d.severity == Severity::Error || !sources.is_quiet(d.span));
    }
}

impl Default for Compiler {
    fn default() -> Self {
        Self::new()
    }
}

impl Compiler {
    /// A compiler with the built-in header and the standard closures.
    pub fn new() -> Self {
        let options = Options {
            own_files: HEADERS.iter().map(|&(name, text)| (name.to_owned(), text.to_owned())).collect(),
            prelude: Some((STDOSL_NAME.to_owned(), STDOSL.to_owned())),
            ..Options::default()
        };
        Compiler { options, closures: Arc::new(Library::standard()) }
    }

    /// Uses these closures: velour's own, and those that the host has registered.
    pub fn with_closures(mut self, closures: impl Into<Arc<Library>>) -> Self {
        self.closures = closures.into();
        self
    }

    /// Uses another standard header.
    pub fn with_header(mut self, name: &str, text: &str) -> Self {
        self.options.prelude = Some((name.to_owned(), text.to_owned()));
        self
    }

    /// Parses and checks a text and gives everything there is to say about it.
    pub fn check(&self, name: &str, text: &str) -> Checked {
        let parsed = parse(name, text, &self.options);
        // After a syntax error the tree lacks pieces.
        if parsed.diagnostics.has_errors() { self.check_around(parsed, name, text) } else { self.finish(parsed) }
    }

    /// The same for the bytes of a file, which may be anything.
    pub fn check_bytes(&self, name: &str, bytes: &[u8]) -> Checked {
        let parsed = parse_bytes(name, bytes, &self.options);
        match std::str::from_utf8(bytes).ok().filter(|_| parsed.diagnostics.has_errors()) {
            Some(text) => self.check_around(parsed, name, text),
            None => self.finish(parsed),
        }
    }

    /// The same, with warnings of what works and is odd: variables that nothing reads, or nothing writes.
    pub fn check_closely(&self, name: &str, bytes: &[u8]) -> Checked {
        let prelude = self.options.prelude.as_ref().map_or("", |(name, _)| name.as_str());
        let mut checked = self.check_bytes(name, bytes);
        if let Some(shader) = &checked.shader {
            let mut more = crate::check::unused(&shader.typed);
            let sources = &checked.sources;
            more.list.retain(|d| sources.locate(d.span).is_some_and(|at| at.file != prelude));
            checked.diagnostics.append(more);
            checked.drop_quiet();
        }
        checked
    }

    fn finish(&self, parsed: velour_grammar::Parsed) -> Checked {
        let mut diagnostics = parsed.diagnostics;
        let mut shader = None;
        // What is missing after bytes that are no text would only distract.
        if !diagnostics.has_errors() {
            let (typed, more) = check(&parsed.file, self.closures.table());
            diagnostics.append(more);
            shader = typed.map(|typed| Shader {
                typed: Arc::new(typed),
                sources: parsed.sources.clone(),
                closures: self.closures.clone(),
            });
        }
        let mut checked = Checked { shader, diagnostics, sources: parsed.sources, tree: parsed.file };
        checked.drop_quiet();
        checked
    }

    /// Compiles a text to a shader.
    ///
    /// # Errors
    /// All messages, when one of them is an error.
    pub fn compile(&self, name: &str, text: &str) -> Result<Shader, CompileError> {
        Self::require(self.check(name, text))
    }

    /// Compiles a file to a shader: its text, or a [`Recipe`], whose macros and folders go before those of this compiler.
    ///
    /// # Errors
    /// The file cannot be read, or its text is wrong.
    pub fn compile_file(&self, path: &Path) -> Result<Shader, CompileError> {
        let Some(recipe) = Recipe::of_file(path, &self.options.access) else {
            return self.compile_text_of(path, path.display().to_string());
        };
        let mut compiler = self.clone();
        if let Some(header) = &recipe.header {
            let name = header.display().to_string();
            let text = String::from_utf8(self.read(header, &name)?).map_err(|_| CompileError::File {
                name: name.clone(),
                error: std::io::Error::other("it is not UTF-8 text"),
            })?;
            compiler = compiler.with_header(&name, &text);
        }
        compiler.options.include_dirs.splice(0..0, recipe.include_dirs);
        compiler.options.defines.splice(0..0, recipe.defines);
        compiler.options.undefines.splice(0..0, recipe.undefines);
        compiler.compile_text_of(&recipe.source, recipe.name)
    }

    /// The bytes of a file that may be read, which messages call `name`.
    fn read(&self, path: &Path, name: &str) -> Result<Vec<u8>, CompileError> {
        let read = self.options.access.read(path, SHADER_BYTES);
        read.map_err(|error| CompileError::File { name: name.to_owned(), error: error.into() })
    }

    fn compile_text_of(&self, path: &Path, name: String) -> Result<Shader, CompileError> {
        let bytes = self.read(path, &name)?;
        Self::require(self.check_bytes(&name, &bytes))
    }

    fn require(checked: Checked) -> Result<Shader, CompileError> {
        let Checked { shader, diagnostics, sources, .. } = checked;
        shader.ok_or(CompileError::Text { diagnostics, sources })
    }
}

/// Compiles a text with the built-in header and the standard closures.
///
/// # Errors
/// All messages, when one of them is an error.
pub fn compile(text: &str) -> Result<Shader, CompileError> {
    Compiler::new().compile("shader", text)
}
