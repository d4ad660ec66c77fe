//! What may be written at a place.

use super::context::{Call, members};
use super::study::Study;
use crate::check::notes::Meaning;
use crate::check::{NOISES, TEXTURE_OPTIONS};
use crate::lang::builtins;
use crate::lang::closures::ParamSpec;
use crate::lang::describe::{closure_head, kind_name, signature_text};
use crate::lang::sentences::sentence;
use std::collections::BTreeMap;
use std::ops::Range;

/// What something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemKind {
    /// A variable or parameter.
    Variable,
    /// A variable that every shader has.
    Global,
    /// A function.
    Function,
    /// A closure.
    Closure,
    /// A struct.
    Struct,
    /// A field or component.
    Field,
    /// The name of a keyword parameter or option.
    Keyword,
    /// A value that a parameter may have.
    Value,
    /// A word of the language.
    Word,
    /// A macro.
    Macro,
    /// A header.
    File,
}

/// Something that may be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Its name, as it is shown.
    pub label: String,
    /// What it is.
    pub kind: ItemKind,
    /// Its type or signature.
    pub detail: String,
    /// What it means.
    pub doc: String,
    /// What is written, and over which bytes of the text.
    pub insert: (Range<usize>, String),
}

/// Words that begin types and statements.
const WORDS: &[&str] = &[
    "break",
    "closure",
    "color",
    "continue",
    "displacement",
    "do",
    "else",
    "float",
    "for",
    "if",
    "int",
    "matrix",
    "normal",
    "output",
    "point",
    "return",
    "shader",
    "string",
    "struct",
    "surface",
    "vector",
    "void",
    "volume",
    "while",
];

/// Directives.
const DIRECTIVES: &[&str] = &[
    "define",
    "elif",
    "else",
    "endif",
    "error",
    "if",
    "ifdef",
    "ifndef",
    "include",
    "pragma once",
    "undef",
    "warning",
];

/// A name, what it is, its type, what it means.
type Entry = (ItemKind, String, String);

impl Study {
    /// What may be written at a byte. `earlier` is the text when it last was whole, whose variables are offered as well where this one
    /// does not parse.
    pub fn complete(&self, offset: usize, earlier: Option<&Study>) -> Vec<Item> {
        if self.in_comment(offset) {
            return Vec::new();
        }
        if self.is_whole() || self.string_at(offset).is_some() {
            return self.offered(offset, earlier);
        }
        // A statement that is being written has no end yet, and may take all around it with it.
        let end = self.name_at(offset).map_or(offset, |token| token.end);
        let mended = [&self.text[..end], ";", &self.text[end..]].concat();
        Study::new(&self.compiler, &self.name, &mended).offered(offset, earlier)
    }

    fn offered(&self, offset: usize, earlier: Option<&Study>) -> Vec<Item> {
        if let Some(string) = self.string_at(offset) {
            let (start, end) = (string.start + 1, string.end);
            let text = self.text_at(string);
            let end = if text.len() > 1 && text.ends_with('"') { end - 1 } else { offset };
            let directive = string.directive;
            let values = if directive { self.headers() } else { self.strings(start - 1) };
            return values.into_iter().map(|(label, entry)| item(label, entry, start..end.max(start))).collect();
        }
        let word = self.name_at(offset);
        let range = word.map_or(offset..offset, |token| token.start..token.end);
        let mut out: BTreeMap<String, Entry> = BTreeMap::new();
        let before = self.before(range.start);
        if let Some(last) =
            before.last().filter(|token| token.directive && !self.text[token.end..offset].contains('\n'))
        {
            if self.text_at(last) == "#" {
                out.extend(
                    DIRECTIVES.iter().map(|word| ((*word).to_owned(), (ItemKind::Word, String::new(), String::new()))),
                );
            }
            return out.into_iter().map(|(label, entry)| item(label, entry, range.clone())).collect();
        }
        if let Some(ty) = self.type_before_dot(offset) {
            out.extend(
                members(&ty).into_iter().map(|(name, ty)| (name, (ItemKind::Field, ty.to_string(), String::new()))),
            );
            return out.into_iter().map(|(label, entry)| item(label, entry, range.clone())).collect();
        }
        if before.last().is_some_and(|token| self.text_at(token) == ".") {
            return Vec::new();
        }
        self.names(&mut out);
        if let Some(earlier) = earlier.filter(|_| !self.is_whole()) {
            for (name, var) in earlier.own_variables() {
                let ty = earlier.notes.variables.get(var).map_or(String::new(), |variable| variable.ty.to_string());
                out.insert(name.to_owned(), (ItemKind::Variable, ty, String::new()));
            }
        }
        for (name, var) in self.visible_variables(range.start) {
            let ty = self.notes.variables.get(var).map_or(String::new(), |variable| variable.ty.to_string());
            out.insert(name.to_owned(), (ItemKind::Variable, ty, String::new()));
        }
        let keywords = self.keywords(range.start).into_iter().map(|(label, entry)| (format!("\"{label}\""), entry));
        keywords.chain(out).map(|(label, entry)| item(label, entry, range.clone())).collect()
    }

