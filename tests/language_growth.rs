//! Four times the text takes about four times as long to compile, whatever it is made of: no pass is quadratic.

use std::time::Instant;
use velour::compile::Compiler;

/// Lines of the shorter text.
const LINES: usize = 1_500;

/// What the longer text may take of the shorter one's time. Linear is 4, quadratic 16; the rest is noise of busy machines.
const MOST: f64 = 10.0;

fn seconds(text: &str) -> f64 {
    let compiler = Compiler::new();
    let once = || {
        let start = Instant::now();
        let shader = compiler.compile("growth.osl", text).unwrap_or_else(|e| panic!("{e}"));
        let group = shader.group().build().unwrap();
        assert!(group.program().result.is_some());
        start.elapsed().as_secs_f64()
    };
    (0..3).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// A line for each number up to `n`.
fn lines(n: usize, line: impl Fn(usize) -> String) -> String {
    (0..n).map(|i| line(i) + "\n").collect()
}

fn surface(body: &str) -> String {
    format!("surface s() {{ float x = u; float y = v; {body} }}")
}

/// Texts of so many lines, each with a name.
fn texts(n: usize) -> Vec<(&'static str, String)> {
    let declared = lines(n, |i| format!("float x{i} = u;"));
    vec![
        ("branches that nobody reads", surface(&lines(n, |i| format!("if (u > {i}) y += {i};")))),
        (
            "branches that hang on each other",
            surface(&lines(n, |i| format!("if (y > {i}) y = u * {i}.5; else x = y;"))),
        ),
        ("branches that are read", surface(&(lines(n, |i| format!("if (y > {i}) y += u;")) + "Ci = y * diffuse(N);"))),
        (
            "a loop that hands values up",
            surface(&format!(
                "{declared} for (int i = 0; i < 3; ++i) {{ {} }} Ci = x0 * diffuse(N);",
                lines(n - 1, |i| format!("x{i} = x{};", i + 1))
            )),
        ),
        (
            "a loop that hands values down",
            surface(&format!(
                "{declared} while (x0 < 3) {{ {} x0 += 1; }} Ci = Dx(x{}) * diffuse(N);",
                lines(n - 1, |i| format!("x{} = x{} + u;", n - 1 - i, n - 2 - i)),
                n - 1
            )),
        ),
        ("a sum", surface(&format!("Ci = ({}0) * diffuse(N);", lines(n, |i| format!("u * {i} +"))))),
        ("a sum of side effects", surface(&format!("Ci = ({}0) * diffuse(N);", lines(n, |_| "x++ +".to_owned())))),
        ("derivatives", surface(&(lines(n, |_| "x = x * u + sin(y); y = x;".to_owned()) + "Ci = Dx(x) * diffuse(N);"))),
        (
            "calls",
            format!(
                "float f(float a, output float b) {{ if (a > b) return a; b += a; return b * 2; }} {}",
                surface(&(lines(n, |_| "x = f(x, y);".to_owned()) + "Ci = x * diffuse(N);"))
            ),
        ),
        (
            "functions that call each other",
            format!(
                "float f0(float a) {{ return a; }} {} {}",
                lines(n, |i| format!("float f{}(float a) {{ float b = a + u0(); return f{i}(b); }}", i + 1))
                    .replace("u0()", "1"),
                surface(&format!("Ci = f{n}(u) * diffuse(N);"))
            ),
        ),
        (
            "elements",
            surface(&format!(
                "float a[8]; {} Ci = a[1] * diffuse(N);",
                lines(n, |i| format!("a[(int)x] = a[{}] + u;", i % 8))
            )),
        ),
        (
            "components",
            surface(&(lines(n, |i| format!("P[{}] += N[(int)(u * 3)];", i % 3)) + "Ci = diffuse(normal(P));")),
        ),
        ("closures", surface(&lines(n, |i| format!("Ci += {i} * diffuse(N);")))),
        ("closures in branches", surface(&lines(n, |i| format!("if (u > {i}) Ci += {i} * diffuse(N);")))),
        ("prints", surface(&lines(n, |_| "printf(\"%g\\n\", x);".to_owned()))),
        ("early ends", surface(&(lines(n, |i| format!("if (u > {i}) return; y += v;")) + "Ci = y * diffuse(N);"))),
    ]
}

#[test]
fn four_times_the_text_takes_four_times_as_long() {
    let (short, long) = (texts(LINES), texts(4 * LINES));
    let mut slow = Vec::new();
    for ((name, short), (_, long)) in short.iter().zip(&long) {
        // A burst of other work spoils a measurement, but not three.
        let ratio = || seconds(long) / seconds(short);
        let best = (0..3).map(|_| ratio()).find(|&ratio| ratio < MOST);
        println!("{name}: {best:?}");
        if best.is_none() {
            slow.push(*name);
        }
    }
    assert!(slow.is_empty(), "more than {MOST} times as long: {slow:?}");
}
