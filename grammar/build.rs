//! Generates the parser tables from `src/osl.lalrpop`.

fn main() {}
