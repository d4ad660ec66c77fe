//! Extremes: every closure with hostile parameters, frames and weights. Directions stay of unit length, and what comes out
//! is a number, or is dropped and reported.

use crate::layering::id;
use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::closure::print::tree_text;
use velour::closure::tree::{Floats, Ints, NodeId, Param, Tree};
use velour::closure::{Evaluation, Library, Lobes, Samples, Settings};
use velour::compile::compile;
use velour::exec::{Machine, Points};
use velour::lang::closures::{ClosureSpec, ParamKind, ParamSpec};
use velour::lang::symbols::Symbol;
use velour::math::columns::Column3;
use velour::measure::statistics::Random;

const LANES: usize = 256;

/// Numbers at and beyond the ends of what models take.
const NUMBERS: [f32; 24] = [
    0.0, -1.0, 1e-38, 1e-10, 1e-6, 1e-4, 1e-3, 0.01, 0.06, 0.3, 0.5, 0.7, 0.999, 1.0, 1.001, 1.5, 2.5, 10.0, 100.0,
    999.0, 1e4, 1e6, 1e30, 3e38,
];

/// Weights, most of them within reason.
const WEIGHTS: [f32; 10] = [1.0, 0.5, 0.1, -1.0, 1e-30, 1e10, 1e17, 1e25, 3e38, -3e38];

struct Maker {
    random: Random,
    table: Library,
    tree: Tree,
}

impl Maker {
    fn new(seed: u64) -> Self {
        let mut tree = Tree::default();
        tree.clear(LANES);
        Maker { random: Random(seed), table: Library::standard(), tree }
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.random.bits() % of.len() as u64) as usize]
    }

    /// A hostile number, or any of 0..1.
    fn number(&mut self) -> f32 {
        if self.random.number() < 0.4 { self.random.number() } else { self.pick(&NUMBERS) }
    }

    fn floats(&mut self, value: impl Fn(&mut Self) -> f32) -> Floats {
        if self.random.number() < 0.3 {
            return Floats::Uniform(value(self));
        }
        let column: Vec<f32> = (0..LANES).map(|_| value(self)).collect();
        self.tree.varying(&column)
    }

    /// A direction near an axis, far from all, of any length, or none.
    fn triples(&mut self) -> [Floats; 3] {
        let directions: Vec<Vec3> = (0..LANES)
            .map(|_| {
                let axis = self.pick(&[Vec3::Z, -Vec3::Z, Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, -0.8), Vec3::ZERO]);
                let off = self.pick(&[0.0, 1e-7, 1e-5, 1e-4, 1e-3, 0.03, 0.3, 1.0]);
                let mut random = || self.random.number() - 0.5;
                (axis + Vec3::new(random(), random(), random()) * off) * self.pick(&[1.0, 1.0, 1e-3, 1e6])
            })
            .collect();
        [0, 1, 2].map(|k| self.tree.varying(&directions.iter().map(|v| v[k]).collect::<Vec<f32>>()))
    }

    fn value(&mut self, param: &ParamSpec, nested: Option<NodeId>) -> Param {
        match param.kind {
            ParamKind::Float => Param::Float(self.floats(Self::number)),
            ParamKind::Color => Param::Triple([0; 3].map(|_| self.floats(Self::number))),
            ParamKind::Normal | ParamKind::Vector => Param::Triple(self.triples()),
            ParamKind::Int => Param::Int(Ints::Uniform(self.pick(&[0, 1, 2]))),
            ParamKind::String if param.choices.is_empty() => Param::String(Ints::Uniform(Symbol::new("x").0)),
            ParamKind::String => Param::String(Ints::Uniform(Symbol::new(self.pick(&param.choices)).0)),
            ParamKind::Closure => Param::Closure(nested),
        }
    }

    fn leaf(&mut self, spec: &ClosureSpec, nested: Option<NodeId>) -> NodeId {
        let params: Vec<Param> = spec.params.iter().map(|param| self.value(param, nested)).collect();
        let mut keywords = Vec::new();
        for (at, keyword) in spec.keywords.iter().enumerate() {
            if self.random.number() < 0.3 {
                keywords.push((at as u32, self.value(keyword, nested)));
            }
        }
        // Closures of one name differ in their parameters.
        let mut named = self.table.named(spec.name);
        let id = named.find(|(_, own)| own.params == spec.params).map(|(id, _)| id).expect("a closure of the table");
        self.tree.leaf(id, &params, &keywords)
    }

    /// The tree's lobes for viewers all around, grazing ones among them.
    fn lobes(&mut self, root: NodeId) -> Lobes {
        self.tree.root = Some(root);
        let mut wo = Column3::zeros(LANES);
        for lane in 0..LANES {
            let cos = self.pick(&[1.0, 0.9999, 0.5, 0.05, 1e-3, 1e-6, 0.0]) * (1.0 - 0.1 * self.random.number());
            wo.set(lane, narrow(direction(f64::from(cos), 6.0 * f64::from(self.random.number()))));
        }
        let mut lobes = Lobes::new(Settings::default());
        lobes.flatten(&self.table, &self.tree, &wo, &Column3::splat(Vec3::Z, LANES));
        lobes
    }

    fn numbers(&mut self) -> Column3 {
        let mut xi = Column3::zeros(LANES);
        for lane in 0..LANES {
            let mut one = || if self.random.number() < 0.1 { 0.0 } else { self.random.number().min(0.999_999_94) };
            xi.set(lane, Vec3::new(one(), one(), one()));
        }
        xi
    }
}

