//! Trees of every shape: nesting, sums, masks, delta lobes, bad numbers, and lanes that know nothing of each other.

use crate::layering::{cloth, flatten, float, id, triple, up};
use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::closure::settings::{Settings, Shadowing};
use velour::closure::tree::{Floats, Ints, Node, Param, Tree};
use velour::closure::{Evaluation, Library, Lobes, Samples, event};
use velour::exec::MAX_LANES;
use velour::lang::symbols::Symbol;
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate};
use velour::measure::statistics::Random;

fn tree(lanes: usize) -> (Library, Tree) {
    let mut tree = Tree::default();
    tree.clear(lanes);
    (Library::standard(), tree)
}

fn evaluate(lobes: &mut Lobes, lanes: usize, wi: Vec3) -> Evaluation {
    let mut out = Evaluation::default();
    lobes.evaluate(&Column3::splat(wi, lanes), &mut out);
    out
}

#[test]
fn ten_thousand_nested_sheens_are_linear() {
    let (table, mut tree) = tree(4);
    let mut node = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    for _ in 0..10_000 {
        node = tree.leaf(
            id(&table, "sheen"),
            &[Param::Closure(Some(node)), up(), triple(0.01, 0.01, 0.01), float(0.3)],
            &[],
        );
    }
    tree.root = Some(node);
    let start = std::time::Instant::now();
    let mut lobes = flatten(Settings::default(), &tree, 0.6);
    assert_eq!(lobes.len(), 10_001);
    let sum = integrate(&mut lobes, 4, &hemisphere(3, 4, 0.6))[0][0];
    assert!(sum > 0.2 && sum < 1.1, "{sum}");
    let mut samples = Samples::default();
    lobes.sample(&Column3::splat(Vec3::splat(0.4), 4), &mut samples);
    assert!(samples.pdf[0] > 0.0);
    assert_eq!(lobes.describe(0).last().map(|l| l.depth), Some(10_000));
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn ten_thousand_summed_lobes_and_nested_layers() {
    let (table, mut tree) = tree(2);
    let mut sum = None;
    for k in 0..10_000 {
        let leaf = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
        let scaled = tree.scale(Some(leaf), [Floats::Uniform(1e-4); 3]);
        sum = tree.add(sum, scaled);
        if k % 2 == 0 {
            let top = tree.leaf(id(&table, "sheen_bsdf"), &[up(), triple(1e-4, 1e-4, 1e-4), float(0.3)], &[]);
            sum = Some(tree.leaf(id(&table, "layer"), &[Param::Closure(Some(top)), Param::Closure(sum)], &[]));
        }
    }
    tree.root = sum;
    let mut lobes = flatten(Settings::default(), &tree, 0.6);
    assert_eq!(lobes.len(), 15_000);
    let total = integrate(&mut lobes, 2, &hemisphere(3, 4, 0.6))[0][0];
    assert!(total > 0.9 && total < 1.2, "{total}");
}

#[test]
fn layers_nested_in_tops_are_linear() {
    let (table, mut tree) = tree(2);
    let mut node = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    for _ in 0..5_000 {
        let base = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
        node = tree.leaf(id(&table, "layer"), &[Param::Closure(Some(node)), Param::Closure(Some(base))], &[]);
    }
    tree.root = Some(node);
    let mut lobes = flatten(Settings::default(), &tree, 0.6);
    let total = integrate(&mut lobes, 2, &hemisphere(3, 4, 0.6))[0][0];
    assert!((total - 1.0).abs() < 1e-3, "white on white is white: {total}");
}

#[test]
fn shared_nodes_do_not_multiply() {
    let (table, mut tree) = tree(3);
    let mut node = Some(tree.leaf(id(&table, "diffuse"), &[up()], &[]));
    for _ in 0..50 {
        node = tree.add(node, node);
        node = tree.scale(node, [Floats::Uniform(0.5); 3]);
    }
    tree.root = node;
    let lobes = flatten(Settings::default(), &tree, 0.6);
    assert_eq!(lobes.describe(0).iter().map(|l| l.weight).collect::<Vec<_>>(), [[1.0; 3]]);
}

#[test]
fn keywords_win_over_settings() {
    let (table, mut tree) = tree(2);
    let base = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    let view = Symbol::new("view").0;
    let published = tree.varying_ints(&[Symbol::new("published").0, Symbol::new("exact").0]);
    let params = [Param::Closure(Some(base)), up(), triple(1.0, 1.0, 1.0), float(0.4)];
    let keywords =
        [(0, Param::String(published)), (1, Param::Int(Ints::Uniform(0))), (2, Param::String(Ints::Uniform(view)))];
    tree.root = Some(tree.leaf(id(&table, "sheen"), &params, &keywords));
    let mut mixed = flatten(Settings::default(), &tree, 0.5);
    let wi = narrow(direction(0.4, 0.9));
    let mixed = evaluate(&mut mixed, 2, wi);
    for (lane, shadowing) in [Shadowing::Published, Shadowing::Exact].into_iter().enumerate() {
        let settings = Settings {
            shadowing,
            softening: false,
            layering: "view".parse().unwrap_or_default(),
            ..Settings::default()
        };
        let mut plain = Tree::default();
        plain.clear(1);
        plain.root = Some(cloth(&table, &mut plain, 1.0, 0.4));
        let alone = evaluate(&mut flatten(settings, &plain, 0.5), 1, wi);
        assert!(
            (alone.f_cos.x[0] - mixed.f_cos.x[lane]).abs() < 1e-6 && (alone.pdf[0] - mixed.pdf[lane]).abs() < 1e-6,
            "{lane}"
        );
    }
}

#[test]
fn numbers_that_are_none_are_dropped_and_reported() {
    let (table, mut tree) = tree(4);
    let good = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    let r = tree.varying(&[0.3, f32::NAN, 0.3, f32::INFINITY]);
    let params = [Param::Closure(Some(good)), up(), triple(1.0, 1.0, 1.0), Param::Float(r)];
    let sheen = tree.leaf(id(&table, "sheen"), &params, &[]);
    let weight = tree.varying(&[1.0, 1.0, f32::NAN, 1.0]);
    let other = tree.leaf(id(&table, "translucent"), &[up()], &[]);
    let other = tree.scale(Some(other), [weight, Floats::Uniform(0.5), Floats::Uniform(0.5)]);
    tree.root = tree.add(Some(sheen), other);
    let mut lobes = flatten(Settings::default(), &tree, 0.5);
    let mut dropped: Vec<_> = lobes.dropped().iter().map(|d| (d.closure, d.lane)).collect();
    dropped.sort();
    assert_eq!(dropped, [("sheen", 1), ("sheen", 3), ("translucent", 2)]);
    let out = evaluate(&mut lobes, 4, Vec3::Z);
    assert!(out.pdf.iter().chain(&out.f_cos.x).all(|v| v.is_finite()));
    // A dropped sheen takes nothing from its base.
    assert!((out.f_cos.x[1] - std::f32::consts::FRAC_1_PI).abs() < 1e-6 && out.f_cos.x[0] < out.f_cos.x[1]);
}

#[test]
fn untaken_branches_may_hold_anything() {
    let (table, mut tree) = tree(2);
    let r = tree.varying(&[f32::NAN, 0.3]);
    let sheen = tree.leaf(id(&table, "sheen_bsdf"), &[up(), triple(1.0, 1.0, 1.0), Param::Float(r)], &[]);
    let plain = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    let mask = tree.varying_ints(&[0, 1]);
    tree.root = Some(tree.push(Node::Select { mask, then: Some(sheen), otherwise: Some(plain) }));
    let lobes = flatten(Settings::default(), &tree, 0.5);
    assert!(lobes.dropped().is_empty());
    assert_eq!(lobes.describe(0)[0].closure, "diffuse");
    assert_eq!(lobes.describe(1)[0].closure, "sheen_bsdf");
}

#[test]
fn delta_lobes_are_picked_by_their_part() {
    let (table, mut tree) = tree(1);
    let mirror = tree.leaf(id(&table, "reflection"), &[up(), float(0.0)], &[]);
    let through = tree.leaf(id(&table, "transparent"), &[], &[]);
    let mirror = tree.scale(Some(mirror), [Floats::Uniform(0.75); 3]);
    let through = tree.scale(Some(through), [Floats::Uniform(0.25); 3]);
    tree.root = tree.add(mirror, through);
    let mut lobes = flatten(Settings::default(), &tree, 0.5);
    assert!(!lobes.has_non_delta());
    assert_eq!(evaluate(&mut lobes, 1, Vec3::Z).pdf, [0.0]);
    let (mut counts, mut out, mut random) = ([0; 6], Samples::default(), Random(SEED));
    for _ in 0..10_000 {
        lobes.sample(&Column3::splat(Vec3::new(random.number(), 0.2, 0.1), 1), &mut out);
        counts[out.event[0] as usize] += 1;
        assert!((out.weight.x[0] - 1.0).abs() < 1e-5);
    }
    assert!((counts[event::DELTA_REFLECT as usize] as f32 / 1e4 - 0.75).abs() < 0.02, "{counts:?}");
    assert!((counts[event::STRAIGHT as usize] as f32 / 1e4 - 0.25).abs() < 0.02, "{counts:?}");
}

#[test]
fn negative_weights_subtract() {
    let (table, mut tree) = tree(1);
    let leaf = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    let other = tree.leaf(id(&table, "diffuse"), &[up()], &[]);
    let minus = tree.scale(Some(other), [Floats::Uniform(-0.25); 3]);
    tree.root = tree.add(Some(leaf), minus);
    let mut lobes = flatten(Settings::default(), &tree, 0.5);
    let out = evaluate(&mut lobes, 1, Vec3::Z);
    assert!((out.f_cos.x[0] - 0.75 * std::f32::consts::FRAC_1_PI).abs() < 1e-6);
    assert!((out.pdf[0] - std::f32::consts::FRAC_1_PI).abs() < 1e-6);
}

#[test]
fn emission_and_holes_are_seen_through_layers() {
    let (table, mut tree) = tree(1);
    let emission = tree.leaf(id(&table, "emission"), &[], &[]);
    let hole = tree.leaf(id(&table, "holdout"), &[], &[]);
    let both = tree.add(Some(emission), Some(hole));
    let params = [Param::Closure(both), up(), triple(1.0, 0.5, 0.5), float(0.4)];
    tree.root = Some(tree.leaf(id(&table, "sheen"), &params, &[]));
    let lobes = flatten(Settings::default(), &tree, 0.5);
    let alpha = 1.0 - lobes.describe(0)[0].albedo;
    assert!((lobes.emission().x[0] - alpha).abs() < 1e-6 && (lobes.holdout()[0] - alpha).abs() < 1e-6);
}

#[test]
fn no_light_leaks_through_a_tilted_normal() {
    let (table, mut tree) = tree(1);
    let tilted = Vec3::new(0.8, 0.0, 0.6);
    tree.root = Some(tree.leaf(id(&table, "diffuse"), &[triple(tilted.x, tilted.y, tilted.z)], &[]));
    let mut lobes = flatten(Settings::default(), &tree, 0.9);
    let below = Vec3::new(0.98, 0.0, -0.2).normalize();
    assert!(below.dot(tilted) > 0.0);
    assert_eq!(evaluate(&mut lobes, 1, below).f_cos.x, [0.0]);
    assert!(evaluate(&mut lobes, 1, Vec3::Z).f_cos.x[0] > 0.0);
}

/// A tree with most closures in it, with columns that vary.
fn everything(table: &Library, lanes: std::ops::Range<usize>) -> Tree {
    let mut tree = Tree::default();
    tree.clear(lanes.len());
    let column = |tree: &mut Tree, f: &dyn Fn(f32) -> f32| {
        let values: Vec<f32> = lanes.clone().map(|k| f(k as f32 / MAX_LANES as f32)).collect();
        tree.varying(&values)
    };
    let n = [column(&mut tree, &|t| 0.3 * (9.0 * t).sin()), Floats::Uniform(0.1), Floats::Uniform(1.0)];
    let r = column(&mut tree, &|t| t);
    let tint = column(&mut tree, &|t| 1.0 - 0.5 * t);
    let ints: Vec<i32> = lanes.clone().map(|k| (k % 3) as i32).collect();
    let refract = tree.varying_ints(&ints);
    let normal = Param::Triple(n);
    let distribution = Param::String(Ints::Uniform(Symbol::new("ggx").0));
    let glass_params =
        [distribution, normal, triple(1.0, 0.0, 0.0), Param::Float(r), float(0.2), float(1.4), Param::Int(refract)];
    let glass = tree.leaf(id(table, "microfacet"), &glass_params, &[]);
    let rough = tree.leaf(id(table, "oren_nayar"), &[normal, Param::Float(r)], &[]);
    let sum = tree.add(Some(glass), Some(rough));
    let sheen =
        tree.leaf(id(table, "sheen"), &[Param::Closure(sum), normal, Param::Triple([tint; 3]), Param::Float(r)], &[]);
    let mirror = tree.leaf(id(table, "refraction"), &[normal, Param::Float(tint)], &[]);
    let mask = tree.varying_ints(&ints);
    let select = tree.push(Node::Select { mask, then: Some(mirror), otherwise: Some(sheen) });
    let top = tree.leaf(id(table, "sheen_bsdf"), &[normal, Param::Triple([r; 3]), Param::Float(tint)], &[]);
    let kelemen = (0, Param::String(Ints::Uniform(Symbol::new("kelemen").0)));
    tree.root =
        Some(tree.leaf(id(table, "layer"), &[Param::Closure(Some(top)), Param::Closure(Some(select))], &[kelemen]));
    tree
}

#[test]
fn lanes_know_nothing_of_each_other() {
    let table = Library::standard();
    let run = |lanes: std::ops::Range<usize>| {
        let n = lanes.len();
        let tree = everything(&table, lanes.clone());
        let mut random: Vec<Random> = lanes.clone().map(|k| Random(SEED + k as u64)).collect();
        let (mut wo, mut xi) = (Column3::zeros(n), Column3::zeros(n));
        for lane in 0..n {
            let mut next = || random[lane].number();
            wo.set(lane, narrow(direction(f64::from(next()), 6.0 * f64::from(next()))));
            xi.set(lane, Vec3::new(next(), next(), next()));
        }
        let mut lobes = Lobes::new(Settings::default());
        lobes.flatten(&table, &tree, &wo, &Column3::splat(Vec3::Z, n));
        let (mut samples, mut out) = (Samples::default(), Evaluation::default());
        lobes.sample(&xi, &mut samples);
        lobes.evaluate(&Column3::splat(narrow(direction(0.7, 2.0)), n), &mut out);
        (samples, out)
    };
    let (samples, out) = run(0..MAX_LANES);
    assert!(samples.event.contains(&event::GLOSSY) && samples.event.contains(&event::DIFFUSE));
    for k in (0..MAX_LANES).step_by(3) {
        let (s, o) = run(k..k + 1);
        assert_eq!(s.weight.get(0), samples.weight.get(k), "lane {k}");
        assert_eq!((s.wi.get(0), s.pdf[0], s.event[0]), (samples.wi.get(k), samples.pdf[k], samples.event[k]));
        assert_eq!((o.f_cos.get(0), o.pdf[0]), (out.f_cos.get(k), out.pdf[k]), "lane {k}");
    }
}

/// A tree that shines through a sheen, and has a hole in it.
fn shining(table: &Library, lanes: usize) -> Tree {
    let mut tree = Tree::default();
    tree.clear(lanes);
    let column = tree.varying(&(0..lanes).map(|k| k as f32 * 0.25).collect::<Vec<f32>>());
    let light = tree.leaf(id(table, "emission"), &[], &[]);
    let light = tree.scale(Some(light), [column, Floats::Uniform(2.0), column]);
    let hole = tree.leaf(id(table, "holdout"), &[], &[]);
    let sum = tree.add(light, Some(hole));
    let params = [Param::Closure(sum), up(), triple(0.5, 0.5, 0.5), float(0.3)];
    tree.root = Some(tree.leaf(id(table, "sheen"), &params, &[]));
    tree
}

#[test]
fn batches_know_nothing_of_those_before() {
    let table = Library::standard();
    let empty = |lanes: usize| {
        let mut tree = Tree::default();
        tree.clear(lanes);
        tree
    };
    let trees = [
        everything(&table, 0..128),
        shining(&table, 128),
        everything(&table, 128..256),
        shining(&table, 7),
        empty(7),
        everything(&table, 0..7),
        shining(&table, 3),
        everything(&table, 0..MAX_LANES),
        empty(MAX_LANES),
        everything(&table, 100..128),
    ];
    let all = |lobes: &mut Lobes, tree: &Tree| {
        let n = tree.lanes;
        let (mut wo, mut xi) = (Column3::zeros(n), Column3::zeros(n));
        let mut random = Random(SEED);
        for lane in 0..n {
            let mut next = || random.number();
            wo.set(lane, narrow(direction(f64::from(next()), 6.0 * f64::from(next()))));
            xi.set(lane, Vec3::new(next(), next(), next()));
        }
        lobes.flatten(&table, tree, &wo, &Column3::splat(Vec3::Z, n));
        let mut samples = Samples::default();
        lobes.sample(&xi, &mut samples);
        let light = evaluate(lobes, n, narrow(direction(0.7, 2.0)));
        (samples, light, lobes.emission().clone(), lobes.holdout().clone(), lobes.describe(n - 1))
    };
    let mut used = Lobes::new(Settings::default());
    for (k, tree) in trees.iter().enumerate() {
        let fresh = all(&mut Lobes::new(Settings::default()), tree);
        assert!(all(&mut used, tree) == fresh, "tree {k}");
    }
}
