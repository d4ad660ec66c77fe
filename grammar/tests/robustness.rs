//! Whatever the bytes, parsing ends soon, with messages and not with a panic or an overflown stack.

use std::time::{Duration, Instant};
use velour_grammar::{Format, Options, Parsed, Severity, parse, parse_bytes, preprocess, print};

/// The seed of all random texts.
const SEED: u64 = 0x7e10_4e5e_ed00_0001;

struct Random(u64);

impl Random {
    /// The next number below a bound (xorshift64*).
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % bound
    }
}

fn parse_all(text: &str) -> Parsed {
    let parsed = parse("test.osl", text, &Options::default());
    parsed.sources.render(&parsed.diagnostics, Format::Full, true);
    parsed.sources.render(&parsed.diagnostics, Format::Short, false);
    for diagnostic in &parsed.diagnostics.list {
        parsed.sources.locate(diagnostic.span);
        parsed.sources.text(diagnostic.span);
    }
    print::print(&parsed.file);
    parsed
}

fn errors(parsed: &Parsed) -> Vec<&str> {
    let errors = parsed.diagnostics.list.iter().filter(|d| d.severity == Severity::Error);
    errors.map(|d| d.message.as_str()).collect()
}

#[test]
fn random_bytes() {
    let mut random = Random(SEED);
    for _ in 0..2000 {
        let bytes: Vec<u8> = (0..random.below(200)).map(|_| random.below(256) as u8).collect();
        let parsed = parse_bytes("test.osl", &bytes, &Options::default());
        parsed.sources.render(&parsed.diagnostics, Format::Full, false);
        let text: String = bytes.iter().map(|b| char::from(b % 128)).collect();
        parse_all(&text);
        preprocess("test.osl", &text, &Options::default());
    }
}

/// Pieces of programs, joined at random.
const SOUP: &[&str] = &[
    "shader",
    "surface",
    "s",
    "float",
    "int",
    "color",
    "struct",
    "closure",
    "void",
    "output",
    "if",
    "else",
    "for",
    "while",
    "do",
    "return",
    "break",
    "(",
    ")",
    "(",
    ")",
    "{",
    "}",
    "{",
    "}",
    "[",
    "]",
    "[[",
    ";",
    ";",
    ",",
    "=",
    "+",
    "-",
    "*",
    "++",
    "?",
    ":",
    ".",
    "x",
    "y",
    "1",
    "2.5",
    "\"t\"",
    "\n",
    "\n#define",
    "\n#if",
    "\n#else",
    "\n#endif",
    "\n#undef",
    "\n#include",
    "F(",
    "#",
    "##",
    "__VA_ARGS__",
    "...",
    "\\\n",
    "/*",
    "*/",
    "//",
    "true",
    "const",
    "@",
    "\"",
    "defined",
    "__LINE__",
    "\n#define F(x) x #x x ## x\n",
    "\n#ifdef F\n",
    "é",
];

#[test]
fn random_tokens() {
    let mut random = Random(SEED);
    for _ in 0..4000 {
        let mut text = String::new();
        for _ in 0..random.below(80) {
            text.push_str(SOUP[random.below(SOUP.len())]);
            text.push_str([" ", "", " "][random.below(3)]);
        }
        parse_all(&text);
        preprocess("test.osl", &text, &Options::default());
    }
}

#[test]
fn damaged_shaders() {
    let whole = include_str!("syntax/statements.osl").to_string() + include_str!("syntax/parameters.osl");
    let mut random = Random(SEED);
    for _ in 0..1000 {
        let mut text = whole.clone();
        for _ in 0..1 + random.below(3) {
            let at = random.below(text.len());
            let end = (at + random.below(8)).min(text.len());
            let put = SOUP[random.below(SOUP.len())];
            if text.is_char_boundary(at) && text.is_char_boundary(end) {
                text.replace_range(at..end, put);
            }
        }
        parse_all(&text);
    }
}

