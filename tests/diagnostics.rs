//! Every message of the checker as the user sees it: `tests/diagnostics/NAME.osl` beside `NAME.txt`.
//!
//! `UPDATE_EXPECT=1 cargo test --test diagnostics` writes the texts anew.

use expect_test::expect_file;
use std::fs;
use std::path::Path;
use velour::check::codes::CODES;
use velour::compile::Compiler;
use velour_grammar::Format;

#[test]
fn messages_are_as_written_down() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let mut seen = Vec::new();
    let mut names: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    for path in names.iter().filter(|path| path.extension().is_some_and(|e| e == "osl")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = fs::read_to_string(path).unwrap();
        // What only -Wall says stands in files of its own.
        let checked = match name.starts_with("unused") {
            true => Compiler::new().check_closely(name, text.as_bytes()),
            false => Compiler::new().check(name, &text),
        };
        seen.extend(checked.diagnostics.list.iter().map(|d| d.code));
        let text = checked.sources.render(&checked.diagnostics, Format::Full, false);
        expect_file![path.with_extension("txt")].assert_eq(&text);
    }
    let missing: Vec<&str> = CODES.iter().map(|code| code.0).filter(|code| !seen.contains(code)).collect();
    assert!(missing.is_empty(), "no file in tests/diagnostics shows {missing:?}");
}

#[test]
fn a_message_has_a_place_and_a_way_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "osl") {
            let checked = Compiler::new().check("shader.osl", &fs::read_to_string(&path).unwrap());
            for message in &checked.diagnostics.list {
                assert!(message.help.is_some(), "{}: no way out of: {}", path.display(), message.message);
            }
        }
    }
}
