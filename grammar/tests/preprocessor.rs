//! The preprocessor: what it prints for small texts, and what it says about wrong ones.

use velour_grammar::{Format, Options, Span, parse, preprocess};

/// The preprocessed text without `#line` directives and with single spaces.
fn expand_with(text: &str, options: &Options) -> String {
    let (out, diagnostics, sources) = preprocess("test.osl", text, options);
    let messages = sources.render(&diagnostics, Format::Short, false);
    assert_eq!(messages, "", "{text}");
    let lines = out.lines().filter(|line| !line.starts_with("#line"));
    lines.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}

fn expand(text: &str) -> String {
    expand_with(text, &Options::default())
}

#[test]
fn object_macros_are_replaced_and_read_again() {
    assert_eq!(expand("#define A B\n#define B C\nA B C AB"), "C C C AB");
    assert_eq!(expand("#define A\n(A)"), "()");
    assert_eq!(expand("#define A 1\n#undef A\nA"), "A");
    assert_eq!(expand("#define A 1\n#define A 1\nA"), "1");
}

#[test]
fn function_macros_take_arguments() {
    assert_eq!(expand("#define F(a, b) b a\nF(1, 2) F((3, 4), f(5, 6))"), "2 1 f(5, 6) (3, 4)");
    assert_eq!(expand("#define F(a) [a]\nF (1) F( ) F\n(2\n) F"), "[1] [] [2] F");
    assert_eq!(expand("#define F() x\nF() F( )"), "x x");
    assert_eq!(expand("#define F (a)\nF"), "(a)");
    assert_eq!(expand("#define F(a) a a\nF(F(1))"), "1 1 1 1");
}

#[test]
fn a_macro_is_not_expanded_in_itself() {
    assert_eq!(expand("#define A A + 1\nA"), "A + 1");
    assert_eq!(expand("#define A B\n#define B A\nA B"), "A B");
    assert_eq!(expand("#define f(x) x + f(x)\nf(f(1))"), "1 + f(1) + f(1 + f(1))");
    assert_eq!(expand("#define g f\n#define f(x) x\ng(2) g (g)(3)"), "2 f(3)");
}

#[test]
fn strings_and_pasting() {
    assert_eq!(
        expand(
            r##"#define S(x) #x
S(a  +  "b\n") S() S( a )"##
        ),
        r#""a + \"b\\n\"" "" "a""#
    );
    assert_eq!(expand("#define J(a, b) a ## b\nJ(x, 1) J(1, .5) J(, y) J(z, ) J(<, <=)"), "x1 1.5 y z <<=");
    assert_eq!(expand("#define J(a, b, c) a##b##c\n#define xyz 7\nJ(x, y, z)"), "7");
    assert_eq!(expand("#define N 3\n#define J(a) a ## N a\nJ(N)"), "NN 3");
}

#[test]
fn variadic_macros() {
    assert_eq!(expand("#define V(...) f(__VA_ARGS__)\nV(1, 2) V()"), "f(1, 2) f()");
    assert_eq!(expand("#define V(a, ...) a: __VA_ARGS__;\nV(1, 2, 3) V(1)"), "1: 2, 3; 1:;");
    assert_eq!(expand("#define V(a, ...) f(a, ## __VA_ARGS__)\nV(1, 2) V(1)"), "f(1, 2) f(1)");
    assert_eq!(expand("#define V(a, rest...) f(rest)\nV(1, 2, 3)"), "f(2, 3)");
    assert_eq!(expand("#define V(...) #__VA_ARGS__\nV(a, b)"), "\"a, b\"");
}

#[test]
fn conditions_choose() {
    assert_eq!(expand("#if 1\na\n#else\nb\n#endif"), "a");
    assert_eq!(expand("#if 0\na\n#elif 1\nb\n#elif 1\nc\n#else\nd\n#endif"), "b");
    assert_eq!(expand("#ifdef X\na\n#endif\n#ifndef X\nb\n#endif"), "b");
    assert_eq!(expand("#if 0\n#if 1\na\n#else\nb\n#endif\n#error no\n#wrong\n#endif\nc"), "c");
    assert_eq!(expand("#define X\n#if defined X && !defined(Y)\na\n#endif"), "a");
    assert_eq!(expand("#define V(a) a > 2\n#if V(3)\na\n#endif"), "a");
}

#[test]
fn conditions_calculate() {
    for (text, value) in [
        ("1 + 2 * 3 == 7", true),
        ("(1 + 2) * 3 == 9", true),
        ("10 - 4 - 3 == 3", true),
        ("-1 < 0 && !0 && ~0 == -1", true),
        ("1 ? 0 : 1", false),
        ("0 ? 0 : 0 ? 0 : 1", true),
        ("0x10 == 16 && 010 == 8 && 5L == 5u", true),
        ("1 << 3 | 1 ^ 3 & 2", true),
        ("7 % 4 == 3 && 7 / 2 == 3", true),
        ("unknown", false),
        ("0 && 1 / 0", false),
        ("1 || 1 % 0", true),
        ("OSL_VERSION >= 11200 && OSL_VERSION_MAJOR == 1", true),
        ("__VELOUR__", true),
    ] {
        let out = expand(&format!("#if {text}\nyes\n#endif"));
        assert_eq!(out == "yes", value, "{text}");
    }
}

