//! What shaders of a scene ask for: the camera's spaces, rays of their own, what surfaces carry, and textures.

use super::materials::picture_with;
use velour::render::Image;

/// A unit quad that fills 32 x 32 pixels exactly, with more elements of the scene after it.
fn facing(shader: &str, more: &str) -> Image {
    let scene = format!(
        r#"<World><Camera eye="0.5,0.5,1" fov="90"/><ShaderGroup>shader s l1;</ShaderGroup>
        <Quad corner="0,0,0" edge_x="1,0,0" edge_y="0,1,0"/>{more}</World>"#
    );
    picture_with(&scene, &[shader], |s| (s.width, s.height, s.samples, s.jitter) = (32, 32, 1, false))
}

fn assert_pixels(image: &Image, tolerance: f32, expected: impl Fn(u32, u32) -> [f32; 3]) {
    for y in 0..32 {
        for x in 0..32 {
            let (found, wanted) = (image.pixel(x, y), expected(x, y));
            let near = (0..3).all(|c| (found[c] - wanted[c]).abs() <= tolerance);
            assert!(near, "at ({x}, {y}): {found:?} in place of {wanted:?}");
        }
    }
}

#[test]
fn raster_and_ndc_are_the_pixels_of_the_picture() {
    let image = facing(
        r#"surface s() { point r = transform("raster", P), n = transform("NDC", P);
            Ci = color(r[0] / 32, r[1] / 32, abs(n[0] - r[0] / 32) + abs(n[1] - r[1] / 32)) * emission(); }"#,
        "",
    );
    let at = |x: u32| (x as f32 + 0.5) / 32.0;
    assert_pixels(&image, 1e-4, |x, y| [at(x), at(y), 0.0]);
    let back =
        r#"surface s() { Ci = length(transform("raster", "common", transform("raster", P)) - P) * emission(); }"#;
    assert_pixels(&facing(back, ""), 1e-4, |_, _| [0.0; 3]);
}

#[test]
fn rays_of_shaders_meet_the_scene() {
    // A lid over the left half, one unit above, seen by nobody.
    let lid = r#"<Quad corner="-1,0,1.5" edge_x="1.5,0,0" edge_y="0,1,0"/>"#;
    let shader = "surface s() { vector up = vector(0, 0, 1);
        Ci = color(trace(P, up), trace(P, up, \"maxdist\", 1.4), trace(P, 10 * up, \"maxdist\", .16)) * emission(); }";
    let met = |x: u32| f32::from(x < 16);
    assert_pixels(&facing(shader, lid), 0.0, |x, _| [met(x), 0.0, met(x)]);
    assert_pixels(&facing(shader, ""), 0.0, |_, _| [0.0; 3]);
}

#[test]
fn surfaces_carry_s_and_t() {
    let shader = "surface s(float s = 7 [[int lockgeom = 0]], float t = 7) { float k = 7;
        getattribute(\"t\", k); Ci = color(s - u, t, k - v) * emission(); }";
    assert_pixels(&facing(shader, ""), 1e-6, |_, _| [0.0, 7.0, 0.0]);
}

#[test]
fn textures_of_a_scene_are_filtered_by_what_a_pixel_covers() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("checks.png");
    let checks = image::GrayImage::from_fn(64, 64, |x, y| image::Luma([if (x + y) % 2 == 0 { 255 } else { 0 }]));
    checks.save(&file).unwrap();
    let name = file.display();
    // Two texels a pixel along both axes: a mean of black and white; without a footprint one or the other.
    let shader = format!(r#"surface s() {{ Ci = (color)texture("{name}", u, v, "fill", .5) * emission(); }}"#);
    let image = facing(&shader, "");
    let inner = (8..24).flat_map(|y| (8..24).map(move |x| (x, y)));
    assert!(inner.clone().all(|(x, y)| (image.pixel(x, y)[0] - 0.5).abs() < 0.01), "{:?}", image.pixel(10, 10));
    let sharp = format!(
        r#"surface s() {{ Ci = (float)texture("{name}", u, v, "width", 0, "interp", "closest") * emission(); }}"#
    );
    let image = facing(&sharp, "");
    assert!(inner.clone().all(|(x, y)| [0.0, 1.0].contains(&image.pixel(x, y)[0])));
    let gone = facing(r#"surface s() { Ci = (color)texture("gone.png", u, v) * emission(); }"#, "");
    let said: Vec<String> = gone.about.reports.iter().map(ToString::to_string).collect();
    assert!(said.len() == 1 && said[0].contains("there is no texture `gone.png`"), "{said:?}");
}
