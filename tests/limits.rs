//! Small inputs that would exhaust a machine, each in a process with a gigabyte of addresses and ten seconds of processor: one clear message, status
//! 1 or 2, nothing written. And what a sandbox, a bound of memory and a time promise.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

/// What the process may have: kilobytes of addresses and seconds of processor.
const LIMITS: &str = "ulimit -v 1048576; ulimit -t 10; ulimit -c 0; exec \"$0\" \"$@\"";

/// A folder for one test.
struct Place(tempfile::TempDir);

/// What a run has come to.
struct Ran {
    status: Option<i32>,
    out: String,
    err: String,
    seconds: f64,
}

impl Place {
    fn new() -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        place.file("ok.osl", "surface ok() { Ci = 0.5 * diffuse(N); }");
        place
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.at(name), text).unwrap();
    }

    /// Writes a surface shader and a scene of one sphere that has it.
    fn surface(&self, name: &str, body: &str) {
        self.file(&format!("{name}.osl"), format!("surface {name}() {{ {body} }}\n"));
        self.scene(name, &format!("shader {name} l;"), SPHERE);
    }

    fn scene(&self, name: &str, group: &str, body: &str) {
        let camera = "<Camera eye=\"0,0,5\" dir=\"0,0,-1\" fov=\"50\"/>";
        let text = format!("<World>{camera}<ShaderGroup>{group}</ShaderGroup>{body}</World>");
        self.file(&format!("{name}.xml"), text);
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    fn run(&self, args: &[&str]) -> Ran {
        let start = Instant::now();
        let mut command = Command::new("sh");
        command.args(["-c", LIMITS, env!("CARGO_BIN_EXE_velour")]).args(args).current_dir(self.0.path());
        let Output { status, stdout, stderr } = command.stdin(std::process::Stdio::null()).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        let seconds = start.elapsed().as_secs_f64();
        Ran { status: status.code(), out: text(stdout), err: text(stderr), seconds }
    }

    fn render(&self, name: &str) -> Ran {
        self.run(&["render", &format!("{name}.xml"), "-o", "o.png", "-r", "24", "24", "--spp", "1", "-t", "1"])
    }

    /// Renders a surface, which must be refused with these words and leave nothing.
    fn refused(&self, name: &str, body: &str, says: &str) {
        self.surface(name, body);
        self.refuses(name, &self.render(name), says);
    }

    fn refuses(&self, what: &str, ran: &Ran, says: &str) {
        let Ran { status, err, .. } = ran;
        assert!(matches!(status, Some(1 | 2)), "{what}: {status:?}: {err:.400}");
        assert!(err.contains(says) && err.contains("error"), "{what}: {err:.400}");
        assert!(err.len() < 40_000 && !err.contains("panicked"), "{what}: {} bytes: {err:.400}", err.len());
        let left: Vec<String> = self.names().into_iter().filter(|n| n == "o.png" || n.ends_with(".part")).collect();
        assert!(left.is_empty(), "{what}: {left:?}");
    }

    fn done(&self, what: &str, ran: &Ran) {
        assert_eq!(ran.status, Some(0), "{what}: {:.400}", ran.err);
        let _ = fs::remove_file(self.at("o.png"));
    }
}

const SPHERE: &str = "<Sphere center=\"0,0,0\" radius=\"1\"/>";

