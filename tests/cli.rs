//! The command as people meet it: one clear message for each mistake, exit statuses, and files that stay whole.

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

const MATTE: &str = "surface matte(color Cs = 0.5)\n{\n    Ci = Cs * diffuse(N);\n}\n";
const CLOTH: &str = "surface cloth(color base = color(0.6, 0.05, 0.05), float roughness = 0.4)\n\
  { Ci = sheen(base * diffuse(N), N, color(1), roughness); }";
const SKY: &str = "surface sky(color radiance = 1) { Ci = radiance * background(); }";
const ENDLESS: &str = "surface endless(float x = 1)\n{\n    float y = x;\n    while (y > 0)\n        y += u;\n    Ci = y * diffuse(N);\n}\n";
const SYNTAX: &str =
    "surface syntax()\n{\n    float y = 1\n    float z = 2;\n    int w = ;\n    Ci = y * diffuse(N);\n}\n";
const TYPES: &str = "surface types()\n{\n    float y = nothing;\n    Ci = diffus(N);\n}\n";

/// A folder of scenes and shaders in which the command is run.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        for (name, text) in [
            ("matte", MATTE),
            ("cloth", CLOTH),
            ("sky", SKY),
            ("endless", ENDLESS),
            ("syntax", SYNTAX),
            ("types", TYPES),
        ] {
            place.file(&format!("{name}.osl"), text);
        }
        let deep = format!("surface deep()\n{{ float x = {}1{}; }}", "(".repeat(20_000), ")".repeat(20_000));
        place.file("deep.osl", deep);
        place.file("binary.osl", (0..5000u32).map(|i| (i * 7919 + 13 * i * i) as u8).collect::<Vec<u8>>());
        place.file("good.xml", scene("radiance 0.5 0.5 0.5", "shader matte l1;"));
        place
    }

    fn file(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), bytes).unwrap();
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(self.path()).output().unwrap()
    }

    /// Status, standard output and standard error.
    fn say(&self, arguments: &[&str]) -> (i32, String, String) {
        let output = self.run(arguments);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code().expect("the command ends by itself"), text(output.stdout), text(output.stderr))
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// A sphere of a group under a sky.
fn scene(sky: &str, group: &str) -> String {
    format!(
        "<World><ShaderGroup>color {sky}; shader sky l1;</ShaderGroup><Background/>\n\
         <ShaderGroup>{group}</ShaderGroup>\n<Sphere center=\"0,0,-3\" radius=\"1\"/></World>"
    )
}

const SMALL: [&str; 5] = ["--res", "16", "12", "-t", "1"];

/// Renders `xml`, expects it to fail, and gives its message; the image that was there must stay as it was.
fn failure(place: &Place, xml: &str, status: i32) -> String {
    place.file("scene.xml", xml);
    place.file("out.png", "what was there before");
    let before = place.names();
    let (code, out, error) = place.say(&[&["render", "scene.xml", "-o", "out.png", "--spp", "1"], &SMALL[..]].concat());
    assert_eq!((code, out.as_str()), (status, ""), "{error}");
    assert_eq!(std::fs::read(place.path().join("out.png")).unwrap(), b"what was there before", "{error}");
    assert_eq!(place.names(), before, "something was left behind");
    assert_eq!(error.matches("scene.xml:").count().max(1), 1, "one message: {error}");
    error
}

