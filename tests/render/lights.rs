//! How lights are chosen, and points of them: every method gives the same picture, and the better ones less noise.

use super::exact::floor_under_quad;
use super::materials::{middle, picture, picture_with};
use velour::render::{Image, LightChoice, LightPoints, LightStrategy, Settings};

/// Every strategy with every choice of lights and points.
fn methods() -> impl Iterator<Item = (LightStrategy, LightChoice, LightPoints)> {
    let strategies = [LightStrategy::Combined, LightStrategy::ScatteringOnly, LightStrategy::LightsOnly];
    let choices = LightChoice::ALL.map(|(_, choice)| choice);
    let points = LightPoints::ALL.map(|(_, points)| points);
    let all = strategies.into_iter().flat_map(move |s| choices.into_iter().map(move |c| (s, c)));
    all.flat_map(move |(s, c)| points.into_iter().map(move |p| (s, c, p)))
}

fn take(settings: &mut Settings, method: (LightStrategy, LightChoice, LightPoints)) {
    (settings.lights, settings.light_choice, settings.light_points) = method;
}

/// A floor with something over it.
fn floor(over: &str) -> String {
    format!(
        r#"<World><Camera eye="0,0.5,0.001" look_at="0,0,0" fov="1"/>
        <ShaderGroup>color Cs 0.8 0.8 0.8; shader matte l1;</ShaderGroup>
        <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/>
        <ShaderGroup is_light="yes">color c 3 3 3; shader glow l1;</ShaderGroup>{over}</World>"#
    )
}

/// The same square light in one piece and in sixteen.
#[test]
fn a_light_in_pieces_gives_what_it_gives_in_one() {
    let exact = 0.8 * 3.0 * floor_under_quad(1.0, 1.0);
    let whole = r#"<Quad corner="-1,1,-1" edge_x="2,0,0" edge_y="0,0,2"/>"#.to_owned();
    let mut squares = String::new();
    for k in 0..16 {
        let (x, z) = (-1.0 + 0.5 * f64::from(k % 4), -1.0 + 0.5 * f64::from(k / 4));
        squares += &format!(r#"<Quad corner="{x},1,{z}" edge_x="0.5,0,0" edge_y="0,0,0.5"/>"#);
    }
    for (name, over) in [("whole", whole), ("squares", squares)] {
        for method in methods() {
            let image = picture(&floor(&over), |s| {
                (s.width, s.height, s.samples, s.max_bounces) = (32, 32, 256, 1);
                take(s, method);
            });
            let mean = middle(&image);
            let tolerance = if method.0 == LightStrategy::ScatteringOnly { 6e-3 } else { 4e-3 };
            assert!((mean / exact - 1.0).abs() < tolerance, "{name}, {method:?}: {mean} against {exact}");
        }
    }
}

/// Lights of every outline around a floor and a ball, some of them behind what they light: all methods agree.
#[test]
fn all_methods_agree_about_lights_of_all_kinds() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.obj"), super::speed::ball(4)).unwrap();
    let path = folder.path().join("s.xml");
    let rhombi = r#"<Quad corner="-2,1,-1" edge_x="1,0.3,0" edge_y="0.6,0,0.9"/>
        <Quad corner="1,0.2,-1" edge_x="0.2,0.7,0" edge_y="0.5,0,0.8"/>
        <Sphere center="0,2.1,0.5" radius="0.2"/><Quad corner="-1,-0.5,-1" edge_x="2,0,0" edge_y="0,0,2"/>
        <Quad corner="-1,0.01,-1.2" edge_x="2,0,0" edge_y="0,1,0"/>"#;
    let text = format!(
        r#"<World><Camera eye="0,2.5,3" look_at="0,0,0" fov="40"/>
        <ShaderGroup>color Cs 0.6 0.6 0.6; shader matte l1;</ShaderGroup>
        <Quad corner="-4,0,-4" edge_x="0,0,8" edge_y="8,0,0"/>
        <ShaderGroup>shader leaf l1;</ShaderGroup><Sphere center="0.4,0.5,0.3" radius="0.4"/>
        <ShaderGroup>color c 2 2 2; shader glow l1;</ShaderGroup>{rhombi}<Model filename="ball.obj"/></World>"#
    );
    std::fs::write(&path, text).unwrap();
    let leaf = "surface leaf() { Ci = 0.5 * diffuse(N) + 0.3 * translucent(N); }";
    let mean = |method| {
        let image = picture_with(path.to_str().unwrap(), &[leaf], |s| {
            (s.width, s.height, s.samples, s.max_bounces) = (32, 32, 128, 2);
            take(s, method);
        });
        image.mean()[0]
    };
    let expected = mean((LightStrategy::Combined, LightChoice::Power, LightPoints::Area));
    for method in methods() {
        let tolerance = if method.0 == LightStrategy::Combined { 4e-3 } else { 1.5e-2 };
        let found = mean(method);
        assert!((found / expected - 1.0).abs() < tolerance, "{method:?}: {found} against {expected}");
    }
}