    /// Everything that has a name everywhere.
    fn names(&self, out: &mut BTreeMap<String, Entry>) {
        let doc = |name: &str| sentence(name).unwrap_or_default().to_owned();
        out.extend(WORDS.iter().map(|word| ((*word).to_owned(), (ItemKind::Word, String::new(), String::new()))));
        for variable in self.notes.variables.iter().filter(|variable| variable.global.is_some()) {
            out.insert(variable.name.to_string(), (ItemKind::Global, variable.ty.to_string(), doc(&variable.name)));
        }
        for name in builtins::names() {
            let first = builtins::signatures(name).and_then(|all| all.first());
            let detail = first.map_or(String::new(), |signature| signature_text(name, signature));
            out.insert(name.to_owned(), (ItemKind::Function, detail, doc(name)));
        }
        for spec in &self.compiler.closures.table().specs {
            out.insert(spec.name.to_owned(), (ItemKind::Closure, closure_head(spec), spec.doc.to_owned()));
        }
        for used in self.notes.uses.iter().filter(|used| used.declares) {
            match used.meaning {
                Meaning::Function(id) => {
                    let function = self.notes.functions.get(id.0 as usize);
                    let types = function.map_or(String::new(), |f| {
                        f.formals.iter().map(|(ty, _)| ty.to_string()).collect::<Vec<_>>().join(", ")
                    });
                    let returns = function.map_or(String::new(), |f| f.returns.to_string());
                    let detail = format!("{returns} {}({types})", used.name);
                    out.insert(used.name.to_string(), (ItemKind::Function, detail, doc(&used.name)));
                }
                Meaning::Struct(_) => {
                    out.insert(
                        used.name.to_string(),
                        (ItemKind::Struct, format!("struct {}", used.name), String::new()),
                    );
                }
                Meaning::Variable(_)
                | Meaning::Field(..)
                | Meaning::Builtin(_)
                | Meaning::Closure(_)
                | Meaning::Shader => {}
            }
        }
        for (name, _) in self.defines() {
            out.insert(name.to_owned(), (ItemKind::Macro, format!("#define {name}"), String::new()));
        }
        let constants = crate::compile::STDOSL.lines().filter_map(|line| line.strip_prefix("#define M_"));
        for line in constants {
            let mut words = line.split_whitespace();
            let (name, value) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
            out.insert(format!("M_{name}"), (ItemKind::Macro, value.to_owned(), String::new()));
        }
    }

    /// The keyword parameters or options that may come next in the call around a byte.
    fn keywords(&self, offset: usize) -> Vec<(String, Entry)> {
        let Some(Call { name, argument, .. }) = self.call_at(offset) else { return Vec::new() };
        let mut out = Vec::new();
        for (_, spec) in self.compiler.closures.named(&name) {
            if argument >= spec.params.len() && (argument - spec.params.len()).is_multiple_of(2) {
                let entry = |p: &ParamSpec| {
                    (p.name.to_owned(), (ItemKind::Keyword, kind_name(p.kind).to_owned(), p.doc.to_owned()))
                };
                out.extend(spec.keywords.iter().map(entry));
            }
        }
        if matches!(name.as_str(), "texture" | "environment") && argument >= 2 {
            let entry = |name: &&str| ((*name).to_owned(), (ItemKind::Keyword, "option".to_owned(), String::new()));
            out.extend(TEXTURE_OPTIONS.iter().map(entry));
        }
        out
    }

    /// What the string that begins at a byte may say.
    fn strings(&self, start: usize) -> Vec<(String, Entry)> {
        let Some(Call { name, argument, word }) = self.call_at(start) else { return Vec::new() };
        let value =
            |text: &str, of: &str| (text.to_owned(), (ItemKind::Value, format!("value of {of}"), String::new()));
        let mut out = self.keywords(start);
        for (_, spec) in self.compiler.closures.named(&name) {
            let param = match spec.params.get(argument) {
                Some(param) => Some(param),
                None if (argument - spec.params.len()).is_multiple_of(2) => None,
                None => spec.keywords.iter().find(|keyword| Some(keyword.name) == word.as_deref()),
            };
            if let Some(param) = param {
                out.extend(param.choices.iter().map(|choice| value(choice, param.name)));
            }
        }
        if argument == 0 && matches!(name.as_str(), "noise" | "pnoise") {
            out.extend(NOISES.iter().filter(|n| name == "noise" || !n.contains("simplex")).map(|n| value(n, "noise")));
        }
        out
    }

    /// The headers that come with velour.
    fn headers(&self) -> Vec<(String, Entry)> {
        let files = self.compiler.options.own_files.iter();
        files.map(|(name, _)| (name.clone(), (ItemKind::File, "comes with velour".to_owned(), String::new()))).collect()
    }
}

fn item(label: String, (kind, detail, doc): Entry, range: Range<usize>) -> Item {
    Item { insert: (range, label.clone()), label, kind, detail, doc }
}
