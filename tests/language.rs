//! Shader text in, printed text out: one line a case.

use velour::closure::print::tree_text;
use velour::compile::Compiler;
use velour::exec::{Machine, Points, Report, ReportKind};

/// Four points along u = 0, 1/4, 1/2, 3/4 with P = (u, v, 1); x moves u by 1, y moves v by 1.
fn points(lanes: usize) -> Points {
    let mut points = Points::new(lanes);
    for lane in 0..lanes {
        points.u[lane] = lane as f32 / 4.0;
        points.p.x[lane] = points.u[lane];
        points.p.z[lane] = 1.0;
        points.dudx[lane] = 1.0;
        points.dvdy[lane] = 1.0;
        points.dpdx.x[lane] = 1.0;
        points.dpdy.y[lane] = 1.0;
        points.n.z[lane] = 1.0;
        points.ng.z[lane] = 1.0;
        points.ray_type[lane] = 1;
    }
    points
}

/// What a whole text prints over so many points.
fn run(text: &str, lanes: usize) -> String {
    let shader = Compiler::new().compile("test.osl", text).unwrap_or_else(|e| panic!("{e}"));
    let group = shader.group().build().unwrap();
    let mut machine = Machine::new();
    machine.shade(&group, &points(lanes));
    let say = |report: Report| match report.kind {
        ReportKind::Output => report.text,
        ReportKind::Mistake(_) => format!("Mistake {:?}\n", Report { kind: report.kind.clone(), ..report }.to_string()),
        kind => format!("{kind:?} {:?}\n", Report { kind: kind.clone(), ..report }.to_string()),
    };
    machine.take_reports().into_iter().map(say).collect()
}

/// Runs statements, one point, and compares what they print.
#[track_caller]
fn cases(list: &[(&str, &str)]) {
    for (statements, expected) in list {
        assert_eq!(run(&format!("shader s() {{ {statements} }}"), 1), *expected, "{statements}");
    }
}

/// Runs statements over four points.
#[track_caller]
fn varying(list: &[(&str, &str)]) {
    for (statements, expected) in list {
        assert_eq!(run(&format!("shader s() {{ {statements} }}"), 4), *expected, "{statements}");
    }
}

/// Runs functions before a shader whose body follows.
#[track_caller]
fn with(before: &str, statements: &str, lanes: usize, expected: &str) {
    assert_eq!(run(&format!("{before} shader s() {{ {statements} }}"), lanes), expected, "{before} {statements}");
}

