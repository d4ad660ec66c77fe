//! Times of flattening, evaluating and sampling closures, a batch of 128 lanes a round; divide by 128 for one direction.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::Vec3;
use multiversion::multiversion;
use velour::bsdf::sheen::{EXACT, Sheen};
use velour::bsdf::{Scatter, params};
use velour::closure::tree::{Floats, Ints, NodeId, Param, Tree};
use velour::closure::{Evaluation, Lobes, Samples, Settings};
use velour::lang::closures::ClosureTable;
use velour::lang::symbols::Symbol;
use velour::math::columns::Column3;
use velour::measure::statistics::Random;

const LANES: usize = 128;

fn main() {
    divan::main();
}

/// What is timed.
const CASES: [&str; 6] = ["diffuse", "cloth", "cloth varying", "cloth published", "ggx", "glass"];

fn directions(seed: u64) -> Column3 {
    let mut random = Random(seed);
    let mut out = Column3::zeros(LANES);
    for lane in 0..LANES {
        let w = velour::math::warp::uniform_hemisphere(random.number(), random.number());
        out.set(lane, w);
    }
    out
}

fn tree(table: &ClosureTable, case: &str) -> Tree {
    let mut tree = Tree::default();
    tree.clear(LANES);
    let mut random = Random(7);
    let normals: [Vec<f32>; 3] =
        std::array::from_fn(|k| (0..LANES).map(|_| if k == 2 { 1.0 } else { 0.2 * (random.number() - 0.5) }).collect());
    let normal = Param::Triple(normals.each_ref().map(|column| tree.varying(column)));
    let roughnesses: Vec<f32> = (0..LANES).map(|_| 0.1 + 0.8 * random.number()).collect();
    let id = |name| table.named(name).next().expect("a closure of this name").0;
    let float = |value| Param::Float(Floats::Uniform(value));
    let white = Param::Triple([Floats::Uniform(0.8); 3]);
    let nest = |tree: &mut Tree, r: Param, keywords: &[(u32, Param)]| -> NodeId {
        let base = tree.leaf(id("diffuse"), &[normal], &[]);
        tree.leaf(id("sheen"), &[Param::Closure(Some(base)), normal, white, r], keywords)
    };
    let rough = |tree: &mut Tree, refract: i32| {
        let ggx = Param::String(Ints::Uniform(Symbol::new("ggx").0));
        let params = [ggx, normal, normal, float(0.3), float(0.3), float(1.5), Param::Int(Ints::Uniform(refract))];
        tree.leaf(id("microfacet"), &params, &[])
    };
    tree.root = Some(match case {
        "diffuse" => tree.leaf(id("diffuse"), &[normal], &[]),
        "cloth" => nest(&mut tree, float(0.3), &[]),
        "cloth varying" => {
            let r = Param::Float(tree.varying(&roughnesses));
            nest(&mut tree, r, &[])
        }
        "cloth published" => {
            nest(&mut tree, float(0.3), &[(0, Param::String(Ints::Uniform(Symbol::new("published").0)))])
        }
        "ggx" => rough(&mut tree, 0),
        _ => rough(&mut tree, 2),
    });
    tree
}

fn prepared(case: &str) -> (ClosureTable, Tree, Lobes, Column3, Column3) {
    let table = ClosureTable::standard();
    let tree = tree(&table, case);
    let (wo, ng) = (directions(1), Column3::splat(Vec3::Z, LANES));
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(&table, &tree, &wo, &ng);
    (table, tree, lobes, wo, ng)
}

#[divan::bench(args = CASES)]
fn flatten(bencher: Bencher, case: &str) {
    let (table, tree, mut lobes, wo, ng) = prepared(case);
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| lobes.flatten(&table, black_box(&tree), &wo, &ng));
}

#[divan::bench(args = CASES)]
fn evaluate(bencher: Bencher, case: &str) {
    let (_, _, mut lobes, _, _) = prepared(case);
    let (wi, mut out) = (directions(2), Evaluation::default());
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| lobes.evaluate(black_box(&wi), &mut out));
}

#[divan::bench(args = CASES)]
fn sample(bencher: Bencher, case: &str) {
    let (_, _, mut lobes, _, _) = prepared(case);
    let mut random = Random(3);
    let (mut xi, mut out) = (Column3::zeros(LANES), Samples::default());
    for lane in 0..LANES {
        xi.set(lane, Vec3::new(random.number(), random.number(), random.number()));
    }
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| lobes.sample(black_box(&xi), &mut out));
}

/// Figure 1 of the paper written by hand as one loop: sheen over Lambert, layering `min`, one frame and one roughness.
#[multiversion(targets("x86_64+avx2"))]
fn by_hand(
    sheen: Sheen<EXACT, true>,
    alpha_o: &[f32],
    wo: [&[f32]; 3],
    wi: [&[f32]; 3],
    out: &mut [f32],
    pdf: &mut [f32],
) {
    let n = out.len();
    let (alpha_o, pdf) = (&alpha_o[..n], &mut pdf[..n]);
    let (wo, wi) = ([&wo[0][..n], &wo[1][..n], &wo[2][..n]], [&wi[0][..n], &wi[1][..n], &wi[2][..n]]);
    for i in 0..n {
        let (o, l) = (Vec3::new(wo[0][i], wo[1][i], wo[2][i]), Vec3::new(wi[0][i], wi[1][i], wi[2][i]));
        let e = sheen.eval(o, l);
        let alpha_i = 1.0 - 0.8 * sheen.albedo(l.z);
        let diffuse = l.z.max(0.0) * std::f32::consts::FRAC_1_PI;
        out[i] = 0.8 * e.f_cos + diffuse * alpha_i.min(alpha_o[i]);
        pdf[i] = 0.3 * e.pdf + 0.7 * diffuse;
    }
}

#[divan::bench]
fn cloth_by_hand(bencher: Bencher) {
    let (wo, wi) = (directions(1), directions(2));
    let sheen = Sheen::<EXACT, true>::prepare(params([0.3, 0.1]));
    let alpha: Vec<f32> = wo.z.iter().map(|&c| 1.0 - 0.8 * sheen.albedo(c)).collect();
    let (mut out, mut pdf) = (vec![0.0; LANES], vec![0.0; LANES]);
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
        let columns = |w| -> [&[f32]; 3] {
            let w: &Column3 = black_box(w);
            [&w.x, &w.y, &w.z]
        };
        by_hand(sheen, &alpha, columns(&wo), columns(&wi), &mut out, &mut pdf);
    });
}
