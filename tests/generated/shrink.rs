//! Cuts a failing shader down: lines and blocks are left out as long as it compiles and still fails.

use crate::compare::{compile, problem};
use velour::compile::Compiler;

/// The line that closes the block which a line opens, or the line itself.
fn end_of(lines: &[String], start: usize) -> usize {
    let mut depth = 0;
    for (at, line) in lines.iter().enumerate().skip(start) {
        depth += line.matches('{').count() as i32 - line.matches('}').count() as i32;
        if depth <= 0 {
            return at;
        }
    }
    start
}

/// The shortest text found that fails.
pub fn shrunk(compiler: &Compiler, lines: &[String]) -> Vec<String> {
    let fails = |lines: &[String]| compile(compiler, &lines.join("\n")).is_ok_and(|shader| problem(&shader).is_some());
    let mut lines = lines.to_vec();
    let mut shorter = true;
    while shorter {
        shorter = false;
        let mut at = lines.len();
        while at > 0 {
            at -= 1;
            if at >= lines.len() {
                continue;
            }
            let end = end_of(&lines, at);
            // The block with its head, its inside alone, or the line alone.
            let whole: Vec<String> = lines.iter().take(at).chain(lines.iter().skip(end + 1)).cloned().collect();
            let inside = lines[at + 1..end.max(at + 1).min(lines.len())].iter();
            let inside: Vec<String> =
                lines[..at].iter().chain(inside).chain(&lines[(end + 1).min(lines.len())..]).cloned().collect();
            for candidate in [whole, inside] {
                if candidate.len() < lines.len() && fails(&candidate) {
                    lines = candidate;
                    shorter = true;
                    break;
                }
            }
        }
    }
    lines
}
