//! `velour new`, `velour render` of a shader alone, of its parameters, of sheets; looks of a picture.

use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SMALL: [&str; 4] = ["--res", "48", "36", "--spp"];

/// A folder with some shaders.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let files = [
        ("red.osl", "surface red(color base = color(0.8, 0, 0), int n = 1) { Ci = base * n * diffuse(N); }"),
        (
            "pattern.osl",
            "shader pattern(float level = 0.5, output float gray = 0, output color Cout = 0) { gray = 1; Cout = level * color(0, 1, 0); }",
        ),
        (
            "node.osl",
            "shader node(color tint = color(0, 0, 1), output closure color BSDF = 0) { BSDF = tint * diffuse(N); }",
        ),
        ("bumps.osl", "displacement bumps(float height = 0.5) { P += height * sin(14 * u) * N; }"),
        ("black.osl", "surface black(float f = 0) { float x = f; }"),
        ("wrong.osl", "surface wrong() { Ci = diffuse(M); }"),
        (
            "deep.xml",
            r#"<World><Camera eye="0,0,4" look_at="0,0,0"/>
            <ShaderGroup name="ball">shader pattern a; color base 0 0 1; shader red b; connect a.Cout b.base;</ShaderGroup>
            <Sphere center="0,0,0" radius="1"/><ShaderGroup>color radiance 1 1 1; shader sky l1;</ShaderGroup><Background/></World>"#,
        ),
    ];
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(folder).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// The mean color of a square of the picture in the middle of a place, in shares of its size; linear.
fn color(folder: &Path, arguments: &[&str], [x, y]: [f32; 2]) -> [f32; 3] {
    let (code, error) = run(folder, &[&["render"], arguments, &["-o", "p.exr"]].concat());
    assert_eq!((code, error.lines().count()), (0, 1), "{arguments:?}: {error}");
    let image = image::open(folder.join("p.exr")).unwrap().to_rgb32f();
    let (w, h) = (image.width(), image.height());
    let (cx, cy) = ((x * w as f32) as u32, (y * h as f32) as u32);
    let mut sum = [0.0; 3];
    for (dx, dy) in (0..9).map(|i| (i % 3, i / 3)) {
        let pixel = image.get_pixel((cx + dx).min(w - 1), (cy + dy).min(h - 1));
        (0..3).for_each(|k| sum[k] += pixel[k] / 9.0);
    }
    sum
}

/// Where the ball and the cloth are.
const BALL: [f32; 2] = [0.2, 0.4];
const CLOTH: [f32; 2] = [0.7, 0.45];

/// Is one channel nearly all of the color?
fn is_mostly(color: [f32; 3], channel: usize) -> bool {
    let others: f32 = (0..3).filter(|k| *k != channel).map(|k| color[k]).sum();
    color[channel] > 0.05 && others < 0.6 * color[channel]
}

#[test]
fn a_shader_alone_is_shown_on_a_ball_and_a_cloth() {
    let folder = folder();
    let folder = folder.path();
    for at in [BALL, CLOTH] {
        let shown = |file: &str| color(folder, &[&[file], &SMALL[..], &["8"]].concat(), at);
        assert!(is_mostly(shown("red.osl"), 0), "{:?}", shown("red.osl"));
        // The color goes before the number, and a closure before both.
        assert!(is_mostly(shown("pattern.osl"), 1));
        assert!(is_mostly(shown("node.osl"), 2));
    }
    // A displacement moves the surfaces and leaves them grey.
    let flat = color(folder, &[&["bumps.osl", "--param", "height", "0"], &SMALL[..], &["16"]].concat(), BALL);
    let moved = color(folder, &[&["bumps.osl"], &SMALL[..], &["16"]].concat(), BALL);
    assert!(
        (flat[0] - flat[2]).abs() < 0.2 * flat[0] && (moved[0] - flat[0]).abs() > 0.02 * flat[0],
        "{flat:?} {moved:?}"
    );
    // Those in the binary, by their bare names, unless there is a file.
    assert!(is_mostly(color(folder, &[&["cloth"], &SMALL[..], &["8"]].concat(), BALL), 0));
    let (code, error) = run(folder, &[&["render", "figure1", "-o", "p.png"], &SMALL[..], &["1"]].concat());
    assert_eq!((code, error.lines().count()), (0, 1), "{error}");
}

