//! Closures of boundaries in trees: tints, smooth limits, both sides, keywords, lanes, and layers on top of a base.

use crate::albedo::mean;
use crate::layering::{flatten, float, id, triple, up};
use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::bsdf::fresnel::{Dielectric, conductor, dielectric};
use velour::bsdf::microfacet::{Ggx, Microfacet};
use velour::bsdf::{Scatter, params};
use velour::closure::settings::Settings;
use velour::closure::tree::{Floats, Ints, NodeId, Param, Tree};
use velour::closure::{Evaluation, Library, Lobes, Samples, event};
use velour::lang::symbols::Symbol;
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate, sample_mean};
use velour::measure::statistics::Random;

fn word(text: &str) -> Param {
    Param::String(Ints::Uniform(Symbol::new(text).0))
}

/// The number of the keyword of all rough boundaries.
const SCATTERING: u32 = 2;

fn grey(x: f32) -> Param {
    triple(x, x, x)
}

/// `dielectric_bsdf` of gray tints.
fn glass(tree: &mut Tree, tints: [f32; 2], alpha: f32, ior: f32, keywords: &[(u32, Param)]) -> NodeId {
    let table = Library::standard();
    let [reflection, transmission] = tints.map(grey);
    let params =
        [up(), triple(1.0, 0.0, 0.0), reflection, transmission, float(alpha), float(alpha), float(ior), word("ggx")];
    tree.leaf(id(&table, "dielectric_bsdf"), &params, keywords)
}

const COPPER: [[f32; 3]; 2] = [[0.23, 0.92, 1.1], [3.4, 2.6, 2.4]];

fn copper(tree: &mut Tree, alpha: f32) -> NodeId {
    let table = Library::standard();
    let [eta, k] = COPPER.map(|c| triple(c[0], c[1], c[2]));
    let params = [up(), triple(1.0, 0.0, 0.0), float(alpha), float(alpha), eta, k, word("ggx")];
    tree.leaf(id(&table, "conductor_bsdf"), &params, &[])
}

/// `generalized_schlick_bsdf` with a colored f0 of mean 0.04.
fn glaze(tree: &mut Tree, transmission: f32, alpha: f32) -> NodeId {
    let table = Library::standard();
    let params = [
        up(),
        triple(1.0, 0.0, 0.0),
        grey(1.0),
        grey(transmission),
        float(alpha),
        float(alpha),
        triple(0.02, 0.04, 0.06),
        grey(1.0),
        float(5.0),
        word("ggx"),
    ];
    tree.leaf(id(&table, "generalized_schlick_bsdf"), &params, &[])
}

/// Lobes of a tree of one lane.
fn lobes(cos: f64, make: impl Fn(&mut Tree) -> NodeId) -> Lobes {
    let mut tree = Tree::default();
    tree.clear(1);
    tree.root = Some(make(&mut tree));
    flatten(Settings::default(), &tree, cos)
}

/// Weights of samples by event, added up, over a row of random numbers: the light that goes each way.
fn by_event(lobes: &mut Lobes, count: u32) -> [Vec3; 6] {
    let (mut random, mut samples, mut sums) = (Random(SEED), Samples::default(), [Vec3::ZERO; 6]);
    for _ in 0..count {
        lobes.sample(&Column3::splat(Vec3::new(random.number(), random.number(), random.number()), 1), &mut samples);
        sums[samples.event[0] as usize] += samples.weight.get(0) / count as f32;
    }
    sums
}

#[test]
fn smooth_boundaries_have_the_color_of_their_fresnel_term() {
    for cos in [0.1, 0.5, 1.0] {
        let c = cos as f32;
        let metal = by_event(&mut lobes(cos, |t| copper(t, 0.0)), 16);
        let [eta, k] = COPPER;
        let expected = Vec3::from_array(std::array::from_fn(|i| conductor(c, eta[i], k[i])));
        assert!((metal[event::DELTA_REFLECT as usize] - expected).abs().max_element() < 1e-5, "{metal:?} {expected}");
        let both = by_event(&mut lobes(cos, |t| glaze(t, 1.0, 0.0)), 40_000);
        let p = (1.0 - c).powi(5);
        let f = Vec3::new(0.02, 0.04, 0.06) * (1.0 - p) + p;
        let (up, down) = (both[event::DELTA_REFLECT as usize], both[event::DELTA_REFRACT as usize]);
        assert!((up - f).abs().max_element() < 0.02 && (down - (Vec3::ONE - f)).abs().max_element() < 0.02);
        let tinted = by_event(&mut lobes(cos, |t| glass(t, [0.5, 0.25], 0.0, 1.5, &[])), 40_000);
        let f = dielectric(c, 1.5);
        assert!((tinted[event::DELTA_REFLECT as usize].x - 0.5 * f).abs() < 0.01, "{tinted:?}");
        assert!((tinted[event::DELTA_REFRACT as usize].x - 0.25 * (1.0 - f)).abs() < 0.01, "{tinted:?}");
    }
}