#[test]
fn strings_and_prints_are_bounded() {
    let place = Place::new();
    let strings = "strings of a batch are longer than 64 MB";
    let double = "string s = \"x\"; for (int i = 0; i < 40; i++)";
    place.refused("f1a", &format!("{double} s = concat(s, s); Ci = strlen(s) * diffuse(N);"), strings);
    let grow = "string s = \"x\"; for (int i = 0; i < 100000; i++) s = concat(s, format(\"%g\", u * i));";
    place.refused("f1b", &format!("{grow} Ci = strlen(s) * diffuse(N);"), strings);
    place.refused("f1c", &format!("{double} s = format(\"%s%s\", s, s); Ci = strlen(s) * diffuse(N);"), strings);
    place.refused("f3a", "for (int i = 0; i < 1000000; i++) printf(\"%d %g\\n\", i, u); Ci = diffuse(N);", "error: ");
    let long = "string s = \"x\"; for (int i = 0; i < 16; i++) s = concat(s, s);";
    place.refused(
        "f3b",
        &format!("{long} for (int i = 0; i < 1000000; i++) error(\"%s%d\", s, i); Ci = diffuse(N);"),
        "error: ",
    );
    let outside = "float a[3] = {1, 2, 3}; for (int i = 0; i < 10000000; i++) a[i] = u; Ci = a[1] * diffuse(N);";
    place.refused("f3c", outside, "error: ");
    for command in [vec!["verify", "f3a.osl", "--quick"], vec!["shade", "-g", "32", "32", "f3a"]] {
        place.refuses("f3 elsewhere", &place.run(&command), "error: ");
    }
    // A flood that ends is told of in part.
    place.surface("flood", "for (int i = 0; i < 20; i++) printf(\"%d %g %g\\n\", i, u, v); Ci = diffuse(N);");
    let ran = place.render("flood");
    place.done("flood", &ran);
    assert!(ran.out.lines().count() <= 1000 && ran.err.contains("and more, which are left out"), "{}", ran.err);
    place.surface("sum", "Ci = diffuse(N); for (int i = 0; i < 40; i++) Ci = Ci + Ci;");
    let tree = place.run(&["tree", "sum.osl"]);
    assert!(tree.status == Some(0) && tree.out.len() < 100_000, "{}", tree.out.len());
}

#[test]
fn arrays_and_structs_are_bounded() {
    let place = Place::new();
    let nested = "struct A { matrix m[1000]; }; struct B { A a[1000]; }; struct C { B b[1000]; };";
    place.file("f2a.osl", format!("{nested} surface f2a() {{ C c; Ci = c.b[1].a[2].m[0][0][0] * diffuse(N); }}"));
    place.scene("f2a", "shader f2a l;", SPHERE);
    place.refuses("f2a", &place.render("f2a"), "has more numbers than the 262144");
    let many: String =
        (0..100).map(|i| format!("matrix a{i}[16384]; a{i}[int(u * 100)] = u; x += a{i}[int(v)][0][0]; ")).collect();
    place.refused("f2b", &format!("float x = 0; {many} Ci = x * diffuse(N);"), "arrays have more than 262144 numbers");
    let (mut deep, mut inner) = (String::new(), "float".to_owned());
    for level in 0..30 {
        deep += &format!("struct S{level} {{ {inner} a; {inner} b; }}; ");
        inner = format!("S{level}");
    }
    place.file("f2c.osl", format!("{deep} surface f2c() {{ S29 s; Ci = diffuse(N); }}"));
    place.refuses("f2c", &place.run(&["check", "f2c.osl"]), "has more numbers than the 262144");
    let copies: String = (0..200).map(|_| "b = a; a = b; ").collect();
    place.refused(
        "f2d",
        &format!("float a[16384]; float b[16384]; a[int(u)] = v; {copies} Ci = b[int(u)] * diffuse(N);"),
        "more than 1048576 instructions",
    );
}

#[test]
fn loops_of_costly_functions_end() {
    let place = Place::new();
    let loops = [
        ("x = pow(abs(x) + .1, 1.1) * .9 + .1 * noise(P * x);", "float x = u; while (x > -1)"),
        ("x = abs(noise(\"simplex\", P * x));", "float x = u; while (x > -1)"),
        ("x = abs(noise(\"gabor\", P * x));", "float x = u; while (x > -1)"),
        ("x = strlen(format(\"%4000.4000f\", u));", "float x = 1; while (x > 0)"),
        ("x = abs(sin(x) + cos(x * x) + exp(-x));", "float x = u; while (x > -1)"),
        ("{ float k[5] = {0, 1, 2, u, 4}; x = abs(splineinverse(\"linear\", x, k)); }", "float x = u; while (x > -1)"),
        ("x = abs(transformc(\"hsv\", \"rgb\", color(x, u, v))[0]);", "float x = u; while (x > -1)"),
        ("x = regex_search(format(\"%0200d\", int(u * 9)), \"(0*)*(0*)*x\");", "float x = 0; while (x > -1)"),
    ];
    for (k, (body, head)) in loops.into_iter().enumerate() {
        place.refused(&format!("f7_{k}"), &format!("{head} {body} Ci = x * diffuse(N);"), "error: ");
    }
    for shader in ["f7_0.osl", "f7_3.osl"] {
        place.refuses("verify", &place.run(&["verify", shader, "--quick"]), "error: ");
    }
}