#[test]
fn shaders_beside_the_one_that_is_shown_do_not_change_the_scene() {
    let folder = folder();
    let folder = folder.path();
    let picture = || {
        let (code, error) = run(folder, &[&["render", "red.osl", "-o", "p.png"], &SMALL[..], &["2"]].concat());
        assert_eq!(code, 0, "{error}");
        std::fs::read(folder.join("p.png")).unwrap()
    };
    let alone = picture();
    // By the names of what the built-in scene is made of: one is wrong, one is another, one is called so within its file.
    std::fs::write(folder.join("form.osl"), "displacement form( {").unwrap();
    std::fs::write(folder.join("matte.osl"), "surface matte() { Ci = emission(); }").unwrap();
    std::fs::write(folder.join("mine.osl"), "surface emitter() { Ci = 0; }").unwrap();
    assert!(alone == picture());
    // The control: shown by its own name, it is that of the file.
    let at = color(folder, &[&["matte.osl"], &SMALL[..], &["4"]].concat(), BALL);
    assert!(at.iter().all(|channel| *channel > 0.9), "{at:?}");
}

#[test]
fn what_is_wrong_with_a_shader_alone_is_said_of_it() {
    let folder = folder();
    let say = |arguments: &[&str]| {
        run(folder.path(), &[&["render"], arguments, &["-o", "p.png"], &SMALL[..], &["1"]].concat())
    };
    let (code, error) = say(&["black.osl"]);
    assert!(code == 0 && error.starts_with("black.osl: warning: the shader gives `Ci` no closure"), "{error}");
    let (code, error) = say(&["wrong.osl"]);
    assert!(code == 1 && error.contains("wrong.osl:1:") && !error.contains("built-in"), "{error}");
    let (code, error) = say(&["missing.osl"]);
    assert_eq!(
        (code, error.as_str()),
        (2, "error: shader `missing.osl` is not found\n  help: no `missing.osl` in .; add folders with --path\n")
    );
    let (code, error) = say(&["red.osl", "--param", "bas", "1"]);
    assert_eq!((code, error.as_str()), (2, "error: the shader has no parameter `bas`\n  help: did you mean `base`?\n"));
    let (code, error) = say(&["red.osl", "--param", "n", "x"]);
    assert!(code == 2 && error.starts_with("error: parameter `n` is an int"), "{error}");
    // The built-in scene's own shaders are not meant.
    assert_eq!(say(&["red.osl", "--param", "power", "1"]).0, 2);
}

#[test]
fn parameters_of_a_scene_are_set_by_their_paths() {
    let folder = folder();
    let mean = |more: &[&str]| color(folder.path(), &[&["deep.xml"], more, &SMALL[..], &["4"]].concat(), [0.5, 0.5]);
    assert!(is_mostly(mean(&[]), 1), "as it is: the pattern feeds the base");
    let dim = mean(&["--param", "level", "0.25"]);
    assert!((dim[1] / mean(&[])[1] - 0.5).abs() < 0.02, "{dim:?}");
    // A value goes before a connection.
    for path in ["base", "b.base", "ball.b.base"] {
        assert!(is_mostly(mean(&["--param", path, "1,0,0"]), 0), "{path}");
    }
    let grey = mean(&["--param", "b.base", "0.5"]);
    assert!((grey[0] - grey[2]).abs() < 1e-6 && grey[0] > 0.1, "one number makes a color: {grey:?}");
    let (code, error) = run(folder.path(), &["render", "deep.xml", "--param", "a.base", "1", "-o", "p.png"]);
    assert!(code == 2 && error.starts_with("error: no shader of the scene has a parameter `a.base`"), "{error}");
}

