//! The commands as people who know OSL's tools type them: `shade`, `check`, `info` and `render` with the options of testshade, oslc,
//! oslinfo and testrender.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// A folder with a few shaders in which the command is run.
struct Place(tempfile::TempDir);

const STRIPES: &str = "shader stripes(float scale = 2 [[string help = \"stripes\"]], color tint = color(1, .5, 0), string word = \"w\",\n\
    int n = 3, output color Cout = 0, output int which = 0)\n\
    { which = (int)floor(scale * u); Cout = which * tint; printf(\"%g %s %d\\n\", scale, word, n); }\n";
const GIVER: &str = "shader giver(float base = 1, output float out = 0) { out = base + u; }\n";
const TAKER: &str = "shader taker(float in = 0, output float twice = 0) { twice = 2 * in; }\n";

impl Place {
    fn new() -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        for (name, text) in [("stripes.osl", STRIPES), ("giver.osl", GIVER), ("another_name.osl", TAKER)] {
            place.file(name, text);
        }
        place
    }

    fn file(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).unwrap();
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn command(&self, line: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_velour"));
        command.args(line).current_dir(self.path());
        command
    }

    /// Status, standard output and standard error.
    fn say(&self, line: &[&str]) -> (i32, String, String) {
        let output = self.command(line).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    }

    /// What a command prints that succeeds and warns of nothing.
    fn prints(&self, line: &[&str]) -> String {
        let (status, out, error) = self.say(line);
        assert_eq!((status, error.as_str()), (0, ""), "{line:?}: {out}");
        out
    }
}

#[test]
fn shade_prints_what_shaders_print_point_by_point() {
    let place = Place::new();
    assert_eq!(place.prints(&["shade", "-g", "2", "1", "stripes"]), "2 w 3\n2 w 3\n\n");
    let line = ["shade", "-param", "scale", "4", "--param:type=string", "word", "7", "-param", "n", "-2", "stripes"];
    assert_eq!(place.prints(&line), "4 7 -2\n\n");
    let line =
        ["shade", "--center", "-g", "2", "1", "--print", "-o", "Cout", "null", "-o", "which", "null", "stripes.osl"];
    let out = place.prints(&line);
    assert!(
        out.ends_with(
            "Pixel (0, 0):\n  Cout : 0 0 0\n  which : 0\n2 w 3\nPixel (1, 0):\n  Cout : 1 0.5 0\n  which : 1\n"
        ),
        "{out}"
    );
}

#[test]
fn shade_builds_groups_from_the_command_line_and_from_text() {
    let place = Place::new();
    let print = ["--print", "-o", "twice", "null"];
    let built =
        ["-param", "base", "3", "-layer", "a", "giver", "-layer", "b", "taker", "-connect", "a", "out", "b", "in"];
    let expected = "Connect a.out to b.in\n\nPixel (0, 0):\n  twice : 7\n\n";
    assert_eq!(place.prints(&[&["shade"], &print[..], &built[..]].concat()), expected);
    let text = "param float base 3; shader giver a; shader taker b; connect a.out b.in;";
    assert_eq!(place.prints(&[&["shade"], &print[..], &["--group", text][..]].concat()), expected);
    place.prints(&[&["shade", "--archivegroup", "kept.txt"], &built[..]].concat());
    assert_eq!(place.prints(&[&["shade"], &print[..], &["--group", "kept.txt"][..]].concat()), expected);
    let out = place.prints(&["shade", "--print", "-o", "result", "null", "--expr", "result = color(u, 2, 3)"]);
    assert!(out.contains("result : 0.5 2 3"), "{out}");
    let changed =
        ["--iters", "2", "--reparam", "a", "base", "9", "-layer", "a", "giver", "-layer", "b", "taker", "-connect"];
    let out = place.prints(&[&["shade"], &print[..], &changed[..], &["a", "out", "b", "in"][..]].concat());
    assert!(out.contains("twice : 3") && out.contains("twice : 19"), "{out}");
}

