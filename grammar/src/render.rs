//! Messages as text: one line each, or with excerpts of the source.

use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::limits::SHOWN;
use crate::source::{NO_CALL, Place, SCRATCH, Sources};
use crate::span::Span;
use codespan_reporting::diagnostic as shown;
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term::{self, Config, termcolor};
use std::ops::Range;
use std::sync::Arc;

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// With excerpts of the source and carets.
    Full,
    /// `file:line:column: error: message`, one line each.
    Short,
    /// One JSON object a line: `severity`, `code`, `message`, `file`, `line`, `column`, `label`, `help`, and `also`, a list of further
    /// places with their `text`. Without a place `file` is null.
    Json,
}

/// More notes than this about macros and includes say no more.
const MAX_NOTES: usize = 6;

/// How the names of shaders and headers end.
const HEADERS: [&str; 8] = ["osl", "h", "oslh", "hpp", "hh", "inc", "glsl", "mx"];

/// Lines of more bytes than this are shown in part.
const LONG_LINE: usize = 240;

impl Sources {
    /// Writes messages as text, in order. Colours are ANSI escapes.
    pub fn render(&self, diagnostics: &Diagnostics, format: Format, color: bool) -> String {
        let mut out = String::new();
        for diagnostic in &self.told(diagnostics) {
            match format {
                Format::Short => self.render_short(diagnostic, &mut out),
                Format::Full => self.render_full(diagnostic, color, &mut out),
                Format::Json => self.render_json(diagnostic, &mut out),
            }
        }
        let more = diagnostics.list.len().saturating_sub(SHOWN) + diagnostics.left_out;
        match (more, format) {
            (0, _) => {}
            (more, Format::Short | Format::Full) => out.push_str(&format!("and {more} more messages\n")),
            (more, Format::Json) => out.push_str(&format!(
                "{{\"severity\":\"note\",\"code\":\"\",\"message\":\"and {more} more messages\",\"file\":null,\"line\":null,\"column\":null,\"label\":\"\",\"help\":null,\"also\":[]}}\n"
            )),
        }
        out
    }

    /// The first messages, errors before warnings where not all are shown, without the text of files that are no shaders.
    fn told(&self, diagnostics: &Diagnostics) -> Vec<Diagnostic> {
        let mut list: Vec<&Diagnostic> = diagnostics.list.iter().collect();
        if list.len() > SHOWN {
            list.sort_by_key(|diagnostic| diagnostic.severity != Severity::Error);
            list.truncate(SHOWN);
        }
        let mut hidden: Vec<Arc<str>> = Vec::new();
        let mut told = Vec::new();
        for diagnostic in list {
            match self.foreign(diagnostic.span) {
                None => told.push(self.without_foreign(diagnostic)),
                // One message for each file: what is wrong in it would tell of its text.
                Some(file) if !hidden.contains(&file) => {
                    let line = self.locate(diagnostic.span).map_or(0, |at| at.line);
                    let message = format!("{file}:{line}: what is included here is no shader text");
                    let error = Diagnostic::error(diagnostic.code, Span::NONE, message);
                    told.push(
                        Diagnostic { severity: diagnostic.severity, ..error }
                            .help("its text is not shown: a header's name ends in .h or .osl"),
                    );
                    hidden.push(file);
                }
                Some(_) => {}
            }
        }
        told
    }

    /// The message without remarks at places of files that are no shaders.
    fn without_foreign(&self, diagnostic: &Diagnostic) -> Diagnostic {
        let mut told = diagnostic.clone();
        told.secondary.retain(|(span, _)| self.foreign(*span).is_none());
        told
    }

    /// The file of a place, when it was included and its name is not that of a header or shader.
    fn foreign(&self, span: Span) -> Option<Arc<str>> {
        let file = self.place(span)?.file;
        self.is_foreign(file).then(|| self.table.files[file as usize].name.clone())
    }

    /// Was a file included whose name is not that of a header or shader?
    fn is_foreign(&self, file: u32) -> bool {
        let file = &self.table.files[file as usize];
        let extension = std::path::Path::new(&*file.name).extension().and_then(|e| e.to_str());
        let known = extension.is_some_and(|e| HEADERS.contains(&e.to_lowercase().as_str()));
        file.included_from.is_some() && !known
    }