#[test]
fn deep_brackets_give_one_message() {
    for (open, close) in [("(", ")"), ("{", "}"), ("a[", "]"), ("f(", ")"), ("(float)(", ")"), ("[[", "]]"), ("{", "")]
    {
        let text = format!("shader s() {{ x = {}1{}; }}", open.repeat(20_000), close.repeat(20_000));
        let parsed = parse_all(&text);
        assert_eq!(errors(&parsed), ["nested more than 256 levels deep"], "{open}");
        assert!(parsed.file.items.is_empty());
    }
    let fine = format!("shader s() {{ x = {}1{}; }}", "(".repeat(250), ")".repeat(250));
    assert!(parse_all(&fine).diagnostics.is_empty());
}

#[test]
fn long_chains_parse() {
    for (first, link) in [("a", "+a"), ("a", "*-a"), ("a", ",a"), ("a", "=a"), ("a", "?b:a"), ("-", " -"), ("a", ".x")]
    {
        let links = if link.len() > 2 { 12_000 } else { 20_000 };
        let last = if first == "-" { "a" } else { "" };
        let text = format!("shader s() {{ {first}{}{last}; }}", link.repeat(links));
        let parsed = parse_all(&text);
        assert_eq!(errors(&parsed), [""; 0], "{link}");
        assert_eq!(parsed.file.items.len(), 1);
    }
    let ifs = format!("shader s() {{ {} ; }}", "if (a) ; else ".repeat(900));
    assert!(parse_all(&ifs).diagnostics.is_empty());
}

#[test]
fn too_long_chains_give_one_message() {
    for link in ["+a", "=a", "- ", "?b:a", "(float)", "while (a) ", "if (a) ", "if (a) ; else ", "do ", "++"] {
        let text = format!("shader s() {{ a {}; }}", link.repeat(200_000));
        let parsed = parse_all(&text);
        assert_eq!(errors(&parsed).len(), 1, "{link}");
    }
    let list = format!("shader s(float a[] = {{ {} }}) {{ }}", "1 + 2, ".repeat(100_000));
    assert!(parse_all(&list).diagnostics.is_empty());
}

#[test]
fn mistakes_at_great_depth_are_found_soon() {
    let start = Instant::now();
    let ends = [") x y z ; ; ;", "] ; a b c d e f ; }", "; a b ; ; c d ; }"];
    for link in
        ["- ", "a=", "a?b:", "if (a) ", "while (a) ", "a+", "{", "(", "( ; ", "{(}", "a b;", "@", "if (a) ; else "]
    {
        for end in ends {
            let text =
                format!("shader s() {{ {}{}", link.repeat(if link.len() > 5 { 900 } else { 20_000 }), end.repeat(50));
            parse_all(&text);
        }
    }
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
}

#[test]
fn macro_bombs_end_soon() {
    let mut doubling = String::from("#define A0(x) x x\n#define S0(x) x##x\n");
    for i in 1..60 {
        doubling += &format!("#define A{i}(x) A{}(x) A{}(x)\n", i - 1, i - 1);
        doubling += &format!("#define S{i}(x) S{}(x##x)\n", i - 1);
    }
    let nested = format!("#define F(x) x x\n{}1{}", "F(".repeat(150), ")".repeat(150));
    for text in [format!("{doubling}A59(1)"), format!("{doubling}S59(abc)"), nested] {
        let start = Instant::now();
        let parsed = parse_all(&text);
        assert_eq!(errors(&parsed), ["macros and includes produce more than 4000000 tokens"]);
        assert!(start.elapsed() < Duration::from_secs(20));
    }
}

#[test]
fn include_bombs_end_soon() {
    let text = "#include \"a.h\"\n#include \"a.h\"\n";
    let options = Options { virtual_files: vec![("a.h".into(), text.into())], ..Options::default() };
    let parsed = parse("test.osl", text, &options);
    // The first that is nested too deep is the end: two of them at each depth would be 2^64.
    let codes: Vec<_> = parsed.diagnostics.list.iter().map(|d| d.code).collect();
    assert_eq!(codes, ["E0104"]);
}

#[test]
fn empty_texts() {
    for text in ["", "\n", " ", "\u{feff}", "// nothing", "#define A", ";"] {
        assert!(parse_all(text).diagnostics.is_empty(), "{text:?}");
    }
}
