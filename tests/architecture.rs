//! The house rules, read off the sources: arrows between rooms, first lines, names, sizes, and what is banned.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the ground up; a room uses itself and the ones before it.
const ROOMS: &[&str] = &[
    "lang", "math", "ops", "check", "ir", "optimize", "bsdf", "closure", "exec", "compile", "scene", "render",
    "measure", "cli",
];

/// Arrows that the order does not have and that are meant: who, and which file of a later room it uses.
const EXCEPTIONS: &[(&str, &str)] = &[];

/// Files that may contain `unsafe`.
const UNSAFE: &[&str] = &["render/accel/prefetch.rs", "math/instruction_set.rs"];

/// Files that may print or end the process, besides the command line.
const SPEAKERS: &[&str] = &["main.rs"];

fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Every source file of a folder of the repository: path relative to it, and text.
fn sources(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut list = Vec::new();
    files(&root, &mut list);
    list.sort();
    let relative = |path: &PathBuf| path.strip_prefix(&root).unwrap().display().to_string().replace('\\', "/");
    list.iter().map(|path| (relative(path), fs::read_to_string(path).unwrap())).collect()
}

/// The text up to the unit tests, without comments.
fn code(text: &str) -> String {
    let end = text.find("#[cfg(test)]").unwrap_or(text.len());
    let lines = text[..end].lines().map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

fn room(path: &str) -> Option<usize> {
    let first = path.split('/').next()?.trim_end_matches(".rs");
    ROOMS.iter().position(|room| *room == first)
}

/// The rooms a text names after `crate::`, also in braces.
fn used_rooms(code: &str) -> Vec<usize> {
    let mut used = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let list = match rest.strip_prefix('{') {
            Some(inside) => inside.split('}').next().unwrap_or("").split(',').collect(),
            None => vec![rest],
        };
        for name in list {
            let name: String = name.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            used.extend(ROOMS.iter().position(|room| *room == name));
        }
    }
    used
}

#[test]
fn rooms_use_only_earlier_rooms() {
    let mut wrong = Vec::new();
    for (path, text) in sources("src") {
        let Some(own) = room(&path) else { continue };
        for used in used_rooms(&code(&text)) {
            if used > own && !EXCEPTIONS.contains(&(ROOMS[own], ROOMS[used])) {
                wrong.push(format!("src/{path} uses {}", ROOMS[used]));
            }
        }
    }
    assert!(wrong.is_empty(), "a room uses a later one:\n{}", wrong.join("\n"));
}

#[test]
fn every_file_opens_with_a_sentence() {
    for folder in ["src", "grammar/src", "tests", "benches"] {
        for (path, text) in sources(folder) {
            let first = text.lines().next().unwrap_or("");
            assert!(first.starts_with("//! ") && first.len() > 8, "{folder}/{path} opens with {first:?}");
        }
    }
}

#[test]
fn no_file_is_a_drawer() {
    for folder in ["src", "grammar/src", "tests", "benches"] {
        for (path, text) in sources(folder) {
            let name = path.rsplit('/').next().unwrap().trim_end_matches(".rs");
            let drawer = ["util", "utils", "helper", "helpers", "common", "misc"].contains(&name);
            assert!(!drawer, "{folder}/{path}: name a file after what is in it");
            let lines = text.lines().count();
            assert!(lines <= 500, "{folder}/{path} has {lines} lines, 500 are the most");
        }
    }
}

#[test]
fn nothing_is_unsafe() {
    for (path, text) in sources("src") {
        let found = code(&text).split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe");
        assert!(!found || UNSAFE.contains(&path.as_str()), "src/{path} says unsafe");
    }
}

#[test]
fn only_the_command_line_speaks() {
    for (path, text) in sources("src") {
        if path.starts_with("cli/") || path.ends_with("tests.rs") || SPEAKERS.contains(&path.as_str()) {
            continue;
        }
        let code = code(&text);
        for word in ["println!", "print!(", "eprintln!", "eprint!(", "process::exit", "dbg!("] {
            let found = code.match_indices(word).any(|(at, _)| !code[..at].ends_with(|c: char| c.is_alphanumeric()));
            assert!(!found, "src/{path} says {word}");
        }
    }
}

#[test]
fn the_rules_catch_what_they_should() {
    assert_eq!(used_rooms("use crate::exec::Group; use crate::{lang::types, cli};"), [8, 0, 13]);
    assert_eq!(code("a // unsafe\nb\n#[cfg(test)]\nunsafe"), "a \nb");
    assert_eq!(room("ir/lower/mod.rs"), Some(4));
}
