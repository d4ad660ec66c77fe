//! The grammar for editors names everything that is built in.

use serde_json::Value;
use std::collections::BTreeSet;

/// The names that a rule of the grammar lists.
fn listed(grammar: &Value, scope: &str) -> BTreeSet<String> {
    let rules = grammar["repository"]["calls"]["patterns"].as_array().unwrap();
    let rule = rules.iter().find(|rule| rule["name"] == scope).unwrap();
    let words = rule["match"].as_str().unwrap().split_once("(?:").unwrap().1.split_once(')').unwrap().0;
    words.split('|').map(str::to_owned).collect()
}

#[test]
fn the_grammar_names_every_closure_and_function() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/editors/vscode/syntaxes/osl.tmLanguage.json");
    let grammar: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let library = velour::closure::Library::standard();
    let closures: BTreeSet<String> = library.table().specs.iter().map(|spec| spec.name.to_owned()).collect();
    assert_eq!(listed(&grammar, "support.function.closure.osl"), closures);
    let header = velour_grammar::parse("a", "", &velour::compile::Compiler::new().options);
    let declared = header.file.items.iter().filter_map(|item| match item {
        velour_grammar::ast::Item::Function(function) => Some(function.name.name.to_string()),
        _ => None,
    });
    let mut functions: BTreeSet<String> = velour::lang::builtins::names().map(str::to_owned).chain(declared).collect();
    for name in &functions {
        assert!(velour::lang::sentences::sentence(name).is_some() || closures.contains(name), "{name} has no sentence");
    }
    functions.retain(|name| !closures.contains(name));
    assert_eq!(listed(&grammar, "support.function.builtin.osl"), functions);
}
