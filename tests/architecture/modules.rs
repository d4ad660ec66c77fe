//! Which file uses which: the paths of `use` lines and of code, followed through re-exports to the file that defines.

use crate::source::{Kind, Source, Token, closed};
use std::collections::{BTreeMap, BTreeSet};

/// One name that a `use` brings into a file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Import {
    /// The path as written, without the braces.
    path: Vec<String>,
    /// The name in this file; `*` for all names of a module.
    name: String,
    /// True with `pub`: others may come through here.
    public: bool,
}

/// What is known of one file.
struct File {
    module: Vec<String>,
    imports: Vec<Import>,
    /// Names of the items that it defines.
    items: BTreeSet<String>,
    /// Paths of two or more names in code, each as written.
    paths: BTreeSet<Vec<String>>,
    /// All words outside of `use` lines.
    words: BTreeSet<String>,
}

/// All files of a crate by module.
pub struct Modules {
    files: Vec<File>,
    names: Vec<String>,
    by_module: BTreeMap<Vec<String>, usize>,
}

const ITEMS: &[&str] = &["struct", "enum", "trait", "fn", "const", "static", "type", "union", "macro_rules", "mod"];

impl Modules {
    /// Reads the files of a crate, tests left out.
    pub fn new(sources: &[Source]) -> Self {
        let kept: Vec<&Source> = sources.iter().filter(|source| !source.is_test()).collect();
        let files: Vec<File> = kept.iter().map(|source| file(source)).collect();
        let by_module = files.iter().enumerate().map(|(i, file)| (file.module.clone(), i)).collect();
        Modules { files, names: kept.iter().map(|source| source.path.clone()).collect(), by_module }
    }

    /// The path of a file.
    pub fn name(&self, file: usize) -> &str {
        &self.names[file]
    }

    /// How many files there are.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// The files that a file uses, each with a path that says so.
    pub fn used(&self, from: usize) -> BTreeMap<usize, String> {
        let file = &self.files[from];
        let mut used = BTreeMap::new();
        let mut add = |to: Option<usize>, path: &[String]| {
            if let Some(to) = to.filter(|&to| to != from) {
                used.entry(to).or_insert_with(|| path.join("::"));
            }
        };
        for import in &file.imports {
            let Some(target) = self.absolute(&file.module, &import.path) else { continue };
            if import.name == "*" {
                for word in &file.words {
                    let mut path = target.clone();
                    path.push(word.clone());
                    // A glob of a module reaches what stands in it under that name, and nothing else.
                    if self.module(&target).is_some_and(|m| self.defines(m, word, &mut BTreeSet::new())) {
                        add(self.definer(&path, 0), &path);
                    }
                }
            } else if (!import.public || file.words.contains(&import.name)) && self.module(&target).is_none() {
                add(self.definer(&target, 0), &import.path);
            }
        }
        for path in &file.paths {
            if let Some(target) = self.absolute(&file.module, path) {
                add(self.definer(&target, 0), path);
            }
        }
        used
    }

    /// The file that is a module, if a module it is.
    fn module(&self, path: &[String]) -> Option<usize> {
        self.by_module.get(path).copied()
    }