    fn render_short(&self, diagnostic: &Diagnostic, out: &mut String) {
        if let Some(at) = self.locate(diagnostic.span) {
            out.push_str(&format!("{}:{}:{}: ", at.file, at.line, at.column));
        }
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        out.push_str(&format!("{severity}: {}\n", diagnostic.message.replace('\n', " ")));
        for (heading, functions) in diagnostic.functions.iter().filter(|(_, functions)| !functions.is_empty()) {
            out.push_str(&format!("  {heading}:\n"));
            for (span, text) in functions {
                let place = self.locate(*span).map_or(String::new(), |at| format!("{}:{}\t", at.file, at.line));
                out.push_str(&format!("    {place}{text}\n"));
            }
        }
    }

    fn render_json(&self, diagnostic: &Diagnostic, out: &mut String) {
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let place = |span: Span| match self.locate(span) {
            Some(at) => format!("\"file\":{},\"line\":{},\"column\":{}", json(&at.file), at.line, at.column),
            None => "\"file\":null,\"line\":null,\"column\":null".to_owned(),
        };
        let also =
            diagnostic.secondary.iter().map(|(span, text)| format!("{{{},\"text\":{}}}", place(*span), json(text)));
        let also: Vec<String> = also.collect();
        out.push_str(&format!(
            "{{\"severity\":\"{severity}\",\"code\":\"{}\",\"message\":{},{},\"label\":{},\"help\":{},\"also\":[{}]}}\n",
            diagnostic.code,
            json(&diagnostic.message),
            place(diagnostic.span),
            json(&diagnostic.label),
            diagnostic.help.as_deref().map_or("null".to_owned(), json),
            also.join(",")
        ));
    }

    fn render_full(&self, diagnostic: &Diagnostic, color: bool, out: &mut String) {
        let severity = match diagnostic.severity {
            Severity::Error => shown::Severity::Error,
            Severity::Warning => shown::Severity::Warning,
        };
        let mut message = shown::Diagnostic::new(severity).with_code(diagnostic.code).with_message(&diagnostic.message);
        message.labels.extend(self.labels(diagnostic.span, &diagnostic.label, shown::LabelStyle::Primary));
        for (span, remark) in &diagnostic.secondary {
            message.labels.extend(self.labels(*span, remark, shown::LabelStyle::Secondary));
        }
        message.notes.extend(self.includes(diagnostic.span));
        message.notes.extend(diagnostic.help.iter().map(|help| format!("help: {help}")));
        if let Some(place) = self.place(diagnostic.span)
            && let Some(excerpt) = Excerpt::of_long_line(self, place)
        {
            let range = excerpt.range.clone();
            message.labels = vec![shown::Label::primary(0, range).with_message(&diagnostic.label)];
            return self.emit(diagnostic, &excerpt, &message, color, out);
        }
        self.emit(diagnostic, self, &message, color, out);
    }

    fn emit<'a, F: Files<'a, FileId = usize>>(
        &self,
        diagnostic: &Diagnostic,
        files: &'a F,
        message: &shown::Diagnostic<usize>,
        color: bool,
        out: &mut String,
    ) {
        let config = Config::default();
        // Writing to memory fails only if a place lies outside of its file; then the short form still says it.
        let result = if color {
            let mut buffer = termcolor::Ansi::new(Vec::new());
            let result = term::emit_to_write_style(&mut buffer, &config, files, message);
            result.map(|()| String::from_utf8_lossy(&buffer.into_inner()).into_owned())
        } else {
            term::emit_into_string(&config, files, message)
        };
        match result {
            Ok(text) => out.push_str(&text),
            Err(_) => self.render_short(diagnostic, out),
        }
    }

    /// A label at the user's text, and one for each macro whose body the token came out of.
    fn labels(&self, span: Span, text: &str, style: shown::LabelStyle) -> Vec<shown::Label<usize>> {
        let Some(place) = self.place(span) else {
            return Vec::new();
        };
        let range = place.start as usize..place.end as usize;
        let mut labels = vec![shown::Label::new(style, place.file as usize, range).with_message(text)];
        let Some(token) = self.token(span.first) else {
            return labels;
        };
        let (mut at, mut call) = (token.place, token.call);
        while call != NO_CALL && labels.len() <= MAX_NOTES {
            let Some(made_by) = self.table.calls.get(call as usize) else {
                break;
            };
            if at.file != SCRATCH && !self.is_foreign(at.file) {
                let range = at.start as usize..at.end as usize;
                let note = format!("in expansion of macro {}", made_by.name);
                labels.push(shown::Label::secondary(at.file as usize, range).with_message(note));
            }
            (at, call) = (made_by.place, made_by.parent);
        }
        labels
    }

