//! What shaders see of the scene: layers, texture coordinates, derivatives, normals, ray kinds and attributes.

use super::materials::{middle, picture, picture_with};
use velour::render::Image;

/// Shows a colour as it is.
const SHOW: &str = "surface show(color c = 0) { Ci = c * emission(); }";

/// A unit quad that fills the picture exactly: u runs to the right from 0 to 1 and v upward.
fn facing(group: &str, shaders: &[&str]) -> Image {
    let scene = format!(
        r#"<World><Camera eye="0.5,0.5,1" fov="90"/><ShaderGroup>{group}</ShaderGroup>
        <Quad corner="0,0,0" edge_x="1,0,0" edge_y="0,1,0"/></World>"#
    );
    picture_with(&scene, shaders, |s| {
        (s.width, s.height, s.samples, s.jitter) = (32, 32, 1, false);
    })
}

/// Holds every pixel of a picture of `facing` against a function of u and v.
fn assert_pixels(image: &Image, tolerance: f32, expected: impl Fn(f32, f32) -> [f32; 3]) {
    for y in 0..32 {
        for x in 0..32 {
            let (u, v) = ((x as f32 + 0.5) / 32.0, 1.0 - (y as f32 + 0.5) / 32.0);
            let (found, wanted) = (image.pixel(x, y), expected(u, v));
            let near = (0..3).all(|c| (found[c] - wanted[c]).abs() <= tolerance);
            assert!(near, "at ({u}, {v}): {found:?} in place of {wanted:?}");
        }
    }
}

#[test]
fn u_and_v_are_where_they_should_be() {
    let image = facing("shader at l1;", &["surface at() { Ci = color(u, v, P[0]) * emission(); }"]);
    assert_pixels(&image, 1e-5, |u, v| [u, v, u]);
}

#[test]
fn connected_layers_pass_their_values_on() {
    let ramp = "shader ramp2(float gain = 1, output float across = 0, output color both = 0)
      { across = gain * u; both = color(u, v, 0); }";
    let blend =
        "shader blend(float x = 0, color a = 0, color b = 0, output color result = 0) { result = mix(a, b, x); }";
    let group = "float gain 0.5; shader ramp2 one; color b 0 0 1; shader blend two; shader show three;
      connect one.across two.x; connect one.both two.a; connect two.result three.c;";
    let image = facing(group, &[ramp, blend, SHOW]);
    assert_pixels(&image, 1e-5, |u, v| {
        let x = 0.5 * u;
        [(1.0 - x) * u, (1.0 - x) * v, x]
    });
}

#[test]
fn closures_pass_between_layers() {
    let base = "surface base(output closure color c = 0) { c = color(u, 0, 0) * emission(); }";
    let over = "surface over(closure color below = 0) { Ci = 0.5 * below + color(0, v, 0) * emission(); }";
    let image = facing("shader base one; shader over two; connect one.c two.below;", &[base, over]);
    assert_pixels(&image, 1e-5, |u, v| [0.5 * u, v, 0.0]);
}

/// One pixel is 1/32 wide on the quad. The cone is round across the ray and has the pixel's solid angle, so its
/// footprint has the pixel's area everywhere and its shape at the centre.
#[test]
fn derivatives_are_as_wide_as_a_pixel() {
    let shader = "surface widths() {
      float area = Dx(u) * Dy(v) - Dy(u) * Dx(v);
      Ci = color(filterwidth(u), filterwidth(v), sqrt(abs(area))) * emission(); }";
    let image = facing("shader widths l1;", &[shader]);
    let pixel = 1.0 / 32.0;
    assert_pixels(&image, 0.15 * pixel, |_, _| [pixel; 3]);
    for y in 0..32 {
        for x in 0..32 {
            assert!((image.pixel(x, y)[2] / pixel - 1.0).abs() < 2e-3, "the area at {x}, {y}: {:?}", image.pixel(x, y));
        }
    }
    let middle = image.pixel(16, 16);
    assert!((0..3).all(|c| (middle[c] / pixel - 1.0).abs() < 5e-3), "{middle:?}");
}

