//! How long functions are, and which matches of which enums have an arm for whatever else there may be.

use crate::source::{Kind, Token, closed};
use std::collections::BTreeSet;

/// The functions of a file: name, first line, and lines from `fn` to the closing brace.
pub fn functions(tokens: &[Token]) -> Vec<(String, usize, usize)> {
    let mut out = Vec::new();
    for (at, pair) in tokens.windows(2).enumerate() {
        if !pair[0].is("fn") || pair[1].kind != Kind::Word {
            continue;
        }
        let mut open = at + 2;
        while open < tokens.len() && !tokens[open].is("{") && !tokens[open].is(";") {
            open = if tokens[open].is("(") || tokens[open].is("[") { closed(tokens, open) } else { open + 1 };
        }
        if tokens.get(open).is_some_and(|token| token.is("{")) {
            let last = tokens[closed(tokens, open) - 1].line;
            out.push((pair[1].text.clone(), pair[0].line, last + 1 - pair[0].line));
        }
    }
    out
}

/// The matches with an arm `_ =>` or `_ if`, among whose other arms variants of `enums` stand: line, and those enums.
pub fn open_matches(tokens: &[Token], enums: &BTreeSet<String>) -> Vec<(usize, BTreeSet<String>)> {
    let mut out = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        if !token.is("match") {
            continue;
        }
        let mut open = at + 1;
        while open < tokens.len() && !tokens[open].is("{") {
            open = if tokens[open].is("(") || tokens[open].is("[") { closed(tokens, open) } else { open + 1 };
        }
        let patterns = patterns(tokens, open);
        let wild = |pattern: &&[Token]| pattern[0].is("_") && pattern.get(1).is_none_or(|t| t.is("if"));
        if !patterns.iter().any(wild) {
            continue;
        }
        let named = patterns.iter().flat_map(|pattern| pattern.windows(2));
        let named = named.filter(|pair| pair[1].is("::") && enums.contains(&pair[0].text));
        let named: BTreeSet<String> = named.map(|pair| pair[0].text.clone()).collect();
        if !named.is_empty() {
            out.push((token.line, named));
        }
    }
    out
}

/// The patterns of the arms of a match whose brace opens at `open`, each with its guard.
fn patterns(tokens: &[Token], open: usize) -> Vec<&[Token]> {
    let end = closed(tokens, open).saturating_sub(1);
    let (mut out, mut at) = (Vec::new(), open + 1);
    while at < end {
        let start = at;
        while at < end && !tokens[at].is("=>") {
            at = if ["(", "[", "{"].iter().any(|mark| tokens[at].is(mark)) { closed(tokens, at) } else { at + 1 };
        }
        if at > start {
            out.push(&tokens[start..at]);
        }
        at += 1;
        // The arm's body: a block, or an expression up to its comma.
        if at < end && tokens[at].is("{") {
            at = closed(tokens, at);
        }
        while at < end && !tokens[at].is(",") && !ends_arm(tokens, at) {
            at = if ["(", "[", "{"].iter().any(|mark| tokens[at].is(mark)) { closed(tokens, at) } else { at + 1 };
        }
        at += usize::from(at < end && tokens[at].is(","));
    }
    out
}

/// True right after a block that was an arm's whole body: what follows is the next pattern.
fn ends_arm(tokens: &[Token], at: usize) -> bool {
    let goes_on = [".", "?", "+", "-", "*", "/", "=", "<", ">", "as", "else"];
    tokens[at - 1].is("}") && !goes_on.iter().any(|mark| tokens[at].is(mark))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::tokens;

    #[test]
    fn a_function_is_as_long_as_its_lines() {
        let text = "fn a() {}\ntrait T { fn b(); fn c(x: [f32; 2]) -> u8\n{\n 1 } }\nfn d<const N: usize>() {\n\n}";
        let found: Vec<(String, usize, usize)> = functions(&tokens(text));
        let expected = [("a", 1, 1), ("c", 2, 3), ("d", 5, 3)];
        assert_eq!(found, expected.map(|(name, line, length)| (name.to_owned(), line, length)));
    }

    #[test]
    fn an_open_match_of_an_own_enum_is_found() {
        let own = BTreeSet::from(["Op".to_owned()]);
        let found = |text: &str| open_matches(&tokens(text), &own).len();
        assert_eq!(found("match x { Op::A => 1, _ => 2 }"), 1);
        assert_eq!(found("match x { Op::A | Op::B { .. } if y => { f(); } _ if z => {} Op::C => 3 }"), 1);
        assert_eq!(found("match (x, y) { (ir::Op::A, _) => 1, (_, _) => 2 }"), 0);
        assert_eq!(found("match x { Op::A => 1, Op::B => 2 }"), 0);
        assert_eq!(found("match x { Other::A => Op::A, _ => Op::B }"), 0);
        assert_eq!(found("match x { Op::A => match y { 1 => 2, _ => 3 }, Op::B => if c { 1 } else { 2 }, }"), 0);
        assert_eq!(found("match x { 1 => match y { Op::A => 2, _ => 3 }.max(1), _ => 5 }"), 1);
        assert_eq!(found("match f(|x| x) { Some(Op::A) => 1, _ => 0 }"), 1);
    }
}
