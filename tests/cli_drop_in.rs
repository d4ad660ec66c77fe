//! What lets scripts that were written for OSL's tools run as they are: compiling first, the tools' names, their settings, and their words
//! for what goes wrong.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder in which commands are run.
struct Place(tempfile::TempDir);

impl Place {
    fn new(files: &[(&str, &str)]) -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        for (name, text) in files {
            let path = place.path(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, program: &Path, folder: &str, line: &str) -> (i32, String) {
        let output = Command::new(program).args(line.split(' ')).current_dir(self.path(folder)).output().unwrap();
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
        (output.status.code().unwrap(), text)
    }

    /// Status and all that velour says.
    fn say(&self, line: &str) -> (i32, String) {
        self.run(Path::new(env!("CARGO_BIN_EXE_velour")), ".", line)
    }
}

const TWICE: &str = "#include \"amount.h\"\n#ifndef MORE\n#define MORE 0\n#endif\nshader twice(float x = 1) { int a[2]; int i = (int)x;\n  \
     printf(\"%g %d %d\\n\", AMOUNT * x, MORE, a[i + 3]); }\n";

#[test]
fn what_has_been_compiled_is_found_by_its_name_with_its_macros_and_folders() {
    let place = Place::new(&[("lib/twice.osl", TWICE), ("include/amount.h", "#define AMOUNT 2\n"), ("here/x", "")]);
    let velour = Path::new(env!("CARGO_BIN_EXE_velour"));
    let here = |line: &str| place.run(velour, "here", line);
    assert_eq!(here("check -I../include ../lib/twice.osl").0, 0);
    assert!(!place.path("here/twice.oso").exists(), "who checks finds no new files");
    let (status, out) = here("compile -I../include -DMORE=7 ../lib/twice.osl");
    assert_eq!((status, out.as_str()), (0, "Compiled ../lib/twice.osl -> twice.oso\n"));
    let (status, out) = here("shade -param x 3 twice");
    // Messages name the file as it was named to the compiler.
    let error = "ERROR: Index [6] out of range a[0..1]: ../lib/twice.osl:6 (group unnamed_group_1, layer 0 twice_0, shader twice)\n";
    assert_eq!((status, out), (0, format!("{error}6 7 0\n\n")));
    assert!(here("info twice.oso").1.contains("\"x\" \"float\""));
    // The text is compiled when it runs, so it is never older than it.
    std::fs::write(place.path("include/amount.h"), "#define AMOUNT 5\n").unwrap();
    assert!(here("shade twice").1.contains("5 7 0\n"));
    assert_eq!(here("compile -q -I../include -o other.oso ../lib/twice.osl"), (0, String::new()));
    assert!(here("shade other").1.contains("5 0 0\n"));
    assert_eq!(here("compile nowhere.osl").0, 2);
    std::fs::write(place.path("here/bad.osl"), "shader bad() { x = 1; }").unwrap();
    let (status, out) = here("compile bad.osl");
    assert!(status == 1 && out.contains("FAILED bad.osl\n") && !place.path("here/bad.oso").exists(), "{out}");
}

#[test]
fn what_has_been_compiled_leads_out_of_no_sandbox() {
    let text = "#include \"amount.h\"\nshader twice() { printf(\"%d\\n\", AMOUNT); }";
    let header = "#define AMOUNT 2\n";
    let place = Place::new(&[
        ("secret.osl", text),
        ("out/amount.h", header),
        ("own.h", ""),
        ("in/lib/own.osl", text),
        ("in/include/amount.h", header),
    ]);
    let status = |line: &str| place.say(line).0;
    assert_eq!(status("compile -q -Iin/include -o in/own.oso in/lib/own.osl"), 0);
    assert_eq!(status("compile -q -Iin/include -o in/text.oso secret.osl"), 0);
    assert_eq!(status("compile -q -Iout -o in/folder.oso in/lib/own.osl"), 0);
    assert_eq!(status("compile -q -Iin/include --stdosl own.h -o in/header.oso in/lib/own.osl"), 0);
    assert_eq!(status("compile -q -Iin/include -o out/recipe.oso in/lib/own.osl"), 0);
    for name in ["in/own", "in/text", "in/folder", "out/recipe"] {
        assert_eq!(place.say(&format!("shade {name}")), (0, "2\n\n".to_owned()), "{name} without a sandbox");
    }
    assert_eq!(place.say("shade --sandbox in in/own"), (0, "2\n\n".to_owned()));
    for name in ["in/text", "in/folder", "in/header", "out/recipe"] {
        let (status, out) = place.say(&format!("shade --sandbox in {name}"));
        assert!(status == 1 && !out.contains("AMOUNT 2"), "{name}: {out}");
    }
    assert_eq!(status("compile --sandbox in -o in/b.oso secret.osl"), 2);
    assert!(!place.path("in/b.oso").exists());
}

#[test]
fn code_of_osl_itself_is_passed_over() {
    let text = "shader a() { printf(\"text\\n\"); }";
    let place = Place::new(&[("a.osl", text), ("a.oso", "OpenShadingLanguage 1.00\nshader a\n")]);
    assert_eq!(place.say("shade a"), (0, "text\n\n".to_owned()));
    assert_eq!(place.say("shade a.oso"), (0, "text\n\n".to_owned()));
    std::fs::remove_file(place.path("a.osl")).unwrap();
    let (status, out) = place.say("shade a");
    assert!(status == 1 && out.contains("a.oso is code for OSL's tools; velour needs the text, `a.osl`"), "{out}");
}

#[cfg(unix)]
#[test]
fn links_by_the_names_of_osl_s_tools_are_those_tools() {
    let text = "surface s(float x = 1) { int i = 1.5 * x; printf(\"%d\\n\", i); Ci = diffuse(N); }";
    let place = Place::new(&[("s.osl", text)]);
    for name in ["oslc", "oslinfo", "testshade", "testrender"] {
        std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_velour"), place.path(name)).unwrap();
    }
    let run = |name: &str, line: &str| place.run(&place.path(name), ".", line);
    let (status, out) = run("oslc", "-Wall s.osl");
    assert!(status == 0 && out.contains("s.osl:1:34: warning: ") && out.contains("Compiled s.osl -> s.oso"), "{out}");
    assert_eq!(run("testshade", "-g 1 1 -param x 2 s"), (0, "3\n\n".to_owned()));
    assert!(run("oslinfo", "-v s").1.starts_with("surface \"s\"\n"));
    let scene = "<World><ShaderGroup>shader s l;</ShaderGroup><Sphere center=\"0,0,-3\" radius=\"1\" /></World>";
    std::fs::write(place.path("w.xml"), scene).unwrap();
    assert_eq!(run("testrender", "-r 8 8 -aa 1 w.xml out.exr").0, 0);
    assert!(place.path("out.exr").exists());
}

#[test]
fn groups_that_cannot_be_built_are_told_of_in_osl_s_words_and_ours() {
    let giver = "shader giver(output float out = 0) { out = u; }";
    let taker =
        "shader taker(float in = 0 [[int allowconnect = 0]], float other = 0) { printf(\"%g\\n\", in + other); }";
    let place =
        Place::new(&[("giver.osl", giver), ("taker.osl", taker), ("g.oslgroup", "shader taker;\nconnect a.b c.d;\n")]);
    let (status, out) = place.say("shade -layer a nowhere -layer b taker -connect a out b other");
    let lines = [
        "Connect a.out to b.other",
        "ERROR: No .oso file could be found for shader \"nowhere\"",
        "ERROR: Could not find shader \"nowhere\"",
        "        group: unnamed_group_1",
        "ERROR: ConnectShaders: source layer \"a\" not found",
        "        group: unnamed_group_1",
        "FAILED to build the group: no `nowhere.osl` in .; add folders with --path",
    ];
    assert_eq!((status, out.lines().collect::<Vec<_>>()), (1, lines.to_vec()));
    let (status, out) = place.say("shade -layer a giver -layer b taker -connect a out b in");
    assert_eq!(status, 1);
    assert!(
        out.contains("ERROR: ConnectShaders: cannot connect to b.in because it has metadata allowconnect=0\n"),
        "{out}"
    );
    assert!(out.contains("its parameters are in, other"), "{out}");
    let (status, out) = place.say("shade --group g.oslgroup");
    assert!(status == 1 && out.contains("problem might be here: connect a.b c.d;\n"), "{out}");
    assert!(out.contains("FAILED to build the group at g.oslgroup:2:9: there is no layer `a`; declare"), "{out}");
}

#[test]
fn missing_dictionaries_and_writes_outside_are_told_of() {
    let dictionary = "shader d() { printf(\"%d\\n\", dict_find(\"gone.xml\", \"a\")); }";
    // Nobody reads what the last statement writes.
    let dead = "shader dead() { vector v = 1; printf(\"%g\\n\", v); for (int i = 0; i < 4; ++i) v[i] = 2; }";
    let array = "shader array() { float a[2]; int i = (int)(7 * u); a[i] = 2; }";
    let place = Place::new(&[("d.osl", dictionary), ("dead.osl", dead), ("array.osl", array)]);
    let (_, out) = place.say("shade d");
    assert!(
        out.contains("ERROR: XML parsed with errors: File was not found, at offset 0\nFAILED to read \"gone.xml\""),
        "{out}"
    );
    let (_, out) = place.say("shade dead");
    assert!(out.contains("1 1 1\nERROR: Index [3] out of range v[0..2]: dead.osl:1 "), "{out}");
    assert!(place.say("shade array").1.contains("ERROR: Index [3] out of range a[0..1]: array.osl:1 "));
}

#[test]
fn a_watched_shader_tells_what_is_not_finite() {
    // Division by zero is zero in this language; what overflows is not.
    let text = "shader w(float big = 1e30, output color Cout = 0) { float x = big * big; float y = x - x; Cout = color(y, 0, 0); \
                Cout += 1; }";
    let place = Place::new(&[("w.osl", text)]);
    let (status, out) = place.say("shade --debugnan -o Cout null w");
    let found: Vec<&str> = out.lines().filter(|line| line.starts_with("ERROR")).collect();
    let expected = [
        "ERROR: Detected inf value in x at w.osl:1 (op mul)",
        "ERROR: Detected nan value in y at w.osl:1 (op sub)",
        "ERROR: Detected nan value in Cout at w.osl:1 (op assign)",
        "ERROR: Detected nan value in Cout at w.osl:1 (op add)",
    ];
    assert_eq!((status, found), (0, expected.to_vec()));
    assert!(!place.say("shade -o Cout null w").1.contains("ERROR"), "it is looked for on request alone");
    assert!(!place.say("shade --debugnan --param big 2 -o Cout null w").1.contains("ERROR"));
}

#[test]
fn layers_that_call_error_wait_or_not_and_are_warned_of() {
    let bad = "shader bad(output float out = 0) {\n  if (u > 2) error(\"far\");\n  printf(\"bad ran\\n\"); }";
    let place = Place::new(&[("bad.osl", bad), ("last.osl", "shader last() { printf(\"last\\n\"); }")]);
    assert_eq!(place.say("shade -options opt_warnings=1 bad last").1, "last\n\n");
    let (_, out) = place.say("shade -options lazyerror=0,opt_warnings=1 bad last");
    assert!(out.contains("  layer:  bad_0\n  source: bad.osl:2\n  issue:  error() call present"), "{out}");
    assert!(out.ends_with("bad ran\nlast\n\n"), "{out}");
}

#[test]
fn layers_run_right_before_the_statement_that_reads_them() {
    let give = "shader give(output float out[2] = {1, 2}) { printf(\"give\\n\"); }";
    let take = "shader take(float in[2] = {0, 0}) { printf(\"take\\n\"); for (int i = 0; i < 2; ++i) printf(\"%g\\n\", in[i]); }";
    let place = Place::new(&[("give.osl", give), ("take.osl", take)]);
    let (_, out) = place.say("shade -layer a give -layer b take -connect a out b in");
    assert!(out.ends_with("take\ngive\n1\n2\n\n"), "{out}");
}

#[test]
fn the_working_space_is_what_rgb_means() {
    let text = "shader w() { color white = transformc(\"xyY\", \"RGB\", color(.32168, .33767, 1)); \
                printf(\"%.4f %.4f\\n\", white, luminance(color(1, 0, 0))); }";
    let place = Place::new(&[("w.osl", text)]);
    // The white of ACES is its own; AP1's red has the luminance that S-2014-004 gives.
    assert_eq!(place.say("shade --colorspace ACEScg w").1, "1.0000 1.0000 1.0000 0.2722\n\n");
    assert_eq!(place.say("shade w").1.split(' ').next_back(), Some("0.2125\n\n"));
    let (status, out) = place.say("shade --colorspace ACESCG w");
    assert!(status == 2 && out.contains("Rec709, sRGB"), "{out}");
}

#[test]
fn whole_numbers_are_saved_whole() {
    let place = Place::new(&[("n.osl", "shader n(output int n = 0) { n = (int)(u * 600) - 1; }")]);
    assert_eq!(place.say("shade -g 2 1 -o n n.tif n").0, 0);
    assert_eq!(place.say("shade -g 2 1 -d uint8 -o n bytes.tif n").0, 0);
    let read = |name: &str| {
        let file = std::io::BufReader::new(std::fs::File::open(place.path(name)).unwrap());
        tiff::decoder::Decoder::new(file).unwrap().read_image().unwrap()
    };
    let tiff::decoder::DecodingResult::I32(ints) = read("n.tif") else { panic!("no ints") };
    let tiff::decoder::DecodingResult::U8(bytes) = read("bytes.tif") else { panic!("no bytes") };
    assert_eq!((ints, bytes), (vec![-1, 599], vec![0, 255]));
}

#[test]
fn ambiguous_calls_list_what_fits_in_the_short_form() {
    let text = "float f() { return 1; }\ncolor f() { return 2; }\nint f() { return 3; }\nshader a() { f(); }\n";
    let place = Place::new(&[("a.osl", text)]);
    let (_, out) = place.say("check --message-format short a.osl");
    let list = "  Chosen function is:\n    a.osl:1\tfloat f ()\n  Other candidates are:\n    a.osl:3\tint f ()\n    a.osl:2\tcolor f ()\n";
    assert!(out.contains("a.osl:4:14: warning: ") && out.ends_with(list), "{out}");
}
