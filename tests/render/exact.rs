//! Scenes whose answer is a formula.

use super::materials::{middle, picture, picture_with};
use velour::render::LightStrategy;

const FURNACE: &str = r#"<World>
  <Camera eye="0,0,3" look_at="0,0,0" fov="40"/>
  <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="64"/>
  <ShaderGroup>color Cs 1 1 1; shader matte l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
</World>"#;

#[test]
fn a_white_sphere_vanishes_in_a_white_furnace() {
    let image = picture(FURNACE, |s| s.samples = 64);
    for mean in image.mean() {
        assert!((mean - 1.0).abs() <= 2e-3, "{mean}");
    }
    // The same for every pixel, for this Lambert lobe samples exactly what it scatters.
    assert!(image.pixels.iter().all(|p| (p - 1.0).abs() < 1e-4));
}

#[test]
fn a_slightly_gray_sphere_is_seen_in_the_furnace() {
    let gray = FURNACE.replace("Cs 1 1 1", "Cs 0.98 0.98 0.98");
    let image = picture(&gray, |s| s.samples = 64);
    assert!((image.mean()[0] - 1.0).abs() > 2e-3, "a loss of 2 % must be found: {:?}", image.mean());
}

/// Inside a closed sphere that emits 1/2 and reflects 1/2, radiance is 1/2 + 1/4 + 1/8 + ... = 1.
#[test]
fn a_closed_sphere_sums_its_series() {
    let scene = r#"<World><Camera eye="0.3,0.2,0.1"/>
      <ShaderGroup>color c .5 .5 .5; color Cs .5 .5 .5; shader glow l1;</ShaderGroup>
      <Sphere center="0,0,0" radius="1"/></World>"#;
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
        let mean = picture(scene, |s| (s.samples, s.lights) = (64, lights)).mean()[0];
        assert!((mean - 1.0).abs() < 4e-3, "{lights:?}: {mean}");
    }
}

/// The same for every lobe that loses nothing and lets nothing through, diffuse, rough or a mirror.
#[test]
fn a_closed_sphere_sums_its_series_for_every_lossless_lobe() {
    for lobe in [
        "diffuse(N)",
        "reflection(N, 0)",
        "oren_nayar_diffuse_bsdf(N, color(1), 0.6, \"energy_compensation\", 1)",
        "subsurface_bssrdf(N, color(1), color(1), 0)",
        "0.5 * diffuse(N) + 0.5 * reflection(N, 0)",
        "sheen(diffuse(N), N, color(1), 0.3, \"layering\", \"view\")",
    ] {
        let shader = format!("surface it() {{ Ci = 0.5 * emission() + 0.5 * ({lobe}); }}");
        let scene = r#"<World><Camera eye="0.3,0.2,0.1"/><ShaderGroup>shader it l1;</ShaderGroup>
          <Sphere center="0,0,0" radius="1"/></World>"#;
        let mean = picture_with(scene, &[&shader], |s| s.samples = 64).mean()[0];
        assert!((mean - 1.0).abs() < 4e-3, "{lobe}: {mean}");
    }
}