#[test]
fn closures_are_bounded() {
    let place = Place::new();
    place.refused(
        "f5",
        "Ci = diffuse(N); for (int i = 0; i < 20; i++) Ci = layer(Ci, Ci);",
        "lobes, or layers over them",
    );
    // What fits is done in linear time, and the rest is refused.
    let bent = "Ci = diffuse(N); for (int i = 0; i < 8000; i++) Ci = sheen(Ci, normalize(N + .1 * vector(u, v, i * 1e-4)), color(1), .3);";
    place.surface("e9a", bent);
    place.done("e9a", &place.render("e9a"));
    place.refused("e9f", &bent.replace("8000", "40000"), "batch");
    let sum = "closure color k = diffuse(N); for (int i = 0; i < 14; i++) k = layer(k, k + u * diffuse(N)); Ci = k;";
    place.refused("e9b", sum, "lobes, or layers over them");
    place.refused(
        "e9c",
        "for (int i = 0; i < 100000; i++) Ci += u * i * diffuse(normalize(N + u));",
        "closures of a batch",
    );
    let layers = "for (int i = 0; i < 1600; i++) c = layer(sheen_bsdf(N, color(1), .3), c + .001 * diffuse(normalize(N + .1 * vector(u * i, v, u))));";
    let many = layers.replace("1600", "8000");
    place.refused("e9d", &format!("closure color c = diffuse(N); {many} Ci = c;"), "batch");
    let half = layers.replace("1600", "400");
    place.surface("e9e", &format!("closure color c = diffuse(N); {half} Ci = c;"));
    place.done("e9e", &place.render("e9e"));
    place.file(
        "f9.xml",
        format!("<World><Camera eye=\"0,0,0\" dir=\"0,0,-1\"/><Option max_bounces=\"int 4000000000\" rr_depth=\"int 4000000000\"/><ShaderGroup>shader white l;</ShaderGroup>{SPHERE}</World>"),
    );
    place.file("white.osl", "surface white() { Ci = diffuse(N); }");
    let ran = place.run(&["render", "f9.xml", "-o", "o.png", "-r", "4", "4", "--spp", "1", "-t", "1"]);
    place.done("f9", &ran);
}

#[test]
fn scenes_are_bounded() {
    let place = Place::new();
    place.scene("f4a", &format!("{} shader ok l;", "matrix[16777216] x 1; ".repeat(100)), SPHERE);
    place.refuses("f4a", &place.render("f4a"), "no array length");
    place.scene("f4b", &format!("{} shader ok l;", "float[262144] x 1; ".repeat(100)), SPHERE);
    place.refuses("f4b", &place.render("f4b"), "more than 16777216 values");
    let flakes = "<Flakes low=\"-1,-1,-1\" high=\"1,1,1\" count=\"8000000\" size=\".02\"/>";
    place.scene("f4c", "shader ok l;", &flakes.repeat(20));
    place.refuses("f4c", &place.render("f4c"), "40000000 are the most");
    place.scene("f4d", "shader ok l;", &flakes.repeat(4));
    let args = ["render", "f4d.xml", "-o", "o.png", "-r", "8", "8", "--memory", "200M"];
    place.refuses("f4d", &place.run(&args), "more memory than --memory gives it, 200 MB");
    let spheres: String = (0..40_000).map(|i| format!("<Sphere center=\"{},0,0\" radius=\".01\"/>", i % 200)).collect();
    place.scene("f8a", "shader ok l;", &spheres);
    place.done("f8a", &place.render("f8a"));
    // Shaders that are in the binary, in a folder with others that are looked through.
    let groups: String =
        (0..4000).map(|i| format!("<ShaderGroup name=\"g{i}\">shader matte l;</ShaderGroup>")).collect();
    place.scene("f8b", "shader ok l;", &format!("{groups}{SPHERE}"));
    place.done("f8b", &place.render("f8b"));
    let attributes: String = (0..40_000).map(|i| format!("a{i}=\"1\" ")).collect();
    place.scene("f8c", "shader ok l;", &format!("<Sphere {attributes}/>"));
    place.refuses("f8c", &place.render("f8c"), "more than 1024 attributes");
    place.file("nodes.xml", format!("<World>{}</World>", "<a/>".repeat(5_000_000)));
    place.refuses("nodes", &place.render("nodes"), "nodes limit");
    // A spiral has a face that no corner can be cut from for long.
    let spiral = |k: usize, out: f64| {
        let (turn, r) = (k as f64 * 0.05, 1.0 + k as f64 * 1e-3 + out);
        format!("v {} {} 0\n", r * turn.cos(), r * turn.sin())
    };
    let corners: String = (0..5000).map(|k| spiral(k, 0.0)).chain((0..5000).rev().map(|k| spiral(k, 0.005))).collect();
    let face: String = (1..=10_000).map(|k| format!(" {k}")).collect();
    place.file("spiral.obj", format!("{corners}f{face}\nf{face}\nf{face}\n"));
    place.scene("spiral", "shader ok l;", "<Model filename=\"spiral.obj\"/>");
    let ran = place.render("spiral");
    place.done("spiral", &ran);
    assert!(ran.err.contains("too many corners to be cut well"), "{}", ran.err);
    place.file("deep.xml", format!("<World>{}{}</World>", "<a>".repeat(200_000), "</a>".repeat(200_000)));
    place.refuses("deep", &place.render("deep"), "unknown tag <a>");
    place.scene("value", "shader ok l;", &format!("<Sphere center=\"{}x\" radius=\"1\"/>", "1".repeat(3_000_000)));
    place.refuses("value", &place.render("value"), "bytes more");
}

