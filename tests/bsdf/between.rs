//! Rough boundaries lose nothing, and choose at the facet: white furnaces, noise and reciprocity by sums over samples.

use crate::layering::{float, id, triple};
use crate::{direction, narrow};
use glam::Vec3;
use velour::closure::settings::Settings;
use velour::closure::tree::{Floats, Ints, NodeId, Param, Tree};
use velour::closure::{Evaluation, Library, Lobes, Samples};
use velour::lang::symbols::Symbol;
use velour::math::columns::Column3;

const LANES: usize = 512;

fn word(text: &str) -> Param {
    Param::String(Ints::Uniform(Symbol::new(text).0))
}

/// A boundary of a closure: its name, its widths, its index or reflectance, and words for its keywords.
#[derive(Clone, Copy)]
struct Case<'a> {
    closure: &'static str,
    widths: [f32; 2],
    eta: f32,
    distribution: &'a str,
    keywords: &'a [(&'a str, &'a str)],
}

impl Case<'_> {
    fn leaf(&self, tree: &mut Tree) -> NodeId {
        let library = Library::standard();
        let closure = id(&library, self.closure);
        let [x, y] = self.widths.map(float);
        let (white, normal, u) = (triple(1.0, 1.0, 1.0), triple(0.0, 0.0, 1.0), triple(1.0, 0.0, 0.0));
        let d = word(self.distribution);
        let params: Vec<Param> = match self.closure {
            "dielectric_bsdf" => vec![normal, u, white, white, x, y, float(self.eta), d],
            "conductor_bsdf" => vec![normal, u, x, y, triple(0.0, 0.0, 0.0), triple(1e6, 1e6, 1e6), d],
            // f0 = f90 = 1: a mirror. A positive index makes it a glaze that transmits.
            "generalized_schlick_bsdf" if self.eta == 0.0 => {
                vec![normal, u, white, triple(0.0, 0.0, 0.0), x, y, white, white, float(5.0), d]
            }
            "generalized_schlick_bsdf" => {
                let f0 = ((self.eta - 1.0) / (self.eta + 1.0)).powi(2);
                vec![normal, u, white, white, x, y, triple(f0, f0, f0), white, float(5.0), d]
            }
            _ => vec![d, normal, u, x, y, float(self.eta), Param::Int(Ints::Uniform(2))],
        };
        let spec = library.get(closure);
        let keywords: Vec<(u32, Param)> = self
            .keywords
            .iter()
            .map(|(name, value)| (spec.keywords.iter().position(|k| k.name == *name).unwrap() as u32, word(value)))
            .collect();
        tree.leaf(closure, &params, &keywords)
    }

    /// The lobes of a batch that sees it from one side.
    fn lobes(&self, wo: Vec3, inside: bool) -> Lobes {
        let mut tree = Tree::default();
        tree.clear(LANES);
        tree.root = Some(self.leaf(&mut tree));
        let mut lobes = Lobes::new(Settings::default());
        let (wo, ng) = (Column3::splat(wo, LANES), Column3::splat(Vec3::Z, LANES));
        lobes.flatten_sides(&Library::standard(), &tree, &wo, &ng, &[i32::from(inside); LANES]);
        lobes
    }

    /// Mean, relative variance and maximum of the weights of samples.
    fn weights(&self, wo: Vec3, inside: bool, batches: usize) -> [f64; 3] {
        let (mut lobes, mut samples) = (self.lobes(wo, inside), Samples::default());
        let (mut sum, mut squares, mut most) = (0.0, 0.0, 0.0f64);
        for batch in 0..batches {
            let mut xi = Column3::zeros(LANES);
            for lane in 0..LANES {
                // Roberts's sequence in three dimensions fills the cube evenly.
                let k = (batch * LANES + lane) as f64;
                let at = |step: f64| ((0.5 + k * step).fract() as f32).min(0.999_999_94);
                xi.set(
                    lane,
                    Vec3::new(at(0.819_172_513_396_164_4), at(0.671_043_606_703_789_2), at(0.549_700_477_901_97)),
                );
            }
            lobes.sample(&xi, &mut samples);
            for lane in 0..LANES {
                let weight = f64::from(samples.weight.x[lane]);
                (sum, squares, most) = (sum + weight, squares + weight * weight, most.max(weight));
            }
        }
        let count = (batches * LANES) as f64;
        let mean = sum / count;
        [mean, squares / count / (mean * mean) - 1.0, most]
    }
}

const COSINES: [f64; 5] = [0.05, 0.2, 0.5, 0.8, 1.0];

fn view(cos: f64) -> Vec3 {
    narrow(direction(cos, 0.4))
}

