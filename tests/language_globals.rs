//! A global is a variable like any other: with a local copy in its place, a shader prints the same and gives the same trees.

use velour::closure::print::tree_text;
use velour::compile::{Compiler, Shader};
use velour::exec::{Group, Machine, Points, ReportKind};

const LANES: usize = 9;

/// What stands in for a global in the statements below.
struct Stand {
    global: &'static str,
    ty: &'static str,
    /// A new value made of the old one, written `@`.
    step: &'static str,
    format: &'static str,
}

const WRITABLE: &[Stand] = &[
    Stand { global: "N", ty: "normal", step: "normalize(@ + normal(.5, 0, u))", format: "%g" },
    Stand { global: "P", ty: "point", step: "@ * 2 + vector(1, u, v)", format: "%g" },
    Stand { global: "I", ty: "vector", step: "@ * 3 - vector(v, 0, 1)", format: "%g" },
    Stand { global: "Ci", ty: "closure color", step: "u * @ + .5 * diffuse(N)", format: "%s" },
];

const READ_ONLY: &[Stand] = &[
    Stand { global: "Ng", ty: "normal", step: "", format: "%g" },
    Stand { global: "u", ty: "float", step: "", format: "%g" },
    Stand { global: "v", ty: "float", step: "", format: "%g" },
    Stand { global: "dPdu", ty: "vector", step: "", format: "%g" },
    Stand { global: "dPdv", ty: "vector", step: "", format: "%g" },
    Stand { global: "Ps", ty: "point", step: "", format: "%g" },
    Stand { global: "time", ty: "float", step: "", format: "%g" },
    Stand { global: "dtime", ty: "float", step: "", format: "%g" },
    Stand { global: "dPdtime", ty: "vector", step: "", format: "%g" },
];

/// Statements on a variable `@` of type `T`: `#` gives it its next value, `SHOW(x)` prints, `LEAF` adds a closure that depends on it.
const WRITES: &[&str] = &[
    "#; SHOW(@) #; SHOW(@)",
    "if (u > .3) { #; T k = @; #; SHOW(k) SHOW(@) LEAF }",
    "if (u > .3) { SHOW(@) } else { #; LEAF #; LEAF } SHOW(@)",
    "if (u > .3) { #; LEAF #; LEAF } else { #; SHOW(@) } #; LEAF SHOW(@)",
    "if (u > .3) #; LEAF",
    "if (time >= 0) { #; T k = @; #; SHOW(k) SHOW(@) LEAF }",
    "for (int i = 0; i < 3; ++i) { #; LEAF SHOW(@) } SHOW(@)",
    "for (int i = 0; i < 4; ++i) { if (i == 2 && u > .5) continue; #; LEAF if (v > .5) break; #; LEAF } SHOW(@)",
    "int i = 0; while (i < u * 4) { ++i; if (v > .3) { #; T k = @; #; SHOW(k) LEAF } } SHOW(@)",
    "int i = 0; do { #; SHOW(@) #; LEAF ++i; } while (i < u * 3); SHOW(@)",
    "for (int i = 0; i < 2; ++i) for (int j = 0; j < 2; ++j) { if (u > v) { #; LEAF } else { #; #; LEAF } } SHOW(@)",
    "if (u > .2) { if (v > .2) { #; T k = @; if (v > .5) { #; SHOW(k) } LEAF } #; LEAF } SHOW(@)",
    "void f() { if (u > .3) { #; return; } #; LEAF #; } f(); SHOW(@) f(); LEAF SHOW(@)",
    "void f() { if (u > .3) { #; return; } #; #; } if (v > .2) { f(); LEAF f(); } SHOW(@)",
    "T f(T x) { if (u > .3) return x; #; return @; } T a = f(@); SHOW(a) SHOW(@) if (v > .3) { a = f(a); #; } SHOW(a) SHOW(@)",
    "void g(output T x) { T k = x; #; SHOW(k) if (v > .5) return; x = k; } g(@); SHOW(@) if (u > .3) { g(@); #; LEAF } SHOW(@)",
    "void g(output T x, T y) { x = y; } T k = @; if (u > .3) { #; g(k, @); #; g(@, k); } SHOW(k) SHOW(@)",
    "T k = u > .3 ? (#) : @; SHOW(k) SHOW(@) k = v > .3 ? (#) : (#); SHOW(k) SHOW(@) LEAF",
    "int f() { #; return u > .5; } int a = v > .3 && f(); int b = v > .3 || f(); LEAF SHOW(@) if (f() && v < .7 && f()) { #; LEAF } SHOW(@)",
    "Q q; if (u > .3) { q.t = @; #; q.k[0] = @; #; q.k[1] = @; } else q.t = @; SHOW(q.t) SHOW(@) q.k[0] = @; if (v > .3) { #; @ = q.k[0]; } SHOW(@)",
    "T k[2]; for (int i = 0; i < 2; ++i) { k[i] = @; #; } SHOW(k[0]) SHOW(k[1]) if (u > .3) { @ = k[u > .6]; LEAF } SHOW(@)",
    "if (u > .3) { T a = (#, @); T b = @ = a; #; SHOW(a) SHOW(b) LEAF }",
];

