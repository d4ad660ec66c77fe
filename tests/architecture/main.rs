//! The house rules, read off the sources: arrows between rooms, first lines, names, sizes, and what is banned.

mod bodies;
mod circles;
mod modules;
mod source;

use circles::circles;
use modules::Modules;
use source::{Source, Token, sources};

/// The rooms from the ground up; a room uses itself and the ones before it.
const ROOMS: &[&str] = &[
    "limits", "files", "lang", "math", "ops", "check", "ir", "optimize", "bsdf", "closure", "exec", "compile", "query",
    "lsp", "scene", "render", "measure", "live", "cli",
];

/// Arrows that the order does not have and that are meant: who, and which file of a later room it uses.
const EXCEPTIONS: &[(&str, &str)] = &[];

/// Files that may contain `unsafe`.
const UNSAFE: &[&str] = &["render/accel/prefetch.rs", "math/instruction_set.rs"];

/// Files that may print or end the process, besides the command line.
const SPEAKERS: &[&str] = &["main.rs"];

/// All folders of Rust, tests and benches included.
const FOLDERS: [&str; 6] = ["src", "grammar/src", "tests", "grammar/tests", "benches", "examples"];

/// Enums that will grow: a match of one names every variant, so that a new one is thought about wherever it matters.
/// The others (types, operators' operands, nodes of syntax) are matched for the few cases that a rule is about, and a
/// new variant falls under "all else is no such case".
const GROWING: &[&str] = &[
    "Attribute",
    "Binary",
    "Check",
    "Facets",
    "Geometry",
    "Global",
    "Instr",
    "InstructionSet",
    "Layering",
    "ParamKind",
    "ParamType",
    "Promise",
    "ReportKind",
    "Routine",
    "Shadowing",
    "Shape",
    "SheenAlbedo",
    "SheenSampling",
    "Sky",
    "Slopes",
    "Smooth",
    "Spread",
    "Stmt",
    "TopAlbedo",
    "Unary",
    "Usage",
    "Way",
];

/// The room of a file of `src`.
fn room(path: &str) -> Option<usize> {
    let first = path.split('/').next()?.trim_end_matches(".rs");
    ROOMS.iter().position(|room| *room == first)
}

/// Files that use a later room.
fn arrows_back(sources: &[Source]) -> Vec<String> {
    let modules = Modules::new(sources);
    let mut wrong = Vec::new();
    for from in 0..modules.len() {
        let Some(own) = room(modules.name(from)) else { continue };
        for (to, path) in modules.used(from) {
            let Some(other) = room(modules.name(to)) else { continue };
            if other > own && !EXCEPTIONS.contains(&(ROOMS[own], ROOMS[other])) {
                wrong.push(format!("src/{} uses {path} of {}", modules.name(from), ROOMS[other]));
            }
        }
    }
    wrong
}

#[test]
fn rooms_use_only_earlier_rooms() {
    let wrong = arrows_back(&sources("src"));
    assert!(wrong.is_empty(), "a room uses a later one:\n{}", wrong.join("\n"));
}