#[test]
fn messages_are_bounded() {
    let place = Place::new();
    place.file("f10a.osl", "@ ".repeat(1_000_000));
    place.refuses("f10a", &place.run(&["check", "f10a.osl"]), "more messages");
    let names: String = (0..100_000).map(|i| format!("x{i} = y{i};\n")).collect();
    place.file("f10b.osl", format!("surface f10b() {{ {names} }}"));
    place.refuses("f10b", &place.run(&["check", "f10b.osl"]), "more messages");
    place.refuses("f10b", &place.run(&["check", "f10b.osl", "--message-format", "json"]), "more messages");
    place.file("self.osl", "#include \"self.osl\"\n#include \"self.osl\"\nsurface s() {}\n");
    place.refuses("self", &place.run(&["check", "self.osl"]), "nested more than 64 deep");
    place.surface("esc", "printf(\"a\\033[31mred\\007\\x1b]0;title\\007\\n\"); Ci = diffuse(N);");
    place.file("esc2.osl", "surface esc2() { Ci = \u{1b}[2J \u{9b}x \u{202e}diffuse(N); }");
    let runs = [place.run(&["shade", "esc"]), place.render("esc"), place.run(&["check", "esc2.osl"])];
    for ran in runs {
        let odd = |c: char| c.is_control() && c != '\n' && c != '\t' || c == '\u{202e}';
        assert!(!ran.out.contains(odd) && !ran.err.contains(odd), "{}{}", ran.out, ran.err);
    }
}

