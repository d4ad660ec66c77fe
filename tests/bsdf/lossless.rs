//! Layering without loss: white furnaces over diffuse bases, no gain over any, reciprocity, colors, and layers in layers.

use crate::{SEED, direction, narrow};
use glam::Vec3;
use velour::closure::settings::{Settings, SheenAlbedo};
use velour::closure::{Evaluation, Layering, Lobes};
use velour::compile::compile;
use velour::exec::{Machine, Points};
use velour::math::columns::Column3;
use velour::measure::furnace::{hemisphere, integrate, sample_mean};
use velour::measure::statistics::Random;

const COSINES: [f64; 6] = [0.02, 0.1, 0.3, 0.6, 0.9, 1.0];

/// The lobes of a closure expression, under a rule.
fn lobes(expression: &str, wo: Vec3, layering: Layering) -> Lobes {
    let shader = compile(&format!("surface s() {{ Ci = {expression}; }}")).expect("a right shader");
    let group = shader.group().build().expect("a group");
    let points = Points::single(wo);
    let mut machine = Machine::new();
    let mut lobes = Lobes::new(Settings { layering, sheen_albedo: SheenAlbedo::Long, ..Settings::default() });
    lobes.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
    assert!(lobes.dropped().is_empty(), "{:?}", lobes.dropped());
    lobes
}

/// The light of a white sky that a closure sends to a viewer, by color: both hemispheres.
fn white(expression: &str, cos: f64, layering: Layering) -> Vec3 {
    let mut lobes = lobes(expression, narrow(direction(cos, 0.3)), layering);
    let above = hemisphere(24, 64, cos);
    let below: Vec<(Vec3, f64)> = above.iter().map(|&(w, weight)| (-w, weight)).collect();
    let [above, below] = [above, below].map(|side| integrate(&mut lobes, 1, &side)[0]);
    Vec3::from_array(std::array::from_fn(|c| (above[c] + below[c]) as f32))
}

const DIFFUSE: [&str; 6] = [
    "diffuse(N)",
    "translucent(N)",
    "oren_nayar_diffuse_bsdf(N, color(1), .6, \"energy_compensation\", 1)",
    "oren_nayar_diffuse_bsdf(N, color(1), 1, \"energy_compensation\", 1)",
    "(.5 * diffuse(N) + .5 * oren_nayar_diffuse_bsdf(N, color(1), .3, \"energy_compensation\", 1))",
    "(.3 * diffuse(N) + .7 * translucent(N))",
];

#[test]
fn white_cloth_over_a_diffuse_base_is_white() {
    for base in DIFFUSE {
        for r in [0.1, 0.25, 0.5, 1.0] {
            for cos in COSINES {
                let total = white(&format!("sheen({base}, N, color(1), {r:?})"), cos, Layering::Lossless);
                assert!((total.x - 1.0).abs() <= 1.5e-3, "{base}, r = {r}, cos {cos}: {total}");
            }
        }
    }
    // The rule that is safe over every base loses up to 13 %.
    let least = COSINES.map(|cos| white("sheen(diffuse(N), N, color(1), .25)", cos, Layering::Min).x);
    assert!(least.iter().any(|e| *e < 0.95), "{least:?}");
}

/// A base that gains by itself keeps what it has.
#[test]
fn a_base_keeps_its_own_albedo() {
    let burley = |r: f32| format!("burley_diffuse_bsdf(N, color(1), {r:?})");
    let bases = [burley(0.0), burley(0.3), burley(0.5), burley(1.0), "oren_nayar(N, .5)".to_owned()];
    for (base, cos) in bases.iter().flat_map(|base| COSINES.map(|cos| (base, cos))) {
        let (bare, sheen) = (
            white(base.as_str(), cos, Layering::Lossless).x,
            white("sheen(0 * diffuse(N), N, color(1), .4)", cos, Layering::Lossless).x,
        );
        let total = white(&format!("sheen({base}, N, color(1), .4)"), cos, Layering::Lossless).x;
        let expected = sheen + (1.0 - sheen) * bare;
        assert!((total - expected).abs() <= 1.5e-3 * bare.max(1.0), "{base}, cos {cos}: {total} for {expected}");
    }
}

/// A tint covers by color: what the sheen does not reflect in blue, the base still does.
#[test]
fn each_color_is_covered_by_its_own_tint() {
    for cos in COSINES {
        let total = white("sheen(diffuse(N), N, color(1, .2, 0), .4)", cos, Layering::Lossless);
        assert!((total - Vec3::ONE).abs().max_element() <= 1.5e-3, "cos {cos}: {total}");
    }
    let min = white("sheen(diffuse(N), N, color(1, .2, 0), .4)", 0.3, Layering::Min);
    assert!(min.z < 0.9, "the safe rule takes from blue what red loses: {min}");
}