/// The derivative of a product is by the product rule: Dx(u v) = v Dx(u) + u Dx(v).
#[test]
fn derivatives_follow_the_rules() {
    let shader = "surface rule() {
      float a = Dx(u * v) - (v * Dx(u) + u * Dx(v)); float b = Dy(sin(u)) - cos(u) * Dy(u);
      float c = Dx(P[0]) - Dx(u);
      Ci = 1e3 * color(abs(a), abs(b), abs(c)) * emission(); }";
    assert_pixels(&facing("shader rule l1;", &[shader]), 1e-3, |_, _| [0.0; 3]);
}

/// A normal computed from P is that of the surface, on the viewer's side, so that bumps rise where they should.
#[test]
fn a_calculated_normal_faces_the_viewer() {
    let shader = "surface bumps() { vector n = normalize(calculatenormal(P)); Ci = color(dot(n, N)) * emission(); }";
    assert_pixels(&facing("shader bumps l1;", &[shader]), 1e-4, |_, _| [1.0; 3]);
}

#[test]
fn noise_of_p_varies_and_repeats() {
    let shader = "surface marble(float scale = 5) { Ci = color(noise(scale * P), noise(\"simplex\", scale * P) * 0.5 + 0.5, snoise(scale * P) * 0.5 + 0.5) * emission(); }";
    let image = facing("shader marble l1;", &[shader]);
    for c in 0..3 {
        let values: Vec<f32> = image.pixels.chunks_exact(3).map(|p| p[c]).collect();
        let (low, high) = values.iter().fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        assert!((0.0..0.4).contains(&low) && (0.6..=1.0).contains(&high), "channel {c}: {low} to {high}");
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        assert!((mean - 0.5).abs() < 0.15, "channel {c}: {mean}");
        // Neighbours are alike: the noise is continuous.
        let jump = values
            .windows(2)
            .enumerate()
            .filter(|(i, _)| i % 32 != 31)
            .map(|(_, w)| (w[0] - w[1]).abs())
            .fold(0.0, f32::max);
        assert!(jump < 0.4, "channel {c}: {jump}");
    }
    assert_eq!(image.pixels, facing("shader marble l1;", &[shader]).pixels);
}

/// A mesh of two triangles over the unit square, its normals leaning outward, its texture coordinates turned around.
fn mesh(shader: &str) -> Image {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 1 0\n\
      vn -1 0 2\nvn 1 0 2\nf 1/1/1 2/2/2 3/3/2\nf 1/1/1 3/3/2 4/4/1\n";
    std::fs::write(folder.path().join("square.obj"), obj).unwrap();
    let xml = folder.path().join("s.xml");
    let text = r#"<World><Camera eye="0.5,0.5,1" fov="90"/><ShaderGroup>shader it l1;</ShaderGroup>
      <Model filename="square.obj"/></World>"#;
    std::fs::write(&xml, text).unwrap();
    picture_with(xml.to_str().unwrap(), &[shader], |s| {
        (s.width, s.height, s.samples, s.jitter) = (32, 32, 1, false);
    })
}

#[test]
fn a_mesh_has_its_own_texture_coordinates() {
    let image = mesh("surface it() { Ci = color(u, v, 0) * emission(); }");
    assert_pixels(&image, 1e-5, |x, y| [1.0 - x, 1.0 - y, 0.0]);
    let image = mesh("surface it() { Ci = color(-dPdu[0], -dPdv[1], abs(dPdu[1]) + abs(dPdv[0])) * emission(); }");
    assert_pixels(&image, 1e-4, |_, _| [1.0, 1.0, 0.0]);
}