#[test]
fn a_rough_mirror_loses_nothing() {
    for closure in ["conductor_bsdf", "generalized_schlick_bsdf"] {
        for distribution in ["ggx", "beckmann"] {
            for alpha in [0.05, 0.1, 0.25, 0.5, 0.8, 1.0] {
                for cos in COSINES {
                    let case = Case { closure, widths: [alpha; 2], eta: 0.0, distribution, keywords: &[] };
                    // Narrow facets lose light toward the horizon alone, where cosines seldom lead.
                    let [mean, ..] = case.weights(view(cos), false, if alpha < 0.2 { 2048 } else { 512 });
                    assert!((mean - 1.0).abs() <= 2e-3, "{closure} {distribution} {alpha} at {cos}: {mean}");
                    let single = Case { keywords: &[("scattering", "single")], ..case };
                    let [once, ..] = single.weights(view(cos), false, 16);
                    assert!(alpha < 0.5 || once < 0.98, "single scattering loses light: {alpha} {cos}: {once}");
                }
            }
        }
    }
}

#[test]
fn rough_glass_loses_nothing_from_either_side() {
    for eta in [0.67, 1.33, 1.5, 2.4] {
        for alpha in [0.05, 0.1, 0.3, 0.6, 1.0] {
            for cos in COSINES {
                for inside in [false, true] {
                    let case = Case {
                        closure: "dielectric_bsdf",
                        widths: [alpha; 2],
                        eta,
                        distribution: "ggx",
                        keywords: &[],
                    };
                    // Where narrow facets send light along the horizon it takes many samples to know how much.
                    let [mean, _, most] = case.weights(view(cos), inside, if alpha < 0.2 { 1024 } else { 512 });
                    let what = format!("{eta} {alpha} at {cos}, inside {inside}: {mean}, at most {most}");
                    // The table bends sharply around the critical angle.
                    assert!((mean - 1.0).abs() <= 2e-3, "{what}");
                }
            }
        }
    }
}

/// Schlick's term is known as a dielectric's is, and stretched facets never gain.
#[test]
fn schlicks_glass_loses_nothing_and_stretched_glass_never_gains() {
    for alpha in [0.1, 0.4, 1.0] {
        for cos in COSINES {
            let case = Case {
                closure: "generalized_schlick_bsdf",
                widths: [alpha; 2],
                eta: 1.5,
                distribution: "ggx",
                keywords: &[],
            };
            for inside in [false, true] {
                let [mean, ..] = case.weights(view(cos), inside, 512);
                assert!((mean - 1.0).abs() <= 2e-3, "schlick {alpha} at {cos}, inside {inside}: {mean}");
            }
            for ratio in [1.05, 1.2, 1.5, 2.0, 4.0, 10.0] {
                for (closure, eta) in [("conductor_bsdf", 0.0), ("dielectric_bsdf", 1.5)] {
                    for widths in [[alpha, alpha / ratio], [alpha / ratio, alpha]] {
                        let case = Case { closure, widths, eta, distribution: "ggx", keywords: &[] };
                        let [mean, ..] = case.weights(view(cos), false, 32);
                        let single = Case { keywords: &[("scattering", "single")], ..case };
                        let [once, ..] = single.weights(view(cos), false, 32);
                        let what =
                            format!("{closure} {widths:?} at {cos}: {mean} where single scattering leaves {once}");
                        let least = if ratio < 1.1 { 0.985 } else { once - 1e-3 };
                        assert!(mean <= 1.0 + 1e-2 && mean >= least, "{what}");
                    }
                }
            }
        }
    }
}

/// The figures of a peer that chooses at the facet, for one of a width of .3 and an index of 1.5: .055, .19 and .11.
#[test]
fn choosing_at_the_facet_is_nearly_free_of_noise() {
    let glass =
        |keywords| Case { closure: "dielectric_bsdf", widths: [0.3; 2], eta: 1.5, distribution: "ggx", keywords };
    for (cos, inside, bar) in [(0.05, false, 0.07), (0.3, true, 0.25), (0.7, true, 0.15)] {
        for keywords in [&[("scattering", "single")][..], &[]] {
            let [_, variance, most] = glass(keywords).weights(view(cos), inside, 128);
            assert!(variance <= bar, "{cos}, inside {inside}: {variance}");
            let [left, ..] = glass(&[("scattering", "single")]).weights(view(cos), inside, 128);
            let bound = if keywords.is_empty() { 1.1 / left } else { 1.1 };
            assert!(most <= bound, "{cos}, inside {inside}: at most {most}");
        }
    }
}