#[test]
fn a_black_tint_switches_a_half_off() {
    for (tints, alpha, count) in
        [([1.0, 1.0], 0.2, 2), ([1.0, 0.0], 0.2, 1), ([0.0, 1.0], 0.2, 1), ([0.0, 0.0], 0.2, 0)]
    {
        // Where nothing passes, light between the facets is a lobe of its own.
        let between = usize::from(tints == [1.0, 0.0]);
        assert_eq!(lobes(0.5, |t| glass(t, tints, alpha, 1.5, &[])).len(), count + between, "{tints:?}");
        assert_eq!(lobes(0.5, |t| glass(t, tints, 0.0, 1.5, &[])).len(), count, "{tints:?}");
    }
    assert_eq!(lobes(0.5, |t| glass(t, [1.0, 1.0], 0.0, -1.5, &[])).len(), 1, "an index below zero is a mirror");
    assert_eq!((lobes(0.5, |t| copper(t, 0.2)).len(), lobes(0.5, |t| copper(t, 0.01)).len()), (2, 1));
    assert_eq!(lobes(0.5, |t| glaze(t, 0.0, 0.2)).len(), 2);
}

#[test]
fn both_halves_are_picked_as_often_as_they_should() {
    for alpha in [0.02, 0.3, 1.0] {
        for cos in [0.1, 0.5, 1.0] {
            let wo = narrow(direction(cos, 0.3));
            let p = params([alpha, alpha, 1.5]);
            let expected = mean(&Microfacet::<Ggx, Dielectric, false>::prepare(p), wo)
                + mean(&Microfacet::<Ggx, Dielectric, true>::prepare(p), wo);
            let mut random = Random(SEED);
            let mut glass = lobes(cos, |t| glass(t, [1.0; 2], alpha, 1.5, &[(SCATTERING, word("single"))]));
            let total = sample_mean(&mut glass, 1, 20_000, || random.number())[0][0];
            assert!((total - expected.x).abs() < 0.02, "{alpha} {cos}: {total} {}", expected.x);
        }
    }
}

#[test]
fn an_opaque_glaze_looks_alike_from_both_sides() {
    let table = Library::standard();
    for (transmission, alike) in [(0.0, true), (1.0, false)] {
        let mut tree = Tree::default();
        tree.clear(1);
        tree.root = Some(glaze(&mut tree, transmission, 0.3));
        let (wo, mirror) = (narrow(direction(0.5, 0.3)), narrow(direction(0.55, 3.4)));
        let mut values = [Vec3::ZERO; 2];
        for (k, value) in values.iter_mut().enumerate() {
            let flip = if k == 0 { Vec3::ONE } else { Vec3::new(1.0, 1.0, -1.0) };
            let (mut lobes, mut out) = (Lobes::new(Settings::default()), Evaluation::default());
            lobes.flatten(&table, &tree, &Column3::splat(wo * flip, 1), &Column3::splat(Vec3::Z, 1));
            lobes.evaluate(&Column3::splat(mirror * flip, 1), &mut out);
            *value = out.f_cos.get(0);
        }
        let apart = (values[0] - values[1]).abs().max_element() / values[0].max_element();
        assert_eq!(apart < 1e-4, alike, "{values:?}");
    }
}

#[test]
fn keywords_choose_shadowing_and_sampling() {
    let (geometry, sampling) = (0, 1);
    let table = Library::standard();
    let spec = table.get(id(&table, "dielectric_bsdf"));
    assert_eq!([0, 1, 2].map(|k| spec.keywords[k].name), ["geometry", "sampling", "scattering"]);
    let wi = narrow(direction(0.1, 2.0));
    let seen = |keywords: &[(u32, Param)]| {
        let keywords = [keywords, &[(SCATTERING, word("single"))]].concat();
        let (mut lobes, mut out) = (lobes(0.2, |t| glass(t, [1.0, 0.0], 0.6, 1.5, &keywords)), Evaluation::default());
        lobes.evaluate(&Column3::splat(wi, 1), &mut out);
        (out.f_cos.x[0], out.pdf[0])
    };
    let plain = seen(&[]);
    assert_eq!(seen(&[(geometry, word("smith")), (sampling, word("visible"))]), plain);
    let (separable, grooves) = (seen(&[(geometry, word("separable"))]), seen(&[(geometry, word("vgroove"))]));
    assert!(separable.0 < plain.0 && grooves.0 != plain.0 && grooves.0 != separable.0);
    assert_eq!((separable.1, grooves.1), (plain.1, plain.1));
    let normals = seen(&[(sampling, word("normals"))]);
    assert!(normals.0 == plain.0 && normals.1 != plain.1);
}