/// The same inside a closed box of six quads: no light leaks at the edges.
#[test]
fn a_closed_box_sums_its_series() {
    let mut scene = String::from(
        r#"<World><Camera eye="0.3,0.2,0.1" fov="120"/>
        <ShaderGroup>color c .5 .5 .5; color Cs .5 .5 .5; shader glow l1;</ShaderGroup>"#,
    );
    for (corner, x, y) in [
        ("-1,-1,-1", "2,0,0", "0,2,0"),
        ("-1,-1,1", "2,0,0", "0,2,0"),
        ("-1,-1,-1", "0,2,0", "0,0,2"),
        ("1,-1,-1", "0,2,0", "0,0,2"),
        ("-1,-1,-1", "2,0,0", "0,0,2"),
        ("-1,1,-1", "2,0,0", "0,0,2"),
    ] {
        scene += &format!(r#"<Quad corner="{corner}" edge_x="{x}" edge_y="{y}"/>"#);
    }
    scene += "</World>";
    let image = picture(&scene, |s| s.samples = 64);
    assert!((image.mean()[0] - 1.0).abs() < 4e-3, "{:?}", image.mean());
    let darkest = image.pixels.iter().copied().fold(f32::INFINITY, f32::min);
    assert!(darkest >= 0.5, "a ray that escapes loses its emission: {darkest}");
}

/// A quad straight above a floor: the irradiance below its centre is a product of arctangents.
pub fn floor_under_quad(a: f64, h: f64) -> f64 {
    // Form factor from a point to a parallel rectangle a x a with a corner above the point; four of them.
    let (x, root) = (a / h, (1.0 + (a / h).powi(2)).sqrt());
    4.0 / (2.0 * std::f64::consts::PI) * (2.0 * x / root * (x / root).atan())
}

const QUAD_LIGHT: &str = r#"<World><Camera eye="0,0.5,0.001" look_at="0,0,0" fov="1"/>
  <ShaderGroup>color Cs 0.8 0.8 0.8; shader matte l1;</ShaderGroup>
  <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/>
  <ShaderGroup is_light="yes">color c 3 3 3; shader glow l1;</ShaderGroup>
  <Quad corner="-1,1,-1" edge_x="2,0,0" edge_y="0,0,2"/></World>"#;

#[test]
fn a_quad_light_gives_the_irradiance_of_the_formula() {
    let exact = 0.8 * 3.0 * floor_under_quad(1.0, 1.0);
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
        let image = picture(QUAD_LIGHT, |s| (s.samples, s.lights, s.max_bounces) = (256, lights, 1));
        let mean = middle(&image);
        assert!((mean / exact - 1.0).abs() < 3e-3, "{lights:?}: {mean} against {exact}");
    }
}

#[test]
fn counting_light_twice_would_be_found() {
    // The negative control of the test above: light and scattering samples added without weights.
    let mean = |lights| middle(&picture(QUAD_LIGHT, |s| (s.samples, s.lights, s.max_bounces) = (256, lights, 1)));
    let both = mean(LightStrategy::ScatteringOnly) + mean(LightStrategy::LightsOnly);
    let exact = 0.8 * 3.0 * floor_under_quad(1.0, 1.0);
    assert!((both / exact - 1.0).abs() > 0.5);
}

/// A sphere light seen from a point facing it: irradiance is pi L (r/d)^2.
#[test]
fn a_sphere_light_gives_the_irradiance_of_the_formula() {
    let scene = QUAD_LIGHT.replace(
        r#"<Quad corner="-1,1,-1" edge_x="2,0,0" edge_y="0,0,2"/>"#,
        r#"<Sphere center="0,2,0" radius="0.5"/>"#,
    );
    let exact = 0.8 * 3.0 / 16.0;
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
        let image = picture(&scene, |s| (s.samples, s.lights, s.max_bounces) = (256, lights, 1));
        let mean = middle(&image);
        assert!((mean / exact - 1.0).abs() < 4e-3, "{lights:?}: {mean} against {exact}");
    }
}

/// A light whose radiance varies has the mean of its samples: here 2u, so the floor sees as much as from a light of 1.
#[test]
fn a_light_that_varies_is_shaded_where_it_is_sampled() {
    let scene = QUAD_LIGHT.replace("color c 3 3 3; shader glow l1;", "shader ramp l1;");
    let exact = 0.8 * floor_under_quad(1.0, 1.0);
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
        let mean = middle(&picture(&scene, |s| (s.samples, s.lights, s.max_bounces) = (256, lights, 1)));
        assert!((mean / exact - 1.0).abs() < 4e-3, "{lights:?}: {mean} against {exact}");
    }
}

