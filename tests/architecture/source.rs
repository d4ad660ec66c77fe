//! A source file as the rules see it: where it stands among the modules, and its words without comments and tests.

use std::fs;
use std::path::{Path, PathBuf};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An identifier or keyword.
    Word,
    /// Punctuation; `::`, `=>` and `->` are one token each.
    Mark,
    /// A string, character, number or lifetime; its text is not kept.
    Literal,
}

/// One token of Rust.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    pub kind: Kind,
    pub text: String,
    /// From 1.
    pub line: usize,
}

impl Token {
    /// True for this punctuation or keyword; false for a literal.
    pub fn is(&self, text: &str) -> bool {
        self.kind != Kind::Literal && self.text == text
    }
}

/// One file.
#[derive(Clone, Debug)]
pub struct Source {
    /// Relative to the folder that was read, with forward slashes.
    pub path: String,
    /// The module it is: `exec::machine` for `exec/machine.rs`, `exec` for `exec/mod.rs`, nothing for `lib.rs`.
    pub module: Vec<String>,
    /// The text as it is.
    pub text: String,
    /// The tokens that are compiled outside of tests.
    pub tokens: Vec<Token>,
}

impl Source {
    /// A file of that path and text.
    pub fn new(path: &str, text: &str) -> Self {
        let mut module: Vec<String> = path.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
        if ["mod", "lib", "main"].contains(&module.last().map_or("", String::as_str)) {
            module.pop();
        }
        Source { path: path.to_owned(), module, text: text.to_owned(), tokens: without_tests(tokens(text)) }
    }

    /// True for a file that holds nothing but unit tests.
    pub fn is_test(&self) -> bool {
        self.path.ends_with("tests.rs")
    }
}

/// Every source file below a folder of the repository, sorted by path.
pub fn sources(folder: &str) -> Vec<Source> {
    fn gather(folder: &Path, out: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                gather(&path, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                out.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths = Vec::new();
    gather(&root, &mut paths);
    paths.sort();
    let relative = |path: &PathBuf| path.strip_prefix(&root).unwrap().display().to_string().replace('\\', "/");
    paths.iter().map(|path| Source::new(&relative(path), &fs::read_to_string(path).unwrap())).collect()
}

/// The tokens of a text; comments are left out.
pub fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let (mut out, mut at, mut line) = (Vec::new(), 0, 1);
    while at < bytes.len() {
        let start = at;
        let rest = &text[at..];
        let c = rest.chars().next().unwrap();
        let mut push = |kind, text: &str| out.push(Token { kind, text: text.to_owned(), line });
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += comment(rest);
        } else if let Some(length) = string(rest) {
            push(Kind::Literal, "");
            at += length;
        } else if c == '\'' {
            push(Kind::Literal, "");
            at += character_or_lifetime(rest);
        } else if c.is_alphabetic() || c == '_' {
            let word = &rest[..rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())];
            push(Kind::Word, word);
            at += word.len();
        } else if c.is_ascii_digit() {
            push(Kind::Literal, "");
            // A dot belongs to a number only before a digit, so that ranges stay whole.
            let number = |(i, c): (usize, char)| {
                let dot = c == '.' && rest[i + 1..].starts_with(|c: char| c.is_ascii_digit());
                !(c.is_alphanumeric() || c == '_' || dot)
            };
            at += rest.char_indices().find(|&entry| number(entry)).map_or(rest.len(), |(i, _)| i);
        } else {
            let pair = ["::", "=>", "->"].into_iter().find(|pair| rest.starts_with(pair));
            let mark = pair.unwrap_or(&rest[..c.len_utf8()]);
            push(Kind::Mark, mark);
            at += mark.len();
        }
        line += text[start..at].matches('\n').count();
    }
    out
}

/// The length of a block comment, which may hold others.
fn comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        let step = if rest.starts_with(b"/*") {
            depth += 1;
            2
        } else if rest.starts_with(b"*/") {
            depth -= 1;
            2
        } else {
            1
        };
        at += step;
        if depth == 0 {
            break;
        }
    }
    at
}