/// The largest difference from 1 of the length of a sampled direction, and how many were sampled.
fn lengths(maker: &mut Maker, lobes: &mut Lobes, out: &mut Samples) -> (f64, usize) {
    let (mut worst, mut count) = (0.0f64, 0);
    for _ in 0..4 {
        lobes.sample(&maker.numbers(), out);
        for lane in 0..LANES {
            let wi = out.wi.get(lane).as_dvec3();
            if wi != glam::DVec3::ZERO {
                worst = worst.max((wi.length() - 1.0).abs());
                count += 1;
            }
        }
    }
    (worst, count)
}

/// 430 of 1.76e9 directions of hair and of Schlick's boundary were not: rounding in a frame whose tangent was made from a
/// vector along the normal, and in Snell's law of a large index.
#[test]
fn sampled_directions_are_of_unit_length() {
    let table = Library::standard();
    let mut out = Samples::default();
    for (k, spec) in table.specs().iter().enumerate() {
        let mut all = 0;
        for round in 0..24 {
            let mut maker = Maker::new(SEED + 1000 * k as u64 + round);
            let base = maker.leaf(table.get(id(&table, "diffuse")), None);
            let leaf = maker.leaf(spec, Some(base));
            let mut lobes = maker.lobes(leaf);
            let (worst, count) = lengths(&mut maker, &mut lobes, &mut out);
            assert!(worst < 1e-5, "{} in round {round}: {worst:e}", spec.name);
            all += count;
        }
        assert!(all > 0 || !spec.scatters || lobeless(spec), "{} was never sampled", spec.name);
    }
}

fn lobeless(spec: &ClosureSpec) -> bool {
    ["emission", "background", "holdout", "uniform_edf"].contains(&spec.name)
}

fn all_finite(lobes: &mut Lobes, maker: &mut Maker, what: &str) {
    let (mut evaluation, mut samples) = (Evaluation::default(), Samples::default());
    let finite = |column: &[f32], name: &str| {
        let wrong = column.iter().position(|v| !v.is_finite());
        assert!(wrong.is_none(), "{what}: {name} is {} in lane {wrong:?}", column[wrong.unwrap_or(0)]);
    };
    let triple = |column: &Column3, name: &str| [&column.x, &column.y, &column.z].map(|c| finite(c, name));
    triple(lobes.emission(), "emission");
    finite(lobes.holdout(), "holdout");
    for _ in 0..3 {
        lobes.sample(&maker.numbers(), &mut samples);
        triple(&samples.wi, "a direction");
        triple(&samples.weight, "a weight");
        finite(&samples.pdf, "a density");
        let mut wi = samples.wi.clone();
        for lane in 0..LANES {
            let z = maker.pick(&[1.0, 0.3, 1e-3, 1e-6, 0.0, -1e-6, -0.5, -1.0]);
            let kept = maker.random.number() < 0.5 && wi.get(lane) != Vec3::ZERO;
            if !kept {
                wi.set(lane, narrow(direction(z, 6.0 * f64::from(maker.random.number()))));
            }
        }
        lobes.evaluate(&wi, &mut evaluation);
        triple(&evaluation.f_cos, "f cos");
        finite(&evaluation.pdf, "the density of a direction");
    }
}

