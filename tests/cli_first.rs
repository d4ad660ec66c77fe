//! What a first user does with names, values and options, and what is said when they are wrong.

use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SCENE: &str = r#"<World><Camera eye="0,0,4" look_at="0,0,0" res="32 24"/><Option aa="int 2" max_bounces="int 3"/>
    <ShaderGroup name="wool">color base 1 0 0; shader paint coat;</ShaderGroup><Sphere center="-1,0,0" radius="0.8"/>
    <ShaderGroup name="silk">color base 0 1 0; shader paint coat;</ShaderGroup><Sphere center="1,0,0" radius="0.8"/>
    <ShaderGroup>color radiance 1 1 1; shader sky light;</ShaderGroup><Background/></World>"#;

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in [
        ("room.xml", SCENE),
        ("paint.osl", "surface paint(color base = 0.5, float nap = 1) { Ci = nap * base * diffuse(N); }"),
        ("still.osl", "displacement still(float height = 0) { P += height * N; }"),
        ("lost.osl", "surface lost() { Ci = (color)texture(\"nowhere.png\", u, v) * diffuse(N); }"),
        ("slips.osl", "surface slips(float nap = 1) { Ci = shen(diffuse(N), N, color(1), npa); }"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// Status, standard output and standard error.
fn say(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

/// The bytes of a picture.
fn picture(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let (code, _, error) = say(folder, &[&["render"], arguments, &["-o", "p.png"]].concat());
    assert_eq!((code, error.lines().count()), (0, 1), "{arguments:?}: {error}");
    std::fs::read(folder.join("p.png")).unwrap()
}

#[test]
fn the_command_line_goes_before_the_scene() {
    let folder = folder();
    let samples = |more: &[&str]| {
        let (code, _, error) = say(folder.path(), &[&["render", "room.xml", "-o", "p.png"], more].concat());
        assert_eq!(code, 0, "{error}");
        error
    };
    assert!(samples(&[]).contains(" 4 samples a pixel"));
    assert!(samples(&["--spp", "9"]).contains(" 9 samples a pixel"));
    assert!(samples(&["--aa", "3"]).contains(" 9 samples a pixel"));
    let of = |bounces: &str| picture(folder.path(), &["room.xml", "--max-bounces", bounces]);
    assert!(of("3") == picture(folder.path(), &["room.xml"]) && of("0") != of("3"));
}

#[test]
fn scenes_go_before_shaders_of_their_name_and_both_have_names_of_their_own() {
    let folder = folder();
    let size = |argument: &str| {
        let (code, _, error) = say(folder.path(), &["render", argument, "-o", "p.png", "--spp", "1", "--explain"]);
        assert_eq!(code, 0, "{argument}: {error}");
        let picture = image::open(folder.path().join("p.png")).unwrap();
        [picture.width(), picture.height()]
    };
    let small = ["--res", "24", "18", "--spp", "1"];
    let shown = |argument: &str| picture(folder.path(), &[&[argument], &small[..]].concat());
    assert!(shown("curtain") == shown("curtain.xml") && shown("curtain") != shown("curtain.osl"));
    assert!(shown("velour:cloth") == shown("cloth") && shown("cloth") == shown("cloth.osl"));
    assert_eq!(size("room.xml"), [32, 24]);
}

#[test]
fn a_displacement_moves_the_ball_and_the_cloth_as_they_are() {
    let folder = folder();
    let small = ["--res", "48", "36", "--spp", "2"];
    let of = |arguments: &[&str]| picture(folder.path(), &[arguments, &small[..]].concat());
    // One that moves nothing leaves what a matte surface shows.
    assert!(of(&["still.osl"]) == of(&["velour:matte"]));
    assert!(of(&["still.osl", "--param", "height", "0.1"]) != of(&["still.osl"]));
}

#[test]
fn values_are_for_the_groups_that_are_named() {
    let folder = folder();
    let with = |path: &str| picture(folder.path(), &["room.xml", "--param", path, "0,0,1"]);
    let (all, wool, silk) = (with("base"), with("wool.base"), with("silk.base"));
    assert!(wool != silk && wool != all && silk != all);
    assert!(wool == with("wool.coat.base") && all == with("coat.base"));
    let (code, _, error) = say(folder.path(), &["render", "room.xml", "-o", "p.png", "--param", "wool.bose", "1"]);
    assert!(code == 2 && error.contains("did you mean `wool.base`?"), "{error}");
    // A color takes one number or three.
    for arguments in [&["tree", "paint.osl"][..], &["render", "paint.osl", "-o", "p.png"]] {
        let (code, _, error) = say(folder.path(), &[arguments, &["--param", "base", "1,2"]].concat());
        assert!(code == 1 || code == 2, "{error}");
        assert!(error.contains("takes 3 numbers, or one, not 2 numbers"), "{error}");
    }
}

#[test]
fn shaders_of_the_binary_are_explained() {
    let folder = folder();
    for name in ["sky", "emitter", "velour:emitter", "form"] {
        let (code, out, error) = say(folder.path(), &["info", name]);
        assert!(code == 0 && out.contains(name.trim_start_matches("velour:")) && out.contains('"'), "{out}{error}");
    }
    // A word of the language goes before; a file here before the binary.
    assert!(say(folder.path(), &["info", "layer"]).1.starts_with("closure color layer("));
    let (code, out, _) = say(folder.path(), &["info", "paint"]);
    assert!(code == 0 && out.contains("nap"), "{out}");
    let (code, out, error) = say(folder.path(), &["tree", "cloth"]);
    assert!(code == 0 && out.contains("sheen"), "{out}{error}");
}

#[test]
fn what_does_not_parse_hides_nothing_else_and_is_shown_as_it_is_written() {
    let folder = folder();
    let text = "float f(float x) { return x + bad; }\nsurface odd(float a = 1)\n{\n    float y = f(a)\n    float z = y;\n    Ci = z * foo * diffuse(N);\n}\n";
    std::fs::write(folder.path().join("odd.osl"), text).unwrap();
    let (code, _, error) = say(folder.path(), &["check", "odd.osl"]);
    for part in [
        "odd.osl:1:31",
        "`bad` is not declared",
        "odd.osl:4:18",
        "missing `;`",
        "odd.osl:6:14",
        "`foo` is not declared",
    ] {
        assert!(error.contains(part), "{part}: {error}");
    }
    assert!(code == 1 && error.contains("4 │     float y = f(a)\n"), "{error}");
    assert_eq!(error.matches("error[").count(), 3, "what was declared is known: {error}");
}

#[test]
fn what_is_wrong_is_said_with_a_way_out() {
    let folder = folder();
    let says = |arguments: &[&str]| {
        let (code, out, error) = say(folder.path(), arguments);
        (code, out + &error)
    };
    let (code, text) = says(&["render", "room.xml", "-o", "p.png", "--crop", "20", "10", "16", "4"]);
    assert!(code == 2 && text.contains("ends at pixel 36 14, outside of its 32 x 24"), "{text}");
    let (code, text) = says(&["render", "room.xml", "-o", "p.png", "--debug-pixel", "1", "1"]);
    assert!(code == 0 && text.contains("no shader says anything at pixel 1 1"), "{text}");
    let (_, text) = says(&["render", "lost.osl", "-o", "p.png", "--res", "16", "12", "--spp", "1", "--path", "there"]);
    assert!(text.contains("there is no texture `nowhere.png` in the working folder, there"), "{text}");
    std::fs::create_dir(folder.path().join("inside")).unwrap();
    let (code, text) = says(&["render", "room.xml", "-o", "p.png", "--sandbox", "inside"]);
    assert!(code == 2 && text.contains("`room.xml` lies outside of the sandbox"), "{text}");
    // Both slips of one call, each with the name that was meant.
    let (code, text) = says(&["check", "slips.osl"]);
    assert_eq!(code, 1);
    assert!(text.contains("did you mean `sheen`?") && text.contains("did you mean `nap`?"), "{text}");
    let (_, text) = says(&["shade", "-o", "nothing", "null", "--print", "paint"]);
    assert!(text.contains("Output nothing not found, skipping."), "{text}");
    let (_, text) = says(&["shade", "--expr", "result = 0.25", "--print"]);
    assert!(text.contains("result : 0.25 0.25 0.25"), "{text}");
}
