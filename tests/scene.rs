//! Scenes: what they may say, and one clear message with a place for each thing they may not.

use std::path::PathBuf;
use velour::exec::Group;
use velour::scene::{
    GroupCompiler, GroupSpec, ParamType, Place, Scene, SceneError, SceneProblem, ShaderFiles, Shape, Usage, Values,
    parse_group,
};

/// Knows every shader but `missing`, and keeps nothing.
struct Anything;

impl GroupCompiler for Anything {
    fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
        match spec.layers.iter().find(|l| l.shader == "missing") {
            Some(layer) => {
                Err(SceneError::at(layer.place.clone(), SceneProblem::ShaderNotFound { shader: layer.shader.clone() }))
            }
            None => {
                Ok(velour::compile::compile("surface any() { Ci = diffuse(N); }").unwrap().group().build().unwrap())
            }
        }
    }
}

fn load(argument: &str) -> Result<Scene, SceneError> {
    Scene::load(argument, &[] as &[PathBuf], &Anything)
}

/// The message of a scene whose second line is `line`, in a file called `<scene text>`.
fn message(line: &str) -> String {
    let text = format!(
        "<World><ShaderGroup>shader matte l1;</ShaderGroup><Sphere center=\"0,0,0\" radius=\"1\"/>\n{line}\n</World>"
    );
    match load(&text) {
        Ok(_) => panic!("accepted: {line}"),
        Err(error) => error.to_string().replace("<scene text>", "s"),
    }
}

