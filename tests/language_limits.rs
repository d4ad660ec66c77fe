//! Shaders that are endless, huge, deep or garbage: always an answer, never a crash and never a long wait.

use std::time::Instant;
use velour::closure::print::tree_text;
use velour::compile::{Compiler, compile};
use velour::exec::{Machine, Points, Report, ReportKind};

fn reports(text: &str) -> Vec<Report> {
    let shader = Compiler::new().compile("limit.osl", text).unwrap_or_else(|e| panic!("{e}"));
    let group = shader.group().keep_outputs().build().unwrap();
    let mut points = Points::new(16);
    (0..16).for_each(|lane| points.u[lane] = lane as f32 / 16.0);
    let mut machine = Machine::new();
    machine.budget = 100_000;
    machine.shade(&group, &points);
    machine.take_reports()
}

#[test]
fn endless_loops_end_in_one_report_with_a_place() {
    let bodies = [
        "while (1) {}",
        "for (;;);",
        "for (;;) { x += 1; }",
        "while (u < 2) {}",
        "while (u < 2) { if (u > 0.5) x += 1; }",
        "do { x = u; } while (x >= 0);",
        "for (int i = 0; i < 10; ++i) { while (1) { if (u > 0.5) continue; } }",
        "if (u > 0.3) while (u > 0.2) x = sin(x);",
        "f(x);",
    ];
    for body in bodies {
        let text = format!(
            "void f(output float y) {{ for (;;) {{ y += 1; if (y < 0) return; }} }}\nshader s(output float x = 0) {{\n{body}\nprintf(\"not here\"); while (1) {{}} }}"
        );
        let reports = reports(&text);
        assert_eq!(reports.iter().filter(|r| r.is_fatal()).count(), 1, "{body}: {reports:?}");
        let Some(last) = reports.last().filter(|r| r.is_fatal()) else { panic!("{body}: {reports:?}") };
        let message = last.to_string();
        let line = if body == "f(x);" { 1 } else { 3 };
        assert!(message.starts_with(&format!("limit.osl:{line}:")), "{body}: {message}");
        let printed = reports.iter().any(|r| r.kind == ReportKind::Output);
        assert!(!printed || body.starts_with("if"), "{body}: {reports:?}");
    }
}

#[test]
fn a_machine_goes_on_after_a_fatal_batch() {
    let compiler = Compiler::new();
    let make = |text| compiler.compile("a.osl", text).unwrap().group().build().unwrap();
    let (endless, fine) =
        (make("shader s() { while (u >= 0) {} }"), make("shader s() { if (u < 1) printf(\"%g \", u); }"));
    let mut machine = Machine::new();
    machine.budget = 10_000;
    machine.shade(&endless, &Points::new(3));
    assert_eq!(machine.take_reports().len(), 1);
    machine.shade(&fine, &Points::new(3));
    assert_eq!(machine.take_reports().len(), 3);
}

#[test]
fn deep_and_long_texts() {
    let sum = (0..20_000).map(|_| "u").collect::<Vec<_>>().join(" + ");
    assert!(reports(&format!("shader s(output float x = 0) {{ x = {sum}; }}")).is_empty());
    let sum = (0..12_000).map(|_| "x++").collect::<Vec<_>>().join(" + ");
    assert!(reports(&format!("shader s(output float x = 0) {{ float y = {sum}; if (y > 0) x = y; }}")).is_empty());
    let both = (0..5_000).map(|_| "f(u)").collect::<Vec<_>>().join(" && ");
    assert!(
        reports(&format!("float f(float x) {{ return x; }} shader s(output int x = 0) {{ x = {both}; }}")).is_empty()
    );
    let nested = format!("{}x{}", "abs(".repeat(250), ")".repeat(250));
    assert!(reports(&format!("shader s(output float x = 0) {{ x = {nested}; }}")).is_empty());
    let choice = (0..990).map(|i| format!("if (u > {i}) x += 1; else ")).collect::<String>();
    assert!(reports(&format!("shader s(output float x = 0) {{ {choice} x = 2; }}")).is_empty());
}

