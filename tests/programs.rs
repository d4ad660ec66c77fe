//! What the compiler makes of small shaders: `tests/programs/NAME.osl` beside its listing `NAME.txt`.
//!
//! `UPDATE_EXPECT=1 cargo test --test programs` writes the listings anew.

use expect_test::expect_file;
use std::fs;
use std::path::Path;
use velour::compile::Compiler;
use velour::ir::print::listing;

#[test]
fn listings_are_as_written_down() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|e| e == "osl")) {
        let shader = Compiler::new().compile_file(path).unwrap_or_else(|e| panic!("{e}"));
        let group = shader.group().keep_outputs().build().unwrap();
        expect_file![path.with_extension("txt")].assert_eq(&listing(group.program(), group.table()));
    }
}
