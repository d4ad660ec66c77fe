//! The nouns of the language: types, symbols, and the tables of closures, builtins and shader globals.

pub mod builtins;
pub mod closures;
pub mod describe;
pub mod globals;
pub mod nearest;
pub mod path;
pub mod sentences;
pub mod symbols;
pub mod types;