#[test]
fn what_comes_of_large_weights_and_deep_nests_is_finite() {
    let table = Library::standard();
    let nests: Vec<&ClosureSpec> = table.specs().iter().filter(|s| s.nests()).collect();
    assert_eq!(nests.iter().map(|s| s.name).collect::<Vec<_>>(), ["sheen", "layer", "coat"]);
    for round in 0..200 {
        let mut maker = Maker::new(SEED + 77_000 + round);
        let mut root = None;
        for _ in 0..3 + maker.random.bits() % 20 {
            let spec = &table.specs()[(maker.random.bits() % table.specs().len() as u64) as usize];
            let mut leaf = match maker.random.number() {
                x if x < 0.4 => {
                    let nest = nests[(maker.random.bits() % nests.len() as u64) as usize];
                    maker.leaf(nest, root.take())
                }
                _ => maker.leaf(spec, root),
            };
            if maker.random.number() < 0.4 {
                let weight = [0; 3].map(|_| maker.floats(|m| m.pick(&WEIGHTS)));
                leaf = maker.tree.scale(Some(leaf), weight).unwrap_or(leaf);
            }
            root = maker.tree.add(root, Some(leaf));
        }
        let Some(root) = root else { continue };
        let mut lobes = maker.lobes(root);
        let what = format!("round {round}, lane 0: {}", tree_text(maker.table.table(), &maker.tree, 0));
        all_finite(&mut lobes, &mut maker, &what);
    }
}

/// What overflows is no lobe, and says so.
#[test]
fn weights_that_overflow_are_dropped_and_reported() {
    let coats =
        |base: &str, eta: &str| (0..12).fold(base.to_owned(), |b, _| format!("coat({b}, N, 0, {eta}, color(0), 0)"));
    let cases = [
        (
            "3e38 * ashikhmin_shirley(N, vector(1, 0, 0), 1000, 1000, color(1), color(1))".to_owned(),
            "ashikhmin_shirley",
        ),
        ("color(3e38) * holdout()".to_owned(), "holdout"),
        ("3e38 * emission() + 3e38 * emission()".to_owned(), "emission"),
        (format!("1e30 * ({})", coats("phong(N, 1e6)", "100")), "coat"),
        (coats("microfacet(\"ggx\", N, 0.01, 1.5, 0)", "100"), ""),
        (coats("diffuse(N)", "0.01"), ""),
    ];
    for (text, dropped) in cases {
        let shader = compile(&format!("surface s() {{ Ci = {text}; }}")).unwrap_or_else(|e| panic!("{e}"));
        let group = shader.group().build().expect("a group");
        let mut maker = Maker::new(SEED);
        let (mut points, mut machine) = (Points::new(LANES), Machine::new());
        let mut wo = Column3::zeros(LANES);
        for lane in 0..LANES {
            wo.set(lane, narrow(direction(1.0 - lane as f64 / LANES as f64, 0.3)));
            points.n.set(lane, Vec3::Z);
            points.ng.set(lane, Vec3::Z);
            points.i.set(lane, -wo.get(lane));
        }
        let mut lobes = Lobes::new(Settings::default());
        lobes.flatten(group.library(), machine.shade(&group, &points), &wo, &points.ng);
        all_finite(&mut lobes, &mut maker, &text);
        let names: Vec<&str> = lobes.dropped().iter().map(|d| d.closure).collect();
        let expected = if dropped.is_empty() { names.is_empty() } else { names.contains(&dropped) };
        assert!(expected, "{text}: dropped {} lanes, the first of {:?}", names.len(), names.first());
    }
}