    /// A path as seen from a module, from the root of the crate; nothing when it leads to another crate.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let (mut base, mut rest) = (module.to_vec(), path);
        match path.first()?.as_str() {
            "crate" => (base, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop()?;
                    rest = &rest[1..];
                }
            }
            first => {
                let file = &self.files[self.module(module)?];
                let mut child = module.to_vec();
                child.push(first.to_owned());
                if let Some(import) = file.imports.iter().find(|import| import.name == first && import.path != path) {
                    base = self.absolute(module, &import.path)?;
                    rest = &path[1..];
                } else if self.module(&child).is_none() && !file.items.contains(first) {
                    return None;
                }
            }
        }
        base.extend(rest.iter().cloned());
        Some(base)
    }

    /// The file that defines what a path from the root names.
    fn definer(&self, path: &[String], depth: usize) -> Option<usize> {
        // Re-exports that lead in a circle end here.
        if depth > 16 {
            return None;
        }
        let known = (0..=path.len()).rev().find(|&n| self.module(&path[..n]).is_some())?;
        let at = self.module(&path[..known])?;
        let file = &self.files[at];
        let Some(name) = path.get(known) else { return Some(at) };
        if file.items.contains(name) {
            return Some(at);
        }
        let onward = |target: Vec<String>| {
            let whole: Vec<String> = target.into_iter().chain(path[known + 1..].iter().cloned()).collect();
            self.definer(&whole, depth + 1)
        };
        if let Some(import) = file.imports.iter().find(|import| import.name == *name) {
            return self.absolute(&file.module, &import.path).map_or(Some(at), onward);
        }
        let globs = file.imports.iter().filter(|import| import.name == "*");
        for target in globs.filter_map(|import| self.absolute(&file.module, &import.path)) {
            if self.module(&target).is_some_and(|m| self.defines(m, name, &mut BTreeSet::new())) {
                return onward(target.into_iter().chain([name.clone()]).collect());
            }
        }
        // Made by a macro, or a method of a type: it stands where the path ends.
        Some(at)
    }

    /// True when a name stands in a module: defined there, or re-exported.
    fn defines(&self, module: usize, name: &str, seen: &mut BTreeSet<usize>) -> bool {
        let file = &self.files[module];
        let exports = |import: &&Import| import.public;
        seen.insert(module)
            && (file.items.contains(name)
                || file.imports.iter().filter(exports).any(|import| import.name == name)
                || file.imports.iter().filter(exports).filter(|import| import.name == "*").any(|import| {
                    let target = self.absolute(&file.module, &import.path);
                    target.and_then(|t| self.module(&t)).is_some_and(|m| self.defines(m, name, seen))
                }))
    }
}

/// Reads one file.
fn file(source: &Source) -> File {
    let tokens = &source.tokens;
    let mut file = File {
        module: source.module.clone(),
        imports: Vec::new(),
        items: BTreeSet::new(),
        paths: BTreeSet::new(),
        words: BTreeSet::new(),
    };
    let mut at = 0;
    while at < tokens.len() {
        let token = &tokens[at];
        let next = tokens.get(at + 1);
        if token.is("use") && !next.is_some_and(|t| t.is("<")) {
            let public = at > 0 && (tokens[at - 1].is("pub") || tokens[at - 1].is(")"));
            at = tree(tokens, at + 1, &[], public, &mut file.imports);
        } else if token.kind == Kind::Word {
            let defines = ITEMS.iter().any(|item| token.is(item));
            let name = next.filter(|t| t.kind == Kind::Word).or(tokens.get(at + 2).filter(|_| token.is("macro_rules")));
            if defines && let Some(name) = name {
                // A module of another file is not defined here.
                if !(token.is("mod") && tokens.get(at + 2).is_some_and(|t| t.is(";"))) {
                    file.items.insert(name.text.clone());
                }
                at += 2;
                continue;
            }
            let path = path(&tokens[at..]);
            at += 2 * path.len() - 1;
            file.words.insert(path[0].clone());
            if path.len() > 1 {
                file.paths.insert(path);
            }
        } else {
            at += 1;
        }
    }
    file
}

/// The names joined by `::` that tokens begin with.
fn path(tokens: &[Token]) -> Vec<String> {
    let mut path = vec![tokens[0].text.clone()];
    let mut rest = &tokens[1..];
    while let [colons, name, ..] = rest
        && colons.is("::")
        && name.kind == Kind::Word
    {
        path.push(name.text.clone());
        rest = &rest[2..];
    }
    path
}

