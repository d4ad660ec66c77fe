//! The kinds of input, and who reads them.

use std::path::Path;
use velour::compile::{Compiler, Recipe};
use velour::exec::{Machine, Points};
use velour::render::part;
use velour::render::{Renderer, Settings, Silent};
use velour::scene::{Place, Scene, ShaderFiles, parse_group};
use velour::texture;

/// A kind of input.
#[derive(Clone, Copy)]
pub struct Kind {
    pub name: &'static str,
    /// How many inputs `cargo test` makes.
    pub few: u64,
    /// The endings of files that are of this kind.
    pub extensions: &'static [&'static str],
    /// Inputs to begin with.
    pub own: fn() -> Vec<Vec<u8>>,
    /// What is put in here and there.
    pub words: &'static [&'static str],
    /// Reads an input and does what follows from it; the folder is its own.
    pub read: fn(&[u8], &Path),
}

pub const SHADER: Kind =
    Kind { name: "shader", few: 1500, extensions: &["osl", "h"], own: shaders, words: WORDS, read: read_shader };
pub const GROUP: Kind =
    Kind { name: "group", few: 5000, extensions: &["group"], own: groups, words: GROUP_WORDS, read: read_group };
pub const SCENE_XML: Kind =
    Kind { name: "scene", few: 800, extensions: &["xml"], own: scenes, words: XML_WORDS, read: read_scene };
pub const MESH: Kind =
    Kind { name: "mesh", few: 800, extensions: &["obj"], own: meshes, words: OBJ_WORDS, read: read_mesh };
pub const MATERIALS: Kind =
    Kind { name: "materials", few: 800, extensions: &["mtl"], own: materials, words: MTL_WORDS, read: read_materials };
pub const PART: Kind = Kind { name: "part", few: 400, extensions: &[], own: parts, words: PART_WORDS, read: read_part };
pub const TEXTURE: Kind =
    Kind { name: "texture", few: 800, extensions: &[], own: textures, words: PART_WORDS, read: read_texture };

pub const RECIPE: Kind =
    Kind { name: "recipe", few: 5000, extensions: &["oso"], own: recipes, words: RECIPE_WORDS, read: read_recipe };

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

const WORDS: &[&str] = &[
    "float",
    "int",
    "color",
    "string",
    "closure color",
    "struct",
    "matrix",
    "output",
    "if (",
    "for (",
    "while (u > 0)",
    "do {",
    "} while (",
    "return",
    "break;",
    "continue;",
    "exit();",
    "[3]",
    "[1000000000]",
    "{",
    "}",
    "(",
    ")",
    ";",
    ",",
    "\"",
    "\\",
    "/*",
    "*/",
    "//",
    "#define A(x) x A(x)\n",
    "#include \"",
    "#if 1/0\n",
    "#endif\n",
    "#ifdef",
    "##",
    "[[",
    "]]",
    "?",
    ":",
    "=",
    "==",
    "<<",
    "<<=",
    "-2147483648",
    "1e999",
    "0x7fffffff",
    "99999999999",
    "Dx(",
    "noise(\"gabor\",",
    "texture(",
    "spline(\"linear\",",
    "format(\"%*d\",",
    "printf(\"%s%d%n\",",
    "Ci = layer(Ci,",
    "sheen(",
    "microfacet(",
    "getattribute(",
    "setmessage(",
    "trace(",
    "regex_search(",
    "dict_find(",
    "split(",
    "(color)",
    "P[u]",
    "N.x",
    "Ci",
    "u",
    "v",
    "%",
    "&&",
    "~",
    "\u{0}",
    "\u{feff}",
    "\u{e9}",
    "'",
    "@",
    "$",
    "`",
];