#[test]
fn a_sheet_has_a_cell_for_each_value() {
    let folder = folder();
    let folder = folder.path();
    let sheet = |sweeps: &[&str]| {
        let (code, error) =
            run(folder, &[&["render", "deep.xml"], sweeps, &["-o", "s.exr"], &SMALL[..], &["4"]].concat());
        assert_eq!((code, error.lines().count()), (0, 1), "{error}");
        image::open(folder.join("s.exr")).unwrap().to_rgb32f()
    };
    // Five cells of 48 by 36, and 14 lines for their labels.
    let image = sheet(&["--sweep", "level", "0.2:1:5"]);
    assert_eq!((image.width(), image.height()), (5 * 48, 36 + 14));
    let middle = |column: u32| image.get_pixel(column * 48 + 24, 18)[1];
    for (column, level) in [0.2, 0.4, 0.6, 0.8, 1.0].into_iter().enumerate() {
        assert!((middle(column as u32) / level - middle(4)).abs() < 0.02 * middle(4), "{column}");
    }
    // Labels have letters.
    let ink = (0..48).map(|x| image.get_pixel(x, 43)[0]).fold(0.0, f32::max);
    assert!(ink > 0.3, "{ink}");
    let alone = color(folder, &[&["deep.xml", "--param", "level", "0.4"], &SMALL[..], &["4"]].concat(), [0.5, 0.5]);
    let cell: f32 = (0..9).map(|i| image.get_pixel(48 + 24 + i % 3, 18 + i / 3)[1] / 9.0).sum();
    assert!((alone[1] - cell).abs() < 1e-6, "a cell is the picture: {alone:?} {cell}");

    let image = sheet(&["--sweep", "level", "0.5:1:2", "--sweep", "n", "0:1:2"]);
    assert_eq!((image.width(), image.height()), (2 * 48, 2 * 50));
    assert_eq!((image.get_pixel(24, 18)[1], image.get_pixel(72, 18)[1]), (0.0, 0.0), "n = 0 above");
    let below = [24, 72].map(|x| image.get_pixel(x, 68)[1]);
    assert!((below[0] / below[1] - 0.5).abs() < 0.02, "{below:?}");

    for wrong in [["level", "1:2"], ["nothing", "0:1:3"], ["level", "0:1:1000"]] {
        let (code, error) = run(folder, &[&["render", "deep.xml", "-o", "s.png", "--sweep"], &wrong[..]].concat());
        assert!(code == 2 && error.starts_with("error: "), "{error}");
    }
}

#[test]
fn a_swept_displacement_moves_its_surfaces_anew() {
    let folder = folder();
    let (code, error) = run(
        folder.path(),
        &[&["render", "bumps.osl", "--sweep", "height", "0:0.3:2", "-o", "s.exr"], &SMALL[..], &["4"]].concat(),
    );
    assert_eq!((code, error.lines().count()), (0, 1), "{error}");
    let image = image::open(folder.path().join("s.exr")).unwrap().to_rgb32f();
    let differ = (0..36).flat_map(|y| (0..48).map(move |x| (x, y)));
    let differ =
        differ.filter(|(x, y)| (image.get_pixel(*x, *y)[0] - image.get_pixel(x + 48, *y)[0]).abs() > 0.02).count();
    assert!(differ > 100, "{differ} pixels differ");
}

#[test]
fn a_value_that_moves_one_surface_and_colors_another_does_both_in_every_cell() {
    let folder = folder();
    let folder = folder.path();
    // The color is of the material that comes first, the displacement of the second.
    std::fs::write(folder.join("lift.osl"), "displacement lift(float level = 0) { P += vector(0, 0.5 * level, 0); }")
        .unwrap();
    let scene = r#"<World><Camera eye="0,0,4" look_at="0,0,0"/>
        <ShaderGroup name="left">shader pattern a; shader red b; connect a.Cout b.base;</ShaderGroup><Sphere center="-0.7,0,0" radius="0.4"/>
        <ShaderGroup name="right" type="displacement">shader lift l;</ShaderGroup>
        <ShaderGroup name="right">shader matte m;</ShaderGroup><Sphere center="0.5,-0.3,0" radius="0.3" resolution="16"/>
        <ShaderGroup>color radiance 1 1 1; shader sky l1;</ShaderGroup><Background/></World>"#;
    std::fs::write(folder.join("both.xml"), scene).unwrap();
    let sheet = ["render", "both.xml", "--sweep", "level", "0.25:1:2", "-o", "s.exr"];
    let (code, error) = run(folder, &[&sheet[..], &SMALL[..], &["4"]].concat());
    assert_eq!((code, error.lines().count()), (0, 1), "{error}");
    let sheet = image::open(folder.join("s.exr")).unwrap().to_rgb32f();
    let alone = ["render", "both.xml", "--param", "level", "1", "-o", "p.exr"];
    assert_eq!(run(folder, &[&alone[..], &SMALL[..], &["4"]].concat()).0, 0);
    let alone = image::open(folder.join("p.exr")).unwrap().to_rgb32f();
    for (x, y) in (0..36).flat_map(|y| (0..48).map(move |x| (x, y))) {
        assert_eq!(sheet.get_pixel(48 + x, y), alone.get_pixel(x, y), "{x} {y}");
    }
}

