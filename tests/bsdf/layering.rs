//! Furnaces: a white sky over layered closures, by quadrature and by sampling, with golden totals and negative controls.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use serde_json::Value;
use velour::closure::settings::Shadowing;
use velour::closure::tree::{Floats, NodeId, Param, Tree};
use velour::closure::{Layering, Library, Lobes, Settings};
use velour::lang::closures::ClosureId;
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate, sample_mean};
use velour::measure::statistics::Random;

/// The closure of a name.
pub fn id(table: &Library, name: &'static str) -> ClosureId {
    table.named(name).next().expect("a closure of this name").0
}

/// A constant triple.
pub fn triple(x: f32, y: f32, z: f32) -> Param {
    Param::Triple([Floats::Uniform(x), Floats::Uniform(y), Floats::Uniform(z)])
}

/// The normal along z.
pub fn up() -> Param {
    triple(0.0, 0.0, 1.0)
}

/// A constant float.
pub fn float(value: f32) -> Param {
    Param::Float(Floats::Uniform(value))
}

/// `sheen(diffuse(N), N, tint, r)`.
pub fn cloth(table: &Library, tree: &mut Tree, tint: f32, r: f32) -> NodeId {
    let base = tree.leaf(id(table, "diffuse"), &[up()], &[]);
    tree.leaf(id(table, "sheen"), &[Param::Closure(Some(base)), up(), triple(tint, tint, tint), float(r)], &[])
}

/// Lobes of one lane seen at a cosine.
pub fn flatten(settings: Settings, tree: &Tree, cos: f64) -> Lobes {
    let table = Library::standard();
    let mut lobes = Lobes::new(settings);
    let wo = Column3::splat(narrow(direction(cos, 0.3)), tree.lanes);
    lobes.flatten(&table, tree, &wo, &Column3::splat(Vec3::Z, tree.lanes));
    lobes
}

/// Total of `sheen over white Lambert` toward a cosine, by quadrature.
fn total(settings: Settings, r: f64, cos: f64) -> f64 {
    let table = Library::standard();
    let mut tree = Tree::default();
    tree.clear(1);
    tree.root = Some(cloth(&table, &mut tree, 1.0, r as f32));
    let mut lobes = flatten(settings, &tree, cos);
    integrate(&mut lobes, 1, &hemisphere(40, 128, cos))[0][0]
}

fn settings(layering: Layering, shadowing: Shadowing, softening: bool) -> Settings {
    Settings { layering, shadowing, softening, ..Settings::default() }
}

const ROUGHNESSES: [f64; 6] = [0.06, 0.15, 0.25, 0.4, 0.65, 1.0];

#[test]
fn white_furnace() {
    for r in ROUGHNESSES {
        let (mut least, mut most, mut off) = (2.0f64, 0.0f64, 0.0f64);
        for cos in [0.05, 0.1, 0.25, 0.5, 0.75, 1.0] {
            let min = total(settings(Layering::Min, Shadowing::Exact, true), r, cos);
            let view = total(settings(Layering::View, Shadowing::Exact, true), r, cos);
            least = least.min(min);
            most = most.max(min);
            off = off.max((view - 1.0).abs());
        }
        println!("r {r}: min {least:.4}..{most:.5}, view off by {off:.5}");
        assert!(least >= 0.85 && most <= 1.0 + 1e-3, "min, r {r}: {least} {most}");
        assert!(off <= 2e-3, "view, r {r}: {off}");
    }
}

#[test]
fn golden_totals() {
    let reference: Value = serde_json::from_str(include_str!("../reference/scattering.json")).expect("JSON");
    let table = &reference["layer_over_white_lambert"];
    let names: Vec<&str> = table["columns"].as_array().expect("columns").iter().filter_map(Value::as_str).collect();
    let mut worst = [0.0f64; 2];
    for row in table["rows"].as_array().expect("rows") {
        let at = |name: &str| &row[names.iter().position(|n| *n == name).expect("a column")];
        let number = |name: &str| at(name).as_f64().expect("a number");
        let (shadowing, soft) = match at("model").as_str() {
            Some("paper_soft") => (Shadowing::Published, true),
            Some("exact_soft") => (Shadowing::Exact, true),
            _ => (Shadowing::Exact, false),
        };
        let family = usize::from(shadowing == Shadowing::Published);
        for (rule, column) in
            [(Layering::Min, "E_min(1-ai,1-ao)"), (Layering::View, "E_1-ao"), (Layering::Kelemen, "E_kelemen")]
        {
            let value = total(settings(rule, shadowing, soft), number("r"), number("cos_o"));
            let error = (value - number(column)).abs();
            worst[family] = worst[family].max(error);
            assert!(error < 1e-3, "{rule} {shadowing} {soft} {row}: {value}");
        }
    }
    println!("golden totals: exact {:.2e}, published {:.2e}", worst[0], worst[1]);
}