#[test]
fn shade_saves_images_of_every_kind() {
    let place = Place::new();
    let saved = |file: &str, format: &[&str]| {
        let line = [
            &["shade", "-g", "4", "2", "--center", "-param", "scale", "4", "-o", "Cout", file],
            format,
            &["stripes"][..],
        ];
        place.prints(&line.concat());
        image::open(place.path().join(file)).unwrap_or_else(|error| panic!("{file}: {error}")).into_rgb32f()
    };
    for (file, format) in [("a.exr", vec![]), ("b.exr", vec!["-od", "half"]), ("c.hdr", vec![])] {
        let pixel = saved(file, &format).get_pixel(3, 1).0;
        assert!((pixel[0] - 3.0).abs() < 0.02 && (pixel[1] - 1.5).abs() < 0.02, "{file}: {pixel:?}");
    }
    assert_eq!(saved("d.png", &[]).get_pixel(1, 0).0[0], 1.0);
    let texture = velour::texture::read(
        &{
            place.prints(&[
                "shade", "-g", "4", "2", "--center", "-param", "scale", "4", "-o", "Cout", "e.tif", "stripes",
            ]);
            place.path().join("e.tif")
        },
        1 << 20,
    );
    let texture = texture.unwrap();
    let mut texel = [0.0; 4];
    texture.level(0).read(3, 1, 0, &mut texel);
    assert_eq!((texture.size(), texture.channels(), texel[..3].to_vec()), ([4, 2], 3, vec![3.0, 1.5, 0.0]));
}

#[test]
fn shade_words_mistakes_as_osl_does_and_tells_usage() {
    let place = Place::new();
    place.file("odd.osl", "shader odd() { int a[5]; int i = (int)(u * 20); printf(\"%d\\n\", a[i]); point p = transform(\"spam\", P); printf(\"%g\\n\", p); error(\"no\"); }");
    let out = place.prints(&["shade", "odd"]);
    assert!(
        out.contains(
            "ERROR: Index [10] out of range a[0..4]: odd.osl:1 (group unnamed_group_1, layer 0 odd_0, shader odd)\n"
        ),
        "{out}"
    );
    assert!(
        out.contains("ERROR: Unknown transformation \"spam\"\n") && out.contains("ERROR: Shader error [odd]: no\n"),
        "{out}"
    );
    for (line, status, says) in [
        (vec!["shade"], 2, "there is no shader and no group"),
        (vec!["shade", "nowhere"], 1, "Could not find shader \"nowhere\""),
        (vec!["shade", "--param", "x", "1"], 2, "there is no shader after --param x"),
        (vec!["shade", "--gird", "1", "1", "stripes"], 2, "there is no option --gird"),
        (vec!["shade", "-d", "int7", "-o", "Cout", "a.exr", "stripes"], 2, "`int7` are no numbers of files"),
    ] {
        let (got, _, error) = place.say(&line);
        assert_eq!(got, status, "{line:?}: {error}");
        assert!(error.contains(says), "{line:?}: {error}");
    }
    assert!(place.prints(&["shade", "--help"]).contains("--connect <FROM> <OUTPUT> <TO> <INPUT>"));
    assert!(place.prints(&["shade", "--stats", "stripes"]).contains("ns a point"));
}

#[test]
fn check_takes_the_options_of_oslc() {
    let place = Place::new();
    place.file("warns.osl", "#include \"part.h\"\nshader warns() { int i = 1.5 * u; printf(\"%d\", i); }\n");
    place.file("part.h", "float half(float x) { return x / 2; }\n");
    let short = ["--message-format", "short"];
    let run = |more: &[&str]| place.say(&[&["check"], &short[..], more].concat());
    let (status, _, error) = run(&["warns.osl"]);
    assert!(status == 0 && error.contains("warns.osl:2:26: warning: "), "{error}");
    assert_eq!(run(&["-Werror", "warns.osl"]).0, 1);
    assert_eq!(run(&["-q", "warns.osl"]).2, "");
    place.file("unread.osl", "shader unread(float x = 1) { float y = 2; }");
    assert_eq!(run(&["unread.osl"]).2, "");
    assert_eq!(run(&["-Wall", "unread.osl"]).2.lines().count(), 2);
    let (status, out, _) = place.say(&["check", "-M", "warns.osl"]);
    assert_eq!((status, out.as_str()), (0, "warns.oso: warns.osl \\\n  part.h\n"));
    place.say(&["check", "-MD", "-MT", "x.oso", "warns.osl"]);
    assert!(std::fs::read_to_string(place.path().join("warns.d")).unwrap().starts_with("x.oso: warns.osl"));
    assert_eq!(place.say(&["check", "-MMD", "-MFown.d", "warns.osl"]).0, 0);
    assert!(std::fs::read_to_string(place.path().join("own.d")).unwrap().starts_with("warns.oso: warns.osl"));
    place.say(&["check", "-E", "-o", "out.i", "-DSIDE=7", "warns.osl"]);
    assert!(std::fs::read_to_string(place.path().join("out.i")).unwrap().contains("return x / 2"));
    let (_, _, json) = place.say(&["check", "--message-format", "json", "warns.osl"]);
    let value: serde_json::Value = serde_json::from_str(json.trim()).unwrap();
    assert_eq!((value["severity"].as_str(), value["line"].as_i64()), (Some("warning"), Some(2)));
    let mut child = place.command(&["check", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"shader s() { x = 1; }").unwrap();
    let output = child.wait_with_output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && error.contains("<stdin>:1:14"), "{error}");
    place.file("quiet.osl", "shader quiet() {\n#pragma osl nowarn\nint i = 1.5 * u;\nprintf(\"%d\", i); }");
    assert_eq!(run(&["-Werror", "quiet.osl"]), (0, String::new(), String::new()));
}

