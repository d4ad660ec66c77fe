//! The chart and the tolerance: files that parse, fronts that are fronts, errors that agree with known figures, picks that
//! follow the tolerance.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;
use velour::closure::Settings as ClosureSettings;
use velour::closure::settings::{Shadowing, SheenAlbedo};
use velour::measure::chart::figure::{Figure, Join, Point};
use velour::measure::chart::{Budget, Effort, density, draw, figures, scene_figure, table};
use velour::measure::choose::{Asked, Choice, Reason, choose};
use velour::measure::statistics::Random;
use velour::render::{Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

const SEED: u64 = 20_261_122;
const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/scenes/spheres.xml");

/// Every figure that needs no scene, measured once.
static FIGURES: LazyLock<Vec<Figure>> = LazyLock::new(|| figures(&Effort::tiny(), &|_, _| ()).unwrap());

fn scene() -> Scene {
    Scene::load(SCENE, &[], &ShaderFiles::default()).unwrap()
}

fn error_of(figure: &str, method: &str) -> f64 {
    let figure = FIGURES.iter().find(|f| f.name == figure).unwrap();
    figure.points.iter().find(|p| p.method.starts_with(method)).unwrap_or_else(|| panic!("{method}")).error
}

/// Is the front exactly the points that no other of their group beats? Written without looking at how it is made.
fn is_front(figure: &Figure) -> bool {
    figure.points.iter().all(|p| {
        let rivals = figure.points.iter().filter(|q| q.group == p.group);
        let beaten = rivals
            .into_iter()
            .any(|q| (q.cost < p.cost && q.error <= p.error) || (q.cost <= p.cost && q.error < p.error));
        p.front != beaten
    })
}

fn random_figure(random: &mut Random) -> Figure {
    let point = |random: &mut Random| {
        // Coarse numbers, so that ties occur.
        let mut number = || f64::from((random.number() * 6.0).floor());
        let (cost, error, group) = (number(), number(), number());
        Point {
            group: format!("{}", group % 2.0),
            method: "m".to_owned(),
            cost,
            spread: [cost; 2],
            error,
            front: false,
        }
    };
    Figure {
        name: "random",
        title: String::new(),
        cost: String::new(),
        error: String::new(),
        meaning: String::new(),
        join: Join::Front,
        points: (0..12).map(|_| point(random)).collect(),
    }
}

#[test]
fn fronts_are_fronts() {
    let mut random = Random(SEED);
    for _ in 0..500 {
        let mut figure = random_figure(&mut random).with_front();
        assert!(is_front(&figure), "{:?}", figure.points);
        assert!(figure.groups().iter().all(|group| !figure.front(group).is_empty()));
        // The check notices a mark that is wrong.
        let spoiled = (random.number() * 12.0) as usize;
        figure.points[spoiled].front ^= true;
        assert!(!is_front(&figure));
    }
}

#[test]
fn measured_figures_are_finite_and_marked() {
    assert_eq!(FIGURES.len(), 8);
    for figure in FIGURES.iter() {
        assert!(figure.points.len() > 2 && !figure.meaning.is_empty(), "{}", figure.name);
        for p in &figure.points {
            let numbers = [p.cost, p.spread[0], p.spread[1], p.error];
            assert!(numbers.iter().all(|n| n.is_finite() && *n >= 0.0) && p.cost > 0.0, "{}: {p:?}", figure.name);
        }
        assert!(figure.join == Join::Lines || is_front(figure), "{}", figure.name);
    }
}

#[test]
fn errors_agree_with_known_figures() {
    // The published fit errs by 34 % of Lambda for r >= 0.06; the default fit by at most 0.57 %.
    let published = error_of("lambda", "published");
    assert!((0.30..0.36).contains(&published), "{published}");
    let fitted = error_of("lambda", "exact, fitted");
    assert!((0.002..0.0058).contains(&fitted), "{fitted}");
    assert!(error_of("lambda", "exact, Chebyshev") < 1e-5);
    assert!(error_of("lambda", "closed form, f64") < 1e-6);
    // Albedo: 0.127 of the published fit, 6.6e-5 of the default, 0.63 of Ashikhmin's visibility at r = 0.06.
    let published = error_of("visibility", "published");
    assert!((0.10..0.16).contains(&published), "{published}");
    assert!(error_of("visibility", "exact, fitted") < 1e-4);
    assert!((0.5..0.7).contains(&error_of("visibility", "Ashikhmin")));
    let fit = error_of("albedo", "polynomial 9 x 7");
    assert!((2e-4..9e-4).contains(&fit), "{fit}");
    let rational = error_of("albedo", "MaterialX");
    assert!((0.04..0.12).contains(&rational), "{rational}");
    // Uniform sampling at r = 0.25 has two to six times the variance of the transformed cosine.
    let sampling = FIGURES.iter().find(|f| f.name == "sampling").unwrap();
    let at = |m: &str| sampling.points.iter().find(|p| p.group == "r = 0.25" && p.method == m).unwrap().error;
    assert!(at("uniform") > 2.0 * at("ltc") && at("normals") > 5.0 * at("uniform"));
    // The rule min never gains over a mirror and is reciprocal; view is not, Kelemen's gains.
    assert_eq!(error_of("layering", "min (0)"), 0.0);
    let layering = FIGURES.iter().find(|f| f.name == "layering").unwrap();
    let gain =
        |m: &str| layering.points.iter().find(|p| p.group == "gain over a mirror" && p.method.starts_with(m)).unwrap();
    assert_eq!(gain("min").error, 0.0);
    assert!((0.04..0.2).contains(&gain("kelemen").error));
    // At the terminator of a coarse ball, the default is nearest to a fine one, and it alone loses nothing in a furnace.
    let terminator = FIGURES.iter().find(|f| f.name == "terminator").unwrap();
    let of = |g: &str, m: &str| terminator.points.iter().find(|p| p.group == g && p.method == m).unwrap().error;
    let squares = |m: &str| of("squared error at the terminator", m);
    assert!(5.0 * squares("origin") < squares("none").min(squares("factor")));
    let lost = |m: &str| of("energy in a white furnace", m);
    assert!(lost("origin") < 1e-3 && lost("none") > 2e-3 && lost("factor") > lost("none"));
}

/// Figure 2 of the paper: (2 + 1/r) / tau at the horizon, nothing along the normal unless r is large, and the integral of D cos is 1.
#[test]
fn the_figure_of_the_distribution_is_equation_2() {
    let figure = density();
    assert_eq!(figure.join, Join::Curves);
    assert_eq!(figure.groups().first().copied(), Some("r = 0.05"));
    assert_eq!(figure.groups().last().copied(), Some("r = 1"));
    for group in figure.groups() {
        let r: f64 = group.trim_start_matches("r = ").parse().unwrap();
        let line: Vec<(f64, f64)> =
            figure.points.iter().filter(|p| p.group == group).map(|p| (p.cost.to_radians(), p.error)).collect();
        let horizon = line.last().unwrap().1;
        assert!((horizon / ((2.0 + 1.0 / r) / std::f64::consts::TAU) - 1.0).abs() < 1e-4, "{group}: {horizon}");
        assert!(line.windows(2).all(|pair| pair[1].1 >= pair[0].1), "{group} does not rise");
        let ring = |&(theta, d): &(f64, f64)| std::f64::consts::TAU * d * theta.sin() * theta.cos();
        let total: f64 = line.windows(2).map(|p| 0.5 * (ring(&p[0]) + ring(&p[1])) * (p[1].0 - p[0].0)).sum();
        assert!((total - 1.0).abs() < 5e-3, "{group}: {total}");
    }
    let svg = draw::svg(&figure).unwrap();
    assert!(svg.contains("r = 0.05") && svg.contains("theta") && roxmltree::Document::parse(&svg).is_ok());
    assert_eq!(draw::pixels(&figure).unwrap().0, 1290);
}

#[test]
fn tables_and_drawings_parse() {
    let csv = table::csv(&FIGURES);
    let rows: usize = FIGURES.iter().map(|f| f.points.len()).sum();
    assert_eq!(csv.lines().count(), rows + 1);
    for line in csv.lines().skip(1) {
        // The numbers stand between two quoted texts on either side.
        let texts: Vec<&str> = line.split('"').collect();
        let numbers: Vec<f64> = texts[4].trim_matches(',').split(',').map(|n| n.parse().unwrap()).collect();
        assert!(numbers.len() == 5 && numbers.iter().all(|n| n.is_finite()), "{line}");
    }
    let markdown = table::markdown(&FIGURES, "a machine");
    assert!(FIGURES.iter().all(|f| markdown.contains(&f.meaning) && markdown.contains(&format!("({}.svg)", f.name))));
    for figure in FIGURES.iter() {
        let svg = draw::svg(figure).unwrap();
        let parsed = roxmltree::Document::parse(&svg).unwrap();
        let texts: String = parsed.descendants().filter_map(|n| n.text()).collect();
        assert!(figure.points.iter().all(|p| texts.contains(&p.method)), "{}", figure.name);
    }
    let (width, height, pixels) = draw::pixels(&FIGURES[0]).unwrap();
    assert_eq!(pixels.len(), 3 * (width * height) as usize);
    let inked = pixels.chunks(3).filter(|p| p != &[255, 255, 255]).count();
    assert!(inked > 2000 && inked < pixels.len() / 6, "{inked}");
}

#[test]
fn scenes_are_measured_at_equal_time() {
    let figure = scene_figure(&scene(), &Budget::tiny(), &|_, _| ()).unwrap();
    assert_eq!(figure.points.len(), 30);
    assert!(figure.points.iter().all(|p| p.cost > 0.0 && p.error > 0.0 && p.error.is_finite()));
    assert!(figure.meaning.contains("At equal time the defaults have"), "{}", figure.meaning);
    roxmltree::Document::parse(&draw::svg(&figure).unwrap()).unwrap();
}

#[test]
fn a_scene_without_error_has_no_numbers_that_divide_by_it() {
    let text = r#"<World><Camera eye="0,0,3" look_at="0,0,0" fov="40"/><ShaderGroup>shader matte layer1;</ShaderGroup>
        <Sphere center="0,0,0" radius="0.5"/></World>"#;
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders").into();
    let black = Scene::load(text, &[folder], &ShaderFiles::default()).unwrap();
    let figure = scene_figure(&black, &Budget::tiny(), &|_, _| ()).unwrap();
    assert!(figure.points.iter().all(|p| p.error == 0.0));
    let text = table::markdown(&[figure], "a machine");
    assert!(!text.contains("NaN") && !text.contains("inf") && !text.contains("At equal time"), "{text}");
    assert!(text.contains("| defaults |"), "{text}");
}

fn picked(tolerance: f64) -> Choice {
    choose(tolerance, Asked::default(), ClosureSettings::default())
}

#[test]
fn picks_follow_the_tolerance() {
    let terms = [
        (1.5, Shadowing::Ashikhmin),
        (0.5, Shadowing::Exact),
        (1e-2, Shadowing::Exact),
        // The fit errs by 0.57 % from r = 0.06 up and by 0.67 % at 0.01; a tenth is added.
        (7.5e-3, Shadowing::Exact),
        (6.6e-3, Shadowing::Series),
        (1e-4, Shadowing::Series),
    ];
    for (tolerance, term) in terms {
        let choice = picked(tolerance);
        assert_eq!(choice.closure.shadowing, term, "{choice}");
        assert!(choice.missed().next().is_none(), "{choice}");
    }
    for (tolerance, method) in [(0.05, SheenAlbedo::Short), (1e-3, SheenAlbedo::Fit), (1e-4, SheenAlbedo::Long)] {
        assert_eq!(picked(tolerance).closure.sheen_albedo, method, "{}", picked(tolerance));
    }
    // Twice asked, the same answer to the last digit.
    assert_eq!(picked(1e-3), picked(1e-3));
}

#[test]
fn what_no_method_reaches_is_said() {
    let choice = picked(1e-9);
    assert_eq!(choice.missed().count(), 2);
    assert!(choice.picks.iter().all(|pick| pick.reason == Reason::MostExact));
    assert_eq!(choice.closure.shadowing, Shadowing::Series);
    assert!(choice.to_string().contains("none is below the tolerance"));
}

#[test]
fn what_is_asked_for_wins() {
    let asked = Asked { shadowing: Some(Shadowing::Published), albedo: None };
    let choice = choose(1e-3, asked, ClosureSettings::default());
    assert_eq!(choice.closure.shadowing, Shadowing::Published);
    assert_eq!(choice.picks[0].reason, Reason::Asked);
    assert!(choice.missed().any(|pick| pick.place == "shadowing"));
}

/// The image of a tolerance is as near to that of the most exact methods as the tolerance says; the published fit is not.
#[test]
fn images_follow_the_tolerance() {
    let scene = scene();
    let image = |closure: ClosureSettings| {
        let settings = Settings { width: 80, height: 32, samples: 16, closure, ..Settings::default() };
        render(&scene, &settings.with_options(&scene.options), &Silent).unwrap()
    };
    let exact = image(picked(1e-9).closure);
    let mean_difference = |closure: ClosureSettings| {
        let image = image(closure);
        let sum: f64 = image.pixels.iter().zip(&exact.pixels).map(|(a, b)| f64::from((a - b).abs())).sum();
        sum / image.pixels.len() as f64
    };
    // At 1e-4 all picks are the most exact ones, and the picture would be compared with itself.
    let fine = mean_difference(picked(1e-3).closure);
    let coarse = mean_difference(picked(1e-2).closure);
    assert!(fine > 0.0 && fine <= 1e-4, "{fine}");
    // The terms that are passed over fail the bound: it measured 4.2e-5, the published fit 1.1e-3, Ashikhmin's 3.7e-3.
    for term in [Shadowing::Published, Shadowing::Ashikhmin] {
        let other = mean_difference(ClosureSettings { shadowing: term, ..ClosureSettings::default() });
        assert!(coarse <= 5e-4 && other > 5e-4, "{term}: {other} beside {coarse}");
    }
}

fn velour(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn the_command_line_tells_what_it_picks() {
    let folder = tempfile::tempdir().unwrap();
    let render = |more: &[&str]| {
        let mut arguments = vec!["render", SCENE, "-o", "a.png", "--res", "20", "8", "--spp", "1", "--explain"];
        arguments.extend(more);
        let output = velour(&arguments, folder.path());
        (output.status.code(), String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (status, said, _) = render(&["--tolerance", "1e-4"]);
    assert_eq!(status, Some(0));
    for part in ["shadowing: series (the cheapest below the tolerance)", "not exact: not exact enough", "albedo: long"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    let (status, said, told) = render(&["--tolerance", "1e-4", "--shadowing", "published"]);
    assert_eq!(status, Some(0));
    assert!(
        said.contains("shadowing: published (asked for)") && told.contains("warning: shadowing: published"),
        "{told}"
    );
    assert!(!render(&[]).1.contains("tolerance"));
    for wrong in ["0", "-1", "nan", "x"] {
        assert_eq!(render(&["--tolerance", wrong]).0, Some(2), "{wrong}");
    }
}

#[test]
fn folders_that_cannot_be_made_are_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = velour(&["chart", "--quick", "-o", "file"], folder.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("cannot write `file`"));
}
