//! Regular expressions: `regex_search` and `regex_match`.
//!
//! Patterns are those of the `fancy-regex` crate, which has back-references and looks ahead and behind; one that would take more than
//! a hundred thousand steps of going back matches nothing, and neither does one that is malformed, which [`flaw`] tells.

use crate::limits::PATTERN_STEPS;
use fancy_regex::{Captures, Regex, RegexBuilder};
use std::cell::RefCell;
use std::collections::HashMap;

/// Patterns that a thread remembers; a shader that makes up new ones for every point must not fill the memory.
const REMEMBERED: usize = 256;

thread_local! {
    static COMPILED: RefCell<HashMap<String, Result<Regex, String>>> = RefCell::new(HashMap::new());
}

/// Looks for the pattern anywhere in the subject; gives 1 or 0.
///
/// `positions` receives the byte offsets of begin and end of the match and of each group in turn; entries beyond the groups,
/// and all without a match, are the length of the pattern, as OSL has it.
pub fn regex_search(subject: &str, pattern: &str, positions: &mut [i32]) -> i32 {
    find(subject, pattern, pattern, positions)
}

/// As [`regex_search`], for a pattern that has to match the whole subject.
pub fn regex_match(subject: &str, pattern: &str, positions: &mut [i32]) -> i32 {
    find(subject, &format!(r"\A(?:{pattern})\z"), pattern, positions)
}

/// What is wrong with a pattern, if anything.
pub fn flaw(pattern: &str) -> Option<String> {
    with_compiled(pattern, |regex| regex.as_ref().err().cloned())
}

fn find(subject: &str, expression: &str, pattern: &str, positions: &mut [i32]) -> i32 {
    with_compiled(expression, |regex| {
        let captures = regex.as_ref().ok().and_then(|regex| regex.captures(subject).ok().flatten());
        fill(positions, captures.as_ref(), pattern.len(), subject.len());
        captures.is_some() as i32
    })
}

/// Does something with an expression that is compiled once, or with what is wrong with it.
fn with_compiled<T>(expression: &str, work: impl FnOnce(&Result<Regex, String>) -> T) -> T {
    COMPILED.with_borrow_mut(|compiled| {
        if compiled.len() >= REMEMBERED && !compiled.contains_key(expression) {
            compiled.clear();
        }
        let compile = || {
            let builder =
                RegexBuilder::new(expression).backtrack_limit(PATTERN_STEPS).delegate_size_limit(1 << 20).build();
            builder.map_err(|error| error.to_string())
        };
        work(compiled.entry(expression.to_owned()).or_insert_with(compile))
    })
}

fn fill(positions: &mut [i32], captures: Option<&Captures>, absent: usize, end: usize) {
    for (k, position) in positions.iter_mut().enumerate() {
        let group = captures.filter(|c| k / 2 < c.len()).map(|c| c.get(k / 2));
        // A group that took no part in the match stands at the end of the subject, as in C++.
        let offset = match group {
            None => absent,
            Some(None) => end,
            Some(Some(found)) => {
                if k % 2 == 0 {
                    found.start()
                } else {
                    found.end()
                }
            }
        };
        *position = i32::try_from(offset).unwrap_or(i32::MAX);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn search_finds_and_match_covers() {
        assert_eq!(regex_search("foobar.baz", "o+b", &mut []), 1);
        assert_eq!(regex_match("foobar.baz", "o+b", &mut []), 0);
        assert_eq!(regex_match("foobar.baz", "f.*z", &mut []), 1);
        assert_eq!(regex_match("ab", "a|ab", &mut []), 1);
        assert_eq!(regex_search("abc", "(", &mut []), 0);
        assert!(flaw("(").is_some() && flaw("(a)").is_none());
        assert_eq!(regex_search("aa", r"(a)\1", &mut []), 1);
        assert_eq!(regex_search("foobar", "foo(?=bar)", &mut []), 1);
        assert_eq!(regex_match("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaab", r"(?:(a*)*\1)*c", &mut []), 0);
    }

    #[test]
    fn positions_are_those_of_the_groups() {
        let mut positions = [-1; 8];
        assert_eq!(regex_search("foobar.baz", "(b.)(x)?", &mut positions), 1);
        assert_eq!(positions, [3, 5, 3, 5, 10, 10, 8, 8]);
        assert_eq!(regex_search("foobar", "zz", &mut positions), 0);
        assert_eq!(positions, [2; 8]);
    }

    #[test]
    fn memory_is_bounded() {
        for k in 0..1000 {
            assert_eq!(regex_search("a7", &format!("a{k}$"), &mut []), (k == 7) as i32);
        }
        COMPILED.with_borrow(|compiled| assert!(compiled.len() <= REMEMBERED));
    }
}