fn shaders() -> Vec<Vec<u8>> {
    texts(&[
        "surface a(float x = 1 [[float min = 0, float max = 2]], string s = \"k\") { Ci = x * diffuse(N) + emission(); }",
        "shader b(output color c[3] = {0, 1, 2}) { for (int i = 0; i < 3; ++i) c[i] = noise(\"perlin\", P * i, u); }",
        "struct S { float a; int b[2]; }; float f(S s, output int k) { k = s.b[1]; return s.a; }\nshader c() { S s = {u, {1, 2}}; int k; float y = f(s, k); printf(\"%g %d\\n\", y, k); }",
        "#define TWICE(x) ((x) * 2)\n#if defined(TWICE) && 1\nsurface d() { matrix m = 1; point q = transform(m, P); Ci = TWICE(q[0]) * sheen(N, .3); }\n#endif\n",
        "surface e() { string r[4]; int n = split(\"a,b,c\", r, \",\"); color k = texture(\"t.png\", u, v, \"wrap\", \"clamp\"); Ci = layer(sheen_bsdf(N, k, .2), n * diffuse(N)); }",
    ])
}

fn points() -> Points {
    let mut points = Points::new(5);
    for lane in 0..5 {
        (points.u[lane], points.v[lane]) = (lane as f32 / 4.0, 0.3);
        (points.p.x[lane], points.n.z[lane], points.ng.z[lane], points.i.z[lane]) = (lane as f32, 1.0, 1.0, -1.0);
    }
    points
}

thread_local! {
    /// With the standard header, and with none, which is read faster.
    static COMPILERS: [Compiler; 2] = [Compiler::new(), Compiler::new().with_header("none.h", "")];
}

fn read_shader(bytes: &[u8], _folder: &Path) {
    let checked =
        COMPILERS.with(|both| both[usize::from(!bytes.len().is_multiple_of(8))].check_closely("input.osl", bytes));
    let _ = checked.diagnostics.list.len();
    let Some(shader) = checked.shader else { return };
    let Ok(group) = shader.group().build() else { return };
    let mut machine = Machine::new();
    machine.budget = 20_000;
    machine.shade(&group, &points());
    machine.take_reports().iter().for_each(|report| drop(report.to_string()));
}

const GROUP_WORDS: &[&str] = &[
    "shader",
    "param",
    "float",
    "connect",
    "a.b",
    "c.d",
    ";",
    "\"",
    "[4]",
    "color",
    "1 2 3",
    "[[",
    "]]",
    "lockgeom=0",
    "string",
    "matrix",
    "int[",
    "{",
    "}",
    "-",
    "1e99",
    "\\",
    "#",
];

fn groups() -> Vec<Vec<u8>> {
    texts(&[
        "float x 1; shader ramp one; color c .1 .2 .3; string[2] s \"a\" \"b\"; shader matte two; connect one.c two.Cs;",
        "param int k 3 [[int lockgeom=0]];\nshader a b ;\nparam matrix m 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1; shader c d;",
    ])
}

fn read_group(bytes: &[u8], _folder: &Path) {
    let _ = parse_group(&String::from_utf8_lossy(bytes), &|_| Place { file: "g".into(), line: 1, column: 1 });
}

const XML_WORDS: &[&str] = &[
    "<World>",
    "</World>",
    "<Sphere center=\"0,0,0\" radius=\"1\"/>",
    "<Quad corner=\"0,0,0\" edge_x=\"1,0,0\" edge_y=\"0,1,0\"/>",
    "<ShaderGroup>",
    "</ShaderGroup>",
    "<Model filename=\"m.obj\"/>",
    "<Background resolution=\"9\"/>",
    "<Flakes count=\"9\"",
    "<Weave",
    "<Option",
    "radius=\"",
    "shader matte l;",
    "&amp;",
    "&#x0;",
    "<!--",
    "-->",
    "<![CDATA[",
    "<!DOCTYPE a [",
    "\"",
    "'",
    "nan",
    "inf",
    "1e39",
    "-",
    ",",
];