#[test]
fn layers_in_layers_lose_nothing_over_a_diffuse_base_and_never_gain() {
    for inner in [0.15, 0.5] {
        for outer in [0.3, 1.0] {
            for cos in COSINES {
                // A sheen under a sheen is no diffuse lobe and loses a little; the base below both loses nothing.
                let nested = format!("sheen(sheen(diffuse(N), N, color(1), {inner:?}), N, color(1), {outer:?})");
                let total = white(&nested, cos, Layering::Lossless).x;
                assert!((0.93..=1.0 + 1.5e-3).contains(&total), "{inner} in {outer} at {cos}: {total}");
                let without = format!("sheen(sheen(0 * diffuse(N), N, color(1), {inner:?}), N, color(1), {outer:?})");
                let tops = white(&without, cos, Layering::Lossless).x;
                let pass = |r: f64| {
                    1.0 - white(&format!("sheen(0 * diffuse(N), N, color(1), {r:?})"), cos, Layering::Lossless).x
                };
                let expected = pass(inner) * pass(outer);
                assert!(
                    (total - tops - expected).abs() < 1.5e-3,
                    "{inner} in {outer} at {cos}: {} {expected}",
                    total - tops
                );
            }
        }
    }
}

/// Whatever the base, nothing gains; sums of lobes neither.
#[test]
fn nothing_gains_over_any_base() {
    for base in [
        "conductor_bsdf(N, vector(1,0,0), .3, .3, color(0), color(1e6), \"ggx\")",
        "conductor_bsdf(N, vector(1,0,0), .05, .05, color(0), color(1e6), \"ggx\")",
        "dielectric_bsdf(N, vector(1,0,0), color(1), color(1), .3, .3, 1.5, \"ggx\")",
        "conductor_bsdf(N, vector(1,0,0), .6, .1, color(0), color(1e6), \"ggx\")",
        "conductor_bsdf(normalize(N + vector(.5,0,0)), vector(1,0,0), .3, .3, color(0), color(1e6), \"ggx\")",
        "diffuse(normalize(N + vector(-.5,0,0)))",
        "diffuse(normalize(N + vector(.9,0,0)))",
        "sheen_bsdf(N, color(1), .5)",
        "(.5 * diffuse(N) + .5 * reflection(N, 0))",
        "layer(.5 * diffuse(N), diffuse(N))",
        "reflection(N, 0)",
        "transparent()",
    ] {
        for r in [0.1, 0.4, 1.0] {
            for cos in COSINES {
                let expression = format!("sheen({base}, N, color(1), {r:?})");
                let mut lobes = lobes(&expression, narrow(direction(cos, 0.3)), Layering::Lossless);
                let mut random = Random(SEED);
                let total = sample_mean(&mut lobes, 1, 20_000, || random.number())[0][0];
                assert!(total <= 1.0 + 2e-3, "{expression} at {cos}: {total}");
            }
        }
    }
}

#[test]
fn the_rule_is_reciprocal() {
    for base in
        ["diffuse(N)", "translucent(N)", "conductor_bsdf(N, vector(1,0,0), .3, .3, color(0), color(1e6), \"ggx\")"]
    {
        for (a, b) in [(0.1, 0.9), (0.4, 0.6), (0.03, 0.5)] {
            // Softening is the light's alone, so the sheen itself is left unsoftened.
            let text = format!(
                "sheen(sheen({base}, N, color(.9, .5, .1), .2, \"softening\", 0), N, color(.5), .6, \"softening\", 0)"
            );
            let below = if base.starts_with('t') { -1.0 } else { 1.0 };
            let (a, b) = (narrow(direction(a, 0.3)), narrow(direction(b, 1.7)) * Vec3::new(1.0, 1.0, below));
            let f = |wo: Vec3, wi: Vec3| {
                let flip = wo.z.signum();
                let mut out = Evaluation::default();
                let mut lobes = lobes(&text, wo * Vec3::new(1.0, 1.0, flip), Layering::Lossless);
                lobes.evaluate(&Column3::splat(wi * Vec3::new(1.0, 1.0, flip), 1), &mut out);
                out.f_cos.get(0) / wi.z.abs()
            };
            let (there, back) = (f(a, b), f(b, a));
            assert!(
                (there - back).abs().max_element() <= 1e-5 * there.max_element().max(0.1),
                "{base}: {there} {back}"
            );
        }
    }
}
/// What a base sends of a white sky under a white sheen, less what it should.
fn over_facets(base: &str, r: f64, cos: f64) -> f64 {
    let e = |text: &str| {
        let mut lobes = lobes(text, narrow(direction(cos, 0.3)), Layering::Lossless);
        let mut random = Random(SEED);
        sample_mean(&mut lobes, 1, 60_000, || random.number())[0][0]
    };
    let sheen = |base: &str| e(&format!("sheen({base}, N, color(1), {r:?})"));
    let top = sheen("0 * diffuse(N)");
    sheen(base) - top - (1.0 - top) * e(base)
}

/// The smaller T alone loses up to 8.6 % here.
#[test]
fn cloth_over_rough_metal_loses_at_most_a_per_cent() {
    for (facets, alphas) in [("ggx", &[0.1, 0.3][..]), ("beckmann", &[0.1, 0.3])] {
        for alpha in alphas {
            let base =
                format!("conductor_bsdf(N, vector(1,0,0), {alpha:?}, {alpha:?}, color(0), color(1e6), \"{facets}\")");
            for r in [0.1, 0.5] {
                let lost = COSINES.map(|cos| over_facets(&base, r, cos));
                assert!(lost.iter().all(|x| (-1e-2..=2e-3).contains(x)), "{facets} {alpha}, r = {r}: {lost:.4?}");
            }
        }
    }
}