/// The same for variables with components.
const COMPONENTS: &[&str] = &[
    "if (u > .3) { @[1] = 4; float a = @[1]; @[1] += u; float b = @[1]; SHOWF(a) SHOWF(b) LEAF }",
    "for (int i = 0; i < 3; ++i) { @[i] *= 2; LEAF @[2 - i] += u; } SHOW(@)",
    "void h(output float x) { if (u > .3) { x = 3; return; } x += 1; } if (v > .3) { h(@[0]); LEAF h(@[0]); } SHOW(@)",
    "float s = 0; if (u > .3) { sincos(u, @[0], s); LEAF sincos(v, s, @[0]); } SHOW(@) SHOWF(s)",
    "if (u > .3) { float x = @[0]++; float y = ++@[0]; SHOWF(x) SHOWF(y) LEAF }",
    "int found = 0; if (u > .3) { found = getattribute(\"there\", @[0]); T k = @; @ = @ + 1; SHOW(k) } SHOW(@)",
];

const READS: &[&str] = &[
    "if (u > .3) { T k = @; SHOW(k) SHOW(@) } SHOW(@)",
    "for (int i = 0; i < 2; ++i) { T k = @; if (v > .3) { SHOW(k) SHOW(@ + 1) } }",
    "T f(T x) { if (u > .3) return x * 2; return @; } SHOW(f(@)) if (v > .3) SHOW(f(@) * 2)",
    "T k = u > .3 ? @ * 2 : @; int a = u > .3 && high(@); SHOW(k) SHOW(@)",
];

fn points() -> Points {
    let mut points = Points::new(LANES);
    for lane in 0..LANES {
        let (x, y) = (lane as f32 / LANES as f32, (lane as f32 * 0.37).fract());
        (points.u[lane], points.v[lane]) = (x, y);
        (points.p.x[lane], points.p.y[lane], points.p.z[lane]) = (x, y, 1.0);
        (points.n.x[lane], points.n.z[lane], points.ng.z[lane]) = (x * 0.1, 1.0, 1.0);
        (points.i.x[lane], points.i.z[lane]) = (y, -1.0);
        (points.dpdu.x[lane], points.dpdv.y[lane]) = (1.0 + x, 2.0 + y);
        points.ray_type[lane] = 1;
    }
    points
}