#[test]
fn sampling_agrees_with_quadrature() {
    let table = Library::standard();
    let mut tree = Tree::default();
    for (k, r) in [0.06f32, 0.25, 1.0].into_iter().enumerate() {
        tree.clear(128);
        tree.root = Some(cloth(&table, &mut tree, 1.0, r));
        for rule in [Layering::Min, Layering::View, Layering::Kelemen] {
            let mut lobes = flatten(settings(rule, Shadowing::Exact, true), &tree, 0.5);
            let expected = integrate(&mut lobes, 1, &[]).len();
            assert_eq!(expected, 1);
            let expected = total(settings(rule, Shadowing::Exact, true), f64::from(r), 0.5);
            let mut random = Random(SEED + k as u64);
            let means = sample_mean(&mut lobes, 128, 400, || random.number());
            let mean = means.iter().map(|m| m[1]).sum::<f64>() / 128.0;
            assert!((mean - expected).abs() < 4e-3, "{rule} {r}: {mean} {expected}");
        }
    }
}

#[test]
fn a_lobe_two_percent_too_bright_is_rejected() {
    let table = Library::standard();
    let mut tree = Tree::default();
    tree.clear(1);
    let cloth = cloth(&table, &mut tree, 1.0, 0.25);
    tree.root = tree.scale(Some(cloth), [Floats::Uniform(1.02); 3]);
    let mut lobes = flatten(settings(Layering::View, Shadowing::Exact, true), &tree, 0.5);
    let sum = integrate(&mut lobes, 1, &hemisphere(40, 128, 0.5))[0][0];
    assert!((sum - 1.0).abs() > 2e-3, "the furnace does not see 2 %: {sum}");
}

/// A rough boundary that both reflects and refracts, for 64 lanes.
fn glass(table: &Library, distribution: &str, x: f32, eta: f32) -> Tree {
    let mut tree = Tree::default();
    tree.clear(64);
    let name = velour::lang::symbols::Symbol::new(distribution).0;
    let params = [
        Param::String(velour::closure::tree::Ints::Uniform(name)),
        up(),
        triple(0.0, 0.0, 0.0),
        float(x),
        float(x),
        float(eta),
        Param::Int(velour::closure::tree::Ints::Uniform(2)),
    ];
    tree.root = Some(tree.leaf(id(table, "microfacet"), &params, &[]));
    tree
}

#[test]
fn rough_glass_samples_what_it_is() {
    // From inside, a reflection that falls below the horizon must not be weighed as a refraction.
    let table = Library::standard();
    for distribution in ["ggx", "beckmann"] {
        for (eta, cos) in [(1.5f32, 0.3f64), (1.5, 0.8), (1.0 / 1.5, 0.5), (1.0 / 1.5, 0.7), (1.0 / 1.5, 0.9)] {
            let mut lobes = flatten(Settings::default(), &glass(&table, distribution, 0.3, eta), cos);
            let upper = hemisphere(64, 256, cos);
            let lower = upper.iter().map(|&(wi, weight)| (glam::Vec3::new(wi.x, wi.y, -wi.z), weight));
            let sphere: Vec<_> = upper.iter().copied().chain(lower).collect();
            let expected = integrate(&mut lobes, 64, &sphere)[0][0];
            let mut random = Random(SEED);
            let means = sample_mean(&mut lobes, 64, 2000, || random.number());
            let mean = means.iter().map(|m| m[0]).sum::<f64>() / 64.0;
            assert!((mean - expected).abs() < 6e-3, "{distribution}, eta {eta}, cos {cos}: {mean} {expected}");
            assert!(expected < 1.001, "{distribution}, eta {eta}, cos {cos}: {expected}");
        }
    }
}

#[test]
fn glass_is_white() {
    // Smooth glass reflects or refracts everything; rough glass loses only what is scattered twice, which
    // is more from inside, close to the critical angle.
    let table = Library::standard();
    for (x, outside, inside) in [(0.0f32, 0.9999, 0.9999), (0.2, 0.97, 0.9), (0.5, 0.85, 0.7)] {
        for distribution in ["ggx", "beckmann"] {
            for eta in [1.5f32, 1.0 / 1.5] {
                let tree = glass(&table, distribution, x, eta);
                let mut lobes = flatten(Settings::default(), &tree, 0.8);
                let mut random = Random(SEED);
                let means = sample_mean(&mut lobes, 64, 1000, || random.number());
                let mean = means.iter().map(|m| m[0]).sum::<f64>() / 64.0;
                let least = if eta > 1.0 { outside } else { inside };
                assert!(mean > least && mean < 1.004, "{distribution} {x} {eta}: {mean}");
            }
        }
    }
}
