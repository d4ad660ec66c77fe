//! One small case a file: `syntax/*.osl` beside the printed tree, `errors/*.osl` beside the messages. After a wanted
//! change, `UPDATE_EXPECT=1 cargo test -p velour-grammar` writes the `.txt` files anew.

use std::path::{Path, PathBuf};
use velour_grammar::{Format, Options, codes, parse, parse_bytes, print};

fn cases(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(root)
        .expect("the folder of cases")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "osl"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

fn short_name(path: &Path) -> String {
    path.file_name().expect("a name").to_string_lossy().into_owned()
}

fn options() -> Options {
    let header = "#pragma once\n#define HEADER 1\nfloat broken(float a) { return a + ; }\n";
    Options {
        include_dirs: vec!["tests/errors".into()],
        virtual_files: vec![("header.h".into(), header.into())],
        ..Options::default()
    }
}

/// The debug text of a tree without its spans.
fn without_spans(file: &velour_grammar::ast::File) -> String {
    let text = format!("{file:?}");
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find("Span { first: ") {
        out.push_str(&rest[..at]);
        let end = rest[at..].find('}').expect("a closing brace");
        rest = &rest[at + end + 1..];
    }
    out + rest
}

#[test]
fn trees_print_as_expected() {
    for path in cases("syntax") {
        let text = std::fs::read_to_string(&path).expect("a case");
        let parsed = parse(&short_name(&path), &text, &Options::default());
        let messages = parsed.sources.render(&parsed.diagnostics, Format::Short, false);
        let printed = print::print(&parsed.file);
        let out = if messages.is_empty() { printed } else { format!("{messages}\n{printed}") };
        expect_test::expect_file![path.with_extension("txt")].assert_eq(&out);
    }
}

#[test]
fn printed_trees_parse_back() {
    for path in cases("syntax") {
        let text = std::fs::read_to_string(&path).expect("a case");
        let name = short_name(&path);
        let first = parse(&name, &text, &Options::default());
        let printed = print::print(&first.file);
        let second = parse(&name, &printed, &Options::default());
        let messages = second.sources.render(&second.diagnostics, Format::Full, false);
        assert!(!second.diagnostics.has_errors(), "{name}: {messages}\n{printed}");
        assert_eq!(without_spans(&first.file), without_spans(&second.file), "{name}");
    }
}

#[test]
fn messages_are_as_expected() {
    for path in cases("errors") {
        let bytes = std::fs::read(&path).expect("a case");
        let parsed = parse_bytes(&short_name(&path), &bytes, &options());
        assert!(!parsed.diagnostics.is_empty(), "{} has nothing to say", path.display());
        let short = parsed.sources.render(&parsed.diagnostics, Format::Short, false);
        let full = parsed.sources.render(&parsed.diagnostics, Format::Full, false);
        expect_test::expect_file![path.with_extension("txt")].assert_eq(&format!("{short}\n{full}"));
    }
}

#[test]
fn every_code_has_a_case() {
    let mut seen = std::collections::BTreeSet::new();
    for path in cases("errors") {
        let bytes = std::fs::read(&path).expect("a case");
        let parsed = parse_bytes(&short_name(&path), &bytes, &options());
        seen.extend(parsed.diagnostics.list.iter().map(|d| d.code));
        for diagnostic in &parsed.diagnostics.list {
            let known = codes::CODES.iter().any(|(code, _)| *code == diagnostic.code);
            assert!(known, "{} is not in the table of codes", diagnostic.code);
            let kind = if diagnostic.code.starts_with('W') { "warning" } else { "error" };
            assert_eq!(format!("{:?}", diagnostic.severity).to_lowercase(), kind);
        }
    }
    for (code, meaning) in codes::CODES {
        assert!(seen.contains(code), "no case in tests/errors gives {code}: {meaning}");
    }
}
