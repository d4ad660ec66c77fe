//! Clear surfaces: what passes them, for eyes, for lamps and for alpha, against numbers known exactly.

use super::materials::picture_with;
use velour::render::{Image, LightStrategy, Settings};

const SKY: &str = r#"<ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="64"/>"#;

/// So many sheets of `shader`, one behind the other, in a white sky.
fn sheets(count: usize, shader: &str, change: impl FnOnce(&mut Settings)) -> Image {
    let mut scene =
        format!(r#"<World><Camera eye="0,0,5" dir="0,0,-1" fov="50"/>{SKY}<ShaderGroup>shader it l1;</ShaderGroup>"#);
    for k in 0..count {
        scene += &format!(r#"<Quad corner="-50,-50,{}" edge_x="100,0,0" edge_y="0,100,0"/>"#, -0.01 * k as f64);
    }
    picture_with(&(scene + "</World>"), &[&format!("surface it() {{ {shader} }}")], |s| {
        (s.width, s.height, s.samples, s.alpha) = (8, 8, 16, true);
        change(s);
    })
}

#[test]
fn any_number_of_clear_sheets_is_invisible() {
    for count in [1, 3, 66, 200, 500] {
        for rr_depth in [0, 5] {
            let image = sheets(count, "Ci = transparent();", |s| (s.rr_depth, s.alpha) = (rr_depth, false));
            let off = image.pixels.iter().find(|p| (*p - 1.0).abs() >= 1e-3);
            assert_eq!(off, None, "{count} sheets");
            // With alpha, the background is left to what the picture is laid over.
            let image = sheets(count, "Ci = transparent();", |s| s.rr_depth = rr_depth);
            assert!(image.pixels.iter().all(|p| *p == 0.0), "{count} sheets");
        }
    }
}

/// A medium that neither absorbs nor scatters is nothing; another one is left out, and that is said once.
#[test]
fn a_medium_is_nothing_or_said_to_be_left_out() {
    let with = |medium: &str| sheets(2, &format!("Ci = layer(transparent(), {medium});"), |s| s.alpha = false);
    for medium in [
        "medium_vdf(color(0), 1, color(1), 0, 1, 0)",
        "medium_vdf(color(.5), 0, color(1), .3, 1.5, 2)",
        "anisotropic_vdf(color(1), color(0), 0)",
        "0 * anisotropic_vdf(color(1), color(1), 0)",
        "(u > 2 ? 1.0 : 0.0) * medium_vdf(color(0), 1, color(.5), 0, 1, 0)",
    ] {
        let image = with(medium);
        assert!(image.about.reports.is_empty(), "{medium}: {:?}", image.about.reports);
        assert!(image.pixels.iter().all(|p| (p - 1.0).abs() < 1e-5), "{medium}");
    }
    for medium in
        ["medium_vdf(color(0), 1, color(1, .9, 1), 0, 1, 0)", "(.5 * u) * anisotropic_vdf(color(1), color(.1), 0)"]
    {
        let image = with(&medium.replace("* anis", "* 1e3 * anis"));
        let [report] = image.about.reports.as_slice() else { panic!("{:?}", image.about.reports) };
        let report = report.to_string();
        assert!(report.starts_with("memory:1:") && report.contains("_vdf` fills a volume"), "{report}");
        assert!(!image.about.reports[0].is_wrong());
    }
}

#[test]
fn clear_sheets_are_no_bounces() {
    let image = sheets(20, "Ci = transparent();", |s| (s.max_bounces, s.alpha) = (1, false));
    assert!(image.pixels.iter().all(|p| (p - 1.0).abs() < 1e-5));
}

#[test]
fn a_path_through_a_thousand_sheets_ends_with_a_warning() {
    let image = sheets(1100, "Ci = transparent();", |s| s.samples = 1);
    let said: Vec<String> = image.about.reports.iter().map(|report| report.to_string()).collect();
    assert!(said.iter().any(|text| text.contains("1024 clear surfaces")), "{said:?}");
}

/// Alpha is a share whatever the weights are.
#[test]
fn alpha_stays_between_0_and_1() {
    for shader in
        ["Ci = color(2) * transparent();", "Ci = .5 * transparent() + .5 * diffuse(N);", "Ci = .25 * transparent();"]
    {
        for count in [1, 5] {
            let image = sheets(count, shader, |_| ());
            let outside = image.pixels.iter().skip(3).step_by(4).find(|a| !(0.0..=1.0).contains(*a));
            assert_eq!(outside, None, "{count} of {shader}");
        }
    }
    let alpha = |count| sheets(count, "Ci = .25 * transparent();", |_| ()).pixels[3];
    assert!((alpha(1) - 0.75).abs() < 1e-6 && (alpha(2) - 0.9375).abs() < 1e-6);
}

/// A floor under a small lamp, and what hangs between.
fn under_lamp(between: &str, shader: &str, lamp: &str, change: impl FnOnce(&mut Settings)) -> Image {
    let scene = format!(
        r#"<World><Camera eye="0,.9,0" look_at="0,0,.001" fov="20"/>
        <ShaderGroup>color Cs .8 .8 .8; shader matte l1;</ShaderGroup>
        <Quad corner="-50,0,-50" edge_x="0,0,100" edge_y="100,0,0"/>
        <ShaderGroup>shader it l1;</ShaderGroup>{between}
        <ShaderGroup is_light="yes">color c 30 30 30; shader glow l1;</ShaderGroup>{lamp}</World>"#
    );
    picture_with(&scene, &[&format!("surface it() {{ {shader} }}")], |s| {
        (s.width, s.height, s.samples, s.max_bounces) = (12, 12, 64, 1);
        change(s);
    })
}

const BALL: &str = r#"<Sphere center="0,3,0" radius=".1"/>"#;
const PANEL: &str = r#"<Quad corner="-.2,3,-.2" edge_x=".4,0,0" edge_y="0,0,.4"/>"#;
const PANE: &str = r#"<Quad corner="-50,1.5,-50" edge_x="0,0,100" edge_y="100,0,0"/>"#;
const PANE_2: &str = r#"<Quad corner="-50,1.7,-50" edge_x="100,0,0" edge_y="0,0,100"/>"#;

/// Mean and relative deviation of the pixels from those of a picture without panes, in its scale.
fn against(image: &Image, bare: &Image) -> (f64, f64) {
    let ratio = image.mean()[0] / bare.mean()[0];
    let squares = image.pixels.iter().zip(&bare.pixels).map(|(a, b)| (f64::from(a / b) / ratio - 1.0).powi(2));
    (ratio, (squares.sum::<f64>() / image.pixels.len() as f64).sqrt())
}

#[test]
fn panes_before_a_lamp_take_their_part_and_add_no_noise() {
    for lamp in [BALL, PANEL] {
        let bare = under_lamp("", "Ci = diffuse(N);", lamp, |_| ());
        for (panes, shader, part) in [
            (PANE.to_owned(), "Ci = transparent();", 1.0),
            (PANE.to_owned(), "Ci = .5 * transparent();", 0.5),
            (format!("{PANE}{PANE_2}"), "Ci = .5 * transparent();", 0.25),
            (PANE.to_owned(), "Ci = sheen(transparent(), N, color(0), .5);", 1.0),
        ] {
            let (ratio, noise) = against(&under_lamp(&panes, shader, lamp, |_| ()), &bare);
            assert!((ratio - part).abs() < 1e-3 * part, "{shader}: {ratio} for {part}");
            assert!(noise < 2e-3, "{shader}: {noise}");
        }
    }
}

/// The lamp behind a pane is found and sampled: both together, and each alone, give one number.
#[test]
fn all_ways_to_find_the_lamp_agree() {
    let lamp = r#"<Quad corner="-1,3,-1" edge_x="2,0,0" edge_y="0,0,2"/>"#;
    let shader = "Ci = color(.5, .25, 1) * transparent() + .1 * diffuse(N);";
    let mean = |lights, depth| {
        under_lamp(PANE, shader, lamp, |s| (s.samples, s.lights, s.max_bounces) = (4096, lights, depth)).mean()
    };
    for depth in [1, 4] {
        let both = mean(LightStrategy::Combined, depth);
        for lights in [LightStrategy::ScatteringOnly, LightStrategy::LightsOnly] {
            let alone = mean(lights, depth);
            for c in 0..3 {
                assert!((alone[c] / both[c] - 1.0).abs() < 8e-3, "{lights:?}, {depth}: {alone:?} against {both:?}");
            }
        }
    }
}

/// A board with holes: light falls through where they are, and the eye sees through them.
#[test]
fn a_cut_out_casts_its_own_shadow() {
    let shader = "Ci = P[0] > 0 ? transparent() : diffuse(N);";
    let lamp = r#"<Sphere center="0,100,0" radius=".01"/>"#;
    let bare = under_lamp("", "Ci = diffuse(N);", lamp, |_| ());
    let cut = under_lamp(PANE, shader, lamp, |_| ());
    let (mut lit, mut dark) = (0, 0);
    for (cut, bare) in cut.pixels.chunks_exact(3).zip(bare.pixels.chunks_exact(3)) {
        lit += i32::from((cut[0] / bare[0] - 1.0).abs() < 1e-3);
        dark += i32::from(cut[0] < 1e-3 * bare[0]);
    }
    // Pixels along the edge of the shadow are neither.
    assert_eq!((lit, dark), (60, 60));
}

/// A closed room that loses a thousandth a bounce, and emits as much.
#[test]
fn a_closed_room_keeps_its_light() {
    let shader = "surface it() { Ci = .999 * diffuse(N) + .001 * emission(); }";
    let scene = r#"<World><Camera eye="0.3,0.2,0.1"/><ShaderGroup>shader it l1;</ShaderGroup>
      <Sphere center="0,0,0" radius="1"/></World>"#;
    for lights in [LightStrategy::Combined, LightStrategy::ScatteringOnly] {
        let image = picture_with(scene, &[shader], |s| (s.width, s.height, s.samples, s.lights) = (8, 8, 128, lights));
        let mean = image.mean()[0];
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }
}