/// Reads one branch of a `use` tree and gives the place after it.
fn tree(tokens: &[Token], mut at: usize, prefix: &[String], public: bool, out: &mut Vec<Import>) -> usize {
    let mut path = prefix.to_vec();
    while let Some(token) = tokens.get(at) {
        if token.is("{") {
            let end = closed(tokens, at);
            at += 1;
            while at < end - 1 {
                at = tree(tokens, at, &path, public, out);
                at += usize::from(tokens[at].is(","));
            }
            return end;
        }
        if token.is("*") {
            out.push(Import { path, name: "*".to_owned(), public });
            return at + 1;
        }
        if token.kind == Kind::Word {
            path.push(token.text.clone());
            at += 1;
            if tokens.get(at).is_some_and(|t| t.is("::")) {
                at += 1;
                continue;
            }
        }
        let renamed = tokens.get(at).is_some_and(|t| t.is("as"));
        let name = if renamed { tokens.get(at + 1).map(|t| t.text.clone()) } else { None };
        // `a::{self}` names `a`.
        if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
            path.pop();
        }
        let name = name.unwrap_or_else(|| path.last().cloned().unwrap_or_default());
        out.push(Import { path, name, public });
        return at + if renamed { 2 } else { usize::from(tokens.get(at).is_some_and(|t| t.is("::"))) };
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crate_of(files: &[(&str, &str)]) -> Modules {
        Modules::new(&files.iter().map(|(path, text)| Source::new(path, text)).collect::<Vec<_>>())
    }

    /// What the first file uses, by name.
    fn used(files: &[(&str, &str)]) -> Vec<String> {
        let modules = crate_of(files);
        modules.used(0).keys().map(|&to| modules.name(to).to_owned()).collect()
    }

    #[test]
    fn a_use_leads_through_re_exports_to_the_file_that_defines() {
        let room = [
            ("r/mod.rs", "mod a; mod b; mod c; pub use b::{Thing, c_name as other}; pub use c::*; pub struct Own;"),
            ("r/b.rs", "pub struct Thing; pub fn c_name() {}"),
            ("r/c.rs", "pub fn glob() {}"),
        ];
        let with = |text| used(&[&[("r/a.rs", text)], &room[..]].concat());
        assert_eq!(with("use super::Thing;"), ["r/b.rs"]);
        assert_eq!(with("use crate::r::{other as mine, Own};"), ["r/mod.rs", "r/b.rs"]);
        assert_eq!(with("use super::glob;"), ["r/c.rs"]);
        assert_eq!(with("use super::*; fn f() { glob() }"), ["r/c.rs"]);
        assert_eq!(with("use super::*; fn f() { none() }"), [""; 0]);
        assert_eq!(with("fn f() -> super::Thing { crate::r::c::glob() }"), ["r/b.rs", "r/c.rs"]);
        assert_eq!(with("use super::b; fn f(x: b::Thing) {}"), ["r/b.rs"]);
        assert_eq!(with("use crate::r; fn f(x: r::Thing) {}"), ["r/b.rs"]);
        assert_eq!(with("use super::{b::{self, Thing}};"), ["r/b.rs"]);
        assert_eq!(with("use std::fmt; fn f() { fmt::b(); }"), [""; 0]);
        assert_eq!(with("#[cfg(test)] mod tests { use super::super::Own; } // use super::Own;"), [""; 0]);
    }

    #[test]
    fn a_mod_that_only_declares_and_exports_uses_nothing() {
        let a = ("r/a.rs", "pub struct A; pub fn go() {}");
        assert_eq!(used(&[("r/mod.rs", "mod a; pub use a::A;"), a]), [""; 0]);
        assert_eq!(used(&[("r/mod.rs", "mod a; pub use a::A; fn f(a: A) {}"), a]), ["r/a.rs"]);
        assert_eq!(used(&[("r/mod.rs", "pub mod a; fn f() { a::go() }"), a]), ["r/a.rs"]);
        assert_eq!(used(&[("r/mod.rs", "pub mod a; use a::go;"), a]), ["r/a.rs"]);
    }
}
