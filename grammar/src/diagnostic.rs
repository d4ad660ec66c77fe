//! Messages for the person who wrote the shader: one type, collected, never thrown.

use crate::limits::MESSAGES;
use crate::span::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Severity {
    /// The text is wrong; nothing is made of it.
    Error,
    /// The text is doubtful; it is compiled all the same.
    Warning,
}

/// A message: what is wrong, where, and one way out.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// A stable code, such as `E0203`.
    pub code: &'static str,
    /// One sentence without a full stop.
    pub message: String,
    /// The place that is wrong.
    pub span: Span,
    /// What to write under the place (may be empty).
    pub label: String,
    /// Other places that matter, each with a remark.
    pub secondary: Vec<(Span, String)>,
    /// Functions that it is about, each as it is declared, under headings; the short form lists them below the message.
    pub functions: Vec<(&'static str, Vec<(Span, String)>)>,
    /// One line on how to get out of it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Diagnostic {
            severity: Severity::Error,
            code,
            message: message.into(),
            span,
            label: String::new(),
            secondary: Vec::new(),
            functions: Vec::new(),
            help: None,
        }
    }

    /// A warning at a place.
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Diagnostic { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// Adds the text under the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds another place with a remark.
    pub fn also(mut self, span: Span, remark: impl Into<String>) -> Self {
        self.secondary.push((span, remark.into()));
        self
    }

    /// Adds functions that it is about.
    pub fn functions(mut self, heading: &'static str, functions: Vec<(Span, String)>) -> Self {
        self.functions.push((heading, functions));
        self
    }

    /// Adds the way out.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// The messages of one run, in the order they were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// The messages, [`crate::limits::MESSAGES`] of them at most.
    pub list: Vec<Diagnostic>,
    /// How many there were beyond that.
    pub left_out: usize,
}

impl Diagnostics {
    /// Adds a message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.list.len() < MESSAGES {
            self.list.push(diagnostic);
            return;
        }
        self.left_out += 1;
        // One error at least is among those that are kept.
        if diagnostic.severity == Severity::Error
            && !self.has_errors()
            && let Some(last) = self.list.last_mut()
        {
            *last = diagnostic;
        }
    }

    /// True when at least one message is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// Makes errors of all warnings.
    pub fn promote_warnings(&mut self) {
        self.list.iter_mut().for_each(|diagnostic| diagnostic.severity = Severity::Error);
    }

    /// Leaves only errors.
    pub fn drop_warnings(&mut self) {
        self.list.retain(|diagnostic| diagnostic.severity == Severity::Error);
    }

    /// True when there is nothing to say.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Takes over all messages of another list.
    pub fn append(&mut self, other: Diagnostics) {
        other.list.into_iter().for_each(|diagnostic| self.push(diagnostic));
        self.left_out += other.left_out;
    }
}