#[test]
fn mistakes_of_a_scene_have_one_message_each() {
    let place = Place::new();
    place.file("noise.obj", (0..=255u8).collect::<Vec<u8>>());
    let with = |line: &str| format!("<World><ShaderGroup>shader matte l1;</ShaderGroup>\n{line}</World>");
    let group = |text: &str| scene("radiance 1 1 1", text);
    let cases = [
        (with("<Spere/>"), "scene.xml:2:1: error: unknown tag <Spere>\n  help: did you mean <Sphere>?\n"),
        (
            with(r#"<Quad corner="0,0,0" edge_x="1,0,0" edge_y="2,0,0"/>"#),
            "scene.xml:2:1: error: this <Quad> has no area\n  help: ",
        ),
        (with(r#"<Model filename="noise.obj"/>"#), "scene.xml:2:18: error: mesh `noise.obj`: it is not text"),
        (with(r#"<Model filename="none.obj"/>"#), "scene.xml:2:18: error: mesh `none.obj` is not found\n  help: "),
        (
            group("shader missing l1;"),
            "scene.xml:2:21: error: shader `missing` is not found\n  help: no `missing.osl` in .; add folders with --path\n",
        ),
        (group("string Cs x; shader matte l1;"), "scene.xml:2:21: error: parameter `Cs` is a color, not a string\n"),
        (
            group("shader cloth a; shader matte b; connect a.base b.C;"),
            "scene.xml:2:54: error: shader `matte` has no parameter `C`\n",
        ),
        (with("<Sphere"), "scene.xml:2:"),
    ];
    for (xml, expected) in cases {
        let error = failure(&place, &xml, 1);
        assert!(error.starts_with(expected), "{xml}\ngives {error}expected {expected}");
    }
}

#[test]
fn mistakes_of_a_shader_are_reported_together_with_their_places() {
    let place = Place::new();
    let render = |name: &str| failure(&place, &scene("radiance 1 1 1", &format!("shader {name} l1;")), 1);
    let syntax = render("syntax");
    assert!(syntax.starts_with("scene.xml:2:21: error: shader `syntax` does not compile\n"), "{syntax}");
    assert!(syntax.contains("syntax.osl:3:15") && syntax.contains("syntax.osl:5:13"), "{syntax}");
    let types = render("types");
    assert!(types.contains("types.osl:3:15") && types.contains("did you mean `diffuse`?"), "{types}");
    let deep = render("deep");
    assert!(deep.contains("nested more than 256 levels deep") && deep.contains("deep.osl:2:"), "{deep}");
    assert!(deep.len() < 2000, "a message is no copy of the file");
    assert!(render("binary").contains("binary.osl is not a text file"));
}

#[test]
fn an_endless_loop_ends_with_one_message() {
    let place = Place::new();
    let start = Instant::now();
    let error = failure(&place, &scene("radiance 1 1 1", "shader endless l1;"), 1);
    assert_eq!(
        error,
        "endless.osl:4:5: error: a loop does not end: the batch has run as many instructions as it may\n"
    );
    let (code, out, error) = place.say(&["tree", "endless.osl"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(error.starts_with("endless.osl:4:5: error: a loop does not end"), "{error}");
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[test]
fn wrong_usage_has_status_2() {
    let place = Place::new();
    // Numbers are looked at before the scene, whose shader is wrong too.
    place.file("bad.xml", scene("radiance 1 1 1", "shader syntax l1;"));
    let cases: [(&[&str], &str); 15] = [
        (
            &["render", "good.xml", "-o", "out.gif"],
            "error: cannot tell the image format of `out.gif`; known extensions: exr, png, hdr\n",
        ),
        (&["render", "good.xml", "-o", "none/out.png"], "error: the folder `none` is not there\n"),
        (&["render", "good.xml", "-o", "/proc/out.png"], "error: cannot write `/proc/out.png`: "),
        (&["render", "good.xml"], "error: no image is named\n  help: add `-o picture.png`\n"),
        (&["render", "none.xml", "-o", "out.png"], "error: cannot read the scene `none.xml`: "),
        (&["render", "good.xml", "-o", "out.png", "--foo"], "error: unexpected argument '--foo' found\n"),
        (&["render", "good.xml", "-o", "out.png", "--res", "5"], "error: 2 values required for '--res <W> <H>'"),
        (
            &["render", "good.xml", "-o", "out.png", "--res", "0", "5"],
            "error: an image of 0 x 5 pixels cannot be rendered\n",
        ),
        (&["render", "good.xml", "-o", "out.png", "--spp", "0"], "error: at least one sample a pixel is needed\n"),
        (&["render", "bad.xml", "-o", "out.png", "--aa", "0"], "error: at least one sample a pixel is needed\n"),
        (
            &["render", "bad.xml", "-o", "out.png", "--res", "0", "0"],
            "error: an image of 0 x 0 pixels cannot be rendered\n",
        ),
        (
            &["render", "good.xml", "-o", "out.png", "--aa", "2", "--spp", "4"],
            "error: the argument '--aa <N>' cannot be used with",
        ),
        (&["render", "good.xml", "-o", "out.png", "--layering", "max"], "error: invalid value 'max' for '--layering"),
        (&["check", "none.osl"], "none.osl: error: cannot be read: "),
        (&["paint"], "error: unrecognized subcommand 'paint'"),
    ];
    let before = place.names();
    for (arguments, expected) in cases {
        let (code, out, error) = place.say(arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {error}");
        assert!(error.starts_with(expected), "{arguments:?} gives {error}");
    }
    assert_eq!(place.names(), before);
}

#[test]
fn check_reports_every_file_in_lines_for_programs() {
    let place = Place::new();
    let (code, out, error) = place.say(&["check", "syntax.osl", "types.osl", "matte.osl", "--message-format", "short"]);
    assert_eq!((code, out.as_str()), (1, ""));
    let lines: Vec<&str> = error.lines().collect();
    let expected = [
        "syntax.osl:3:15: error: missing",
        "syntax.osl:5:13: error: ",
        "types.osl:3:15: error: ",
        "types.osl:4:10: error: ",
    ];
    assert_eq!(lines.len(), expected.len(), "{error}");
    assert!(lines.iter().zip(expected).all(|(line, start)| line.starts_with(start)), "{error}");
    assert_eq!(place.say(&["check", "matte.osl", "cloth.osl"]), (0, String::new(), String::new()));
    let (code, _, error) = place.say(&["check", "none.osl", "types.osl", "--message-format", "short"]);
    assert_eq!((code, error.lines().count()), (2, 3), "{error}");
}

#[test]
fn check_stops_after_the_preprocessor() {
    let place = Place::new();
    place.file("macro.osl", "#define TWICE(x) (2 * (x))\nsurface m() { float a = TWICE(3) + EXTRA; }\n");
    let (code, out, error) = place.say(&["check", "-E", "-D", "EXTRA=7", "macro.osl"]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(out.contains("(2 * (3)) + 7"), "{out}");
}

#[test]
fn tree_shows_closures_and_lobes() {
    let place = Place::new();
    let (code, out, _) = place.say(&["tree", "cloth.osl"]);
    let expected = "(1, 1, 1) * sheen ((0.6, 0.05, 0.05) * diffuse ((0, 0, 1)), (0, 0, 1), (1, 1, 1), 0.4)\n";
    assert_eq!((code, out.as_str()), (0, expected));
    let set = ["tree", "cloth.osl", "--param", "roughness", "0.25", "--param", "base", "0.1,0.2,0.3"];
    let (code, out, _) = place.say(&set);
    assert!(code == 0 && out.contains("(0.1, 0.2, 0.3) * diffuse") && out.contains("0.25)"), "{out}");
    let (code, out, _) = place.say(&["tree", "cloth.osl", "--lobes", "--view", "0.5", "--layering", "view"]);
    let lines: Vec<&str> = out.lines().collect();
    assert!(code == 0 && lines.len() == 3 && lines[0].starts_with("lobe ") && lines[1].starts_with("sheen "), "{out}");
    assert!(lines[2].starts_with("diffuse        (0.6000, 0.0500, 0.0500)"), "{out}");
    let (code, _, error) = place.say(&["tree", "cloth.osl", "--param", "rough", "1"]);
    assert_eq!(code, 1);
    assert_eq!(error, "error: shader `cloth` has no parameter `rough`\n  help: its parameters are base, roughness\n");
}

#[test]
fn a_value_keeps_the_type_it_was_written_with() {
    let place = Place::new();
    place.file(
        "typed.osl",
        "surface typed(int n = 0, float k = 0, string s = \"\", color c = 0) { printf(\"%s\", s); Ci = 0; }",
    );
    assert_eq!(place.say(&["tree", "typed.osl", "--param", "s", "inf"]).1, "inf0\n");
    for (value, says) in [
        ("float n 1", "parameter `n` is an int, not a float"),
        ("color k 1 2 3", "parameter `k` is a float, not a color"),
        ("string k \"1\"", "parameter `k` is a float, not a string"),
        ("float s 1", "parameter `s` is a string, not a float"),
        ("float[2] k 1 2", "parameter `k` is a float and holds 1, not 2 numbers"),
    ] {
        let error = failure(&place, &scene("radiance 1 1 1", &format!("{value}; shader typed l1;")), 1);
        assert!(error.contains(&format!("error: {says}\n")), "{value}: {error}");
    }
    place.file("fine.xml", scene("radiance 1 1 1", "int k 1; vector c 1 2 3; int n 2; shader typed l1;"));
    assert_eq!(place.say(&["render", "fine.xml", "-o", "fine.png", "--res", "4", "4", "--spp", "1"]).0, 0);
}

#[test]
fn info_lists_explains_and_reads_files() {
    let place = Place::new();
    let (code, out, _) = place.say(&["info"]);
    assert!(code == 0 && out.contains("sheen(closure color base, normal N, color tint, float roughness"), "{out}");
    assert!(out.contains("smoothstep") && out.lines().all(|line| line.len() < 160));
    let (_, out, _) = place.say(&["info", "sheen"]);
    assert!(out.contains("keyword parameters:") && out.contains("string shadowing: "), "{out}");
    // A builtin, an overload of the header, and what they mean.
    let (_, out, _) = place.say(&["info", "distance"]);
    assert!(
        out.lines().count() == 3
            && out.ends_with("    The distance between two points, or of a point from a segment.\n"),
        "{out}"
    );
    let (_, out, _) = place.say(&["info"]);
    assert!(out.contains("medium_vdf(color albedo") && out.contains("textureinfo"), "{out}");
    place.file("own.osl", "float twice(float x) { return 2 * x; }\n");
    let (_, out, _) = place.say(&["info", "twice", "--stdosl", "own.osl"]);
    assert_eq!(out, "float twice(float x)\n");
    let (code, _, error) = place.say(&["info", "shene"]);
    assert_eq!((code, error.lines().count()), (2, 2), "{error}");
    assert!(error.contains("did you mean `sheen`?"));
    place.file(
        "kinds.osl",
        "surface kinds [[ int version = 3 ]] (float f = -0.5 [[ float min = 0 ]], color g = 0.5, color h = color(\"hsv\", 0.5, 1, 1),\n\
         string s = \"x y\", color many[2] = { color(1), color(0, 1, 2) }, float computed = f * 2, output float o = 1e-7) { Ci = 0; }",
    );
    let expected = "surface \"kinds\"\n\t\tmetadata: int version = 3\n    \"f\" \"float\"\n\t\tDefault value: -0.5\n\
        \t\tmetadata: float min = 0\n    \"g\" \"color\"\n\t\tDefault value: [ 0.5 0.5 0.5 ]\n    \"h\" \"color\"\n\
        \t\tDefault value: [ \"hsv\" 0.5 1 1 ]\n    \"s\" \"string\"\n\t\tDefault value: \"x y\"\n    \"many\" \"color[2]\"\n\
        \t\tDefault value: [ 1 1 1 0 1 2 ]\n    \"computed\" \"float\"\n\t\tUnknown default value\n    \"o\" \"output float\"\n\
        \t\tDefault value: 1e-7\n";
    assert_eq!(place.say(&["info", "kinds.osl"]), (0, expected.to_owned(), String::new()));
}

#[test]
fn a_render_says_one_line_and_leaves_one_file() {
    let place = Place::new();
    for name in ["out.png", "out.exr", "out.hdr"] {
        let before = place.names();
        let (code, out, error) = place.say(&["render", "good.xml", name, "-r", "16", "12", "--aa", "2"]);
        assert_eq!((code, out.as_str()), (0, ""), "{error}");
        // No terminal, so no bar.
        assert_eq!(error.lines().count(), 1, "{error}");
        assert!(error.starts_with(&format!("{name}: 16 x 12, 4 samples a pixel, ")), "{error}");
        assert!(error.ends_with(" million paths a second\n"), "{error}");
        let mut after = place.names();
        after.retain(|file| !before.contains(file));
        assert_eq!(after, [name]);
        let image = image::open(place.path().join(name)).unwrap();
        assert_eq!((image.width(), image.height()), (16, 12));
    }
}

#[test]
fn the_exr_header_says_how_to_make_it_again() {
    let place = Place::new();
    let arguments = ["render", "good.xml", "-o", "out.exr", "--spp", "3", "--seed", "42", "--res", "8", "8"];
    assert_eq!(place.say(&arguments).0, 0);
    let meta = exr::prelude::MetaData::read_from_file(place.path().join("out.exr"), false).unwrap();
    let own = &meta.headers[0].own_attributes;
    let comments = own.comments.as_ref().unwrap().to_string();
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(comments, format!("scene=good.xml samples=3 seed=42 velour={version}"));
    assert_eq!(own.software_name.as_ref().unwrap().to_string(), format!("velour {version}"));
}

/// The linear pixels of a render of a scene of cloth.
fn pixels(place: &Place, more: &[&str]) -> Vec<f32> {
    place.file("cloth.xml", scene("radiance 1 1 1", "float roughness 0.3; shader cloth l1;"));
    let arguments = [&["render", "cloth.xml", "-o", "p.exr", "--res", "16", "16", "--spp", "4"], more].concat();
    let (code, _, error) = place.say(&arguments);
    assert_eq!(code, 0, "{error}");
    image::open(place.path().join("p.exr")).unwrap().to_rgb32f().into_raw()
}

#[test]
fn flags_of_a_render_do_what_they_say() {
    let place = Place::new();
    let plain = pixels(&place, &["-t", "1"]);
    assert_eq!(plain, pixels(&place, &["-t", "2"]), "threads do not show");
    assert_eq!(
        plain,
        pixels(&place, &["--layering", "min", "--shadowing", "exact", "--softening", "true"]),
        "defaults"
    );
    for change in [
        ["--seed", "1"],
        ["--layering", "view"],
        ["--layering", "kelemen"],
        ["--shadowing", "published"],
        ["--shadowing", "ashikhmin"],
        ["--softening", "false"],
        ["--max-bounces", "0"],
    ] {
        assert!(plain != pixels(&place, &change), "{change:?} changes nothing");
    }
    let black = pixels(&place, &["--max-bounces", "0", "--no-jitter"]);
    assert_eq!(black[3 * (8 * 16 + 8)], 0.0, "without a bounce nothing lights the sphere");
}

#[test]
fn a_path_finds_shaders_elsewhere_and_a_scene_may_be_an_argument() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("more")).unwrap();
    place.file("more/other.osl", "surface other() { Ci = 0.25 * emission(); }");
    let text = r#"<World><ShaderGroup>shader other l1;</ShaderGroup><Sphere center="0,0,-3" radius="1"/></World>"#;
    let base = ["render", text, "-o", "o.png", "--res", "4", "4", "--spp", "1"];
    let (code, _, error) = place.say(&base);
    assert_eq!(code, 1);
    assert!(error.starts_with("<scene text>:1:28: error: shader `other` is not found"), "{error}");
    assert_eq!(place.say(&[&base[..], &["--path", "none:more"]].concat()).0, 0);
}

#[test]
fn explain_tells_the_plan_and_shaders_may_print() {
    let place = Place::new();
    place.file("says.osl", "surface says() { if (u < 2) warning(\"look at %s\", \"me\"); Ci = diffuse(N); }");
    place.file("says.xml", scene("radiance 1 1 1", "shader says l1;"));
    let (code, out, error) = place.say(&[&["render", "says.xml", "-o", "s.png", "--explain"], &SMALL[..]].concat());
    assert_eq!(code, 0);
    assert!(out.starts_with("lights: none, so no light sampling") && out.contains("ray cones: not carried"), "{out}");
    assert!(out.contains("closures diffuse\n") && out.contains("globals N, u; derivatives of none"), "{out}");
    let saved = out.split("not needed, and what it would cost:\n").nth(1).expect("a list of savings");
    for what in ["u and v", "dPdu and dPdv", "derivatives", "sampling of lights", "closures", "layers"] {
        let there = saved.lines().any(|line| line.trim_start().starts_with(what) || line.contains(what));
        // What is read is no saving.
        assert_eq!(there, what != "u and v", "{what}: {saved}");
    }
    assert_eq!(error.lines().filter(|line| line.contains("look at me")).count(), 1, "{error}");
}

#[test]
fn renders_stop_at_a_noise_or_a_time_and_say_what_they_reached() {
    let place = Place::new();
    place.file("s.xml", scene("radiance 1 1 1", "shader matte l1;"));
    let render =
        |more: &[&str]| place.say(&[&["render", "s.xml", "-o", "s.exr"], more, &["--res", "24", "24"]].concat());
    let (code, _, error) = render(&["--noise", "0.01"]);
    assert!(code == 0 && error.contains("error ") && error.contains("samples a pixel"), "{error}");
    let (code, _, error) = render(&["--time", "0.05"]);
    assert!(code == 0 && error.contains("error "), "{error}");
    let (code, _, error) = render(&["--noise", "0"]);
    assert!(code == 2 && error.contains("above 0"), "{error}");
    let (code, _, error) = render(&["--time=-1"]);
    assert!(code == 2 && error.contains("seconds above 0"), "{error}");
}

#[test]
fn shaders_of_the_binary_come_after_those_of_the_scene_and_the_path() {
    let place = Place::new();
    std::fs::remove_file(place.path().join("sky.osl")).unwrap();
    let render = |more: &[&str]| {
        let text = r#"<World><ShaderGroup>shader sky l1;</ShaderGroup><Background/></World>"#;
        let arguments = [&["render", text, "-o", "p.exr", "--spp", "1"], &SMALL[..], more].concat();
        let (code, _, error) = place.say(&arguments);
        assert_eq!(code, 0, "{error}");
        image::open(place.path().join("p.exr")).unwrap().to_rgb32f().into_raw()[0]
    };
    assert_eq!(render(&[]), 0.3, "the sky of the binary");
    std::fs::create_dir(place.path().join("more")).unwrap();
    place.file("more/sky.osl", "surface sky() { Ci = 0.5 * background(); }");
    assert_eq!(render(&["--path", "more"]), 0.5);
    place.file("sky.osl", "surface sky() { Ci = 0.75 * background(); }");
    assert_eq!(render(&["--path", "more"]), 0.75);
}

#[test]
fn a_parameter_that_is_not_there_is_a_warning_and_an_error_with_strict() {
    let place = Place::new();
    place.file("scene.xml", scene("radiance 1 1 1", "float Cx 1; shader matte l1;"));
    let render = |more: &[&str]| {
        place.say(&[&["render", "scene.xml", "-o", "out.png", "--spp", "1"], &SMALL[..], more].concat())
    };
    let (code, _, error) = render(&[]);
    let expected = "scene.xml:2:20: warning: shader `matte` has no parameter `Cx`";
    assert!(code == 0 && error.starts_with(expected), "{error}");
    let (code, _, error) = render(&["--strict"]);
    assert!(code == 1 && error.starts_with("scene.xml:2:20: error: shader `matte` has no parameter `Cx`\n"), "{error}");
}

#[test]
fn flags_of_testrender_are_taken_with_a_note() {
    let place = Place::new();
    place.file("scene.xml", scene("radiance 1 1 1", "shader matte l1;"));
    let flags = ["-v", "--runstats", "--llvm_opt", "2", "--options", "a=1", "-t", "100000"];
    let base = ["render", "scene.xml", "-o", "out.png", "--spp", "1"];
    let (_, _, error) = place.say(&[&base[..], &SMALL[..3], &flags].concat());
    for flag in ["-v", "--runstats", "--llvm_opt", "--options"] {
        let note = format!("note: {flag} is of testrender and changes nothing here\n");
        assert_eq!(error.matches(&note).count(), 1, "{error}");
    }
    assert!(error.contains("warning: 100000 threads are too many for this machine; "), "{error}");
}

#[test]
fn a_scene_states_its_size_and_the_command_line_wins() {
    let place = Place::new();
    let text = scene("radiance 1 1 1", "shader matte l1;").replace("<World>", "<World><Camera res=\"20 10\"/>");
    place.file("scene.xml", text);
    let render = |more: &[&str]| place.say(&[&["render", "scene.xml", "-o", "out.png", "--spp", "1"], more].concat()).2;
    assert!(render(&[]).contains("out.png: 20 x 10, "));
    assert!(render(&["--res", "8", "6"]).contains("out.png: 8 x 6, "));
}
