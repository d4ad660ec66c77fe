//! What is wrong or odd, at places of the text itself.

use super::study::Study;
use std::ops::Range;
use velour_grammar::places::MAIN_FILE;
use velour_grammar::{Diagnostic, Severity};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing is made of the text.
    Error,
    /// It is doubtful.
    Warning,
    /// It works and is odd: nothing reads or writes a variable.
    Unused,
}

/// A message.
#[derive(Clone, Debug)]
pub struct Message {
    /// How bad it is.
    pub level: Level,
    /// A stable code, such as `E0203`.
    pub code: &'static str,
    /// What is wrong, and one way out.
    pub text: String,
    /// The bytes of the text that it is about. What is wrong in an included file is shown where that is included.
    pub range: Range<usize>,
    /// Other places of the text that matter, each with a remark.
    pub also: Vec<(Range<usize>, String)>,
}

impl Study {
    /// All messages. A header need not have a shader in it.
    pub fn messages(&self) -> Vec<Message> {
        let header =
            !self.name.ends_with(".osl") && self.name.rsplit(['/', '\\']).next().is_some_and(|n| n.contains('.'));
        let told = self.checked.diagnostics.list.iter().filter(|d| !(header && d.code == "E0402"));
        told.map(|diagnostic| self.message(diagnostic)).collect()
    }

    fn message(&self, diagnostic: &Diagnostic) -> Message {
        let sources = &self.checked.sources;
        let level = match (diagnostic.severity, diagnostic.code) {
            (Severity::Error, _) => Level::Error,
            (Severity::Warning, "W0507" | "W0508") => Level::Unused,
            (Severity::Warning, _) => Level::Warning,
        };
        let mut text = diagnostic.message.clone();
        if !diagnostic.label.is_empty() {
            text = format!("{text}: {}", diagnostic.label);
        }
        if let Some(help) = &diagnostic.help {
            text = format!("{text}\n{help}");
        }
        let place = sources.written(diagnostic.span);
        if let (Some(place), Some(at)) = (place, sources.locate(diagnostic.span))
            && place.file != MAIN_FILE
        {
            text = format!("{}:{}: {text}", at.file, at.line);
        }
        let range = place.and_then(|place| sources.in_main(place)).map_or(0..0, |p| p.start as usize..p.end as usize);
        let also = diagnostic.secondary.iter().filter_map(|(span, remark)| {
            let place = sources.written(*span).filter(|place| place.file == MAIN_FILE)?;
            Some((place.start as usize..place.end as usize, remark.clone()))
        });
        Message { level, code: diagnostic.code, text, range, also: also.collect() }
    }
}
