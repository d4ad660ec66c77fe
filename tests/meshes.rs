//! Meshes as people have them: whatever an OBJ or MTL file says, there is a mesh or a message with its line.

use std::path::PathBuf;
use velour::scene::{Primitive, Scene, SceneError, ShaderFiles, Shape};

/// Loads a scene of `elements` beside `files`, after a red and a blue group and one without a name.
fn load(files: &[(&str, &[u8])], elements: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let group = |name: &str| format!("<ShaderGroup name=\"{name}\">shader matte l1;</ShaderGroup>");
    let text = format!("<World>{}{}{}\n{elements}</World>", group("red"), group("blue"), group(""));
    let path = folder.path().join("s.xml");
    std::fs::write(&path, text).unwrap();
    let search = [PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("shaders")];
    Scene::load(path.to_str().unwrap(), &search, &ShaderFiles::default())
}

fn mesh(text: &[u8]) -> Scene {
    load(&[("m.obj", text)], r#"<Model filename="m.obj"/>"#)
        .unwrap_or_else(|error| panic!("{}\n{error}", String::from_utf8_lossy(text)))
}

/// The message of a mesh that is refused.
fn message(text: &str) -> String {
    match load(&[("m.obj", text.as_bytes())], r#"<Model filename="m.obj"/>"#) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => error.to_string(),
    }
}

fn material(scene: &Scene, primitive: &Primitive) -> u32 {
    scene.geometry.objects[primitive.object as usize].material
}

fn materials(scene: &Scene) -> Vec<u32> {
    scene.geometry.primitives.iter().map(|p| material(scene, p)).collect()
}

fn area(scene: &Scene) -> f64 {
    scene.geometry.primitives.iter().map(|p| f64::from(p.shape.area())).sum()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn colours_of_an_mtl_may_have_one_number_or_two_or_none() {
    for line in ["Kd 1", "Ka 1", "Ks 1", "Ke 1", "Kd 1 2", "Kd", "Kd x", "Tf 1", "Ns", "illum foo", "map_Kd", "newmtl"]
    {
        let obj = format!("mtllib m.mtl\n{SQUARE}usemtl red\nf 1 2 3 4\n");
        let mtl = format!("newmtl a\n{line}\nnewmtl red\nKd 1 0 0\n");
        let files: [(&str, &[u8]); 2] = [("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        let scene = load(&files, r#"<Model filename="m.obj"/>"#).unwrap();
        assert_eq!(materials(&scene), [0, 0], "{line}");
        let grey = ["Kd 1", "Ka 1", "Ks 1", "Ke 1", "Tf 1", "map_Kd"].contains(&line);
        assert_eq!(scene.warnings.is_empty(), grey, "{line}: {:?}", scene.warnings);
        assert!(grey || scene.warnings[0].contains("m.mtl:2: warning: `"), "{line}: {:?}", scene.warnings);
    }
}

#[test]
fn names_of_usemtl_find_their_groups_whatever_the_mtl_says() {
    let obj = format!("mtllib m.mtl\n{SQUARE}usemtl blue\nf 1 2 3\nusemtl red # wool\nf 1 3 4\nusemtl else\nf 1 2 4\n");
    let run = |mtl: Option<&str>| {
        let mut files: Vec<(&str, &[u8])> = vec![("m.obj", obj.as_bytes())];
        files.extend(mtl.map(|text| ("m.mtl", text.as_bytes())));
        let scene = load(&files, r#"<Model filename="m.obj"/>"#).unwrap();
        assert_eq!(materials(&scene), [1, 0, 2], "{mtl:?}");
        scene.warnings
    };
    let missing = run(None);
    assert!(
        missing[0].contains("m.obj:1: warning: `") && missing[0].contains("m.mtl`: it cannot be opened"),
        "{missing:?}"
    );
    let whole = run(Some("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl else\n"));
    assert_eq!(whole.len(), 1);
    assert!(whole[0].contains("s.xml:2:18: warning: material `else` of `m.obj` has no <ShaderGroup>"), "{whole:?}");
    for odd in ["illum foo", "Kd spectral f.rfl", "d -halo .5", "Ns"] {
        let warnings = run(Some(&format!("newmtl red\n{odd}\nKd 1 0 0\nnewmtl blue\n")));
        assert!(warnings[0].contains("m.mtl:2: warning: "), "{odd}: {warnings:?}");
    }
}

#[test]
fn shapes_are_matched_by_their_own_names_when_no_material_is() {
    let obj = format!("{SQUARE}o blue\nf 1 2 3\ng small red\nf 1 3 4\nusemtl steel\no none\nf 1 2 4\n");
    let scene = mesh(obj.as_bytes());
    assert_eq!(materials(&scene), [1, 0, 2]);
    assert_eq!(scene.warnings, [] as [String; 0]);
}

#[test]
fn a_concave_polygon_keeps_its_area() {
    let cup =
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv .5 1 0\nv .5 -.5 0\nv -.5 -.5 0\nv -.5 1 0\nv -1 1 0\nf 1 2 3 4 5 6 7 8\n";
    let scene = mesh(cup.as_bytes());
    assert!((area(&scene) - 2.5).abs() < 1e-6, "{}", area(&scene));
    for primitive in &scene.geometry.primitives {
        let Shape::Triangle { a, b, c } = primitive.shape else { panic!("not a triangle") };
        assert!((b - a).cross(c - a).z > 0.0, "turned round");
        let center = (a + b + c) / 3.0;
        assert!(!(center.x.abs() < 0.5 && center.y > -0.5), "in the hollow: {center}");
    }
    // A fan of the same corners would cover 3 and more.
    let quad = mesh(b"v 0 0 0\nv 2 0 0\nv .5 .5 0\nv 0 2 0\nf 2 3 4 1\n");
    assert!((area(&quad) - 1.0).abs() < 1e-6, "{}", area(&quad));
}

#[test]
fn every_way_to_write_a_mesh_gives_the_same_mesh() {
    let plain =
        mesh(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1\n");
    let others: [&[u8]; 9] = [
        b"v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 .5 .5 .5 1\nv 0 1 0 1\nvt 0\nvt 1\nvn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1\n",
        b"v 0 0 0 # a\nv 1 0 0 #b\nv 1 1 0\nv 0 1 0\nvt 0 0 0\nvt 1 0 0\nvn 0 0 1\nusemtl red # c\nf 1/1/1 2/2/1 3/1/1 # d\n",
        b"\xef\xbb\xbfv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvt 1 0\r\nvn 0 0 1\r\nusemtl red\r\nf 1/1/1 2/2/1 3/1/1\r\n",
        b"v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rvt 0 0\rvt 1 0\rvn 0 0 1\rusemtl red\rf 1/1/1 2/2/1 3/1/1",
        b"v 0 0 0\nv 1 0 \\\n 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nf 1/1/1 \\\r\n2/2/1 \\  \n3/1/1\n",
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nf -4/-2/-1 -3/-1/-1 -2/-2/-1\n",
        b"usemtl red\nf 1/1/1 2/2/1 3/1/1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n",
        b"\tv  0.0e0\t-0 +0.\nv 1.0E+0 0 0\nv 10e-1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nfo 1/1/1 2/2/1 3/1/1\n",
        b"# caf\xe9\ng stra\xdfe\ns 1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nl 1 2\np 1\nf 1/1/1 2/2/1 3/1/1\n",
    ];
    for text in others {
        let scene = mesh(text);
        let shown = String::from_utf8_lossy(text);
        let of = |scene: &Scene| {
            let geometry = (*scene.geometry).clone();
            let objects: Vec<(u32, f32)> = geometry.objects.iter().map(|o| (o.material, o.surface_area)).collect();
            (geometry.primitives, geometry.normals, geometry.uvs, objects)
        };
        assert_eq!(of(&scene), of(&plain), "{shown}");
        assert_eq!(scene.warnings, [] as [String; 0], "{shown}");
    }
}

#[test]
fn latin_1_names_find_their_groups() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gr\xfcn\nf 1 2 3\n";
    let group =
        "<ShaderGroup name=\"gr\u{fc}n\">shader matte l1;</ShaderGroup><ShaderGroup>shader matte l1;</ShaderGroup>";
    let scene = load(&[("m.obj", obj)], &format!("{group}<Model filename=\"m.obj\"/>")).unwrap();
    assert_eq!(materials(&scene), [3]);
}

#[test]
fn what_is_wrong_names_its_line() {
    let cases = [
        ("v 1 2\n", "m.obj`: line 1: `v` has 2 numbers, 3 are needed"),
        ("v 1 2 x\n", "line 1: `x` is not a number"),
        ("v 1 2 3\n\nv 1 nan 3\n", "line 3: `nan` is not a finite number"),
        ("v 1 2 1e39\n", "line 1: `1e39` is not a finite number"),
        ("v 0 0 0\nvt nan 0\nf 1/-99999 1 1\n", "line 2: `nan` is not a finite number"),
        ("v 0 0 0\nvt 0 0\nf 1/-99999 1 1\n", "line 3: a face names `vt` -99999; there are 1"),
        ("v 0 0 0\nf 1 2 9\n", "line 2: a face names `v` 9; there are 1"),
        ("v 0 0 0\nf 1//2 1//1 1//1\nvn 0 0 1\n", "line 2: a face names `vn` 2; there are 1"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: an index is 0"),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2: `1/1/1/1` is not an index"),
        ("v 0 0 0\nf 1.5 1 1\n", "line 2: `1.5` is not an index"),
        ("v 0 0 0\nf 99999999999999999999 1 1\n", "line 2: `99999999999999999999` is not an index"),
        ("v 0 0 0\nf 9999999999 1 1\n", "line 2: a face names `v` 9999999999; there are 1"),
        ("# empty\n", "it has no faces"),
        ("v 0 0 0\0\n", "it is not text"),
    ];
    for (text, expected) in cases {
        let found = message(text);
        assert!(found.contains("s.xml:2:18: error: mesh `") && found.contains(expected), "{text:?} gives {found}");
    }
    let many = format!("v 0 0 0\nf{}\n", " 1".repeat(10_001));
    assert!(message(&many).contains("line 2: a face has 10001 corners, 10000 are the most"));
}

#[test]
fn normals_that_faces_name_and_nobody_gives_are_left_out() {
    let scene = mesh(format!("{SQUARE}f 1//1 2//2 3//3\n").as_bytes());
    assert_eq!(scene.geometry.primitives[0].normals, Primitive::NONE);
    assert!(
        scene.warnings[0].contains("m.obj:5: warning: faces name `vn`, of which there are none"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn what_is_left_out_is_named_with_its_line() {
    let scene = mesh(format!("{SQUARE}bogus 1\ncstype bezier\nf 1 2\nf 1 2 3\nbogus 2\n").as_bytes());
    let shown: Vec<&str> = scene.warnings.iter().filter_map(|w| w.split("m.obj:").nth(1)).collect();
    let expected = [
        "5: warning: unknown statement `bogus` is left out",
        "6: warning: `cstype`: curves and surfaces are left out",
        "7: warning: a face of 2 corners is left out",
    ];
    assert_eq!(shown, expected);
}

#[test]
fn an_object_without_area_is_left_out_and_the_rest_is_rendered() {
    let flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\no a\nf 1 2 3\nf 1 1 1\no b\nf 1 2 4\n";
    let scene = mesh(flat.as_bytes());
    assert_eq!((scene.geometry.objects.len(), scene.geometry.primitives.len()), (1, 1));
    assert!(scene.warnings[0].contains("2 triangles of `m.obj` have no area"), "{:?}", scene.warnings);
    let nothing = &b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"[..];
    let error = load(&[("m.obj", nothing)], r#"<Model filename="m.obj"/>"#).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("the scene has nothing to see"), "{error}");
    let scene = load(&[("m.obj", nothing)], r#"<Model filename="m.obj"/><Background/>"#).unwrap();
    assert!(scene.warnings[0].contains("no triangle of `m.obj` has an area"), "{:?}", scene.warnings);
    let settings = velour::render::Settings { width: 4, height: 4, ..Default::default() };
    velour::render::render(&scene, &settings, &velour::render::Silent).unwrap();
}

#[test]
fn a_model_is_scaled_then_turned_then_moved() {
    let obj = format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1\n");
    let run =
        |attributes: &str| load(&[("m.obj", obj.as_bytes())], &format!("<Model filename=\"m.obj\" {attributes}/>"));
    let corners = |attributes: &str| {
        let scene = run(attributes).unwrap();
        let Shape::Triangle { a, b, c } = scene.geometry.primitives[0].shape else { panic!("not a triangle") };
        let normal = scene.geometry.normals[0][0];
        assert!((b - a).cross(c - a).dot(normal) > 0.0, "{attributes}: the normal is turned round");
        assert_eq!(scene.geometry.objects[0].surface_area, scene.geometry.primitives[0].shape.area());
        [a, b, c].map(|p| p.to_array())
    };
    let steps = corners(r#"scale="2,3,4" rotate="0,0,90" translate="10,0,5""#);
    assert_eq!(steps, [[10.0, 0.0, 5.0], [10.0, 2.0, 5.0], [7.0, 2.0, 5.0]]);
    assert_eq!(steps, corners(r#"transform="0 2 0 0  -3 0 0 0  0 0 4 0  10 0 5 1""#), "points are rows");
    assert_eq!(corners(r#"scale="2""#)[2], [2.0, 2.0, 0.0]);
    // A mirror keeps the outside outside: two corners change places.
    assert_eq!(corners(r#"scale="-1,1,1""#), [[0.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
    for (attributes, expected) in [
        (r#"scale="0""#, "`scale` of <Model> is `0`: one number or three, none of them 0, expected"),
        (r#"scale="1,2""#, "`scale`"),
        (r#"rotate="x""#, "`rotate`"),
        (r#"transform="1""#, "16 numbers"),
        (r#"transform="1 0 0 0 0 1 0 0 1 0 0 0 0 0 0 1""#, "invertible"),
        (r#"transform="1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1""#, "invertible"),
        (r#"scale="1" transform="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1""#, "not both"),
        (r#"scale="3e38,1,1" rotate="0,0,1" translate="3e38,0,0""#, "a vertex is not a finite number"),
    ] {
        let error = run(attributes).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("s.xml:2:") && error.contains(expected), "{attributes}: {error}");
    }
}

#[test]
fn models_of_one_file_stand_side_by_side() {
    let obj = format!("mtllib none.mtl\n{SQUARE}f 1 2 3 4\n");
    let elements =
        r#"<Model filename="m.obj"/><Model filename="m.obj" translate="0,0,1"/><Model filename="m.obj" scale="3"/>"#;
    let scene = load(&[("m.obj", obj.as_bytes())], elements).unwrap();
    assert_eq!((scene.geometry.objects.len(), scene.geometry.primitives.len()), (3, 6));
    assert!((area(&scene) - 11.0).abs() < 1e-5);
    assert_eq!(scene.warnings.len(), 1, "what is odd in a file is said once: {:?}", scene.warnings);
}

/// Text that begins as a mesh and goes on anyhow: there is always a scene or a message, and never anything else.
#[test]
fn nonsense_is_refused_or_read_and_never_more() {
    let seed = format!(
        "mtllib m.mtl\n{SQUARE}vt 0 1\nvn 0 0 1\nusemtl red\nf 1/1/1 2//1 3 4\nf -1 -2 -3\no x\nf 1 2 3 4 2 1\n"
    );
    let pieces: [&[u8]; 20] = [
        b"v ",
        b"vt",
        b"vn ",
        b"f ",
        b" 1",
        b"/",
        b"-",
        b"\n",
        b"nan",
        b"1e39",
        b" -99999999999",
        b"#",
        b"\\\n",
        b"\xff",
        b"\0",
        b"usemtl ",
        b"mtllib m.mtl",
        b"4294967295",
        b"g",
        b"\r",
    ];
    let mut state = 1u64;
    let mut below = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let (mut read, mut refused) = (0, 0);
    for _ in 0..800 {
        let mut text = seed.clone().into_bytes();
        for _ in 0..1 + below(6) {
            let at = below(text.len());
            let end = (at + below(4)).min(text.len());
            text.splice(at..end, pieces[below(pieces.len())].iter().copied());
        }
        let files: [(&str, &[u8]); 2] = [("m.obj", &text), ("m.mtl", &text)];
        match load(&files, r#"<Model filename="m.obj"/>"#) {
            Ok(scene) => {
                read += 1;
                let objects = scene.geometry.objects.len() as u32;
                assert!(scene.geometry.primitives.iter().all(|p| p.object < objects && p.shape.area() > 0.0));
            }
            Err(error) => {
                refused += 1;
                assert!(error.place.is_some(), "{error}");
            }
        }
    }
    assert!(read > 80 && refused > 80, "{read} read, {refused} refused");
}
