//! Bent normals: a mirror that loses nothing shows no black spots, however its normals lean.

use super::materials::picture_with;

/// A floor seen at a flat angle in a white furnace.
fn floor(body: &str) -> velour::render::Image {
    let scene = r#"<World><Camera eye="0,.35,3" look_at="0,0,0" fov="30"/>
      <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="64"/>
      <ShaderGroup>shader it l1;</ShaderGroup><Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/></World>"#;
    let shader =
        format!("surface it() {{ normal Nb = normalize(N + .3 * vector(snoise(P*3), 0, snoise(P*3 + 10))); {body} }}");
    picture_with(scene, &[&shader], |s| (s.width, s.height, s.samples) = (32, 32, 64))
}

#[test]
fn a_bumpy_mirror_has_no_black_spots() {
    for body in [
        "Ci = conductor_bsdf(Nb, vector(1,0,0), 0, 0, color(0), color(1e6), \"ggx\");",
        "Ci = reflection(Nb, 0);",
        "Ci = generalized_schlick_bsdf(Nb, vector(1,0,0), color(1), color(0), 0, 0, color(1), color(1), 5, \"ggx\");",
    ] {
        let image = floor(body);
        let darkest = image.pixels.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(darkest > 0.999, "{darkest} of {:?}: {body}", image.mean());
    }
}

/// Of a rough one only facets far from the mirror direction lose light.
#[test]
fn a_bumpy_metal_has_no_black_spots() {
    let image = floor("Ci = conductor_bsdf(Nb, vector(1,0,0), .1, .1, color(0), color(1e6), \"ggx\");");
    let darkest = image.pixels.iter().copied().fold(f32::INFINITY, f32::min);
    assert!(image.mean()[0] > 0.8 && image.mean()[0] < 1.0 + 1e-3 && darkest > 0.4, "{:?}, {darkest}", image.mean());
}