#[test]
fn info_takes_the_options_of_oslinfo() {
    let place = Place::new();
    let verbose = place.prints(&["info", "-v", "stripes"]);
    assert!(verbose.starts_with("shader \"stripes\"\n    \"scale\" \"float\"\n\t\tDefault value: 2\n\t\tmetadata: string help = \"stripes\"\n"), "{verbose}");
    assert_eq!(verbose, place.prints(&["info", "stripes.osl"]));
    assert_eq!(place.prints(&["info", "--terse", "taker"]), "shader taker\nfloat in 0\noutput float twice 0\n");
    assert_eq!(
        place.prints(&["info", "-param", "in", "taker"]),
        "shader \"taker\"\n    \"in\" \"float\"\n\t\tDefault value: 0\n"
    );
    let value: serde_json::Value = serde_json::from_str(&place.prints(&["info", "--json", "stripes"])).unwrap();
    assert_eq!(value["params"][1]["default"], serde_json::json!([1, 0.5, 0]));
    assert_eq!(value["params"][4]["output"], serde_json::json!(true));
    assert_eq!(place.say(&["info", "-param", "none", "taker"]).0, 1);
    place.file("odd.osl", "shader odd(string s = \"a\\a\\\"b\") {}");
    let odd = place.prints(&["info", "--json", "odd"]);
    let value: serde_json::Value = serde_json::from_str(&odd).unwrap_or_else(|error| panic!("{error}: {odd}"));
    assert_eq!(value["params"][0]["name"], serde_json::json!("s"));
}

#[test]
fn render_looks_at_one_pixel_and_refuses_what_means_nothing() {
    let place = Place::new();
    place.file("tell.osl", "shader tell(float in = 0) { printf(\"tell %g at %.1f\\n\", in, P); Ci = diffuse(N); }");
    let scene = "<World><ShaderGroup>shader giver a; shader tell b; connect a.out b.in;</ShaderGroup>\
        <Quad corner=\"-1,-1,-2\" edge_x=\"2,0,0\" edge_y=\"0,2,0\"/></World>";
    place.file("scene.xml", scene);
    let (status, out, error) = place.say(&["render", "scene.xml", "--res", "8", "8", "-debug-pixel", "4", "4"]);
    assert_eq!((status, out.as_str()), (0, "tell 1.5625 at 0.1 -0.1 -2.0\n"), "{error}");
    assert!(
        error.contains("warning: nothing in the scene gives light") && error.contains("layer b (shader tell)\n"),
        "{error}"
    );
    for (line, says) in [
        (vec!["render", "scene.xml", "--debug-pixel", "8", "0", "--res", "8", "8"], "there is no pixel 8 0"),
        (
            vec!["render", "scene.xml", "-o", "a.png", "-r", "8", "8", "-r", "9", "9"],
            "--res, --crop and --debug-pixel are given once",
        ),
        (vec!["tree", "stripes.osl", "--view", "nan"], "--view and --uv take finite numbers"),
    ] {
        let (status, _, error) = place.say(&line);
        assert!(status == 2 && error.contains(says), "{line:?}: {error}");
    }
}
