//! The nouns of the language: types, symbols, and the tables of closures, builtins and shader globals.

pub mod closures;
pub mod symbols;
pub mod types;
