//! The page of the closures is what the library says.

#[path = "../examples/closures.rs"]
#[allow(dead_code)]
mod closures;

use std::collections::BTreeSet;
use std::path::Path;
use velour::closure::Library;

#[test]
fn the_stored_page_has_every_closure_as_the_library_describes_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let stored = std::fs::read_to_string(root.join("shaders/closures/README.md")).unwrap();
    assert!(stored == closures::page(), "run: cargo run --release --example closures -- shaders/closures 256");
    let library = Library::standard();
    let all: BTreeSet<&str> = library.table().specs.iter().map(|spec| spec.name).collect();
    assert_eq!(closures::names().collect::<BTreeSet<_>>(), all);
    assert_eq!(closures::names().count(), all.len());
    // Whatever scatters by a model of ours says by which.
    for spec in library.table().specs.iter().filter(|spec| spec.scatters && !spec.doc.contains("Cycles")) {
        assert!(!spec.formula.is_empty() && !spec.source.is_empty(), "{}", spec.name);
    }
}