#[test]
fn arithmetic() {
    cases(&[
        (r#"float a = 2; a *= 3; printf("%g %d", a + 0.5, 7 / 2);"#, "6.5 3"),
        (r#"printf("%d %d %d %d", 7 % 3, -7 / 2, -7 % 3, 1 / 0);"#, "1 -3 -1 0"),
        (r#"printf("%g %g", 1.0 / 0.0, color(1, 2, 3) / 0);"#, "0 0 0 0"),
        (r#"printf("%d %d %d %d %d", 6 & 3, 6 | 3, 6 ^ 3, ~6, 1 << 4 >> 1);"#, "2 7 5 -7 8"),
        (r#"int i = 3; float f = 2; printf("%g %g %g", i * f, i / f, f - i);"#, "6 1.5 -1"),
        (
            r#"int i = 7; i += 2; i -= 1; i *= 3; i /= 5; i <<= 3; i >>= 1; i |= 1; i &= 29; i ^= 3; printf("%d", i);"#,
            "18",
        ),
        (r#"int i = 2147483647; i++; printf("%d %d", i, -i);"#, "-2147483648 -2147483648"),
        (r#"printf("%d %d %d", 5 < 3, 2.5 >= 2, color(1) == color(1, 1, 1));"#, "0 1 1"),
        (r#"printf("%d %d %d", "a" == "a", "a" != "b", !"");"#, "1 1 1"),
        (r#"printf("%g", -color(1, -2, 3) * 2 + 1);"#, "-1 5 -5"),
        (r#"printf("%g", 2 - vector(1, 2, 3));"#, "1 0 -1"),
        (r#"int i = 5; i *= 0.5; printf("%d", i);"#, "2"),
    ]);
}

#[test]
fn increments_and_assignments_have_values() {
    cases(&[
        (r#"int i = 1; int a = i++; int b = ++i; printf("%d %d %d", a, b, i);"#, "1 3 3"),
        (r#"int i = 1; int a = i--; int b = --i; printf("%d %d %d", a, b, i);"#, "1 -1 -1"),
        (r#"float f = 1.5; printf("%g %g", f++, f);"#, "1.5 2.5"),
        (r#"int a, b, c; a = b = c = 4; printf("%d %d %d", a, b, c);"#, "4 4 4"),
        (r#"int i = 1; int j = (i = 5) + i; printf("%d", j);"#, "10"),
        (r#"int i = 1; int j = i + (i = 5); printf("%d", j);"#, "10"),
        (r#"color c = color(1, 2, 3); c[1]++; c.b += 2; c[0] *= 4; printf("%g", c);"#, "4 3 5"),
        (r#"vector c = vector(1, 2, 3); c = vector(c.z, c.x, c.y); printf("%g", c);"#, "3 1 2"),
        (r#"int a[3] = {1, 2, 3}; int i = 0; a[i++] += 10; printf("%d %d %d, %d", a[0], a[1], a[2], i);"#, "11 2 3, 1"),
        (r#"int i = (1, 2, 3); printf("%d", i);"#, "3"),
    ]);
}

#[test]
fn variables_without_initialiser_are_zero() {
    cases(&[
        (r#"int i; float f; color c; string s; printf("%d %g %g <%s>", i, f, c, s);"#, "0 0 0 0 0 <>"),
        (r#"float a[2]; matrix m; printf("%g %g | %g", a[0], a[1], m);"#, "0 0 | 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"),
        (r#"closure color c; printf("<%s>", c);"#, "<>"),
        (r#"for (int i = 0; i < 2; ++i) { int k; k += 5; printf("%d ", k); }"#, "5 5 "),
    ]);
}

#[test]
fn conditions() {
    cases(&[
        (r#"int k = 0; if (0 && (k = 1)) k = 9; printf("%d", k);"#, "0"),
        (r#"int k = 0; if (1 || (k = 1)) k += 2; printf("%d", k);"#, "2"),
        (r#"int k = 0; int r = not 0 and (k = 4) or 0; printf("%d %d", k, r);"#, "4 1"),
        (r#"int k = 0; int r = 1 ? (k = 3) : (k = 4); printf("%d %d", k, r);"#, "3 3"),
        (
            r#"if (color(0, 0, 1)) printf("color "); if ("") printf("string "); if (0.5) printf("float");"#,
            "color float",
        ),
        (r#"closure color c = diffuse(N); if (c) printf("some "); c = 0; if (!c) printf("none");"#, "some none"),
    ]);
    varying(&[
        (r#"int k = 0; if (u > 0.3 && (k = 1)) k += 4; printf("%d ", k);"#, "0 0 5 5 "),
        (r#"int k = 0; int r = u > 0.3 || (k = 7); printf("%d%d ", k, r);"#, "71 71 01 01 "),
        (r#"int k = 0; int r = u > 0.3 ? (k = 3) : (k = 4); printf("%d%d ", k, r);"#, "44 44 33 33 "),
        (r#"float f = u > 0.3 ? 1 : color(u, 2, 3)[0]; printf("%g ", f);"#, "0 0.25 1 1 "),
        (r#"closure color c = u * diffuse(N); printf("%d ", !c);"#, "1 0 0 0 "),
        (r#"closure color c = 0; if (u > 0.3) c = emission(); printf("%d ", !c);"#, "1 1 0 0 "),
    ]);
}

#[test]
fn loops() {
    cases(&[
        (
            r#"int s = 0; for (int i = 0; i < 10; ++i) { if (i == 3) continue; if (i == 6) break; s += i; } printf("%d", s);"#,
            "12",
        ),
        (r#"int i = 0; do { if (i == 1) continue; } while (++i < 4); printf("%d", i);"#, "4"),
        (r#"int i = 5; while (i) { i--; if (i == 2) break; } printf("%d", i);"#, "2"),
        (r#"int i, j; for (i = 0, j = 9; i < j; i++, j--); printf("%d %d", i, j);"#, "5 4"),
        (
            r#"int n = 0; for (int i = 0; i < 3; ++i) for (int j = 0; j < 3; ++j) { if (j > i) break; n += 1; } printf("%d", n);"#,
            "6",
        ),
        (r#"for (;;) { printf("once"); break; }"#, "once"),
    ]);
    varying(&[
        (r#"int n = 0; while (n < u * 8) n++; printf("%d ", n);"#, "0 2 4 6 "),
        (
            r#"int n = 0; for (int i = 0; i < 6; ++i) { if (i > u * 8) break; if (i % 2) continue; n += i; } printf("%d ", n);"#,
            "0 2 6 6 ",
        ),
        (r#"int n = 0; do { n++; if (u > 0.6) break; } while (n < 3); printf("%d ", n);"#, "3 3 3 1 "),
        (r#"int n = 0; do { n++; if (u > 0.6) continue; n++; } while (n < 3); printf("%d ", n);"#, "4 4 4 3 "),
    ]);
}

#[test]
fn functions() {
    with("float f(float x) { if (x > 0.4) return 10; return x; }", r#"printf("%g ", f(u));"#, 4, "0 0.25 10 10 ");
    with(
        "int f(int x) { return 1; } int f(float x) { return 2; } int f(color x) { return 3; }",
        r#"printf("%d%d%d%d", f(1), f(1.0), f(color(1)), f(P));"#,
        1,
        "1233",
    );
    with(
        "int f() { return 1; } float f() { return 2.5; }",
        r#"int i = (int)f(); float x = (float)f(); printf("%d %g", i, x);"#,
        1,
        "1 2.5",
    );
    with(
        "void f(output float x, output float y) { x += 1; y += 10; }",
        r#"float a = 1, b = 2; f(a, b); printf("%g %g", a, b);"#,
        1,
        "2 12",
    );
    with(
        "void f(output float x) { x = 5; }",
        r#"float a[3] = {1, 2, 3}; f(a[1]); color c = 0; f(c[2]); printf("%g %g %g, %g", a[0], a[1], a[2], c);"#,
        1,
        "1 5 3, 0 0 5",
    );
    with(
        "void f(float a[], output float s) { s = 0; for (int i = 0; i < arraylength(a); ++i) s += a[i]; }",
        r#"float x[4] = {1, 2, 3, 4}; float s; f(x, s); printf("%g", s);"#,
        1,
        "10",
    );
    with(
        "void fill(output float a[]) { for (int i = 0; i < arraylength(a); ++i) a[i] = i * u; }",
        r#"float x[3]; fill(x); printf("%g ", x[2]);"#,
        4,
        "0 0.5 1 1.5 ",
    );
    with(
        "int depth(int n) { for (int i = 0; i < 5; ++i) { for (int j = 0; j < 5; ++j) { if (i * j > n) { return 10 * i + j; } } } return -1; }",
        r#"printf("%d ", depth((int)(u * 16)));"#,
        4,
        "11 23 33 44 ",
    );
    with(
        "float g() { return u; } float f() { float h(float k) { return k + g(); } return h(1); }",
        r#"printf("%g ", f());"#,
        4,
        "1 1.25 1.5 1.75 ",
    );
    with("point abs(point p) { return abs(p) + 1; }", r#"printf("%g", abs(point(-1, 2, 0)));"#, 1, "2 3 1");
    with(
        "int later(int x); int first(int x) { return later(x) + 1; } int later(int x) { return 2 * x; }",
        r#"printf("%d", first(5));"#,
        1,
        "11",
    );
    with(
        "void f(output int n) { n++; if (n > 1) return; n += 10; }",
        r#"int n = u > 0.3; f(n); printf("%d ", n);"#,
        4,
        "11 11 2 2 ",
    );
    with("", r#"if (u > 0.3) return; printf("%g ", u);"#, 4, "0 0.25 ");
    with("void stop() { if (u > 0.3) exit(); }", r#"stop(); printf("%g ", u);"#, 4, "0 0.25 ");
}

#[test]
fn structs_and_arrays() {
    let pair = "struct V { int x; int y; }; struct W { float f; V v; int a[3]; V q[2]; }; string t(V v) { return format(\"{%d %d}\", v.x, v.y); } V add(V a, V b) { V r; r.x = a.x + b.x; r.y = a.y + b.y; return r; }";
    with(
        pair,
        r#"V a = {1, 2}; V b = V(3, 4); V c = add(a, b); a.x = 9; printf("%s%s%s", t(a), t(b), t(c));"#,
        1,
        "{9 2}{3 4}{4 6}",
    );
    with(
        pair,
        r#"W r; r.v.x = 1; r.q[0] = add(r.v, r.v); r.q[1] = add(r.q[0], r.q[0]); W s = r; r.q[0].x = 7; printf("%s%s%s%s", t(s.q[0]), t(s.q[1]), t(r.q[0]), t(r.q[1]));"#,
        1,
        "{2 0}{4 0}{7 0}{4 0}",
    );
    with(
        pair,
        r#"W r; int i = u > 0.3; r.q[i].y = 5; r.a[i + 1] = 3; printf("%d%d%d%d ", r.q[0].y, r.q[1].y, r.a[1], r.a[2]);"#,
        4,
        "5030 5030 0503 0503 ",
    );
    with(
        pair,
        r#"V l[3]; for (int i = 0; i < 3; ++i) { l[i].x = i; l[i].y = i * i; } V m[3]; m = l; l[2].x = 9; printf("%s%s", t(m[2]), t(l[2]));"#,
        1,
        "{2 4}{9 4}",
    );
    with(
        "struct S { float a; color c; }; S __operator__add__(S x, S y) { return S(x.a + y.a, x.c + y.c); } S __operator__mul__(float k, S y) { return S(k * y.a, k * y.c); }",
        r#"S a = {1, color(1)}; S b = 2 * a + a; printf("%g %g", b.a, b.c);"#,
        1,
        "3 3 3 3",
    );
    cases(&[
        (r#"float a[] = {1, 2, 3}; printf("%d %g", arraylength(a), a[2]);"#, "3 3"),
        (r#"float a[3] = {1, 2, 3}; float b[3]; b = a; a[0] = 9; printf("%g %g", a[0], b[0]);"#, "9 1"),
        (r#"int a[3] = {7, 8, 9}; int b[2] = {1, 2}; a = b; printf("%d %d %d", a[0], a[1], a[2]);"#, "1 2 9"),
        (r#"color a[2] = {color(1), color(2)}; a[1][2] = 5; printf("%g|%g", a[0], a[1]);"#, "1 1 1|2 2 5"),
        (r#"matrix m = 1; m[1][2] = 5; m[3][0] += 2; printf("%g", m);"#, "1 0 0 0 0 1 5 0 0 0 1 0 2 0 0 1"),
        (r#"int a[2] = {1, 2}; printf("%d", a);"#, "1 2"),
        (
            r#"closure color c[2]; c[1] = diffuse(N); printf("<%s><%s>", c[0], c[1]);"#,
            "<><(1, 1, 1) * diffuse ((0, 0, 1))>",
        ),
    ]);
    varying(&[
        (r#"int a[4] = {3, 2, 1, 0}; int i = (int)(u * 4); a[a[i]] += 10; printf("%d ", a[3 - i]);"#, "10 11 12 13 "),
        (
            r#"color c = color(1, 2, 3); int i = (int)(u * 4) % 3; c[i] = 9; printf("%g,%g ", c[0], c[2 - i]);"#,
            "9,3 1,9 1,1 9,3 ",
        ),
        (r#"closure color c[2]; int i = u > 0.3; c[i] = emission(); printf("%d%d ", !c[0], !c[1]);"#, "01 01 10 10 "),
    ]);
}

#[test]
fn indices_outside_are_reported_and_clamped() {
    cases(&[
        (
            r#"int a[3] = {1, 2, 3}; int i = 5; printf("%d\n", a[i + (int)u]);"#,
            "Mistake \"test.osl:1:62: error: index 5 is outside 0..2\"\n3\n",
        ),
        (
            r#"int a[3] = {1, 2, 3}; a[-1 - (int)u] = 7; printf("%d\n", a[0]);"#,
            "Mistake \"test.osl:1:36: error: index -1 is outside 0..2\"\n7\n",
        ),
    ]);
}

#[test]
fn derivatives() {
    cases(&[
        (r#"float f = u * u + v; printf("%g %g", Dx(f), Dy(f));"#, "0 1"),
        (r#"vector a = P * 2; printf("%g|%g", Dx(a), Dy(a));"#, "2 0 0|0 2 0"),
        (r#"float a[2]; a[1] = 3 * u; printf("%g", Dx(a[1]));"#, "3"),
    ]);
    varying(&[
        (r#"float f = u * u; printf("%g ", Dx(f));"#, "0 0.5 1 1.5 "),
        (r#"float f = 0; if (u > 0.3) f = 3 * u; printf("%g ", Dx(f));"#, "0 0 3 3 "),
        (r#"float f = u; for (int i = 0; i < 3; ++i) f *= 2; printf("%g ", Dx(f));"#, "8 8 8 8 "),
        (r#"float f = u > 0.3 ? u : 2 * u; printf("%g ", Dx(f));"#, "2 2 1 1 "),
        (
            r#"float x = u; float t = 0; for (int i = 0; i < 2; ++i) { t = x + 1; x = 5 * x; } printf("%g ", Dx(t));"#,
            "5 5 5 5 ",
        ),
        (r#"float f = max(u, 1 - u); printf("%g ", Dx(f));"#, "-1 -1 -1 1 "),
        (r#"float k[4] = {0, 1, 4, 9}; printf("%g ", Dx(spline("linear", u, k)));"#, "3 3 3 3 "),
        (
            r#"color c = transformc("hsv", color(u + 0.1, 0.5, 0.2)); printf("%d ", Dx(c)[0] != 0 || Dx(c)[1] != 0);"#,
            "1 1 1 1 ",
        ),
    ]);
    with(
        "float f(float x) { if (x > 0.3) return x * x; return 3 * x; }",
        r#"printf("%g ", Dx(f(u)));"#,
        4,
        "3 3 1 1.5 ",
    );
    with("void f(output float x) { x *= u; }", r#"float x = u; f(x); printf("%g ", Dx(x));"#, 4, "0 0.5 1 1.5 ");
    with(
        "struct S { float a; float b[2]; };",
        r#"S s; s.a = u; s.b[1] = s.a * s.a; S t = s; printf("%g%g ", Dx(t.a), Dx(t.b[1]));"#,
        4,
        "10 10.5 11 11.5 ",
    );
}

#[test]
fn noise_by_name() {
    cases(&[
        (
            r#"printf("%d", noise("perlin", P) == snoise(P) && noise("uperlin", P) == noise(P) && noise("cell", P) == cellnoise(P));"#,
            "1",
        ),
        (
            r#"printf("%d %d", pnoise("cell", 0.5, 2.0) == pnoise("cell", 2.5, 2.0), pnoise(0.25, 4.0) == pnoise(4.25, 4.0));"#,
            "1 1",
        ),
    ]);
    varying(&[(
        r#"string k = "cell"; if (u > 0.3) k = "perlin"; printf("%d ", noise(k, 3 * P) == (u > 0.3 ? snoise(3 * P) : cellnoise(3 * P)));"#,
        "1 1 1 1 ",
    )]);
    with(
        "",
        r#"string k = "ce"; if (u > 9) k = "perlin"; float x = noise(concat(k, "lx"), P); printf("%g\n", x);"#,
        1,
        "Mistake \"test.osl:1:67: error: there is no noise \\\"celx\\\"\"\n0\n",
    );
}

#[test]
fn strings() {
    cases(&[
        (
            r#"printf("%s", concat("a", "b", "c")); printf(" %d %s", strlen("four"), substr("hello", -3, 2));"#,
            "abc 4 ll",
        ),
        (r#"string p[3]; int n = split("a b c d", p, "", 2); printf("%d %s|%s", n, p[0], p[1]);"#, "2 a|b c d"),
        (r#"printf("%d %g %d", stoi("42x"), stof("2.5e1"), hash("Hello World!"));"#, "42 25 -16050688"),
        (r#"printf("%5.2f|%-4d|%04x|%%", 3.14159, 7, 255);"#, " 3.14|7   |00ff|%"),
        (r#"int r[4]; printf("%d %d %d", regex_search("foobar.baz", r, "(o+)b"), r[2], r[3]);"#, "1 1 3"),
        (
            r#"fprintf("out.txt", "%d\n", 3); warning("w %d", 1); error("e");"#,
            "File(\"out.txt\") \"out.txt: 3\\n\"\nWarning \"test.osl:1:45: w 1\"\nError \"test.osl:1:65: e\"\n",
        ),
    ]);
}

#[test]
fn closures_as_text() {
    cases(&[
        (
            r#"Ci = 0.5 * diffuse(N) + emission(); printf("%s", Ci);"#,
            "(0.5, 0.5, 0.5) * diffuse ((0, 0, 1))\n\t+ (1, 1, 1) * emission ()",
        ),
        (
            r#"Ci = sheen(color(1, 0, 0) * diffuse(N), N, color(1), 0.4, "shadowing", "exact"); printf("%s", Ci);"#,
            "(1, 1, 1) * sheen ((1, 0, 0) * diffuse ((0, 0, 1)), (0, 0, 1), (1, 1, 1), 0.4, \"shadowing\", \"exact\")",
        ),
        (
            r#"Ci = mix(diffuse(N), emission(), 0.25); printf("%s", Ci);"#,
            "(0.75, 0.75, 0.75) * diffuse ((0, 0, 1))\n\t+ (0.25, 0.25, 0.25) * emission ()",
        ),
        (r#"Ci = -diffuse(N) * 0 + transparent(); printf("%s", Ci);"#, "(1, 1, 1) * transparent ()"),
    ]);
    varying(&[(
        r#"closure color c = diffuse(N); if (u > 0.3) c += u * emission(); if (u > 0.6) c = 0; printf("%s\n", c);"#,
        "(1, 1, 1) * diffuse ((0, 0, 1))\n(1, 1, 1) * diffuse ((0, 0, 1))\n(1, 1, 1) * diffuse ((0, 0, 1))\n\t+ (0.5, 0.5, 0.5) * emission ()\n\n",
    )]);
}

#[test]
fn parameters_and_layers() {
    let compiler = Compiler::new();
    let first = compiler
        .compile(
            "a.osl",
            "shader a(float k = 2, output float x = 0, output float l[2] = {1, 2}) { x = k * u; l[1] = k; }",
        )
        .unwrap();
    let second = compiler
        .compile("b.osl", "shader b(float x = 9, float l[] = {}, float y = x + 1, color c = x) { printf(\"%g %g %g %d %d%d \", x, y, c, arraylength(l), isconnected(x), isconnected(y)); }")
        .unwrap();
    let shade = |group: &velour::exec::Group| {
        let mut machine = Machine::new();
        machine.shade(group, &points(2));
        machine.take_reports().into_iter().map(|r| format!("{:?}({:?})", r.kind, r.text)).collect::<String>()
    };
    let builder = || velour::compile::GroupBuilder::new(compiler.closures.clone());
    let group = builder().layer("a", &first).param("k", &[8.0]).layer("b", &second);
    let group = group.connect(("a", "x"), ("b", "x")).connect(("a", "l"), ("b", "l")).build().unwrap();
    assert_eq!(shade(&group), "Output(\"0 1 0 0 0 2 10 \")Output(\"2 3 2 2 2 2 10 \")");
    let group = builder().layer("b", &second).param("l", &[1.0, 2.0, 3.0]).param("x", &[4.0]).build().unwrap();
    assert_eq!(shade(&group), "Output(\"4 5 4 4 4 3 00 \")Output(\"4 5 4 4 4 3 00 \")");
    assert!(builder().layer("b", &second).param("nosuch", &[4.0]).build().is_err());
    assert!(builder().layer("b", &second).strings("x", &["a"]).build().is_err());
}

#[test]
fn closures_of_one_batch_do_not_reach_the_next() {
    let text = "surface s() {
        if (v > 0.5) { Ci = diffuse(N); for (int i = 0; i < 20; ++i) Ci += 0.1 * diffuse(N); Ci = 0; }
        if (fmod(u * 64, 2) > 1) { closure color a[2] = {0.5 * diffuse(N), 0.5 * diffuse(N)}; Ci = a[0] + a[1]; }
    }";
    let shader = Compiler::new().compile("test.osl", text).unwrap();
    let group = shader.group().build().unwrap();
    let mut machine = Machine::new();
    for v in [1.0, 0.0] {
        let mut points = Points::new(4);
        points.v.fill(v);
        points.u = vec![0.0, 1.5 / 64.0, 0.0, 1.5 / 64.0];
        let tree = machine.shade(&group, &points);
        assert!(tree.root.is_none_or(|root| (root.0 as usize) < tree.nodes.len()));
        let texts: Vec<bool> = (0..4).map(|lane| tree_text(group.table(), tree, lane).is_empty()).collect();
        assert_eq!(texts, [true, false, true, false]);
    }
}

#[test]
fn the_number_of_knots_may_vary() {
    let text = "shader s() {
        float k[8] = {0, 1, 2, 3, 9, 9, 9, 9};
        int n = 4 + (int)(u * 0.1);
        printf(\"%g %g\\n\", spline(\"linear\", 0.5, n, k), spline(\"linear\", 0.5, 4, k));
    }";
    let shader = Compiler::new().compile("test.osl", text).unwrap();
    let group = shader.group().build().unwrap();
    let mut machine = Machine::new();
    machine.shade(&group, &Points::new(1));
    let [report] = &machine.take_reports()[..] else { panic!("one line is printed") };
    assert_eq!((&report.kind, report.text.as_str()), (&ReportKind::Output, "1.5 1.5\n"));
}

#[test]
fn deep_nesting_is_checked_once() {
    let deep = |open: &str, seed: &str, close: &str| format!("{}{seed}{}", open.repeat(60), close.repeat(60));
    let calls = deep("f(noise(", "0", "))");
    run(&format!("color f(color c) {{ return c; }} shader s() {{ color c = {calls}; }}"), 1);
    let updates = deep("a[(", "a[0] += 1", ")] += 1");
    run(&format!("shader s() {{ int a[2] = {{0, 0}}; {updates}; }}"), 1);
    let places = deep("a[(", "a[0][0] += 1", ") > 0][0] += 1");
    run(&format!("shader s() {{ vector a[2] = {{0, 0}}; {places}; }}"), 1);
    // The overload of an argument is still the one whose type is wanted.
    with(
        "void g(color c) { color d = cellnoise(0.5, 0.0); printf(\"%d %d\", c == d, c[0] == c[1]); }",
        "g(cellnoise(0.5, 0)); vector v[2] = {1, 2}; v[1][1] += 2; printf(\" %g\", v[1]);",
        1,
        "1 0 2 4 2",
    );
}
