//! Image files: whole or not at all.

use super::materials::picture;
use velour::render::output::{check, write};

const SCENE: &str = r#"<World><ShaderGroup>color c 0.25 0.5 1; shader sky l1;</ShaderGroup><Background/></World>"#;

#[test]
fn every_format_is_written_whole_and_nothing_is_left_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    for alpha in [false, true] {
        let image = picture(SCENE, |s| (s.width, s.height, s.alpha) = (5, 3, alpha));
        for extension in ["exr", "png", "hdr"] {
            let path = folder.path().join(format!("image.{extension}"));
            write(&image, &path).unwrap();
            let read = image::open(&path).unwrap().to_rgb32f();
            assert_eq!((read.width(), read.height()), (5, 3));
            if extension == "exr" {
                // With alpha, a picture of nothing but sky is empty.
                assert_eq!(read.get_pixel(4, 2).0, if alpha { [0.0; 3] } else { [0.25, 0.5, 1.0] });
            }
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn the_exr_header_says_how_the_picture_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.exr");
    write(&picture(SCENE, |s| (s.width, s.height, s.seed) = (4, 4, 7)), &path).unwrap();
    let meta = exr::prelude::MetaData::read_from_file(&path, false).unwrap();
    let own = &meta.headers[0].own_attributes;
    assert!(own.software_name.as_ref().unwrap().to_string().starts_with("velour "));
    let comments = own.comments.as_ref().unwrap().to_string();
    assert!(comments.contains("scene=<scene text> samples=16 seed=7 velour="), "{comments}");
}

#[test]
fn a_name_that_cannot_be_written_is_refused_before_rendering() {
    let error = check("picture.jpeg".as_ref()).unwrap_err();
    assert!(error.to_string().contains("known extensions: exr, png, hdr"), "{error}");
    assert!(check("no-such-folder/picture.exr".as_ref()).unwrap_err().to_string().contains("no-such-folder"));
    assert!(check("picture.EXR".as_ref()).is_ok());
}

/// Every scene that is shipped; those of many triangles with few, so that an unoptimised build renders them at once.
#[test]
fn shipped_scenes_render() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/scenes");
    let cases = [
        ("million", [("warp=\"74\"", "warp=\"6\""), ("weft=\"74\"", "weft=\"6\"")], 6 * 6 * 6 * 8 * 4 + 2),
        ("lamps", [("warp=\"40\"", "warp=\"5\""), ("weft=\"48\"", "weft=\"4\"")], 5 * 4 * 5 * 8 * 4 + 1002),
        ("layers", [("<World>", "<World>"), ("</World>", "</World>")], 5),
        ("spheres", [("<World>", "<World>"), ("</World>", "</World>")], 7),
        ("figure1", [("<World>", "<World>"), ("</World>", "</World>")], 7),
        ("figure3", [("<World>", "<World>"), ("</World>", "</World>")], 3),
        ("figure3-back", [("<World>", "<World>"), ("</World>", "</World>")], 3),
        ("figure4", [("<World>", "<World>"), ("</World>", "</World>")], 10),
        ("curtain", [("<World>", "<World>"), ("</World>", "</World>")], 74),
        ("models", [("<World>", "<World>"), ("</World>", "</World>")], 22),
    ];
    for (name, fewer, primitives) in cases {
        let mut text = std::fs::read_to_string(folder.join(format!("{name}.xml"))).unwrap();
        for (many, few) in fewer {
            assert!(text.contains(many), "{name}: {many}");
            text = text.replace(many, few);
        }
        let source = velour::scene::SceneSource { name: name.into(), text, folder: folder.clone() };
        let scene = velour::scene::Scene::from_source(&source, &[], &velour::scene::ShaderFiles::default())
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.geometry.primitives.len(), primitives, "{name}");
        let settings = velour::render::Settings { width: 24, height: 16, samples: 4, ..Default::default() };
        let settings = settings.with_options(&scene.options);
        let image = velour::render::render(&scene, &settings, &velour::render::Silent).unwrap();
        assert!(image.mean().iter().all(|m| *m > 0.002 && *m < 3.0), "{name}: {:?}", image.mean());
        assert!(image.about.reports.is_empty(), "{name}: {:?}", image.about.reports);
    }
}
