//! The velour command.

fn main() {}
