//! `#include`: where files are looked for, and what is said when one is not there.

use super::scan::{Kind, PpToken};
use super::state::Preprocessor;
use crate::decode::decode;
use crate::diagnostic::Diagnostic;
use crate::files::ReadError;
use crate::limits::{ALL_BYTES, FILE_BYTES, INCLUDE_DEPTH, INCLUDE_TOKENS};
use crate::source::Place;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a search for a file gave.
enum Found {
    Text(String, String),
    NotText(String),
    Unreadable(String, ReadError),
    Nothing(Vec<String>),
}

impl Preprocessor<'_> {
    /// `#include "x"` or `#include <x>`, also with either made by a macro.
    pub(super) fn include(&mut self, name: PpToken, arguments: &[PpToken]) {
        if self.gathering {
            let span = self.span(name);
            self.diagnostics.push(
                Diagnostic::error("E0117", span, "#include among the arguments of a macro call")
                    .label("cannot be obeyed here")
                    .help("close the macro call first"),
            );
            return;
        }
        let Some((wanted, quoted, place)) = self.wanted(name, arguments) else {
            return;
        };
        if self.inputs.len() > INCLUDE_DEPTH {
            let span = self.table.aside(place, crate::source::NO_CALL);
            self.diagnostics.push(
                Diagnostic::error("E0104", span, format!("includes are nested more than {INCLUDE_DEPTH} deep"))
                    .label("not read")
                    .help("does a file include itself? put `#pragma once` at its top"),
            );
            // One message is enough of what would go on without end.
            return self.stop();
        }
        self.spend(INCLUDE_TOKENS, Some(place));
        if self.stopped {
            return;
        }
        match self.search(&wanted, quoted) {
            Found::Text(file, text) => {
                self.bytes = self.bytes.saturating_add(text.len() as u64);
                if self.bytes > ALL_BYTES {
                    let most = ALL_BYTES >> 20;
                    return self.cannot_read(place, format!("included files have more than {most} MB together"), None);
                }
                if !self.once.contains(&key(&file)) {
                    self.open(&file, Arc::from(text), Some(place));
                }
            }
            Found::NotText(file) => self.cannot_read(place, format!("{file} is not a text file"), None),
            Found::Unreadable(file, error) => {
                self.cannot_read(place, format!("cannot read {file}"), Some(error.to_string()));
            }
            Found::Nothing(looked) => self.not_found(&wanted, quoted, place, &looked),
        }
    }

    /// The name between the quotes or angle brackets, and its place.
    fn wanted(&mut self, name: PpToken, arguments: &[PpToken]) -> Option<(String, bool, Place)> {
        let mut expanded = None;
        let tokens = match arguments.first().map(|t| t.kind) {
            Some(Kind::Name) => &*expanded.insert(self.expand_all(arguments.to_vec())),
            _ => arguments,
        };
        let first = tokens.first().copied();
        let result = match first.map(|t| t.kind) {
            Some(Kind::Text) => {
                let text = first.map_or("", |t| self.text(t));
                Some((text.trim_matches('"').to_string(), true, first?.place))
            }
            Some(Kind::Less) => {
                let end = tokens.iter().position(|t| t.kind == Kind::Greater)?;
                let text = tokens[1..end].iter().fold(String::new(), |s, t| s + self.text(*t));
                let last = tokens[end].place;
                let place = if last.file == first?.place.file { Place { end: last.end, ..first?.place } } else { last };
                Some((text, false, place))
            }
            _ => None,
        };
        if result.is_none() {
            let span = self.span(first.unwrap_or(name));
            self.diagnostics.push(
                Diagnostic::error("E0102", span, "#include needs the name of a file")
                    .label("no file name here")
                    .help("write `#include \"file.h\"` or `#include <file.h>`"),
            );
        }
        result
    }

    /// Looks through the folders, then through the virtual files. A header that comes with the compiler is the compiler's own,
    /// whatever the folders have. As OSL does, the folder of the main file serves for all includes, in quotes or not.
    fn search(&self, wanted: &str, quoted: bool) -> Found {
        if let Some((name, text)) = self.options.own_files.iter().find(|(name, _)| is_named(wanted, name)) {
            return Found::Text(name.clone(), text.clone());
        }
        let here = self.inputs.last().and_then(|i| i.folder.clone()).filter(|_| quoted);
        let main = self.main_folder();
        let mut looked = Vec::new();
        let beside = here.iter().chain(main.iter().filter(|main| here.as_ref() != Some(*main)));
        for folder in beside.chain(&self.options.include_dirs) {
            let path = folder.join(wanted);
            if let Some(text) = self.buffer(&path) {
                return Found::Text(path.display().to_string(), text.to_string());
            }
            match self.options.access.read(&path, FILE_BYTES) {
                Ok(bytes) => {
                    let name = path.display().to_string();
                    return match decode(&bytes) {
                        Some(text) => Found::Text(name, text),
                        None => Found::NotText(name),
                    };
                }
                Err(ReadError::Missing) => looked.push(shown(folder)),
                // A folder of a header's name is none.
                Err(ReadError::NotAFile) if path.is_dir() => looked.push(shown(folder)),
                Err(error) => return Found::Unreadable(path.display().to_string(), error),
            }
        }
        match self.virtual_file(wanted, here.as_deref()) {
            Some((name, text)) => Found::Text(name.clone(), text.clone()),
            None => Found::Nothing(looked),
        }
    }

    /// The text that an editor has in place of a file.
    fn buffer(&self, path: &Path) -> Option<Arc<str>> {
        let buffers = &self.options.buffers;
        if buffers.is_empty() || !self.options.access.covers(path) {
            return None;
        }
        let path = key(path);
        buffers.iter().find(|(buffer, _)| *buffer == path).map(|(_, text)| text.clone())
    }

    /// The folder of the first file that is not the prelude.
    fn main_folder(&self) -> Option<PathBuf> {
        let prelude = self.options.prelude.as_ref().map(|(name, _)| name.as_str());
        let main = self.inputs.iter().find(|input| Some(&*self.table.files[input.file as usize].name) != prelude);
        main.and_then(|input| input.folder.clone())
    }

    /// A file that the caller keeps in memory, by its name or by its name beside the current one.
    fn virtual_file(&self, wanted: &str, here: Option<&Path>) -> Option<&(String, String)> {
        let beside = here.map(|folder| folder.join(wanted));
        let files = &self.options.virtual_files;
        let by_folder = files.iter().find(|(name, _)| beside.as_deref() == Some(Path::new(name)));
        by_folder.or_else(|| files.iter().find(|(name, _)| name == wanted))
    }

    /// Says that a file exists but cannot be used.
    fn cannot_read(&mut self, place: Place, message: String, reason: Option<String>) {
        let span = self.table.aside(place, crate::source::NO_CALL);
        let help = reason.unwrap_or_else(|| "only text files can be included".into());
        self.diagnostics.push(Diagnostic::error("E0105", span, message).label("included here").help(help));
    }

    /// Says that a file is nowhere, and where it was looked for.
    fn not_found(&mut self, wanted: &str, quoted: bool, place: Place, looked: &[String]) {
        let span = self.table.aside(place, crate::source::NO_CALL);
        let help = match (looked, quoted) {
            ([], true) => "no folder to look in: name one with -I".to_string(),
            ([], false) => "`<…>` looks only in the folders given with -I, and there are none".to_string(),
            _ => format!("looked in {}; add a folder with -I", looked.join(", ")),
        };
        let help = match self.options.access.sandbox() {
            Some(sandbox) => format!("{help}; nothing outside of the sandbox {} is read", sandbox.display()),
            None => help,
        };
        self.diagnostics
            .push(Diagnostic::error("E0103", span, format!("cannot find {wanted}")).label("not found").help(help));
    }
}

/// Is a file of this name, with or without folders before it, asked for?
fn is_named(wanted: &str, name: &str) -> bool {
    wanted.strip_suffix(name).is_some_and(|folders| folders.is_empty() || folders.ends_with('/'))
}

/// A folder's name for people: the current folder has an empty one.
fn shown(folder: &Path) -> String {
    if folder.as_os_str().is_empty() { ".".into() } else { folder.display().to_string() }
}

/// What makes a file the same one for `#pragma once`.
pub(super) fn key(name: impl AsRef<Path>) -> PathBuf {
    std::fs::canonicalize(&name).unwrap_or_else(|_| name.as_ref().to_owned())
}
