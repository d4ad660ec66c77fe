//! What an operation works on, and when it is read: the same wherever an expression stands.

use velour::compile::Compiler;
use velour::exec::{Machine, Points, Report, ReportKind};

const HEAD: &str = "
struct S { float a; float k[2]; };
void pair(color c, float x) { printf(\"%g %g\\n\", c, x); }
void alias(float a, output float b) { b = 5; printf(\"%g\\n\", a); }
void through(float a, output float b) { alias(a, b); }
void field(S s, output float b) { b = 5; printf(\"%g\\n\", s.a); }
void both(output float a, output float b) { a = 2; b = 3; }
void early(float a, output float b) { if (b < 4) { b = 4; printf(\"%g\\n\", a); return; } b = 5; printf(\"%g\\n\", a); }
float twice(float a) { return a * 2; }
S same(S s) { return s; }
void show(S s, float x) { printf(\"%g %g %g\\n\", s.a, s.k, x); }
";

/// Statements, and what they print.
const CASES: &[(&str, &str)] = &[
    ("float x = .5; printf(\"%g\\n\", color(x, x = .25, x));", "0.25 0.25 0.25"),
    ("float x = .9; printf(\"%g\\n\", x + (x = 2) + x);", "6"),
    ("int k = 0; printf(\"%d %d %d\\n\", k, k++, k);", "1 0 1"),
    ("int k = 0; printf(\"%d %d\\n\", ++k, ++k);", "2 2"),
    ("int k = 1; printf(\"%d\\n\", k++ + k++);", "3"),
    ("int k = 1; printf(\"%g\\n\", k + (k = 2) * 1.5);", "5"),
    ("int k = 1; printf(\"%d %d\\n\", k < (k = 2), k == (k = 3));", "0 1"),
    ("color c = .5; pair(c, c[2] = .25);", "0.5 0.5 0.25 0.25"),
    ("color c = .5; printf(\"%g\\n\", c[0] + (c[0] = 3));", "3.5"),
    ("color c = .5; printf(\"%g\\n\", c * (c = 2));", "4 4 4"),
    ("float x = 1; x += (x = 2); printf(\"%g\\n\", x);", "4"),
    ("float x = 1; float y = (x = 3, x) + (x = 2); printf(\"%g\\n\", y);", "4"),
    ("int i = 0; int a[2] = {7, 8}; a[i = 1] = i; printf(\"%d\\n\", a);", "7 1"),
    ("int i = 0; int a[2] = {7, 8}; a[i++] += 10; printf(\"%d %d\\n\", a, i);", "17 8 1"),
    ("int i = 0; int a[2] = {7, 8}; printf(\"%d\\n\", a[i] + a[i = 1] + i);", "16"),
    ("int i = 0; vector a[2] = {vector(1, 2, 3), vector(4, 5, 6)}; printf(\"%g\\n\", a[i][i = 1]);", "5"),
    ("S s = {1, {2, 3}}; printf(\"%g\\n\", s.a + (s.a = 2) + s.k[0]);", "6"),
    ("S s = {1, {2, 3}}; show(s, s.k[1] = 4);", "1 2 4 4"),
    ("S s = {1, {2, 3}}; show(same(s), s.k[1] = 4);", "1 2 3 4"),
    ("S s = {1, {2, 3}}; float a = 2; show((s.a = 3, s), s.a = a);", "2 2 3 2"),
    ("float x = 1; alias(x, x); printf(\"%g\\n\", x);", "5 5"),
    ("float x = 1; through(x, x); printf(\"%g\\n\", x);", "5 5"),
    ("float x = 1; alias(x + 0, x); printf(\"%g\\n\", x);", "1 5"),
    ("float x = 1; early(x, x); early(x, x);", "4 5"),
    ("S s = {1, {2, 3}}; field(s, s.a);", "5"),
    ("color c = .5; both(c[0], c[1]); printf(\"%g\\n\", c);", "2 3 0.5"),
    ("S s = {1, {2, 3}}; both(s.k[1], s.a); show(s, 0);", "3 2 2 0"),
    ("float x = 1; both(x, x); printf(\"%g\\n\", x);", "3"),
    ("int i = 0; float a[2] = {1, 1}; float x = 0; sincos(x, a[i++], x); printf(\"%g %g %d\\n\", a, x, i);", "0 1 1 1"),
    ("int i = 0; float x = 0; float a[2] = {0, 0}; sincos(x, a[x = 0], a[i++]); printf(\"%g %d\\n\", a, i);", "1 0 1"),
    ("int i = 0; color c = 1; int f = getattribute(\"none\", c[i++]); printf(\"%g %d\\n\", c, i);", "1 1 1 1"),
    ("float x = 1; printf(\"%g\\n\", mix(x, 3, (x = 2) * .25));", "2.5"),
    ("float x = 1; printf(\"%g\\n\", twice(x) + (x = 3));", "5"),
    ("float x = 1; float y = 2; printf(\"%g\\n\", (1 ? x : y) + (x = 3));", "4"),
    ("float x = 1; float y = 2; printf(\"%g\\n\", (u < 2 ? x : y) + (x = 3));", "4"),
    ("float x = 1; Ci = x * diffuse(N) + (x = 3) * diffuse(N); printf(\"%s\\n\", Ci);", "DIFFUSE"),
    ("string s = \"a\"; printf(\"%s\\n\", concat(s, s = \"b\", s));", "bbb"),
    ("matrix m = 1; printf(\"%g\\n\", m[0][0] + (m = 3)[1][1]);", "4"),
    ("int k = 1; printf(\"%d %d\\n\", k && (k = 0), k || (k = 7));", "0 1"),
];

fn reports(text: &str) -> Vec<Report> {
    let shader = Compiler::new().compile("operand.osl", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut all = Vec::new();
    for group in [shader.group().build().unwrap(), shader.group().unoptimized().build().unwrap()] {
        let mut machine = Machine::new();
        machine.shade(&group, &Points::new(1));
        all.push(machine.take_reports());
    }
    assert_eq!(all[0], all[1], "optimised and not\n{text}");
    all.swap_remove(0)
}

/// What a shader prints, words only.
fn words(text: &str) -> String {
    let say = |report: Report| {
        assert_eq!(report.kind, ReportKind::Output, "{report:?}\n{text}");
        report.text
    };
    let printed: String = reports(text).into_iter().map(say).collect();
    printed.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The ways an expression may stand: `@` is where the statements go.
const CONTEXTS: &[&str] = &[
    "surface s() { @ }",
    "surface s() { if (u >= 0) { @ } }",
    "surface s() { if (1) { @ } }",
    "surface s() { for (int n = 0; n < 1; ++n) { @ } }",
    "surface s() { do { @ break; } while (u >= 0); }",
    "surface s() { if (u < 0) return; @ }",
    "surface s() { if (u < 0) exit(); if (v >= 0) { @ } }",
    "surface s() { void f() { if (u < 0) return; @ } f(); }",
    "surface s() { void f() { @ } if (u >= 0) { f(); } }",
];

#[test]
fn operands_are_read_when_the_operation_runs_wherever_it_stands() {
    let diffuse = words("surface s() { Ci = 3 * diffuse(N); printf(\"%s\\n\", 1 * diffuse(N) + Ci); }");
    for (statements, expected) in CASES {
        let expected = if *expected == "DIFFUSE" { &diffuse } else { *expected };
        // A block of its own would not do: some contexts are loops, which stand after the declarations as well.
        for context in CONTEXTS {
            let text = format!("{HEAD}{}", context.replace('@', statements));
            assert_eq!(words(&text), expected, "{statements}\nin {context}");
        }
    }
}

/// Declarations that come before the region, so that the variables are changed inside it.
#[test]
fn variables_from_outside_a_region_are_read_the_same() {
    let cases = [
        ("float x = .5;", "printf(\"%g\\n\", color(x, x = .25, x));", "0.25 0.25 0.25"),
        ("float x = .9;", "printf(\"%g\\n\", x + (x = 2) + x);", "6"),
        ("int k = 0;", "printf(\"%d %d %d\\n\", k, k++, k);", "1 0 1"),
        ("color c = .5;", "pair(c, c[2] = .25);", "0.5 0.5 0.25 0.25"),
        ("float x = 1;", "alias(x, x); printf(\"%g\\n\", x);", "5 5"),
        ("S s = {1, {2, 3}};", "show(same(s), s.k[1] = 4);", "1 2 3 4"),
        ("color c = .5;", "both(c[0], c[1]); printf(\"%g\\n\", c);", "2 3 0.5"),
        ("int i = 0; int a[2] = {7, 8};", "printf(\"%d\\n\", a[i] + a[i = 1] + i);", "16"),
        ("float x = 1; float y = 2;", "printf(\"%g\\n\", (1 ? x : y) + (x = 3));", "4"),
    ];
    for (before, statements, expected) in cases {
        for context in ["if (u >= 0) { @ }", "while (1) { @ break; }", "if (u < 0) {} else { @ }", "@"] {
            let text = format!("{HEAD} surface s() {{ {before} {} }}", context.replace('@', statements));
            assert_eq!(words(&text), expected, "{before} {statements}\nin {context}");
        }
    }
}

#[test]
fn an_index_of_a_component_is_clamped_and_reported_known_or_not() {
    let cases = [
        ("color c = 0; c[i] = 9; printf(\"%g\\n\", c);", "0 0 9", "7 is outside 0..2"),
        ("color c = color(1, 2, 3); printf(\"%g\\n\", c[i]);", "3", "7 is outside 0..2"),
        ("color c = color(1, 2, 3); printf(\"%g\\n\", c[-i]);", "1", "-7 is outside 0..2"),
        ("matrix m = 1; m[3][0] = 5; printf(\"%g\\n\", m[i][0]);", "5", "7 is outside 0..3"),
        ("matrix m = 1; m[0][3] = 5; printf(\"%g\\n\", m[-i][9]);", "5", "-7 is outside 0..3"),
        ("matrix m = 1; m[i][-i] = 5; printf(\"%g\\n\", m[3][0]);", "5", "7 is outside 0..3"),
        ("float a[2] = {1, 2}; printf(\"%g\\n\", a[i]);", "2", "7 is outside 0..1"),
        ("vector a[2] = {1, 2}; a[i][i] = 4; printf(\"%g\\n\", a);", "1 1 1 2 2 4", "7 is outside 0..2"),
        ("S s[2]; s[0].k[i] = 4; printf(\"%g %g\\n\", s[0].k, s[1].k);", "0 4 0 0", "7 is outside 0..1"),
    ];
    for (statements, expected, message) in cases {
        for index in ["7", "7 + (int)(u * 0)"] {
            for place in ["@", "if (u >= 0) { @ }"] {
                let body = place.replace('@', statements);
                let text = format!("{HEAD} surface s() {{ int i = {index}; {body} }}");
                let (mut printed, mut said) = (String::new(), Vec::new());
                for report in reports(&text) {
                    match report.kind {
                        ReportKind::Output => printed += &report.text,
                        ReportKind::Mistake(_) => said.push(report.text),
                        _ => panic!("{report:?}"),
                    }
                }
                assert_eq!(printed.trim(), expected, "{text}");
                assert!(said.iter().any(|text| text.contains(message)), "{said:?}\n{text}");
            }
        }
    }
}

#[test]
fn a_division_makes_the_infinite_zero_known_or_not() {
    for one in ["1", "1.0", "(1 + u * 0)"] {
        let text = format!(
            "surface s() {{ float x = 1e39 * (1 + u); printf(\"%g %g %g %g\\n\", x, x / {one}, x * x / {one}, 1 / x); }}"
        );
        assert_eq!(words(&text), "inf 0 0 0", "{one}");
    }
}

#[test]
fn a_space_to_itself_is_the_same_known_or_not() {
    for name in ["\"nowhere\"", "(u < 2 ? \"nowhere\" : \"elsewhere\")"] {
        let text = format!(
            "surface s() {{ matrix m = 3; string n = {name}; int f = getmatrix(n, n, m); printf(\"%d %g\\n\", f, m); }}"
        );
        assert_eq!(words(&text), "1 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "{name}");
    }
}