#[test]
fn only_regular_files_are_read() {
    let place = Place::new();
    let made = Command::new("mkfifo").arg(place.at("pipe.h")).status().unwrap();
    assert!(made.success());
    for (what, ran) in [
        ("scene", place.run(&["render", "pipe.h", "-o", "o.png"])),
        ("scene", place.run(&["render", "/dev/zero", "-o", "o.png"])),
        ("check", place.run(&["check", "pipe.h"])),
        ("check", place.run(&["check", "/dev/zero"])),
        ("verify", place.run(&["verify", "/dev/zero.osl"])),
        ("group", place.run(&["shade", "--group", "/dev/zero"])),
        ("header", place.run(&["check", "ok.osl", "--stdosl", "pipe.h"])),
    ] {
        place.refuses(what, &ran, "error");
    }
    for name in ["pipe.h", "/dev/zero", "."] {
        place.file("in.osl", format!("#include \"{name}\"\nsurface in() {{ Ci = diffuse(N); }}"));
        place.scene("in", "shader in l;", SPHERE);
        place.refuses("include", &place.render("in"), if name == "." { "cannot find" } else { "no regular file" });
        place.scene("mesh", "shader ok l;", &format!("<Model filename=\"{name}\"/>"));
        place.refuses("mesh", &place.render("mesh"), "is not found");
        place.surface("tex", &format!("Ci = texture(\"{name}\", u, v) * diffuse(N);"));
        let ran = place.render("tex");
        place.done("texture", &ran);
        assert!(ran.err.contains("there is no texture"), "{}", ran.err);
        place.surface("dict", &format!("Ci = dict_find(\"{name}\", \"//a\") * diffuse(N);"));
        place.done("dictionary", &place.render("dict"));
        place.file("m.obj", format!("mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
        place.scene("mtl", "shader ok l;", "<Model filename=\"m.obj\"/>");
        place.done("mtl", &place.render("mtl"));
    }
    // A shader writes to no pipe either: nobody reads it.
    place.surface("writes", "fprintf(\"pipe.h\", \"x\"); Ci = diffuse(N);");
    place.refuses("fprintf", &place.run(&["shade", "writes"]), "no regular file");
}

#[test]
fn what_is_no_shader_is_not_shown() {
    let place = Place::new();
    let secret = "hunter2 = correct horse battery staple";
    fs::create_dir(place.at("home")).unwrap();
    place.file("home/password", format!("{secret}\n#define X {secret}\n"));
    place.file("f12.osl", "#include \"home/password\"\nsurface f12() { Ci = X * diffuse(N); }");
    place.scene("f12", "shader f12 l;", SPHERE);
    for ran in [
        place.render("f12"),
        place.run(&["check", "f12.osl"]),
        place.run(&["check", "f12.osl", "--message-format", "json"]),
        place.run(&["check", "f12.osl", "--message-format", "short"]),
        place.run(&["verify", "f12.osl"]),
        place.run(&["shade", "f12"]),
    ] {
        place.refuses("f12", &ran, "password:1: what is included here is no shader text");
        assert!(secret.split(' ').filter(|word| word.len() > 1).all(|word| !ran.err.contains(word)), "{}", ran.err);
    }
}

#[test]
fn a_sandbox_has_no_way_out() {
    let place = Place::new();
    let inside = place.at("inside");
    fs::create_dir(&inside).unwrap();
    let outside = |name: &str| place.at(name).display().to_string();
    place.file("secret.h", "#define SECRET 1\n");
    place.file("secret.osl", "surface secret() { Ci = diffuse(N); }");
    place.file("secret.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.file("secret.xml", "<a>hunter2</a>");
    for name in ["secret.h", "secret.osl", "secret.obj", "secret.xml"] {
        std::os::unix::fs::symlink(place.at(name), inside.join(format!("link-{name}"))).unwrap();
    }
    std::os::unix::fs::symlink(place.0.path(), inside.join("up")).unwrap();
    place.file("inside/own.h", "#define OWN 1\n");
    place
        .file("inside/own.osl", "#include \"own.h\"\n#include \"vector2.h\"\nsurface own() { Ci = OWN * diffuse(N); }");
    let render = |name: &str| {
        place.run(&[
            "render",
            &format!("inside/{name}.xml"),
            "--sandbox",
            "inside",
            "-o",
            "o.png",
            "-r",
            "8",
            "8",
            "--spp",
            "1",
        ])
    };
    place.scene("inside/own", "shader own l;", SPHERE);
    place.done("its own", &render("own"));
    place.scene("inside/built", "shader matte l;", SPHERE);
    place.done("what is built in", &render("built"));
    let includes = [outside("secret.h"), "../secret.h".into(), "link-secret.h".into(), "up/secret.h".into()];
    for name in includes {
        place.file("inside/a.osl", format!("#include \"{name}\"\nsurface a() {{ Ci = SECRET * diffuse(N); }}"));
        place.scene("inside/a", "shader a l;", SPHERE);
        place.refuses(&name, &render("a"), "nothing outside of the sandbox");
        place.refuses(&name, &place.run(&["check", "inside/a.osl", "--sandbox", "inside"]), "outside of the sandbox");
        place.refuses(&name, &place.run(&["verify", "inside/a.osl", "--sandbox", "inside"]), "outside of the sandbox");
        place.refuses(&name, &place.run(&["shade", "--sandbox", "inside", "inside/a"]), "outside of the sandbox");
    }
    for name in [outside("secret"), "../secret".into(), "link-secret".into(), "up/secret".into()] {
        place.scene("inside/s", &format!("shader {name} l;"), SPHERE);
        place.refuses(&name, &render("s"), "is not found");
        place.scene("inside/m", "shader own l;", &format!("<Model filename=\"{name}.obj\"/>"));
        place.refuses(&name, &render("m"), "is not found");
        place.file(
            "inside/t.osl",
            format!("surface t() {{ Ci = dict_find(\"{name}.xml\", \"//a\") * texture(\"{name}.png\", u, v) * diffuse(N); }}"),
        );
        place.scene("inside/t", "shader t l;", SPHERE);
        let ran = render("t");
        place.done(&name, &ran);
        assert!(ran.err.contains("there is no file") && !ran.err.contains("hunter2"), "{}", ran.err);
    }
    place.refuses("scene", &place.run(&["render", "f.xml", "--sandbox", "inside", "-o", "o.png"]), "no such file");
    place.refuses(
        "scene",
        &place.run(&["render", "secret.xml", "--sandbox", "inside", "-o", "o.png"]),
        "lies outside of the sandbox",
    );
    place.refuses(
        "header",
        &place.run(&["check", "inside/own.osl", "--sandbox", "inside", "--stdosl", "secret.h"]),
        "error",
    );
    place.refuses("folder", &place.run(&["check", "inside/own.osl", "--sandbox", "none"]), "the sandbox none");
    // Nothing is written by shaders.
    place.file("inside/w.osl", "surface w() { fprintf(\"written\", \"x\"); Ci = diffuse(N); }");
    assert_eq!(place.run(&["shade", "--sandbox", "inside", "inside/w"]).status, Some(0));
    assert!(!place.at("written").exists() && !inside.join("written").exists());
}

#[test]
fn a_time_is_kept() {
    let place = Place::new();
    let loops = "float s = 0; for (int i = 0; i < 20000; i++) s += noise(P * i);";
    place.surface("slow", &format!("{loops} Ci = s * diffuse(N);"));
    place.file("slowsky.osl", format!("surface slowsky() {{ {} Ci = s * background(); }}", loops.replace("P", "I")));
    place.scene("slowsky", "shader slowsky l;", "<Background/>");
    place.scene("fast", "shader ok l;", SPHERE);
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/scenes/figure1.xml").display().to_string();
    for scene in ["slow.xml", "slowsky.xml", "fast.xml", &scene] {
        let ran = place.run(&["render", scene, "--time", "1", "-r", "2000", "2000", "-o", "o.png", "-t", "2"]);
        // Of a gigabyte and an unoptimised build; a machine that does much else is slower yet.
        assert!(ran.seconds < 8.0, "{scene}: {} s: {}", ran.seconds, ran.err);
        match ran.status {
            Some(0) => place.done(scene, &ran),
            _ => place.refuses(scene, &ran, "the time"),
        }
    }
    let ran = place.run(&["render", &scene, "--time", "1", "-r", "64", "64", "-o", "o.png"]);
    place.done("a small picture", &ran);
    assert!(!ran.err.contains("warning"), "{}", ran.err);
    place.refuses("shade", &place.run(&["shade", "--time", "0.3", "-g", "512", "512", "slow"]), "the time of 0.3 s");
}

#[test]
fn threads_are_bounded() {
    let place = Place::new();
    place.scene("ok", "shader ok l;", SPHERE);
    let ran = place.run(&["render", "ok.xml", "-t", "100000", "-o", "o.png", "-r", "8", "8", "--spp", "1"]);
    place.done("threads", &ran);
    let most = 4 * std::thread::available_parallelism().unwrap().get();
    assert!(ran.err.contains(&format!("{most} are started")), "{}", ran.err);
}

#[test]
fn a_picture_goes_through_what_stands_at_its_name() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let place = Place::new();
    place.scene("ok", "shader ok l;", SPHERE);
    let to = |name: &str| place.run(&["render", "ok.xml", "-r", "8", "8", "--spp", "1", "-o", name]);
    place.file("real.png", "old");
    fs::set_permissions(place.at("real.png"), fs::Permissions::from_mode(0o600)).unwrap();
    symlink("real.png", place.at("link.png")).unwrap();
    place.done("link", &to("link.png"));
    assert!(place.at("link.png").is_symlink() && fs::read(place.at("real.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(fs::metadata(place.at("real.png")).unwrap().permissions().mode() & 0o777, 0o600);
    let names = place.names();
    let ran = to("png:-");
    assert!(ran.status == Some(0) && ran.out.contains("PNG"), "{}", ran.err);
    assert!(to("-").out.starts_with("v/1\u{1}"), "an EXR");
    assert_eq!(place.names(), names);
    place.refuses("full", &to("/dev/full"), "cannot tell the image format");
    symlink("/dev/full", place.at("full.png")).unwrap();
    place.refuses("full", &to("full.png"), "No space left");
    assert_eq!(to("no/o.png").status, Some(2));
}