/// A closed mesh of triangles, each of them a light, and a closed room of six: 1/2 + 1/4 + ... = 1, whatever the method.
#[test]
fn closed_rooms_of_lights_sum_their_series() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.obj"), super::speed::ball(8)).unwrap();
    let path = folder.path().join("s.xml");
    let text = r#"<World><Camera eye="0.3,0.2,0.1" fov="120"/>
      <ShaderGroup>color c .5 .5 .5; color Cs .5 .5 .5; shader glow l1;</ShaderGroup><Model filename="ball.obj"/></World>"#;
    std::fs::write(&path, text).unwrap();
    for method in methods() {
        let image = picture(path.to_str().unwrap(), |s| {
            (s.width, s.height, s.samples) = (32, 32, 64);
            take(s, method);
        });
        assert!((image.mean()[0] - 1.0).abs() < 8e-3, "{method:?}: {:?}", image.mean());
    }
}

fn error(scene: &str, reference: &Image, change: impl FnOnce(&mut Settings)) -> f64 {
    let image = picture(scene, |s| {
        (s.width, s.height, s.samples, s.max_bounces, s.seed) = (32, 32, 16, 1, 3);
        change(s);
    });
    let squares = image.pixels.iter().zip(&reference.pixels).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>() / image.pixels.len() as f64
}

/// Hundreds of lamps over a floor, and the foot of a window: the squared error falls to less than a fifth and a half.
#[test]
fn the_tree_and_solid_angles_leave_less_noise() {
    // The camera sees no light: the edge of one would bring more noise than all that it lights.
    let lamps = r#"<World><Camera eye="0,0.28,0.001" look_at="0,0,0" fov="90"/>
      <ShaderGroup>color Cs 0.6 0.6 0.6; shader matte l1;</ShaderGroup>
      <Quad corner="-4,0,-4" edge_x="0,0,8" edge_y="8,0,0"/>
      <ShaderGroup is_light="yes">float power 1; shader emitter l1;</ShaderGroup>
      <Flakes low="-2,0.3,-2" high="2,0.8,2" count="400" size="0.05"/></World>"#;
    let window = r#"<World><Camera eye="0,0.8,-1.299" look_at="0,0,-1.3" fov="25"/>
      <ShaderGroup>color Cs 0.6 0.6 0.6; shader matte l1;</ShaderGroup><Quad corner="-4,0,-4" edge_x="0,0,8" edge_y="8,0,0"/>
      <ShaderGroup>color c 1 1 1; shader glow l1;</ShaderGroup>
      <Quad corner="-2,0.02,-1.5" edge_x="4,0,0" edge_y="0,2,0"/></World>"#;
    for (name, scene, factor) in [("lamps", lamps, 5.0), ("window", window, 2.0)] {
        let reference = picture(scene, |s| (s.width, s.height, s.samples, s.max_bounces) = (32, 32, 4096, 1));
        let before = error(scene, &reference, |s| {
            (s.light_choice, s.light_points) = (LightChoice::Power, LightPoints::Area);
        });
        let now = error(scene, &reference, |_| ());
        assert!(factor * now < before, "{name}: {now} against {before}");
    }
}
