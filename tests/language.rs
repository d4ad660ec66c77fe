//! Shader text in, printed text out.

use velour::compile::Compiler;
use velour::exec::{Machine, Points, Report};

fn run(text: &str, lanes: usize) -> String {
    let shader = Compiler::new().compile("test.osl", text).unwrap_or_else(|e| panic!("{e}"));
    let group = shader.group().build().unwrap();
    let mut points = Points::new(lanes);
    for lane in 0..lanes {
        points.u[lane] = lane as f32 / lanes as f32;
        points.p.x[lane] = lane as f32;
        points.dudx[lane] = 0.5;
        points.n.z[lane] = 1.0;
    }
    let mut machine = Machine::new();
    machine.shade(&group, &points);
    machine
        .take_reports()
        .into_iter()
        .map(|r| match r {
            Report::Output(t) => t,
            other => format!("{other:?}\n"),
        })
        .collect()
}

#[test]
fn arithmetic() {
    assert_eq!(run("shader s() { float a = 2; a *= 3; printf(\"%g %d\\n\", a + 0.5, 7 / 2); }", 1), "6.5 3\n");
}

#[test]
fn control_flow() {
    let text = r#"
    float f(float x) { if (x > 0.4) return 10; return x; }
    shader s() {
        int n = 0; float sum = 0;
        for (int i = 0; i < 10; ++i) { if (i == 3) continue; if (u * 10 < i) break; sum += i; n++; }
        color c = color(u, 1, 2); c.y = f(u); c[2] = noise(P);
        float a[3] = {1, 2, 3}; a[n % 3] += 5;
        printf("%d %g %g %g\n", n, sum, c.y, a[1]);
        printf("%g\n", Dx(u * u));
        Ci = sheen(c * diffuse(N) + emission(), N, color(1), 0.4, "shadowing", "exact");
        if (u > 0.3) Ci += 0.5 * transparent();
        printf("%s\n", Ci);
    }"#;
    println!("{}", run(text, 4));
}