/// A sky of base + 20 y^n above a floor: irradiance is pi (base + 40 / (n + 2)).
#[test]
fn a_sky_with_a_sun_lights_the_floor_by_the_formula() {
    let scene = r#"<World><Camera eye="0,5,0.001" look_at="0,0,0" fov="20"/>
      <ShaderGroup>shader sun l1;</ShaderGroup><Background resolution="128"/>
      <ShaderGroup>color Cs 0.5 0.5 0.5; shader matte l1;</ShaderGroup>
      <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/></World>"#;
    let exact = 0.5 * (0.1 + 40.0 / 102.0);
    let tolerances = [(LightStrategy::Combined, 2e-3), (LightStrategy::ScatteringOnly, 1e-2)];
    for (lights, tolerance) in tolerances {
        let mean = middle(&picture(scene, |s| (s.samples, s.lights) = (64, lights)));
        assert!((mean / exact - 1.0).abs() < tolerance, "{lights:?}: {mean} against {exact}");
    }
}

#[test]
fn a_half_clear_pane_lets_half_of_the_light_through() {
    let scene = r#"<World><Camera eye="0,0,3" look_at="0,0,0" fov="20"/>
      <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="0"/>
      <ShaderGroup>color Cs 0 0 0; float through 0.5; shader matte l1;</ShaderGroup>
      <Quad corner="-5,-5,0" edge_x="10,0,0" edge_y="0,10,0"/></World>"#;
    assert!((middle(&picture(scene, |s| s.samples = 64)) - 0.5).abs() < 2e-3);
    // Over another background, the pane shows half of that: none of this one is in the colors.
    let image = picture(scene, |s| (s.samples, s.alpha) = (64, true));
    assert!(image.pixels.chunks_exact(4).all(|p| p[..3] == [0.0; 3]));
    let alpha: f64 = image.pixels.chunks_exact(4).map(|p| f64::from(p[3])).sum::<f64>() / f64::from(64 * 64);
    assert!((alpha - 0.5).abs() < 2e-3, "{alpha}");
}

#[test]
fn what_is_not_a_number_is_dropped_and_told_once() {
    let scene = r#"<World><Camera eye="0,0,3" look_at="0,0,0" fov="40"/>
      <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background/>
      <ShaderGroup name="bad">shader nan l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#;
    let image = picture(scene, |_| ());
    assert!(image.pixels.iter().all(|p| p.is_finite()));
    assert!((middle(&image) - 0.5).abs() < 0.02, "the rest of the path goes on: {}", middle(&image));
    let [report] = image.about.reports.as_slice() else { panic!("{:?}", image.about.reports) };
    assert_eq!(
        report.to_string(),
        "memory:2:73: error: `emission` is dropped where a parameter or weight of it is not a number"
    );
}

/// A closed mesh of triangles, each of them a light, seen from inside: nothing leaks between them.
#[test]
fn a_closed_mesh_sums_its_series() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.obj"), super::speed::ball(16)).unwrap();
    let path = folder.path().join("s.xml");
    let text = r#"<World><Camera eye="0.3,0.2,0.1" fov="120"/>
      <ShaderGroup>color c .5 .5 .5; color Cs .5 .5 .5; shader glow l1;</ShaderGroup>
      <Model filename="ball.obj"/></World>"#;
    std::fs::write(&path, text).unwrap();
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly] {
        let image = picture(path.to_str().unwrap(), |s| (s.samples, s.lights) = (64, lights));
        assert!((image.mean()[0] - 1.0).abs() < 5e-3, "{lights:?}: {:?}", image.mean());
        let darkest = image.pixels.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(darkest >= 0.5, "{lights:?}: {darkest}");
    }
}

/// Two lights, one of them far brighter: the choice between them does not show in the mean.
#[test]
fn two_lights_add_up() {
    let one = QUAD_LIGHT.replace("</World>", "");
    let two = format!(
        r#"{one}<ShaderGroup>color c 0.1 0.1 0.1; shader glow l1;</ShaderGroup>
        <Quad corner="-1,-1,-1" edge_x="2,0,0" edge_y="0,0,2"/>
        <Sphere center="0,2.1,0" radius="0.05"/><Sphere center="3,1,0" radius="0.5"/></World>"#
    );
    let mean = |lights| middle(&picture(&two, |s| (s.samples, s.lights, s.max_bounces) = (256, lights, 1)));
    let (combined, scattering) = (mean(LightStrategy::Combined), mean(LightStrategy::ScatteringOnly));
    assert!((combined / scattering - 1.0).abs() < 3e-3, "{combined} {scattering}");
}
