//! What shaders ask and tell: messages, dictionaries, chance, rays, userdata, their own names; and in which order the layers of a group
//! run. Text in, prints out.

use std::sync::Arc;
use velour::compile::{Compiler, GroupBuilder};
use velour::exec::{AttributeAnswer, AttributeRequest, Host, Machine, Points, ReportKind, TraceRequest};
use velour::ir::lower::Lazy;

/// A host with userdata, a wall at x = 1, and a dictionary by name.
struct Somewhere;

impl Host for Somewhere {
    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        for &lane in answer.lanes() {
            if asked.name == "warm" && asked.points.u[lane] > 0.5 {
                answer.floats(lane, &[10.0 * asked.points.u[lane]]);
                answer.slopes(lane, &[3.0], &[4.0]);
            }
        }
    }

    fn trace(&self, asked: &TraceRequest<'_>) -> Vec<bool> {
        let meets = |ray: &[f32; 8]| {
            let t = (1.0 - ray[0]) / ray[3];
            t > ray[6] && t < ray[7]
        };
        asked.rays.iter().map(meets).collect()
    }

    fn message(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        if asked.object == "trace" && asked.name == "hitdist" {
            answer.lanes().iter().for_each(|&lane| answer.floats(lane, &[2.5]));
        }
    }

    fn read_text(&self, name: &str) -> Result<String, String> {
        let known = (name == "list.xml").then(|| "<list><a v='1'/><a v='2'/></list>".to_owned());
        known.ok_or_else(|| format!("there is no file `{name}`"))
    }
}

/// `len` points on a line: u and P.x are 0, .25, .5 and so on.
fn line(len: usize) -> Points {
    let mut points = Points::new(len);
    for lane in 0..len {
        points.u[lane] = 0.25 * lane as f32;
        points.p.set(lane, glam::Vec3::new(0.25 * lane as f32, 0.0, 0.0));
        points.n.set(lane, glam::Vec3::Z);
        points.ng.set(lane, glam::Vec3::Z);
        points.dpdx.set(lane, glam::Vec3::X);
        points.dpdy.set(lane, glam::Vec3::Y);
        points.dudx[lane] = 1.0;
    }
    points
}

/// What a group says at some points, each text and each mistake with a bar after it.
fn said(build: impl Fn(&Compiler, GroupBuilder) -> GroupBuilder, len: usize) -> String {
    let compiler = Compiler::new();
    let builder = build(&compiler, GroupBuilder::new(compiler.closures.clone()).group_name("Band"));
    let mut texts = Vec::new();
    for builder in [builder.clone(), builder.unoptimized()] {
        let group = builder.build().unwrap_or_else(|error| panic!("{error}"));
        let mut machine = Machine::with_host(Arc::new(Somewhere));
        machine.shade(&group, &line(len));
        let text = |report: velour::exec::Report| match report.kind {
            ReportKind::Output => format!("{}|", report.text.trim_end()),
            _ => format!("!{}|", report.text.trim_end()),
        };
        texts.push(machine.take_reports().into_iter().map(text).collect::<String>());
    }
    assert_eq!(texts[0], texts[1], "optimised and not");
    texts.swap_remove(0)
}

/// The same of one shader with this body.
fn body(text: &str, len: usize) -> String {
    let text = format!("surface s(float warm = 1 [[int lockgeom = 0]], string which = \"m\") {{ {text} }}");
    said(
        |compiler, builder| {
            builder.layer("only", &compiler.compile("s.osl", &text).unwrap_or_else(|error| panic!("{error}")))
        },
        len,
    )
}

/// The same of layers: names and texts, and connections `from.output to.input`.
fn layers(shaders: &[(&str, &str)], connections: &[(&str, &str)], lazy: Lazy, len: usize) -> String {
    let build = |compiler: &Compiler, builder: GroupBuilder| {
        let add = |builder: GroupBuilder, (name, text): &(&str, &str)| {
            builder.layer(name, &compiler.compile(&format!("{name}.osl"), text).unwrap())
        };
        let builder = shaders.iter().fold(builder.lazy(lazy), add);
        connections.iter().fold(builder, |builder, (from, to)| {
            builder.connect(from.split_once('.').unwrap(), to.split_once('.').unwrap())
        })
    };
    said(build, len)
}