#[test]
fn lines_and_comments() {
    assert_eq!(expand("a /* b\n c */ d // e\nf"), "a d f");
    assert_eq!(expand("#define A 1 \\\n + 2\nA"), "1 + 2");
    assert_eq!(expand("#define A /* x */ 1 // y\nA"), "1");
    assert_eq!(expand("a // b \\\n c\nd"), "a d");
    assert_eq!(expand("  #  define A 1\n#\n# 12 \"file\"\n#line 3\n#pragma osl nowarn\nA"), "1");
    assert_eq!(expand("__LINE__\n__LINE__ __FILE__"), "1 2 \"test.osl\"");
    assert_eq!(expand("#define L __LINE__\n\nL"), "3");
}

#[test]
fn directives_among_arguments() {
    assert_eq!(expand("#define F(a) [a]\nF(\n#if 1\n1\n#else\n2\n#endif\n)"), "[1]");
}

#[test]
fn the_caller_defines_and_undefines() {
    let options = Options {
        defines: vec![("A".into(), "1".into()), ("F(x)".into(), "x x".into()), ("B".into(), "2".into())],
        undefines: vec!["B".into()],
        ..Options::default()
    };
    assert_eq!(expand_with("A B F(3)", &options), "1 B 3 3");
}

#[test]
fn includes_are_searched_in_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir(path("sub")).expect("a folder");
    std::fs::write(path("sub/a.h"), "sub_a\n#include \"b.h\"\n").expect("a file");
    std::fs::write(path("sub/b.h"), "sub_b\n").expect("a file");
    std::fs::write(path("a.h"), "#pragma once\nfirst_a\n").expect("a file");
    let options = Options {
        include_dirs: vec![folder.path().into(), path("sub")],
        virtual_files: vec![("b.h".into(), "memory_b".into()), ("c.h".into(), "memory_c".into())],
        prelude: Some(("std.h".into(), "#define FROM_PRELUDE 9\nprelude".into())),
        ..Options::default()
    };
    let text = "#include <a.h>\n#include \"a.h\"\n#include \"sub/a.h\"\n#include <b.h>\n#include \"c.h\"\n\
        #define NAME <c.h>\n#include NAME\nFROM_PRELUDE";
    assert_eq!(expand_with(text, &options), "prelude first_a sub_a sub_b sub_b memory_c memory_c 9");
}

#[test]
fn preprocessed_text_parses_alike() {
    let text = "#define F(x) ((x) + -(x))\n\n\nshader a(float b = F(-1)) {\n  b = F(b)\n   * F(2)\n;}\n";
    let (out, _, _) = preprocess("a.osl", text, &Options::default());
    let (first, second) = (parse("a.osl", text, &Options::default()), parse("a.osl", &out, &Options::default()));
    assert!(second.diagnostics.is_empty(), "{out}");
    let printed = |p: &velour_grammar::Parsed| velour_grammar::print::print(&p.file);
    assert_eq!(printed(&first), printed(&second));
    assert!(out.contains("#line 4 \"a.osl\"\nshader a(float b = ((-1) + -(-1))) {\n"), "{out}");
}

#[test]
fn spans_lead_to_the_users_text() {
    let text = "#define ADD(a) a + zero\n#define zero 0\nshader s() {\n    float x = ADD(one);\n}\n";
    let parsed = parse("s.osl", text, &Options::default());
    let find = |wanted: &str| {
        let index = (0..40).find(|i| parsed.sources.text(Span { first: *i, last: *i }) == wanted);
        let at = parsed.sources.locate(Span { first: index?, last: index? })?;
        Some((at.line, at.column))
    };
    assert_eq!(find("x"), Some((4, 11)));
    assert_eq!(find("one"), Some((4, 19)), "an argument stands where it is written");
    assert_eq!(find("+"), Some((4, 15)), "a body stands where the macro is called");
    assert_eq!(find("0"), Some((4, 15)), "also through two macros");
    assert_eq!(parsed.sources.locate(Span::NONE), None);
    assert_eq!(parsed.sources.text(Span { first: 5, last: 9 }), "float x = one +");
}

#[test]
fn columns_count_characters() {
    let parsed = parse("s.osl", "/* ☂ä */ x", &Options::default());
    let at = parsed.sources.locate(Span { first: 0, last: 0 }).map(|l| l.column);
    // The first entries of the table may be places in directives: look for the name.
    let index = (0..10).find(|i| parsed.sources.text(Span { first: *i, last: *i }) == "x").expect("the name");
    let column = parsed.sources.locate(Span { first: index, last: index }).map(|l| l.column);
    assert!(at.is_some());
    assert_eq!(column, Some(10));
}

#[test]
fn sources_can_go_to_other_threads() {
    fn check<T: Clone + Send + Sync>(_: &T) {}
    check(&parse("s.osl", "shader s() { }", &Options::default()).sources);
}
