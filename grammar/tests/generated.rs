//! `generated/osl.rs` is what LALRPOP makes of `src/osl.lalrpop`. After a change of the grammar,
//! `UPDATE_EXPECT=1 cargo test -p velour-grammar --test generated` writes it anew.
//!
//! Decision (2026-11-29): the tables are kept beside the grammar instead of made by a build script, because LALRPOP and
//! what it needs are most of the packages that a user of the library would compile, for a text that changes when the
//! language does.

use std::path::Path;

/// The text without its first line, which names the version of LALRPOP.
fn tables(text: &str) -> &str {
    text.split_once('\n').map_or("", |(_, tables)| tables)
}

#[test]
fn the_tables_are_those_of_the_grammar() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = tempfile::tempdir().unwrap();
    let mut generator = lalrpop::Configuration::new();
    generator.set_in_dir(root.join("src")).set_out_dir(out.path()).set_features(Vec::<String>::new());
    generator.force_build(true).log_quiet().process().unwrap();
    let made = std::fs::read_to_string(out.path().join("osl.rs")).unwrap();
    let kept = root.join("generated/osl.rs");
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(&kept, &made).unwrap();
    }
    // Some ten thousand lines: the difference is no help.
    let kept = std::fs::read_to_string(kept).unwrap();
    assert!(tables(&kept) == tables(&made), "src/osl.lalrpop has changed: write generated/osl.rs anew");
}