#[test]
fn messages_are_kept_by_point_and_type() {
    for (text, says) in [
        (r#"setmessage("m", u); float x = 9; printf("%d %g", getmessage("m", x), x);"#, "1 0|1 0.25|1 0.5|"),
        (
            r#"if (u > .1) setmessage("m", u); float x = 9; printf("%d %g", getmessage("m", x), x);"#,
            "0 9|1 0.25|1 0.5|",
        ),
        (
            r#"setmessage(which, color(1,2,3)); color x = 0; printf("%d %g", getmessage("m", x), x);"#,
            "1 1 2 3|1 1 2 3|1 1 2 3|",
        ),
        (
            r#"int a[2] = {4, 5}; setmessage("m", a); int b[2]; getmessage("m", b); printf("%d %d", b[0], b[1]);"#,
            "4 5|4 5|4 5|",
        ),
        (r#"setmessage("m", "text"); string x; getmessage("m", x); printf("%s", x);"#, "text|text|text|"),
        (
            r#"setmessage("m", u * diffuse(N)); closure color c; getmessage("m", c); printf("%s", c);"#,
            "|(0.25, 0.25, 0.25) * diffuse ((0, 0, 1))|(0.5, 0.5, 0.5) * diffuse ((0, 0, 1))|",
        ),
        (
            r#"setmessage("m", 1); float x = 2; printf("%d %g", getmessage("m", x), x);"#,
            "!the message \"m\" is read as float and was made as int in s.osl:1:70|0 2|0 2|0 2|",
        ),
        (
            r#"setmessage("m", 1); setmessage("m", 2); int x; getmessage("m", x); printf("%d", x);"#,
            "!the message \"m\" is set already, in s.osl:1:70|1|1|1|",
        ),
        (
            r#"int x = 3; getmessage("m", x); setmessage("m", 1); printf("%d %d", getmessage("m", x), x);"#,
            "!the message \"m\" is set after it was asked for in s.osl:1:81|0 3|0 3|0 3|",
        ),
        (
            r#"for (int i = 0; i < 2000; i++) setmessage(format("m%d", i), i); printf("not reached");"#,
            "!a batch has more than 1,024 messages of different names or types, or more than 65,536 numbers in them|",
        ),
        (r#"float d = 0; printf("%d %g", getmessage("trace", "hitdist", d), d);"#, "1 2.5|1 2.5|1 2.5|"),
    ] {
        assert_eq!(body(text, 3), says, "{text}");
    }
}

#[test]
fn messages_go_from_layer_to_layer() {
    let first = r#"shader a(output float out = 0) { setmessage("from", "a"); out = 1; }"#;
    let last = r#"surface b(float in = 0) { float x = in; string s; getmessage("from", s); printf("%s", s); }"#;
    assert_eq!(layers(&[("a", first), ("b", last)], &[("a.out", "b.in")], Lazy::default(), 1), "a|");
}

#[test]
fn dictionaries_are_searched_by_path() {
    let xml = r#"string d = "<a><b n='1 2 3' s='x y'>in</b><b n='4 5 6'/></a>";"#;
    for (text, says) in [
        (r#"color c = 0; int k = dict_find(d, "//b"); printf("%d %g", dict_value(k, "n", c), c);"#, "1 1 2 3|"),
        (r#"string s; int k = dict_find(d, "/a/b[1]"); dict_value(k, "s", s); printf("%s", s);"#, "x y|"),
        (r#"string s; dict_value(dict_find(d, "//b"), "", s); printf("%s", s);"#, "in|"),
        (r#"int k = dict_find(d, "//b"), n = 0; while (k > 0) { n++; k = dict_next(k); } printf("%d", n);"#, "2|"),
        (r#"int n[3]; dict_value(dict_next(dict_find(d, "//b")), "n", n); printf("%d", n[2]);"#, "6|"),
        (r#"int k = dict_find(dict_find(d, "/a"), "b"); printf("%d", k > 0);"#, "1|"),
        (r#"printf("%d %d", dict_find(d, "//c"), dict_find("list.xml", "//a") > 0);"#, "0 1|"),
        (r#"float f = 7; printf("%d %g", dict_value(dict_find(d, "//b"), "none", f), f);"#, "0 7|"),
    ] {
        assert_eq!(body(&format!("{xml} {text}"), 1), says, "{text}");
    }
    let many =
        body(r#"int k = 1; for (int i = 0; i < 20000; i++) k = dict_find("<a><b/></a>", "//b"); printf("%d", k);"#, 1);
    assert_eq!(many, "!a point holds more than 10000 nodes of dictionaries|0|");
    let many = body(
        r#"int k = 1; for (int i = 0; i < 3000; i++) k = dict_find(format("<a%d/>", i), "*"); printf("%d", k);"#,
        1,
    );
    assert_eq!(many, "!a batch reads more than 1024 dictionaries|-1|");
    let wrong = body(r#"printf("%d", dict_find("<a>", "//a"));"#, 1);
    assert!(wrong.starts_with("!this is no dictionary: ") && wrong.ends_with("|-1|"), "{wrong}");
    let missing = body(r#"printf("%d", dict_find("none.xml", "//a"));"#, 1);
    assert!(missing.starts_with("!there is no file `none.xml`") && missing.ends_with("|-1|"), "{missing}");
    let unread = body(r#"int k = dict_find("<a/>", "//[["); printf("%d", k);"#, 1);
    assert!(unread.starts_with("!`//[[` is no path: ") && unread.ends_with("|0|"), "{unread}");
}

#[test]
fn chance_is_of_the_place_and_the_turn() {
    let draw = "for (int i = 0; i < 3; i++) printf(\"%g,\", random()); color c = random(); printf(\"%g\", c);";
    let (three, one) = (body(draw, 3), body(draw, 1));
    assert!(three.starts_with(&one), "the width of a batch changes nothing: {three} {one}");
    let numbers: Vec<f32> = three.split([',', '|', ' ']).filter_map(|n| n.parse().ok()).collect();
    assert!(numbers.len() == 18 && numbers.iter().all(|x| (0.0..1.0).contains(x)), "{three}");
    assert!(numbers.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn rays_are_the_hosts() {
    let text = r#"printf("%d %d", trace(P, vector(1,0,0)), trace(P, vector(1,0,0), "maxdist", .6));"#;
    assert_eq!(body(text, 3), "1 0|1 0|1 1|");
}

#[test]
fn userdata_goes_before_values_where_there_is_any() {
    assert_eq!(body(r#"printf("%g %g", warm, Dx(warm));"#, 4), "1 0|1 0|1 0|7.5 3|");
    let locked = "surface s(float warm = 1) { printf(\"%g\", warm); }";
    let build = |hint: Option<bool>| {
        said(
            |compiler, builder| {
                let builder = builder.layer("l", &compiler.compile("s.osl", locked).unwrap());
                hint.iter().fold(builder, |builder, &hint| builder.interpolate("warm", hint))
            },
            4,
        )
    };
    assert_eq!((build(None).as_str(), build(Some(true)).as_str()), ("1|1|1|1|", "1|1|1|7.5|"));
}

#[test]
fn formats_may_be_computed() {
    assert_eq!(body(r#"string f = u > .1 ? "%g" : "<%g>"; printf(f, u);"#, 2), "<0>|0.25|");
    assert_eq!(body(r#"string f = concat("%", "s!"); printf("%s", format(f, "a"));"#, 1), "a!|");
    let wrong = body(r#"string f = concat(which, " %d %d"); printf(f, 1);"#, 1);
    assert!(wrong.starts_with("!the arguments do not fit this computed format|"), "{wrong}");
}

#[test]
fn a_closure_output_counts_where_nothing_is_said_of_ci() {
    let text = |shader: &str| {
        let compiler = Compiler::new();
        let group = compiler.compile("s.osl", shader).unwrap().group().build().unwrap();
        let mut machine = Machine::new();
        let tree = machine.shade(&group, &line(1));
        velour::closure::print::tree_text(group.table(), tree, 0)
    };
    let diffuse = "(0.5, 0.5, 0.5) * diffuse ((0, 0, 1))";
    assert_eq!(text("shader s(output closure color BSDF = 0) { BSDF = .5 * diffuse(N); }"), diffuse);
    assert_eq!(text("shader s(output closure color BSDF = 0) { BSDF = .5 * diffuse(N); Ci = 0; }"), "");
    assert_eq!(text("shader s(output closure color A = 0, output closure color B = 0) { A = .5 * diffuse(N); }"), "");
}

#[test]
fn odd_calls_of_the_library_mean_what_they_mean_in_osl() {
    for (text, says) in [
        (r#"printf("%g %g %g", distance({0,0,0}, {1,2,2}), length({1,2,2}), dot({1,2,3}, {1,1,1}));"#, "3 3 6|"),
        (
            r#"printf("%g", normalize({3,0,4})); color c = mix({0,0,0}, {1,1,1}, .5); printf("%g", c);"#,
            "0.6 0 0.8|0.5 0.5 0.5|",
        ),
        (r#"printf("%d %d", regex_search("aa", "(a)\\1"), regex_search("foobar", "foo(?=bar)"));"#, "1 1|"),
        (r#"string r[3]; printf("%d", split("", r, ","));"#, "0|"),
        (
            r#"printf("%v %n %p %c", P, N, P, color(1));"#,
            "0.000000 0.000000 0.000000 0.000000 0.000000 1.000000 0.000000 0.000000 0.000000 1.000000 1.000000 1.000000|",
        ),
        ("if (u < 1) color k = 3; else k = 4; printf(\"%g\", k);", "3 3 3|"),
        (
            "void h(output vector x) { x *= 2; } h(vector(1) + 1); float f(float x) { x *= 2; return x; } float y = 3; printf(\"%g %g\", f(y), y);",
            "6 3|",
        ),
    ] {
        assert_eq!(body(text, 1), says, "{text}");
    }
    let wrong = body(r#"printf("%d", regex_search("aa", "(a"));"#, 1);
    assert!(wrong.starts_with("!\"(a\" is no pattern: ") && wrong.ends_with("|0|"), "{wrong}");
}

#[test]
fn shaders_know_their_names() {
    let text = r#"string a, b, c; getattribute("shader:shadername", a); getattribute("shader:layername", b);
        getattribute("shader:groupname", c); printf("%s %s %s", a, b, c);"#;
    assert_eq!(body(text, 1), "s only Band|");
}

#[test]
fn bumps_turn_the_normal_and_displacement_moves_the_point() {
    // The height rises by .5 a pixel along x, which is one unit: the normal leans by atan(.5).
    for (text, says) in [
        ("bump(.5 * u); printf(\"%.3f\", N);", "-0.447 0.000 0.894|"),
        ("displace(.5 * u + 1); printf(\"%.3f %.3f\", N, P);", "-0.447 0.000 0.894 0.000 0.000 1.000|"),
        ("bump(vector(0, 0, .5 * u)); printf(\"%.3f\", N);", "-0.447 0.000 0.894|"),
        ("if (u < .1) bump(\"world\", .5 * u); printf(\"%.3f\", N);", "-0.447 0.000 0.894|"),
        // A normal that is not the geometric one turns as much and is not replaced.
        ("N = normalize(normal(0, 1, 1)); bump(.5 * u); printf(\"%d\", N[1] > .5 && N[0] < -.3);", "1|"),
        ("bump(1); printf(\"%g\", N);", "0 0 1|"),
    ] {
        assert_eq!(body(text, 1), says, "{text}");
    }
}

const READER: &str = "surface b(float in = 0) { printf(\"b\"); float x = in; printf(\"%g\", x); }";
const GIVER: &str = "shader a(output float out = 0) { printf(\"a\"); out = 7; }";

#[test]
fn layers_run_when_they_are_first_read_or_never() {
    let (one, all) = (Lazy::default(), Lazy { layers: false, ..Lazy::default() });
    let ab = [("a", GIVER), ("b", READER)];
    assert_eq!(layers(&ab, &[("a.out", "b.in")], one, 1), "b|a|7|");
    assert_eq!(layers(&ab, &[("a.out", "b.in")], all, 1), "a|b|7|");
    assert_eq!(layers(&ab, &[], one, 1), "b|0|", "what feeds nobody never runs");
    assert_eq!(layers(&ab, &[], Lazy { unconnected: false, ..one }, 1), "a|b|0|");
    let unread = "surface b(float in = 0) { printf(\"b\"); }";
    assert_eq!(layers(&[("a", GIVER), ("b", unread)], &[("a.out", "b.in")], one, 1), "b|");
    // Read in a branch alone: only the points that come there run it.
    let branch = "surface b(float in = 0) { printf(\"b\"); if (u > .2) printf(\"%g\", in); }";
    assert_eq!(layers(&[("a", GIVER), ("b", branch)], &[("a.out", "b.in")], one, 2), "b|b|a|7|");
    // Read in two places of which lanes may miss the first: it runs right before that statement.
    let twice = "surface b(float in = 0) { printf(\"b\"); if (u > .2) printf(\"%g\", in); printf(\"%g\", in); }";
    assert_eq!(layers(&[("a", GIVER), ("b", twice)], &[("a.out", "b.in")], one, 2), "b|a|7|b|a|7|7|");
    // In a loop, in a function, beside a return: right values, once.
    for text in [
        "surface b(float in = 0) { float s = 0; for (int i = 0; i < 3; i++) s += in; printf(\"%g\", s); }",
        "surface b(float in = 0) { float f() { return in; } printf(\"%g\", f() + f() + f()); }",
        "surface b(float in = 0) { if (u > 2) return; printf(\"%g\", in * 3); }",
    ] {
        assert_eq!(layers(&[("a", GIVER), ("b", text)], &[("a.out", "b.in")], one, 1), "a|21|", "{text}");
    }
    // A chain: the middle runs when it is read, and the first when the middle reads it.
    let middle = "shader m(float in = 0, output float out = 0) { printf(\"m\"); out = in + 1; }";
    let chain = [("a", GIVER), ("m", middle), ("b", READER)];
    assert_eq!(layers(&chain, &[("a.out", "m.in"), ("m.out", "b.in")], one, 1), "b|m|a|8|");
}

#[test]
fn globals_are_shared_by_the_layers_that_run() {
    let giver = "shader a(output float out = 0) { N = normal(0, 1, 0); P = P + 1; out = 7; }";
    let reader =
        "surface b(float in = 0) { printf(\"%g\", N); float x = in; printf(\"%g %g\", N, P); Ci = diffuse(N); }";
    assert_eq!(layers(&[("a", giver), ("b", reader)], &[("a.out", "b.in")], Lazy::default(), 1), "0 0 1|0 1 0 1 1 1|");
    let lonely = layers(&[("a", giver), ("b", reader)], &[], Lazy::default(), 1);
    assert_eq!(lonely, "0 0 1|0 0 1 0 0 0|");
    let globals = Lazy { globals: false, ..Lazy::default() };
    assert_eq!(layers(&[("a", giver), ("b", reader)], &[], globals, 1), "0 1 0|0 1 0 1 1 1|");
}

/// Where a fed parameter is read is looked for as deep as expressions go, on the stack of a thread.
#[test]
fn what_feeds_a_long_expression_is_found() {
    let sum = " + in".repeat(20_000);
    let reader = format!("surface b(float in = 0) {{ float x = 0{sum}; printf(\"%g\", x); }}");
    let said = layers(&[("a", GIVER), ("b", &reader)], &[("a.out", "b.in")], Lazy::default(), 1);
    assert_eq!(said, "a|140000|");
}

#[test]
fn a_parameter_may_refuse_to_be_fed() {
    let compiler = Compiler::new();
    let giver = compiler.compile("a.osl", GIVER).unwrap();
    let reader = compiler.compile("b.osl", "surface b(float in = 0 [[int allowconnect = 0]]) {}").unwrap();
    let builder = GroupBuilder::new(compiler.closures.clone()).layer("a", &giver).layer("b", &reader);
    let error = builder.connect(("a", "out"), ("b", "in")).build().unwrap_err();
    assert_eq!(error.problem.code(), "G0305");
}
