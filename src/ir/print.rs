//! Shows a program as text, one instruction a line.

use super::program::Program;

/// The listing of a program.
pub fn program_text(program: &Program) -> String {
    format!("{:#?}\n", program.body)
}
