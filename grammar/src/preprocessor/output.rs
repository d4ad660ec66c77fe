//! The preprocessed text, as `-E` prints it.

use super::Terminal;
use crate::source::SourceTable;
use std::fmt::Write;

/// More missing lines than this become a `#line` instead of empty lines.
const MAX_EMPTY_LINES: usize = 8;

/// Prints tokens on the lines they came from. `#line` directives mark where the text changes file or jumps.
pub(crate) fn to_text(tokens: &[Terminal], table: &SourceTable) -> String {
    let mut out = String::new();
    let mut at: Option<(u32, usize)> = None;
    for terminal in tokens {
        let token = table.expanded[terminal.index as usize];
        let place = table.outermost(token.place, token.call);
        let file = &table.files[place.file as usize];
        let line = file.line(place.start);
        match at {
            // Only what starts a line there starts one here: arguments stay on the line of their macro call.
            Some(_) if !terminal.line_start => {
                if token.space || glued(&out, table.text(token.place)) {
                    out.push(' ');
                }
            }
            Some((f, l)) if f == place.file && line > l && line - l <= MAX_EMPTY_LINES => {
                out.push_str(&"\n".repeat(line - l));
                at = Some((place.file, line));
            }
            _ => {
                if at.is_some() {
                    out.push('\n');
                }
                let _ = writeln!(out, "#line {} {:?}", line + 1, &*file.name);
                at = Some((place.file, line));
            }
        }
        out.push_str(table.text(token.place));
    }
    if at.is_some() {
        out.push('\n');
    }
    out
}

/// True when two tokens written without a space could read as one.
fn glued(before: &str, after: &str) -> bool {
    let (Some(a), Some(b)) = (before.bytes().last(), after.bytes().next()) else {
        return false;
    };
    let word = |c: u8| c.is_ascii_alphanumeric() || c == b'_' || c == b'.';
    let operator = |c: u8| b"+-*/%<>=!&|^#[".contains(&c);
    (word(a) && word(b)) || (operator(a) && operator(b)) || (a == b'"' && b == b'"')
}