#[test]
fn every_mistake_has_a_place_and_a_message() {
    let cases = [
        ("<Spere/>", "s:2:1: error: unknown tag <Spere>\n  help: did you mean <Sphere>?"),
        ("<Teapot/>", "s:2:1: error: unknown tag <Teapot>\n  help: known tags here: Option, Camera"),
        (
            r#"<Sphere centre="0,0,0"/>"#,
            "s:2:9: error: <Sphere> has no attribute `centre`\n  help: did you mean `center`?",
        ),
        (r#"<Sphere center="0,0,0"/>"#, "s:2:1: error: <Sphere> needs the attribute `radius`"),
        (r#"<Sphere center="0,0" radius="1"/>"#, "s:2:17: error: `center` of <Sphere> is `0,0`: three numbers"),
        (r#"<Sphere center="0,0,0" radius="0"/>"#, "s:2:32: error: `radius` of <Sphere> is `0`: a number above 0"),
        (r#"<Sphere center="0,0,0" radius="nan"/>"#, "s:2:32: error: `radius`"),
        (r#"<Sphere center="0,0,inf" radius="1"/>"#, "s:2:17: error: `center`"),
        (r#"<Quad corner="0,0,0" edge_x="1,0,0" edge_y="0,0,0"/>"#, "s:2:1: error: this <Quad> has no area"),
        (r#"<Quad corner="0,0,0" edge_x="1,2,3" edge_y="2,4,6"/>"#, "s:2:1: error: this <Quad> has no area"),
        (r#"<Model filename="nowhere.obj"/>"#, "s:2:18: error: mesh `nowhere.obj` is not found\n  help: looked in ."),
        (r#"<Weave corner="0,0,0" edge_x="1,0,0"/>"#, "s:2:1: error: <Weave> needs the attribute `edge_y`"),
        (r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="2,0,0"/>"#, "s:2:1: error: this <Weave> has no area\n  help:"),
        (
            r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="0,0,1" warp="0"/>"#,
            "s:2:59: error: `warp` of <Weave> is `0`: a whole number from 1 to 4096 expected",
        ),
        (
            r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="0,0,1" pattern="knit"/>"#,
            "s:2:62: error: `pattern` of <Weave> is `knit`: `plain`, `twill` or `satin` expected",
        ),
        (
            r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="0,0,1" warp="4096" weft="4096"/>"#,
            "s:2:1: error: this <Weave> would have 3221225472 triangles, 8000000 are the most\n  help: lower `warp`",
        ),
        (
            r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="0,0,1" weft_group="blue"/>"#,
            "s:2:65: error: `weft_group` of <Weave> is `blue`: the name of a <ShaderGroup> above expected\n  help: give",
        ),
        (r#"<Flakes low="0,0,0" high="1,1,1"/>"#, "s:2:1: error: <Flakes> needs the attribute `size`"),
        (r#"<Flakes low="0,0,0" high="1,-1,1" size="1"/>"#, "s:2:1: error: `low` of this <Flakes> is above `high`"),
        (
            r#"<Flakes low="0,0,0" high="1,1,1" size="1" count="9000000"/>"#,
            "s:2:50: error: `count` of <Flakes> is `9000000`: a whole number from 1 to 8000000 expected",
        ),
        (r#"<Option aa="4"/>"#, "s:2:13: error: `aa` of <Option> is `4`: `int N`"),
        (r#"<Background resolution="many"/>"#, "s:2:25: error: `resolution`"),
        ("  stray", "s:2:3: error: text in <World>, which holds only elements\n  help: remove it"),
        ("<ShaderGroup/>", "s:2:1: error: this <ShaderGroup> has no shader"),
        (
            r#"<ShaderGroup type="surfac">shader a b;</ShaderGroup>"#,
            "s:2:20: error: `type` of <ShaderGroup> is `surfac`",
        ),
        ("<ShaderGroup>shader missing l1;</ShaderGroup>", "s:2:21: error: shader `missing` is not found"),
        ("<ShaderGroup>float a 1;</ShaderGroup>", "s:2:1: error: this <ShaderGroup> has no shader"),
        ("<ShaderGroup>shader a b; float k 1;</ShaderGroup>", "s:2:32: error: parameter `k` has no shader after it"),
        ("<ShaderGroup>shade a b;</ShaderGroup>", "s:2:14: error: unknown statement `shade`"),
        ("<ShaderGroup>param flat k 1; shader a b;</ShaderGroup>", "s:2:20: error: unknown parameter type `flat`"),
        ("<ShaderGroup>float k 1 2; shader a b;</ShaderGroup>", "s:2:24: error: `;` expected, found `2`"),
        ("<ShaderGroup>float k x; shader a b;</ShaderGroup>", "s:2:22: error: `;` expected, found `x`"),
        ("<ShaderGroup>string k \"x; shader a b;</ShaderGroup>", "s:2:23: error: this string has no closing quote"),
        ("<ShaderGroup>float k 1 [[int lock=0]]; shader a b;</ShaderGroup>", "s:2:26: error: unknown hint `int lock`"),
        ("<ShaderGroup>shader a b; connect b c;</ShaderGroup>", "s:2:36: error: `.` expected after layer `b`"),
        ("<ShaderGroup>shader a b; connect b.x d.y;</ShaderGroup>", "s:2:34: error: no layer is named `d`"),
        (
            "<ShaderGroup>shader a b; shader a c; connect c.x b.y;</ShaderGroup>",
            "s:2:46: error: layer `c` does not come before",
        ),
        ("<ShaderGroup><Shadr/></ShaderGroup>", "s:2:14: error: unknown tag <Shadr>\n  help: did you mean <Shader>?"),
        (r#"<ShaderGroup><Shader name="a"/></ShaderGroup>"#, "s:2:14: error: <Shader> needs the attribute `layer`"),
        ("<Sphere", "error: the scene is not well-formed XML"),
    ];
    hold(&cases);
}

#[test]
fn a_camera_that_makes_no_picture_is_refused() {
    hold(&[
        (r#"<Camera dir="0,0,0"/>"#, "s:2:1: error: the camera looks nowhere"),
        (r#"<Camera dir="0,1,0"/>"#, "s:2:1: error: the camera's `up` is parallel"),
        (r#"<Camera fov="180"/>"#, "s:2:14: error: `fov` of <Camera> is `180`"),
        (
            r#"<Camera fov="0"/>"#,
            "s:2:14: error: `fov` of <Camera> is `0`: an angle between 0 and 180 degrees expected\n  help",
        ),
        (r#"<Camera fov="-40"/>"#, "s:2:14: error: `fov` of <Camera> is `-40`"),
        (r#"<Camera fov="NaN"/>"#, "s:2:14: error: `fov` of <Camera> is `NaN`"),
        (r#"<Camera fov="inf"/>"#, "s:2:14: error: `fov` of <Camera> is `inf`"),
        (
            r#"<Camera fov="2e-21"/>"#,
            "s:2:14: error: the camera's `fov` is so small that all pixels look in one direction\n  help: give at least",
        ),
        (r#"<Camera eye="1e38,0,0" look_at="-3e38,0,0"/>"#, "s:2:1: error: the camera looks nowhere"),
        (r#"<Camera up="0,0,0"/>"#, "s:2:1: error: the camera's `up` is parallel"),
    ]);
}

/// Holds that each line gives its message.
fn hold(cases: &[(&str, &str)]) {
    let wrong: Vec<String> = cases
        .iter()
        .map(|(line, expected)| (line, message(line), expected))
        .filter(|(_, found, expected)| !found.contains(*expected))
        .map(|(line, found, expected)| format!("{line}\n  gives    {found}\n  expected {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn mistakes_of_the_whole_scene() {
    let error = |text: &str| load(text).map(|_| ()).unwrap_err().to_string();
    assert!(error("<World/>").contains(":1:1: error: the scene has nothing to see"));
    assert!(error("<Scene/>").contains(":1:1: error: the scene's root is <Scene>"));
    assert!(error("no-such-file.xml").contains("cannot read the scene `no-such-file.xml`"));
    let early = error(r#"<World><Sphere center="0,0,0" radius="1"/></World>"#);
    assert!(early.contains(":1:8: error: <Sphere> comes before any <ShaderGroup>"), "{early}");
}

#[test]
fn an_unreadable_mesh_blames_the_scene_line() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.xml");
    std::fs::write(&scene, "<World><ShaderGroup>shader a b;</ShaderGroup>\n<Model filename=\"m.obj\"/></World>")
        .unwrap();
    for (mesh, what) in [("v 1 2\n", "mesh"), ("v 0 0 0\nf 1 2 9\n", "mesh"), ("# empty\n", "it has no faces")] {
        std::fs::write(folder.path().join("m.obj"), mesh).unwrap();
        let error = load(scene.to_str().unwrap()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("s.xml:2:18: error: mesh") && error.contains(what), "{error}");
    }
}

#[test]
fn a_mesh_finds_its_materials_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 0\no thing\nusemtl red\nf 1 2 3\nusemtl other\nf 2 4 3\nf 1 5 1\n";
    std::fs::write(folder.path().join("m.obj"), obj).unwrap();
    std::fs::write(folder.path().join("m.mtl"), "newmtl red\nKd 1 0 0\nnewmtl other\nKd 0 0 1\n").unwrap();
    let scene = folder.path().join("s.xml");
    let text = r#"<World><ShaderGroup name="red">shader a b;</ShaderGroup><ShaderGroup name="last">shader a b;</ShaderGroup>
      <Model filename="m.obj"/></World>"#;
    std::fs::write(&scene, text).unwrap();
    let scene = load(scene.to_str().unwrap()).unwrap();
    let objects = &scene.geometry.objects;
    let materials: Vec<u32> = scene.geometry.primitives.iter().map(|p| objects[p.object as usize].material).collect();
    assert_eq!(materials, [0, 1]);
    assert_eq!(objects[0].surface_area, 1.0, "two materials of one shape are one surface");
    assert!(scene.warnings[0].contains("1 triangles of `m.obj` have no area"), "{:?}", scene.warnings);
}

#[test]
fn a_scene_says_what_it_says() {
    let scene = load(
        r#"<World>
        <Camera eye="1,2,3" look_at="1,2,0" fov="30"/>
        <Option max_bounces="int 4" aa="int 3" colour="int 1"/>
        <ShaderGroup name="m" is_light="on">shader matte l1;</ShaderGroup>
        <Quad corner="0,0,0" edge_x="1,0,0" edge_y="0,2,0" resolution="4"/>
        <ShaderGroup name="m" type="displacement">shader bump l1;</ShaderGroup>
        <Background/>
    </World>"#,
    )
    .unwrap();
    assert_eq!(scene.camera.direction, glam::Vec3::NEG_Z);
    assert_eq!((scene.options.max_bounces, scene.options.aa, scene.options.rr_depth), (Some(4), Some(3), None));
    assert!(scene.warnings[0].contains(":3:48: warning: unknown option `colour`"), "{:?}", scene.warnings);
    assert_eq!(scene.materials.len(), 1);
    assert!(scene.materials[0].is_light && scene.materials[0].displacement.is_some());
    assert_eq!(scene.background.unwrap().resolution, 1024);
    assert_eq!(scene.geometry.objects[0].surface_area, 2.0);
    assert!(matches!(scene.geometry.primitives[0].shape, Shape::Quad { .. }));
}

fn at(offset: usize) -> Place {
    Place { file: "g".into(), line: 1, column: offset as u32 + 1 }
}

#[test]
fn group_text_is_read_as_osl_writes_it() {
    let text = r#"param float k 0.5 [[int lockgeom=0, int interactive=1]]; color[2] c 1 2 3 4;
        string s "a; \"b\""; string[] t x "y z" w; int n -3, matrix m 1; float[] e 1 2 3;
        param float st.f 2; shader noise "n 1", shader "mat" l2
        connect"#;
    let error = parse_group(text, &at).unwrap_err();
    assert!(error.problem.to_string().contains("`;` expected, found `connect`"), "{error}");
    let text =
        text.replace("l2\n", "l2;\n").replace("connect", "connect \"n 1\".out l2.st.f; connect \"n 1\".c[1] l2.k");
    let group = parse_group(&text, &at).unwrap();
    let params = &group.layers[0].params;
    let names: Vec<&str> = params.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["k", "c", "s", "t", "n", "m", "e", "st.f"]);
    assert_eq!(params[1].values, Values::Floats(vec![1.0, 2.0, 3.0, 4.0, 0.0, 0.0]), "padded with zeros");
    assert_eq!((params[1].kind, params[1].array), (ParamType::Color, Some(2)));
    assert_eq!(params[2].values, Values::Strings(vec!["a; \"b\"".into()]));
    assert_eq!(
        (&params[3].values, params[3].array),
        (&Values::Strings(vec!["x".into(), "y z".into(), "w".into()]), Some(3))
    );
    assert_eq!(params[4].values, Values::Ints(vec![-3]));
    assert_eq!(params[5].values, Values::Floats([vec![1.0], vec![0.0; 15]].concat()));
    assert_eq!(params[6].array, Some(3));
    assert_eq!((group.layers[0].layer_name.as_str(), group.layers[1].shader.as_str()), ("n 1", "mat"));
    assert_eq!(group.layers[1].params, []);
    assert_eq!(group.connections[1].source_param, "c[1]");
    assert_eq!(group.connections[0].target_param, "st.f");
}

#[test]
fn child_elements_make_the_same_group_as_text() {
    struct Keep(std::cell::RefCell<Vec<GroupSpec>>);
    impl GroupCompiler for Keep {
        fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
            self.0.borrow_mut().push(spec.clone());
            Anything.compile(spec)
        }
    }
    let keep = Keep(Default::default());
    let text = r#"<World>
      <ShaderGroup><Parameter k="float 0.5" c="color 1 2 3" n="int 3" s="plain text"/>
        <Shader type="surface" name="noise" layer="a"/><Shader name="mat" layer="b"/>
        <ConnectShaders srclayer="a" srcparam="out" dstlayer="b" dstparam="in"/></ShaderGroup>
      <ShaderGroup commands="float k 0.5; color c 1 2 3; int n 3; string s &quot;plain text&quot;;
        shader noise a; shader mat b; connect a.out b.in;"/><Background/></World>"#;
    Scene::load(text, &[] as &[PathBuf], &keep).unwrap();
    let specs = keep.0.into_inner();
    let plain = |spec: &GroupSpec| {
        let values = |l: &velour::scene::Layer| {
            l.params.iter().map(|p| (p.name.clone(), p.kind, p.values.clone())).collect::<Vec<_>>()
        };
        spec.layers.iter().map(|l| (l.shader.clone(), l.layer_name.clone(), values(l))).collect::<Vec<_>>()
    };
    assert_eq!(plain(&specs[0]), plain(&specs[1]));
    assert_eq!(specs[0].usage, Usage::Surface);
    assert_eq!(specs[0].connections[0].target_param, specs[1].connections[0].target_param);
}

/// The one triangle mesh of a line of XML, which comes after a sphere.
fn made(line: &str) -> Scene {
    let text = format!(
        "<World><ShaderGroup name=\"b\">shader b l1;</ShaderGroup><ShaderGroup>shader a l1;</ShaderGroup>{line}</World>"
    );
    load(&text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_weave_is_closed_tubes_that_pass_over_and_under_each_other() {
    let line = r#"<Weave corner="-1,0,1" edge_x="2,0,0" edge_y="0,0,-2" warp="4" weft="6" segments="4" sides="8"
        thickness="1" weft_group="b"/>"#;
    let scene = made(line);
    let geometry = &scene.geometry;
    assert_eq!(geometry.primitives.len(), 4 * 4 * 6 * 4 * 8);
    let materials: Vec<u32> = geometry.objects.iter().map(|o| o.material).collect();
    assert_eq!(materials, [1, 0], "the warp takes the last group, the weft the one that is named");
    let total = |object: u32| {
        let own = geometry.primitives.iter().filter(|p| p.object == object);
        own.map(|p| f64::from(p.shape.area())).sum::<f64>()
    };
    for (object, o) in geometry.objects.iter().enumerate() {
        assert!((total(object as u32) - f64::from(o.surface_area)).abs() < 1e-3, "{object}");
    }
    let (mut low, mut high) = (f32::MAX, f32::MIN);
    for primitive in &geometry.primitives {
        let Shape::Triangle { a, b, c } = primitive.shape else { panic!("not a triangle") };
        let flat = (b - a).cross(c - a).normalize();
        for n in geometry.normals[primitive.normals as usize] {
            assert!((n.length() - 1.0).abs() < 1e-5 && n.dot(flat) > 0.5, "{n} on {flat}");
        }
        for uv in geometry.uvs[primitive.uvs as usize] {
            assert!(uv.min_element() >= 0.0 && uv.max_element() <= 1.0, "{uv}");
        }
        (low, high) = (low.min(a.y), high.max(a.y));
    }
    // The nearer yarns are 1/3 apart: at a crossing the middle of one is 1/12 above the cloth, its top another 1/12.
    assert!((high - 1.0 / 6.0).abs() < 0.02 && (low + high).abs() < 1e-3, "{low} to {high}");
}

#[test]
fn flakes_lie_in_their_box_and_have_their_size() {
    let scene = made(r#"<Flakes low="1,2,3" high="2,4,6" count="500" size="0.1"/>"#);
    assert_eq!(scene.geometry.primitives.len(), 500);
    for primitive in &scene.geometry.primitives {
        let Shape::Triangle { a, b, c } = primitive.shape else { panic!("not a triangle") };
        assert!((a.distance(b) - 0.1).abs() < 1e-5 && (b.distance(c) - 0.1).abs() < 1e-5);
        let center = (a + b + c) / 3.0;
        assert!(
            center.cmpge(glam::vec3(1.0, 2.0, 3.0) - 1e-5).all()
                && center.cmple(glam::vec3(2.0, 4.0, 6.0) + 1e-5).all()
        );
    }
    let other = made(r#"<Flakes low="1,2,3" high="2,4,6" count="500" size="0.1" seed="2"/>"#);
    assert_ne!(scene.geometry.primitives[0], other.geometry.primitives[0]);
}

#[test]
fn flakes_of_two_seeds_have_none_in_common_however_many() {
    let corners = |seed: u32| {
        let scene = made(&format!(r#"<Flakes low="0,0,0" high="1,1,1" count="200000" size="0.01" seed="{seed}"/>"#));
        let corner = |shape: Shape| {
            let Shape::Triangle { a, .. } = shape else { panic!("not a triangle") };
            a.to_array().map(f32::to_bits)
        };
        scene.geometry.primitives.iter().map(|p| corner(p.shape)).collect::<std::collections::HashSet<_>>()
    };
    let (one, two) = (corners(1), corners(2));
    assert!(one.len() > 199_000 && two.len() > 199_000, "blocks of one seed differ too");
    assert!(one.is_disjoint(&two));
}

#[test]
fn every_problem_has_a_code_of_its_own() {
    let group =
        |text: &str| format!("<World><ShaderGroup>{text}</ShaderGroup><Sphere center=\"0,0,0\" radius=\"1\"/></World>");
    let element = |text: &str| format!("<World><ShaderGroup>shader matte l1;</ShaderGroup>{text}</World>");
    let cases = [
        ("none.xml".to_owned(), "S0101"),
        ("<World".to_owned(), "S0102"),
        ("<Scene/>".to_owned(), "S0103"),
        ("<World/>".to_owned(), "S0104"),
        (element("<Spere/>"), "S0201"),
        (element("text"), "S0202"),
        (element(r#"<Sphere centre="0,0,0"/>"#), "S0203"),
        (element(r#"<Sphere center="0,0,0"/>"#), "S0204"),
        (element(r#"<Sphere center="0,0" radius="1"/>"#), "S0205"),
        (r#"<World><Sphere center="0,0,0" radius="1"/></World>"#.to_owned(), "S0206"),
        (element(r#"<Camera dir="0,0,0"/>"#), "S0301"),
        (element(r#"<Quad corner="0,0,0" edge_x="1,0,0" edge_y="2,0,0"/>"#), "S0302"),
        (element(r#"<Flakes low="1,1,1" high="0,0,0" size="1"/>"#), "S0303"),
        (element(r#"<Weave corner="0,0,0" edge_x="1,0,0" edge_y="0,0,1" warp="4096" weft="4096"/>"#), "S0304"),
        (element(r#"<Model filename="none.obj"/>"#), "S0401"),
        (element(r#"<Model filename="Cargo.toml"/>"#), "S0402"),
        (group("sader matte l1;"), "S0501"),
        (group("shader matte l1 l2;"), "S0502"),
        (group("shader ;"), "S0503"),
        (group("shader \"matte l1;"), "S0504"),
        (group("param colour Cs 1 1 1; shader matte l1;"), "S0505"),
        (group("float[0] k 1; shader matte l1;"), "S0506"),
        (group("float k 1 [[ int lock = 1 ]]; shader matte l1;"), "S0507"),
        (group("float k 1 [[ int lockgeom ]]; shader matte l1;"), "S0508"),
        (group("float k 1 [[ int lockgeom = 1 ; shader matte l1;"), "S0509"),
        (group("shader matte a; shader matte b; connect a b.Cs;"), "S0510"),
        (group(""), "S0601"),
        (group("shader matte l1; float k 1;"), "S0602"),
        (group("shader matte a; shader matte b; connect c.Cs b.Cs;"), "S0603"),
        (group("shader matte a; shader matte b; connect b.Cs a.Cs;"), "S0604"),
        (group("shader missing l1;"), "S0605"),
        (group("shader wrong l1;"), "S0606"),
        (group("float Cx 1; shader matte l1;"), "S0607"),
    ];
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wrong.osl"), "surface wrong( { }").unwrap();
    let search = [PathBuf::from(env!("CARGO_MANIFEST_DIR")), folder.path().to_owned()];
    let mut seen = std::collections::BTreeSet::new();
    for (text, code) in &cases {
        let error = Scene::load(text, &search, &ShaderFiles::default()).map(|_| ()).unwrap_err();
        assert_eq!(error.problem.code(), *code, "{text}\n{error}");
        assert!(seen.insert(*code) && error.place.is_some() != (*code == "S0101"), "{error:?}");
    }
    let inner = |text: &str| match *Scene::load(text, &search, &ShaderFiles::default()).map(|_| ()).unwrap_err().problem
    {
        SceneProblem::Group(error) => error.problem.code(),
        SceneProblem::Shader { error, .. } => match &*error {
            velour::compile::CompileError::Text { diagnostics, .. } => diagnostics.list[0].code,
            other => panic!("{other}"),
        },
        other => panic!("{other}"),
    };
    assert_eq!(inner(&group("float Cx 1; shader matte l1;")), "G0201");
    assert_eq!(inner(&group("string Cs x; shader matte l1;")), "G0301");
    assert!(inner(&group("shader wrong l1;")).starts_with("E0"), "the messages of the shader are there");
}

#[test]
fn a_parameter_that_is_not_there_is_a_warning_where_that_is_asked_for() {
    let text = "<World><ShaderGroup>float Cx 1; color Cs 1 0 0; shader matte l1;</ShaderGroup>\n<Background/></World>";
    let lenient = ShaderFiles::default().lenient(true);
    let scene = Scene::load(text, &[] as &[PathBuf], &lenient).unwrap_or_else(|error| panic!("{error}"));
    let expected =
        "<scene text>:1:27: warning: shader `matte` has no parameter `Cx`; its value is left out; did you mean `Cs`?";
    assert_eq!(scene.warnings, [expected]);
    let error = Scene::load(text, &[] as &[PathBuf], &ShaderFiles::default()).map(|_| ()).unwrap_err();
    assert_eq!(error.problem.code(), "S0607");
    // A value of the wrong kind is a mistake either way.
    let text = "<World><ShaderGroup>string Cs x; shader matte l1;</ShaderGroup><Background/></World>";
    assert!(Scene::load(text, &[] as &[PathBuf], &lenient).is_err());
}

#[test]
fn a_camera_may_state_the_size_of_its_picture() {
    let size = |attributes: &str| {
        let text = format!("<World><ShaderGroup>shader a l;</ShaderGroup><Background/><Camera {attributes}/></World>");
        load(&text).map(|scene| scene.options.resolution)
    };
    assert_eq!(size("").unwrap(), None);
    assert_eq!(size(r#"res="640 256""#).unwrap(), Some([640, 256]));
    assert_eq!(size(r#"res="640,256""#).unwrap(), Some([640, 256]));
    for wrong in ["640", "0 1", "1.5 2", "-1 1", "1 2 3", "a b", "70000 1", ""] {
        let error = size(&format!("res=\"{wrong}\"")).unwrap_err().to_string();
        assert!(error.contains("`res` of <Camera>") && error.contains("width and height in pixels"), "{error}");
    }
}

/// Places are looked up for every element, so that a lookup must not count from the start of the text.
#[test]
fn many_elements_on_one_line_load_at_once() {
    let mut text = String::from("<World><ShaderGroup>shader a l;</ShaderGroup>");
    (0..60_000).for_each(|i| text += &format!(r#"<Sphere center="{i},0,0" radius=".5"/>"#));
    let bad = text.clone() + r#"<Sphere center="0,0,0" radius="x"/></World>"#;
    text += "</World>";
    let start = std::time::Instant::now();
    let scene = load(&text).unwrap();
    assert_eq!(scene.geometry.primitives.len(), 60_000);
    let last = &scene.geometry.objects[59_999].place;
    let column = text.rfind("<Sphere").unwrap() as u32 + 1;
    assert_eq!((last.line, last.column), (1, column));
    let error = load(&bad).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains(&format!(":1:{}: error: `radius`", bad.rfind('x').unwrap() + 1)), "{error}");
    // A quarter of a second; counting anew for each took a minute.
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn an_element_of_too_many_attributes_is_refused_at_once() {
    let many: String = (0..40_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let error = load(&format!("<World>\n<Camera{many}/></World>")).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains(":2:1: error: the scene is not well-formed XML: an element has more than 1024"), "{error}");
}

#[test]
fn a_scene_too_far_or_too_large_for_singles_is_warned_of_with_its_limit() {
    let warnings = |center: &str, radius: &str| {
        let sphere = format!(r#"<Sphere center="{center}" radius="{radius}"/>"#);
        load(&format!("<World><ShaderGroup>shader a l;</ShaderGroup>{sphere}</World>")).unwrap().warnings
    };
    for (center, radius) in [("0,0,0", "1"), ("1000,0,0", "1"), ("0,0,0", "9e7"), ("0,0,0", "1e-8"), ("1e6,0,0", "1e4")]
    {
        assert_eq!(warnings(center, radius), [] as [String; 0], "{center} {radius}");
    }
    for (center, radius, expected) in [
        ("1e4,0,0", "1", " of its own sizes from the origin; beyond 512 "),
        ("0,0,0", "1e9", "reaches to 1e9 units; above 1e8 areas overflow"),
        ("0,0,0", "1e-12", "is 2e-12 units large; below 1e-9 areas vanish"),
    ] {
        let found = warnings(center, radius);
        assert!(found.len() == 1 && found[0].contains(expected), "{center} {radius}: {found:?}");
        assert!(found[0].starts_with("<scene text>:1:1: warning: "), "{found:?}");
    }
}