/// The length of a string that the text begins with: plain, byte, C or raw.
fn string(text: &str) -> Option<usize> {
    let prefix = text.find(|c: char| !"bcr".contains(c)).filter(|&length| length <= 2)?;
    let raw = text[..prefix].contains('r');
    let hashes = if raw { text[prefix..].chars().take_while(|c| *c == '#').count() } else { 0 };
    let open = prefix + hashes;
    let inside = text[open..].strip_prefix('"')?;
    if raw {
        let close = format!("\"{}", "#".repeat(hashes));
        return Some(open + 1 + inside.find(&close)? + close.len());
    }
    let mut escaped = false;
    let end = inside.char_indices().find(|&(_, c)| {
        let ends = c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
        ends
    })?;
    Some(open + 1 + end.0 + 1)
}

/// The length of `'a'`, `'\n'` or `'lifetime`.
fn character_or_lifetime(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    let Some((_, first)) = chars.next() else { return 1 };
    if first == '\\' {
        let inside = &text[3..];
        return 3 + inside.find('\'').map_or(inside.len(), |i| i + 1);
    }
    match chars.next() {
        Some((i, '\'')) => i + 1,
        _ => 1 + text[1..].find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len() - 1),
    }
}

/// The place after the bracket that closes the one at `open`.
pub fn closed(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0usize;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        if ["(", "[", "{"].iter().any(|mark| token.is(mark)) {
            depth += 1;
        } else if [")", "]", "}"].iter().any(|mark| token.is(mark)) {
            depth -= 1;
            if depth == 0 {
                return at + 1;
            }
        }
    }
    tokens.len()
}

/// The tokens without items under `#[cfg(test)]`.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let attribute = tokens[at].is("#") && tokens.get(at + 1).is_some_and(|t| t.is("["));
        if !attribute {
            out.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let end = closed(&tokens, at + 1);
        let inside = &tokens[at + 2..end - 1];
        let says = |word: &str| inside.iter().any(|token| token.is(word));
        if !(inside[0].is("cfg") && says("test") && !says("not")) {
            out.extend_from_slice(&tokens[at..end]);
            at = end;
            continue;
        }
        // The item ends at its semicolon or with its block.
        at = end;
        while at < tokens.len() && !tokens[at].is(";") && !tokens[at].is("{") {
            at = if tokens[at].is("(") || tokens[at].is("[") { closed(&tokens, at) } else { at + 1 };
        }
        at = if tokens.get(at).is_some_and(|t| t.is("{")) { closed(&tokens, at) } else { at + 1 };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> String {
        let texts: Vec<String> = Source::new("a.rs", text).tokens.iter().map(|t| t.text.clone()).collect();
        texts.join(" ")
    }

    #[test]
    fn comments_strings_and_tests_are_not_code() {
        assert_eq!(words("a // unsafe\n/* b /* c */ d */ e"), "a e");
        assert_eq!(words(r##"f("un\"safe", r#"a " b"#, b'x', '\'', '"') 'a: loop"##), "f (  ,  , b  ,  ,  )  : loop");
        assert_eq!(words("a\n#[cfg(test)]\n#[rustfmt::skip]\nmod tests { unsafe {} }\nb"), "a b");
        assert_eq!(words("#[cfg(test)] mod tests; #[cfg(not(test))] c"), "# [ cfg ( not ( test ) ) ] c");
        assert_eq!(words("0..10 1.5e3 x.0"), " . .   x . ");
        assert_eq!(tokens("a\n\nb /* \n */ c").iter().map(|t| t.line).collect::<Vec<_>>(), [1, 3, 4]);
    }

    #[test]
    fn a_path_is_a_module() {
        assert_eq!(Source::new("ir/lower/mod.rs", "").module, ["ir", "lower"]);
        assert_eq!(Source::new("ir/op.rs", "").module, ["ir", "op"]);
        assert!(Source::new("lib.rs", "").module.is_empty());
    }
}