#[test]
fn a_mesh_has_smooth_normals() {
    let image = mesh("surface it() { Ci = color(0.5 + 0.5 * N[0], N[2], Ng[2]) * emission(); }");
    assert_pixels(&image, 1e-4, |x, _| {
        let n = glam::Vec3::new(2.0 * x - 1.0, 0.0, 2.0).normalize();
        [0.5 + 0.5 * n.x, n.z, 1.0]
    });
}

/// A lamp that only the camera sees lights nothing, and one that the camera alone does not see lights all the same.
#[test]
fn raytype_tells_who_asks() {
    let scene = |test: &str| {
        format!(
            r#"<World><Camera eye="0,0.5,0.001" look_at="0,0,0" fov="1"/>
            <ShaderGroup>color Cs 0.8 0.8 0.8; shader matte l1;</ShaderGroup>
            <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/>
            <ShaderGroup is_light="yes">int camera {test}; shader lamp l1;</ShaderGroup>
            <Quad corner="-1,1,-1" edge_x="2,0,0" edge_y="0,0,2"/></World>"#
        )
    };
    let lamp = "surface lamp(int camera = 1) { if (raytype(\"camera\") == camera) Ci = color(3) * emission(); }";
    let floor = |test: &str| middle(&picture_with(&scene(test), &[lamp], |s| (s.samples, s.max_bounces) = (64, 1)));
    assert_eq!(floor("1"), 0.0);
    assert!((floor("0") / (0.8 * 3.0 * super::exact::floor_under_quad(1.0, 1.0)) - 1.0).abs() < 5e-3, "{}", floor("0"));
    let seen = facing("int camera 1; shader lamp l1;", &[lamp]);
    assert_pixels(&seen, 0.0, |_, _| [3.0; 3]);
}

#[test]
fn attributes_of_the_camera_are_there() {
    let shader = "surface asks() {
      int size[2] = {0, 0}; float fov = 0; int version = 0; float none = 7; string projection = \"\";
      int found = getattribute(\"camera:resolution\", size) + getattribute(\"camera:fov\", fov)
        + getattribute(\"osl:version\", version) + getattribute(\"camera:projection\", projection);
      if (getattribute(\"no such thing\", none)) found = 99;
      if (projection != \"perspective\" || version < 11000) found = 98;
      Ci = color(found, size[0] + 100 * size[1], fov) * emission(); }";
    assert_pixels(&facing("shader asks l1;", &[shader]), 0.0, |_, _| [4.0, 3232.0, 90.0]);
}

/// In camera space the eye is the origin and what is in front has a positive z.
#[test]
fn camera_space_is_known() {
    let shader =
        "surface asks() { point p = transform(\"camera\", P); Ci = color(p[0] + 0.5, p[1] + 0.5, p[2]) * emission(); }";
    assert_pixels(&facing("shader asks l1;", &[shader]), 1e-5, |u, v| [u, v, 1.0]);
}

#[test]
fn backfacing_is_the_inner_side() {
    let scene = |eye: &str| {
        format!(
            r#"<World><Camera eye="{eye}" look_at="0,0,0" fov="20"/><ShaderGroup>shader side l1;</ShaderGroup>
            <Sphere center="0,0,0" radius="1"/></World>"#
        )
    };
    let side = "surface side() { Ci = color(backfacing(), 0, 0) * emission(); }";
    let look = |eye: &str| middle(&picture_with(&scene(eye), &[side], |_| ()));
    assert_eq!((look("0,0,3"), look("0,0,0.5")), (0.0, 1.0));
}

#[test]
fn surfacearea_is_that_of_the_object() {
    let scene = r#"<World><Camera eye="0,0,3" look_at="0,0,0" fov="20"/>
      <ShaderGroup>float power 12; shader emitter l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#;
    let exact = 12.0 / (std::f64::consts::PI * 4.0 * std::f64::consts::PI);
    assert!((middle(&picture(scene, |_| ())) - exact).abs() < 1e-5);
}