#[test]
fn no_files_of_a_room_use_each_other_in_a_circle() {
    let mut wrong = String::new();
    for folder in ["src", "grammar/src"] {
        for circle in circles(&Modules::new(&sources(folder))) {
            wrong += &format!("{folder}: {} files use each other: {}\n", circle.files.len(), circle.files.join(", "));
            for (file, path) in circle.way {
                wrong += &format!("  {file} uses {path}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn every_file_opens_with_a_sentence() {
    for folder in FOLDERS {
        for Source { path, text, .. } in sources(folder) {
            let first = text.lines().next().unwrap_or("");
            assert!(first.starts_with("//! ") && first.len() > 8, "{folder}/{path} opens with {first:?}");
        }
    }
}

#[test]
fn no_file_is_a_drawer() {
    for folder in FOLDERS {
        for Source { path, text, .. } in sources(folder) {
            let name = path.rsplit('/').next().unwrap().trim_end_matches(".rs");
            let drawer = ["util", "utils", "helper", "helpers", "common", "misc"].contains(&name);
            assert!(!drawer, "{folder}/{path}: name a file after what is in it");
            let lines = text.lines().count();
            assert!(lines <= 500, "{folder}/{path} has {lines} lines, 500 are the most");
        }
    }
}

#[test]
fn a_function_fits_on_a_screen() {
    let mut wrong = Vec::new();
    for folder in FOLDERS {
        for source in sources(folder) {
            // The tests of a file count as well.
            for (name, line, lines) in bodies::functions(&source::tokens(&source.text)) {
                if lines > 80 {
                    wrong.push(format!("{folder}/{}:{line}: {name} has {lines} lines, 80 are the most", source.path));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn a_match_of_a_growing_enum_names_every_variant() {
    let sources = sources("src");
    let growing = GROWING.iter().map(|name| (*name).to_owned()).collect();
    let mut wrong = Vec::new();
    for source in &sources {
        let found = bodies::open_matches(&source.tokens, &growing);
        for name in GROWING {
            let lines = found.iter().filter(|(_, named)| named.contains(*name)).map(|(line, _)| line.to_string());
            let lines: Vec<String> = lines.collect();
            if !lines.is_empty() {
                wrong.push(format!("src/{}: `_ =>` in a match of {name}, lines {}", source.path, lines.join(", ")));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The stops `file::function` of the numbered lists in the documentation of the crate, a list a list.
fn ways(text: &str) -> Vec<Vec<(String, String)>> {
    let mut lists: Vec<Vec<(String, String)>> = Vec::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("//! ")) {
        let Some((number, rest)) = line.split_once(". `") else { continue };
        let stop = rest.split('`').next().and_then(|stop| stop.split_once(".rs::"));
        let (Ok(number), Some((file, function))) = (number.parse::<usize>(), stop) else { continue };
        if number == 1 {
            lists.push(Vec::new());
        }
        let list = lists.last_mut().expect("a list begins with 1");
        list.push((format!("{file}.rs"), function.to_owned()));
        assert_eq!(list.len(), number, "{line}");
    }
    lists
}

#[test]
fn the_ways_through_the_house_name_what_is_there() {
    let sources = sources("src");
    let home = sources.iter().find(|source| source.path == "lib.rs").unwrap();
    let ways = ways(&home.text);
    // As many as stops there were before the house was put in order, at most.
    assert!(matches!(&ways[..], [roughness, ray] if roughness.len() < 22 && ray.len() < 27), "{ways:?}");
    let grammar = self::sources("grammar/src");
    for (file, function) in ways.into_iter().flatten() {
        let (list, path) = match file.strip_prefix("grammar/src/") {
            Some(path) => (&grammar, path),
            None => (&sources, file.as_str()),
        };
        let source = list.iter().find(|source| source.path == path);
        let there = source.is_some_and(|s| bodies::functions(&s.tokens).iter().any(|(name, ..)| *name == function));
        assert!(there, "src/lib.rs: there is no {file}::{function}");
    }
}

#[test]
fn nothing_is_unsafe() {
    for source in sources("src") {
        let found = source.tokens.iter().any(|token| token.is("unsafe"));
        assert!(!found || UNSAFE.contains(&source.path.as_str()), "src/{} says unsafe", source.path);
    }
}

/// What a file says that only the command line may.
fn speaks(tokens: &[Token]) -> bool {
    let says = |words: &[&str]| tokens.windows(words.len()).any(|w| w.iter().zip(words).all(|(t, word)| t.is(word)));
    ["println", "print", "eprintln", "eprint", "dbg"].iter().any(|name| says(&[name, "!"]))
        || says(&["process", "::", "exit"])
}

#[test]
fn only_the_command_line_speaks() {
    for source in sources("src") {
        let may = source.path.starts_with("cli/") || source.is_test() || SPEAKERS.contains(&source.path.as_str());
        assert!(may || !speaks(&source.tokens), "src/{} prints or exits", source.path);
    }
}

#[test]
fn the_rules_catch_what_they_should() {
    assert_eq!(room("ir/lower/mod.rs"), Some(6));
    let files = |text| [Source::new("ops/a.rs", text), Source::new("exec/mod.rs", "pub struct Group;")];
    let up = arrows_back(&files("use crate::{lang::types, exec::Group};"));
    assert_eq!(up, ["src/ops/a.rs uses crate::exec::Group of exec"]);
    assert_eq!(arrows_back(&files("// crate::exec::Group")), [""; 0]);
    assert!(speaks(&source::tokens("fn f() { eprintln!(\"a\") }")) && speaks(&source::tokens("std::process::exit(1)")));
    assert!(!speaks(&source::tokens("fn f() { write!(f, \"println!\"); print(1) }")));
}