#[test]
fn three_thousand_statements_compile_quickly() {
    let kinds = [
        "x = x * u + 0.5;",
        "if (x > 1) y += x; else y = v;",
        "a[(int)x] = noise(P * x);",
        "y = f(y, x);",
        "c = c * x + color(u, v, y);",
    ];
    let body: String = (0..3_000).map(|i| format!("{}\n", kinds[i % kinds.len()])).collect();
    let text = format!(
        "float f(float a, float b) {{ if (a > b) return a; return b * 2; }} shader s(output float x = 0, output color c = 0) {{ float y = 1; float a[4]; {body} }}"
    );
    let text = text.replace("c = c * x + color(u, v, y);", "c = c * x + Dx(y);");
    let start = Instant::now();
    let shader = Compiler::new().compile("long.osl", &text).unwrap();
    shader.group().keep_outputs().build().unwrap();
    let seconds = start.elapsed().as_secs_f64();
    // Generous: tests run unoptimised on busy machines. A quadratic step takes minutes here.
    assert!(seconds < 10.0, "{seconds} s");
}

#[test]
fn extreme_numbers() {
    let text = "shader s(output int x = 0) {
        int low = -2147483648 + (int)(0 * u); int minus = -1 + (int)(0 * u);
        printf(\"%d %d %d %d %d \", low / minus, low % minus, 1 << 40 + x, low >> 99 + x, abs(low));
        float big = 3e38 * (1 + u); float nan = sqrt(-1 - u) + log(-u) + pow(-1 - u, 0.5) + (big - big) * big;
        printf(\"%d %d \", (int)(big * 10), (int)(-big * 10));
        float k[4] = {0, 1, 2, 3}; int at = (int)(big * 10);
        k[at] = nan; k[low] = big; printf(\"%g \", spline(\"linear\", big * 10, k) * 0);
        color c = noise(color(big, -big, nan)) + cellnoise(P * big) + snoise(big * 100); c[at] = c[low];
        printf(\"%s\", substr(\"abc\", low, at)); Ci = sheen(diffuse(N * big), N, c * big, nan); }";
    assert!(reports(text).iter().any(|r| r.kind == ReportKind::Output));
}

#[test]
fn garbage_is_a_message() {
    let compiler = Compiler::new();
    let mut state = 12345u32;
    for length in [0, 1, 10, 100, 1000, 5000] {
        let bytes: Vec<u8> = (0..length)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect();
        let checked = compiler.check_bytes("garbage.osl", &bytes);
        assert!(checked.shader.is_none() && checked.diagnostics.has_errors());
        let text: Vec<u8> =
            bytes.iter().map(|b| b" shader(){};=+-*/.,intfoa\"0123[]<>&|?:\n"[*b as usize % 39]).collect();
        assert!(compiler.check_bytes("noise.osl", &text).diagnostics.has_errors());
    }
}

/// The text of a closure in the first lane, and its length.
fn closure_of(body: &str) -> String {
    let shader = compile(&format!("surface s() {{ {body} }}")).unwrap();
    let group = shader.group().build().unwrap();
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &Points::new(2));
    tree_text(group.table(), tree, 0)
}

/// A closure that is added to itself again and again is a small tree with a text beyond all disks.
#[test]
fn the_text_of_a_closure_ends() {
    let doubled = "Ci = diffuse(N); for (int i = 0; i < 60; ++i) Ci = Ci + Ci;";
    let text = closure_of(doubled);
    assert_eq!(text.matches("diffuse").count(), 256);
    assert!(text.ends_with(&format!("\n\t+ ... and {} more", (1u64 << 60) - 256)), "{}", &text[text.len() - 80..]);
    // More terms than can be counted, nested ones, and ones that are nothing.
    assert!(closure_of(&doubled.replace("60", "90")).ends_with(&format!("... and {} more", u64::MAX)));
    let nested = closure_of("Ci = diffuse(N); for (int i = 0; i < 40; ++i) Ci = layer(Ci, Ci);");
    assert!(nested.len() < 1 << 20 && nested.contains("... and "), "{}", nested.len());
    assert_eq!(closure_of("Ci = 0 * diffuse(N); for (int i = 0; i < 60; ++i) Ci = Ci + u * Ci;"), "");
    // As many as there is room for are all written.
    let whole = closure_of(&doubled.replace("60", "8"));
    assert!(whole.matches("diffuse").count() == 256 && !whole.contains("more"));
}