#[test]
fn looks_are_of_png_alone_and_by_their_formulas() {
    let folder = folder();
    let folder = folder.path();
    // One lamp of radiance 4, 1 and .25 that fills the picture.
    let scene = r#"<World><ShaderGroup>color radiance 4 1 0.25; shader sky l1;</ShaderGroup><Background/></World>"#;
    let pixel = |more: &[&str]| {
        let (code, error) = run(folder, &[&["render", scene, "-o", "p.png"], more, &SMALL[..], &["1"]].concat());
        assert_eq!((code, error.lines().count()), (0, 1), "{error}");
        image::open(folder.join("p.png")).unwrap().to_rgb8().get_pixel(3, 3).0
    };
    let srgb = |x: f32| ((1.055 * x.powf(1.0 / 2.4) - 0.055) * 255.0).round() as u8;
    assert_eq!(pixel(&["--view", "srgb"]), [255, 255, srgb(0.25)]);
    assert_eq!(pixel(&["--view", "srgb", "--exposure", "-2"]), [255, srgb(0.25), srgb(0.0625)]);
    assert_eq!(pixel(&["--view", "linear", "--exposure", "-3"]), [128, 32, 8]);
    let [r, g, b] = pixel(&[]);
    assert!(r < 255 && r > g && g > b && b > srgb(0.25), "a lamp keeps its form: {r} {g} {b}");
    assert_ne!(pixel(&["--view", "agx"]), pixel(&[]));
    let exr = |more: &[&str]| {
        let (_, error) = run(folder, &[&["render", scene, "-o", "p.exr"], more, &SMALL[..], &["1"]].concat());
        (std::fs::read(folder.join("p.exr")).unwrap(), error.contains("note: --view and --exposure are of .png"))
    };
    let ((seen, told), (plain, quiet)) = (exr(&["--view", "agx", "--exposure", "3"]), exr(&[]));
    assert!(seen == plain && told && !quiet, "linear light stays as it is, which is said");
    assert_eq!(run(folder, &["render", scene, "-o", "p.png", "--view", "odd"]).0, 2);
}

#[test]
fn a_first_shader_and_scene_are_written_render_and_are_never_written_over() {
    let place = TempDir::new().unwrap();
    let say = |arguments: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(place.path()).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    };
    let (code, out, error) = say(&["new", "first/silk"]);
    assert_eq!((code, error.as_str()), (0, ""));
    let commands: Vec<&str> = out.lines().skip(1).collect();
    assert_eq!(
        commands,
        ["  velour render first/silk.osl -o picture.png", "  velour render first/silk.xml -o scene.png"]
    );
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        // Away from the checkout, so that sky, matte and emitter are those in the binary.
        let (code, _, error) = say(&[&words[..], &SMALL[..], &["1"]].concat());
        assert_eq!((code, error.lines().count()), (0, 1), "{error}");
        assert!(place.path().join(words.last().unwrap()).is_file());
    }
    assert_eq!(say(&["check", "first/silk.osl"]), (0, String::new(), String::new()));

    std::fs::write(place.path().join("first/silk.osl"), "mine").unwrap();
    std::fs::remove_file(place.path().join("first/silk.xml")).unwrap();
    let (code, out, error) = say(&["new", "first/silk"]);
    assert_eq!((code, out.as_str()), (2, ""));
    let expected = "error: `first/silk.osl` is there already\n  help: nothing is written over; take another name\n";
    assert_eq!(error, expected);
    assert_eq!(std::fs::read(place.path().join("first/silk.osl")).unwrap(), b"mine");
    assert!(!place.path().join("first/silk.xml").exists(), "all or nothing");

    let (code, out, _) = say(&["new"]);
    assert!(code == 0 && out.starts_with("silk.osl is a shader to change"), "{out}");
    // Names that the language or a scene cannot have as they are.
    for name in ["color", "2 of-them", "größe.osl"] {
        let (code, _, error) = say(&["new", name]);
        assert_eq!(code, 0, "{name}: {error}");
        let scene = format!("{}.xml", name.trim_end_matches(".osl"));
        let (code, _, error) = say(&[&["render", &scene, "-o", "x.png"], &SMALL[..], &["1"]].concat());
        assert_eq!((code, error.lines().count()), (0, 1), "{name}: {error}");
    }
    assert_eq!(say(&["new", "a\"b"]).0, 2);
    assert_eq!(say(&["new", "silk.osl/x"]).0, 2, "a file is no folder");
}