const SCENE: &str = "<World><Camera eye=\"0,0,4\" look_at=\"0,0,0\" fov=\"50\"/><Option max_bounces=\"int 3\"/>\
    <ShaderGroup name=\"a\">color Cs .5 .4 .3; shader matte l;</ShaderGroup><Sphere center=\"0,0,0\" radius=\"1\" resolution=\"8\"/>\
    <ShaderGroup is_light=\"yes\">shader glow l;</ShaderGroup><Quad corner=\"-1,3,-1\" edge_x=\"2,0,0\" edge_y=\"0,0,2\"/>\
    <ShaderGroup>shader sky l;</ShaderGroup><Background resolution=\"8\"/></World>";

fn scenes() -> Vec<Vec<u8>> {
    texts(&[SCENE])
}

thread_local! {
    /// Compiled once a thread.
    static FILES: ShaderFiles = [
        "surface matte(color Cs = .5) { Ci = Cs * diffuse(N); }",
        "surface glow(float x = 1) { Ci = x * emission(); }",
        "surface sky() { Ci = .2 * background(); }",
    ]
    .iter()
    .fold(ShaderFiles::default(), |files, text| files.with_shader(text).unwrap());
}

/// Loads a scene and renders a few pixels of it.
fn render(text: &str, folder: &Path) {
    let scene = FILES.with(|files| Scene::load(text, &[folder.to_owned()], files));
    let Ok(scene) = scene else { return };
    if scene.geometry.primitives.len() > 10_000 {
        return;
    }
    let settings = Settings { width: 3, height: 2, samples: 1, threads: 1, seconds: Some(1.0), ..Settings::default() };
    if let Ok(mut renderer) = Renderer::new(&scene, &settings.with_options(&scene.options)) {
        let _ = renderer.finish(&Silent);
        assert!(renderer.picture().pixels.iter().all(|x| x.is_finite()));
    }
}

fn read_scene(bytes: &[u8], folder: &Path) {
    let text = String::from_utf8_lossy(bytes);
    // What does not begin as a scene does is the name of a file.
    if text.trim_start().starts_with('<') {
        render(&text, folder);
    }
}

const OBJ_WORDS: &[&str] = &[
    "v 0 0 0\n",
    "vn 0 0 1\n",
    "vt 0 1\n",
    "f 1 2 3\n",
    "f 1//1 2//2 3//3\n",
    "f 1/1/1 2/2/2 3/3/3 4/4/4\n",
    "f -1 -2 -3\n",
    "usemtl a\n",
    "mtllib m.mtl\n",
    "o x\n",
    "g y\n",
    "s 1\n",
    "\\\n",
    "#",
    "/",
    "-99999999",
    "4294967297",
    "nan",
    "1e39",
    "\t",
    "\r",
];

fn meshes() -> Vec<Vec<u8>> {
    texts(&[
        "mtllib m.mtl\no a\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/2/1 3/3/1\nf 1 3 4\n",
        "v 0 0 0 1 0 0\nv 1 0 0 # c\nv 1 1 0\nv .5 1 0\nv .5 .5 0\nv 0 1 0\nf -6 -5 -4 -3 -2 -1\ng b\nf 1 2 \\\n3\n",
    ])
}

fn mesh_scene(folder: &Path) {
    let model = "<Model filename=\"m.obj\"/>";
    render(&SCENE.replace("<Sphere center=\"0,0,0\" radius=\"1\" resolution=\"8\"/>", model), folder);
}

fn read_mesh(bytes: &[u8], folder: &Path) {
    std::fs::write(folder.join("m.obj"), bytes).unwrap();
    mesh_scene(folder);
}

const MTL_WORDS: &[&str] =
    &["newmtl a\n", "Kd 1 1 1\n", "Kd", "map_Kd t.png\n", "Ns", "d 1\n", "illum 2\n", "#", "nan", "\\\n", "-"];

fn materials() -> Vec<Vec<u8>> {
    texts(&["newmtl a\nKd .5 .5 .5\nKs 1 1 1\nNs 10\nd 1\nillum 2\nmap_Kd -s 1 1 1 t.png\nnewmtl b\nTr 0\n"])
}