/// The statements written out for a variable.
fn statements(text: &str, name: &str, stand: &Stand) -> String {
    let assignment = format!("@ = {}", stand.step);
    let leaf = match stand.ty {
        "closure color" => "@ += v * emission();",
        "float" => "Ci += @ * emission();",
        _ => "Ci += diffuse(normal(@));",
    };
    let mut out = text.replace("LEAF", leaf).replace('#', &assignment).replace('T', stand.ty);
    while let Some(at) = out.find("SHOW") {
        let float = out[at..].starts_with("SHOWF(");
        let open = at + if float { 5 } else { 4 };
        let mut depth = 0;
        let close = out[open..].find(|c| {
            depth += (c == '(') as i32 - (c == ')') as i32;
            depth == 0
        });
        let close = open + close.unwrap();
        let format = if float { "%g" } else { stand.format };
        let call = format!("printf(\"{format}\\n\", {});", &out[open + 1..close]);
        out.replace_range(at..=close, &call);
    }
    out.replace('@', name)
}

/// Everything one group prints, and its trees lane by lane.
fn said(group: &Group) -> Vec<String> {
    let mut machine = Machine::new();
    let tree = machine.shade(group, &points());
    let mut out: Vec<String> = (0..LANES).map(|lane| tree_text(group.table(), tree, lane)).collect();
    out.extend(machine.take_reports().into_iter().map(|report| match report.kind {
        ReportKind::Output => report.text,
        _ => panic!("{report:?}"),
    }));
    out
}

/// The ways to run a shader: optimised or not, alone or after a layer of the same text.
fn all_ways(shader: &Shader) -> Vec<Vec<String>> {
    let groups = [
        shader.group(),
        shader.group().unoptimized(),
        shader.group().layer("second", shader),
        shader.group().layer("second", shader).unoptimized(),
    ];
    groups.map(|builder| said(&builder.build().unwrap())).to_vec()
}

fn compare(texts: &[&str], stands: &[Stand]) {
    const HEAD: &str = "int high(float x) { return x > .5; } int high(vector x) { return x[0] > .5; }";
    for stand in stands {
        for text in texts {
            let body = |name| statements(text, name, stand);
            let Stand { global, ty, .. } = stand;
            let own = if *global == "Ci" { "Ci = own;" } else { "" };
            let head = format!("{HEAD} struct Q {{ {ty} t; {ty} k[2]; }};");
            let direct = format!("{head} surface s() {{ {} }}", body(global));
            let copied = format!("{head} surface s() {{ {ty} own = {global}; {} {own} }}", body("own"));
            let compile = |text: &str| Compiler::new().compile("g.osl", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
            let (a, b) = (all_ways(&compile(&direct)), all_ways(&compile(&copied)));
            assert!(a[0].iter().any(|line| !line.is_empty()), "nothing is seen of {direct}");
            for (way, (a, b)) in a.iter().zip(&b).enumerate() {
                assert_eq!(a, b, "way {way} of\n{direct}\n{copied}");
            }
            assert_eq!((&a[0], &a[2]), (&a[1], &a[3]), "optimised and not\n{direct}");
        }
    }
}

#[test]
fn a_global_that_is_written_is_as_a_local_copy() {
    compare(WRITES, WRITABLE);
    compare(COMPONENTS, &WRITABLE[..3]);
}

#[test]
fn a_global_that_is_read_is_as_a_local_copy() {
    compare(READS, READ_ONLY);
    compare(READS, &WRITABLE[..3]);
}

#[test]
fn a_global_first_touched_in_a_branch_keeps_the_values_taken_of_it() {
    let print = |text: &str| said(&Compiler::new().compile("g.osl", text).unwrap().group().build().unwrap());
    let normals =
        print("surface g() { if (u >= 0) { N = N*2; normal n = N; N = N*3; printf(\"%g %g\", n[2], N[2]); } }");
    assert_eq!(normals[LANES..], vec!["2 6"; LANES]);
    let trees =
        print("surface g() { for (int i = 0; i < 3; ++i) { N = N + normal(0, 1, 0); Ci += (i + 1) * diffuse(N); } }");
    assert!((1..4).all(|y| trees[0].contains(&format!("diffuse ((0, {y}, 1))"))), "{}", trees[0]);
}