    /// The place of a span in the user's text.
    fn place(&self, span: Span) -> Option<Place> {
        let outermost = |index| self.token(index).map(|t| self.table.outermost(t.place, t.call));
        let first = outermost(span.first)?;
        let last = outermost(span.last).unwrap_or(first);
        let joined = last.file == first.file && last.end >= first.end;
        Some(Place { end: if joined { last.end } else { first.end }, ..first })
    }

    /// One note for each `#include` that led to the file of a span.
    fn includes(&self, span: Span) -> Vec<String> {
        let mut notes = Vec::new();
        let mut from = self.place(span).and_then(|p| self.table.files[p.file as usize].included_from);
        while let Some(place) = from {
            let at = self.location(place);
            notes.push(format!("included from {}:{}", at.file, at.line));
            from = self.table.files[place.file as usize].included_from;
            if notes.len() == MAX_NOTES && from.is_some() {
                notes.push("and so on".into());
                break;
            }
        }
        notes
    }
}

/// A window on a line that is too long to show whole.
struct Excerpt {
    name: String,
    text: String,
    /// What the message is about, within the text.
    range: Range<usize>,
    line: usize,
    /// How many characters of the line stand before the window.
    skipped: usize,
}

impl Excerpt {
    /// The window around a place, if its line is long.
    fn of_long_line(sources: &Sources, place: Place) -> Option<Excerpt> {
        let file = &sources.table.files[place.file as usize];
        let line = file.line(place.start);
        let whole = file.line_range(line)?;
        if whole.len() <= LONG_LINE {
            return None;
        }
        let text = file.text.get(whole.clone())?.trim_end_matches(['\n', '\r']);
        let at = (place.start as usize - whole.start).min(text.len());
        let end = (place.end as usize - whole.start).min(text.len()).max(at);
        let start = boundary(text, at.saturating_sub(40));
        let stop = boundary(text, (at + 60).min(text.len()));
        Some(Excerpt {
            name: file.name.to_string(),
            range: at - start..end.min(stop).max(at) - start,
            skipped: text[..start].chars().count(),
            text: text[start..stop].to_string(),
            line,
        })
    }
}

/// The last place at or before a byte where a character starts.
fn boundary(text: &str, byte: usize) -> usize {
    (0..=byte).rev().find(|b| text.is_char_boundary(*b)).unwrap_or(0)
}

impl<'a> Files<'a> for Excerpt {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, _: usize) -> Result<&'a str, Error> {
        Ok(&self.name)
    }

    fn source(&'a self, _: usize) -> Result<&'a str, Error> {
        Ok(&self.text)
    }

    fn line_index(&'a self, _: usize, _: usize) -> Result<usize, Error> {
        Ok(0)
    }

    fn line_number(&'a self, _: usize, _: usize) -> Result<usize, Error> {
        Ok(self.line + 1)
    }

    fn column_number(&'a self, _: usize, _: usize, byte: usize) -> Result<usize, Error> {
        let before = self.text.get(..byte).map_or(0, |t| t.chars().count());
        Ok(self.skipped + before + 1)
    }

    fn line_range(&'a self, _: usize, _: usize) -> Result<Range<usize>, Error> {
        Ok(0..self.text.len())
    }
}

impl<'a> Files<'a> for Sources {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: usize) -> Result<&'a str, Error> {
        self.table.files.get(id).map(|f| &*f.name).ok_or(Error::FileMissing)
    }

    fn source(&'a self, id: usize) -> Result<&'a str, Error> {
        self.table.files.get(id).map(|f| &*f.text).ok_or(Error::FileMissing)
    }

    fn line_index(&'a self, id: usize, byte_index: usize) -> Result<usize, Error> {
        self.table.files.get(id).map(|f| f.line(byte_index as u32)).ok_or(Error::FileMissing)
    }

    fn line_range(&'a self, id: usize, line_index: usize) -> Result<Range<usize>, Error> {
        let file = self.table.files.get(id).ok_or(Error::FileMissing)?;
        let max = file.line_starts.len().saturating_sub(1);
        file.line_range(line_index).ok_or(Error::LineTooLarge { given: line_index, max })
    }
}

/// A text as a JSON string, in its quotes.
pub fn json(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if c < ' ' => out.push_str(&format!("\\u{:04x}", c as u32)),
            c => out.push(c),
        }
    }
    out + "\""
}