#[test]
fn lanes_of_one_batch_may_differ_in_everything() {
    let table = Library::standard();
    let n = 64;
    // Distribution, shadowing, sampling, transmission tint, width and index differ by the lane.
    let choices = |lane: usize| {
        let distribution = ["ggx", "beckmann", "blinn", "sharp"][lane % 4];
        let geometry = ["smith", "separable", "vgroove"][lane / 2 % 3];
        let sampling = ["visible", "normals"][lane / 7 % 2];
        (
            distribution,
            geometry,
            sampling,
            f32::from(u8::from(!lane.is_multiple_of(5))),
            0.15 * (lane % 6) as f32,
            1.2 + 0.1 * (lane % 3) as f32,
        )
    };
    let build = |lanes: &[usize]| {
        let mut tree = Tree::default();
        tree.clear(lanes.len());
        let ints = |tree: &mut Tree, f: &dyn Fn(usize) -> i32| {
            let at = tree.ints.len() as u32;
            tree.ints.extend(lanes.iter().map(|&lane| f(lane)));
            Param::String(Ints::Varying(at))
        };
        let floats = |tree: &mut Tree, f: &dyn Fn(usize) -> f32| {
            let at = tree.floats.len() as u32;
            tree.floats.extend(lanes.iter().map(|&lane| f(lane)));
            Floats::Varying(at)
        };
        let distribution = ints(&mut tree, &|lane| Symbol::new(choices(lane).0).0);
        let geometry = ints(&mut tree, &|lane| Symbol::new(choices(lane).1).0);
        let sampling = ints(&mut tree, &|lane| Symbol::new(choices(lane).2).0);
        let tint = floats(&mut tree, &|lane| choices(lane).3);
        let alpha = floats(&mut tree, &|lane| choices(lane).4);
        let f0 = floats(&mut tree, &|lane| choices(lane).5 - 1.15);
        let params = [
            up(),
            triple(1.0, 0.0, 0.0),
            grey(1.0),
            Param::Triple([tint; 3]),
            Param::Float(alpha),
            Param::Float(alpha),
            Param::Triple([f0; 3]),
            grey(1.0),
            float(5.0),
            distribution,
        ];
        let top = tree.leaf(id(&table, "generalized_schlick_bsdf"), &params, &[(0, geometry), (1, sampling)]);
        let base = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
        tree.root = Some(tree.leaf(id(&table, "layer"), &[Param::Closure(Some(top)), Param::Closure(Some(base))], &[]));
        flatten(Settings::default(), &tree, 0.4)
    };
    let all: Vec<usize> = (0..n).collect();
    let (mut many, mut out, mut samples) = (build(&all), Evaluation::default(), Samples::default());
    for wi in [narrow(direction(0.5, 1.0)), narrow(direction(0.45, 3.4)), -narrow(direction(0.8, 3.3))] {
        many.evaluate(&Column3::splat(wi, n), &mut out);
        many.sample(&Column3::splat(Vec3::new(0.3, 0.6, 0.7), n), &mut samples);
        for lane in 0..n {
            let (mut alone, mut one, mut drawn) = (build(&[lane]), Evaluation::default(), Samples::default());
            alone.evaluate(&Column3::splat(wi, 1), &mut one);
            alone.sample(&Column3::splat(Vec3::new(0.3, 0.6, 0.7), 1), &mut drawn);
            assert_eq!(one.f_cos.get(0), out.f_cos.get(lane), "{:?}", choices(lane));
            assert_eq!(one.pdf[0], out.pdf[lane]);
            assert_eq!((drawn.wi.get(0), drawn.weight.get(0)), (samples.wi.get(lane), samples.weight.get(lane)));
        }
    }
}

#[test]
fn parameters_that_are_no_numbers_drop_the_closure() {
    for bad in [f32::NAN, f32::INFINITY] {
        let lobes = lobes(0.5, |t| glass(t, [1.0; 2], 0.3, bad, &[]));
        assert!(lobes.is_empty() && lobes.dropped().iter().all(|d| d.closure == "dielectric_bsdf"));
        assert!(!lobes.dropped().is_empty());
        assert!(self::lobes(0.5, |t| glass(t, [1.0; 2], bad, 1.5, &[])).is_empty());
        assert!(self::lobes(0.5, |t| copper(t, bad)).is_empty());
        assert!(self::lobes(0.5, |t| glaze(t, bad, 0.3)).len() < 2);
    }
}

/// What white under a coat sends back: never more than all light, and near the coat's own share plus what passes twice.
#[test]
fn a_coat_takes_from_white_what_it_reflects() {
    let table = Library::standard();
    for alpha in [0.2, 0.5, 1.0] {
        for cos in [0.05, 0.2, 0.6, 1.0] {
            for k in 0..3 {
                let mut lobes = lobes(cos, |tree| {
                    let top = match k {
                        0 => glass(tree, [1.0, 0.0], alpha, 1.5, &[]),
                        1 => copper(tree, alpha),
                        _ => glaze(tree, 0.0, alpha),
                    };
                    let base = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
                    tree.leaf(id(&table, "layer"), &[Param::Closure(Some(top)), Param::Closure(Some(base))], &[])
                });
                let total = integrate(&mut lobes, 1, &hemisphere(64, 128, cos))[0];
                let most = total.iter().fold(0.0f64, |a, &b| a.max(b));
                assert!(most < 1.0 + 3e-3 && most > 0.5, "{k} {alpha} {cos}: {total:?}");
            }
        }
    }
}