fn read_materials(bytes: &[u8], folder: &Path) {
    std::fs::write(folder.join("m.mtl"), bytes).unwrap();
    std::fs::write(folder.join("m.obj"), &meshes()[0]).unwrap();
    mesh_scene(folder);
}

const PART_WORDS: &[&str] = &[
    "\u{0}",
    "\u{1}",
    "velour part 1",
    "\ntiles 9x0..4",
    "\nsize 9 9",
    "\nscene ",
    "x0..",
    "RLE",
    "chlist",
    "tier0.red.high",
    "~~~~",
];

fn parts() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.exr");
    let scene = FILES.with(|files| Scene::load(SCENE, &[], files)).unwrap();
    let one = |size: (u32, u32)| {
        let settings = Settings { width: size.0, height: size.1, samples: 2, threads: 1, ..Settings::default() };
        let mut renderer = Renderer::new(&scene, &settings).unwrap();
        renderer.finish(&Silent).unwrap();
        part::write(&renderer.part(), &path).unwrap();
        std::fs::read(&path).unwrap()
    };
    [(3, 2), (20, 5)].map(one).to_vec()
}

fn read_part(bytes: &[u8], _folder: &Path) {
    if let Ok(part) = part::read_bytes(bytes) {
        let _ = (part.picture(), part.summary(), part.clone().merge(part));
    }
}

const RECIPE_WORDS: &[&str] = &[
    "velour 1: how a shader is compiled, no code; OSL's tools cannot read it\n",
    "source ",
    "name ",
    "header ",
    "include ",
    "define A 1\n",
    "undefine A\n",
    "\r\n",
    "\u{0}",
    "\u{e9}",
    "  ",
    "/",
    "..",
];

fn recipes() -> Vec<Vec<u8>> {
    let recipe = Recipe {
        source: "/a/b c.osl".into(),
        name: "b c.osl".into(),
        header: Some("std.h".into()),
        include_dirs: vec!["/x".into(), "y z".into()],
        defines: vec![("A".into(), "1".into()), ("B".into(), String::new())],
        undefines: vec!["C".into()],
    };
    vec![recipe.text().unwrap().into_bytes()]
}

fn read_recipe(bytes: &[u8], _folder: &Path) {
    if let Some(recipe) = Recipe::read(&String::from_utf8_lossy(bytes)) {
        // What was read is written as what reads as the same.
        assert!(recipe.text().is_none_or(|text| Recipe::read(&text) == Some(recipe)));
    }
}

/// Small pictures of all formats, the format in the first byte.
fn textures() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let pixels = (0..5 * 4 * 3).map(|i| (i as f32 * 0.37).fract()).collect();
    let image = velour::render::Image { width: 5, height: 4, channels: 3, pixels, about: Default::default() };
    let written = ["exr", "png", "hdr"].into_iter().enumerate().map(|(i, format)| {
        let path = folder.path().join(format!("t.{format}"));
        velour::render::output::write(&image, &path).unwrap();
        [vec![i as u8], std::fs::read(&path).unwrap()].concat()
    });
    written.chain([[vec![3], tiff()].concat()]).collect()
}

/// A TIFF of two by two grey bytes, written by hand: header, directory, texels.
fn tiff() -> Vec<u8> {
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    let tags: [(u16, u16, u32); 8] =
        [(256, 3, 2), (257, 3, 2), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 110), (278, 3, 2), (279, 4, 4)];
    bytes.extend((tags.len() as u16).to_le_bytes());
    for (tag, kind, value) in tags {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(1u32.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
    bytes.extend([10, 20, 30, 40]);
    bytes
}

fn read_texture(bytes: &[u8], folder: &Path) {
    let Some((format, rest)) = bytes.split_first() else { return };
    let path = folder.join(["t.exr", "t.png", "t.hdr", "t.tif", "t.jpg"][usize::from(*format) % 5]);
    std::fs::write(&path, rest).unwrap();
    if let Ok(found) = texture::read(&path, 1 << 24) {
        let _ = found.value(0.3, 0.7, [0.1, 0.0, 0.0, 0.2], &texture::Lookup::default());
    }
}