#[test]
fn light_between_facets_is_reciprocal() {
    let case = |alpha| Case {
        closure: "conductor_bsdf",
        widths: [alpha, 0.6 * alpha],
        eta: 0.0,
        distribution: "ggx",
        keywords: &[],
    };
    for alpha in [0.2, 0.5, 1.0] {
        for (a, b) in [(0.1, 0.9), (0.3, 0.5), (0.05, 0.7)] {
            let (a, b) = (view(a), narrow(direction(b, 2.1)));
            let f = |wo: Vec3, wi: Vec3| {
                let mut out = Evaluation::default();
                case(alpha).lobes(wo, false).evaluate(&Column3::splat(wi, LANES), &mut out);
                out.f_cos.x[0] / wi.z
            };
            let (there, back) = (f(a, b), f(b, a));
            assert!((there - back).abs() <= 1e-5 * there.max(1.0), "{alpha}: {there} {back}");
        }
    }
}

/// Each density is what sampling does: together they integrate to the part of samples that are not lost.
#[test]
fn both_halves_together_have_a_density_of_one() {
    for alpha in [0.2, 0.6] {
        let case =
            Case { closure: "dielectric_bsdf", widths: [alpha; 2], eta: 1.5, distribution: "ggx", keywords: &[] };
        for inside in [false, true] {
            let wo = view(0.6);
            let mut lobes = case.lobes(wo, inside);
            let (mut out, mut sum) = (Evaluation::default(), 0.0);
            let side = 256;
            for row in 0..side * side / LANES {
                let mut wi = Column3::zeros(LANES);
                for lane in 0..LANES {
                    let k = row * LANES + lane;
                    let (u, v) = ((k % side) as f64 + 0.5, (k / side) as f64 + 0.5);
                    wi.set(
                        lane,
                        narrow(direction(1.0 - 2.0 * v / side as f64, u / side as f64 * std::f64::consts::TAU)),
                    );
                }
                lobes.evaluate(&wi, &mut out);
                sum += out.pdf.iter().map(|pdf| f64::from(*pdf)).sum::<f64>();
            }
            let integral = sum * 4.0 * std::f64::consts::PI / (side * side) as f64;
            let mut samples = Samples::default();
            let mut kept = 0;
            for batch in 0..32 {
                let xi = (0..LANES).map(|lane| (batch * LANES + lane) as f64);
                let mut column = Column3::zeros(LANES);
                for (lane, k) in xi.enumerate() {
                    let at = |step: f64| (0.5 + k * step).fract() as f32;
                    column.set(lane, Vec3::new(at(0.8191725133961644), at(0.6710436067037892), at(0.54970047790197)));
                }
                lobes.sample(&column, &mut samples);
                kept += samples.wi.x.iter().zip(&samples.wi.z).filter(|(x, z)| **x != 0.0 || **z != 0.0).count();
            }
            let kept = kept as f64 / (32 * LANES) as f64;
            assert!((integral - kept).abs() < 0.01, "{alpha}, inside {inside}: {integral} against {kept}");
        }
    }
}

/// Lanes of different widths and indices side by side give what each gives alone.
#[test]
fn lanes_do_not_mix() {
    let library = Library::standard();
    let closure = id(&library, "dielectric_bsdf");
    let mut tree = Tree::default();
    tree.clear(2);
    let (alpha, eta) = (tree.varying(&[0.2, 0.7]), tree.varying(&[1.5, 1.2]));
    let white = triple(1.0, 1.0, 1.0);
    let float = |f: Floats| Param::Float(f);
    let params = [
        triple(0.0, 0.0, 1.0),
        triple(1.0, 0.0, 0.0),
        white,
        white,
        float(alpha),
        float(alpha),
        float(eta),
        word("ggx"),
    ];
    tree.root = Some(tree.leaf(closure, &params, &[]));
    let mut lobes = Lobes::new(Settings::default());
    let wo = view(0.5);
    lobes.flatten_sides(&library, &tree, &Column3::splat(wo, 2), &Column3::splat(Vec3::Z, 2), &[1, 0]);
    let mut out = Evaluation::default();
    for wi in [view(0.7), -view(0.9)] {
        lobes.evaluate(&Column3::splat(wi, 2), &mut out);
        for (lane, (alpha, eta, inside)) in [(0.2, 1.5, true), (0.7, 1.2, false)].into_iter().enumerate() {
            let case = Case { closure: "dielectric_bsdf", widths: [alpha; 2], eta, distribution: "ggx", keywords: &[] };
            let mut alone = Evaluation::default();
            case.lobes(wo, inside).evaluate(&Column3::splat(wi, LANES), &mut alone);
            let (a, b) = ([out.f_cos.x[lane], out.pdf[lane]], [alone.f_cos.x[0], alone.pdf[0]]);
            assert!((0..2).all(|k| (a[k] - b[k]).abs() <= 1e-5 * b[k].abs().max(1e-3)), "{lane}: {a:?} {b:?}");
        }
    }
}
