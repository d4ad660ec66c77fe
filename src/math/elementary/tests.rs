//! Sweeps of every elementary function over all binades against `f64`, and the special values.

use super::*;

/// Mantissas tried in each binade.
const PER_BINADE: u32 = 211;

/// The distance of `got` from `want` in units of the last place of an `f32` at `want`.
fn ulps(got: f32, want: f64) -> f64 {
    let rounded = want as f32;
    if got.is_nan() || rounded.is_nan() {
        return if got.is_nan() == rounded.is_nan() { 0.0 } else { f64::INFINITY };
    }
    if got == rounded {
        return if got.is_infinite() { 0.0 } else { (got as f64 - want).abs() / unit(want) };
    }
    if got.is_infinite() || rounded.is_infinite() {
        return f64::INFINITY;
    }
    (got as f64 - want).abs() / unit(want)
}

fn unit(want: f64) -> f64 {
    let exponent = if want == 0.0 { -126 } else { (want.abs().log2().floor() as i32).max(-126) };
    2f64.powi(exponent - 23)
}

/// Numbers of both signs from every binade, denormals included.
fn binades() -> impl Iterator<Item = f32> {
    (0..255u32).flat_map(|exponent| {
        (0..PER_BINADE).flat_map(move |i| {
            let mantissa = (i as u64 * 0x7f_ffff / (PER_BINADE as u64 - 1)) as u32;
            let x = f32::from_bits(exponent << 23 | mantissa);
            [x, -x]
        })
    })
}

/// Numbers spaced evenly between two bounds.
fn even(low: f32, high: f32, count: u32) -> impl Iterator<Item = f32> {
    (0..=count).map(move |i| (low as f64 + (high as f64 - low as f64) * i as f64 / count as f64) as f32)
}

#[track_caller]
fn sweep(name: &str, bound: f64, xs: impl Iterator<Item = f32>, f: impl Fn(f32) -> f32, wide: impl Fn(f64) -> f64) {
    let (worst, at) =
        xs.map(|x| (ulps(f(x), wide(x as f64)), x)).fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    println!("{name}: {worst:.3} ulp at {at:e}");
    assert!(worst <= bound, "{name}: {worst} ulp at {at:e}: {:e} but {:e}", f(at), wide(at as f64));
}

#[test]
fn exponentials_stay_within_their_bounds() {
    for (name, f, wide) in [
        ("exp", exp as fn(f32) -> f32, f64::exp as fn(f64) -> f64),
        ("exp2", exp2, f64::exp2),
        ("expm1", expm1, f64::exp_m1),
    ] {
        sweep(name, 1.2, binades(), f, wide);
        sweep(name, 1.2, even(-160.0, 130.0, 200_003), f, wide);
        sweep(name, 1.2, even(-1.0, 1.0, 100_003), f, wide);
    }
}

#[test]
fn logarithms_stay_within_one_ulp() {
    for (name, f, wide) in [
        ("ln", ln as fn(f32) -> f32, f64::ln as fn(f64) -> f64),
        ("log2", log2, f64::log2),
        ("log10", log10, f64::log10),
    ] {
        sweep(name, 1.0, binades(), f, wide);
        sweep(name, 1.0, even(0.4, 2.2, 200_003), f, wide);
    }
    sweep("logb", 0.0, binades().filter(|x| *x != 0.0), logb, |x| x.abs().log2().floor());
}

#[test]
fn circular_functions_stay_within_two_ulp_up_to_a_million() {
    for (name, f, wide) in [
        ("sin", sin as fn(f32) -> f32, f64::sin as fn(f64) -> f64),
        ("cos", cos, f64::cos),
        ("tan", tan, f64::tan),
        ("sincos.0", |x| sincos(x).0, f64::sin),
        ("sincos.1", |x| sincos(x).1, f64::cos),
    ] {
        sweep(name, 2.0, binades().filter(|x| x.abs() <= 1e6), f, wide);
        sweep(name, 2.0, even(-10.0, 10.0, 300_003), f, wide);
        sweep(name, 2.0, even(-1e6, 1e6, 300_007), f, wide);
        // The floats next to whole quarter turns have the smallest results and so the hardest reduction.
        let turns = (1..636_619u32).step_by(7).map(|n| (n as f64 * std::f64::consts::FRAC_PI_2) as f32);
        sweep(name, 2.0, turns, f, wide);
    }
}

#[test]
fn circular_functions_are_tame_beyond_a_million() {
    for x in binades().filter(|x| x.abs() > 1e6) {
        assert!(sin(x).abs() <= 1.0000001 && cos(x).abs() <= 1.0000001 && tan(x).is_finite(), "{x:e}");
        if x.abs() <= 1e9 {
            assert!((sin(x) as f64 - (x as f64).sin()).abs() < 2e-7, "{x:e}");
            assert!((cos(x) as f64 - (x as f64).cos()).abs() < 2e-7, "{x:e}");
        }
    }
}

#[test]
fn inverse_circular_functions_stay_within_one_ulp() {
    for (name, f, wide) in [
        ("asin", asin as fn(f32) -> f32, f64::asin as fn(f64) -> f64),
        ("acos", acos, f64::acos),
        ("atan", atan, f64::atan),
    ] {
        sweep(name, 1.0, binades(), f, wide);
        sweep(name, 1.0, even(-1.0, 1.0, 300_003), f, wide);
        sweep(name, 1.0, even(-5.0, 5.0, 100_003), f, wide);
    }
    for y in binades().step_by(997) {
        sweep("atan2", 1.0, binades().step_by(211), |x| atan2(y, x), |x| (y as f64).atan2(x));
    }
    for y in even(-3.0, 3.0, 97) {
        sweep("atan2", 1.0, even(-3.0, 3.0, 997), |x| atan2(y, x), |x| (y as f64).atan2(x));
    }
}

#[test]
fn hyperbolic_functions_stay_within_one_ulp() {
    for (name, f, wide) in [
        ("sinh", sinh as fn(f32) -> f32, f64::sinh as fn(f64) -> f64),
        ("cosh", cosh, f64::cosh),
        ("tanh", tanh, f64::tanh),
    ] {
        sweep(name, 1.0, binades(), f, wide);
        sweep(name, 1.0, even(-95.0, 95.0, 200_003), f, wide);
        sweep(name, 1.0, even(-1.0, 1.0, 100_003), f, wide);
    }
}

#[test]
fn roots_stay_within_two_ulp() {
    sweep("cbrt", 1.0, binades(), cbrt, f64::cbrt);
    sweep("rsqrt", 1.5, binades().filter(|x| *x != 0.0), rsqrt, |x| 1.0 / x.sqrt());
}

#[test]
fn pow_stays_within_one_ulp() {
    for y in even(-40.0, 40.0, 160).chain([0.1, -0.1, 1.0 / 3.0, 2.2, 1.0 / 2.4, 1e-6, 200.0, 1e4]) {
        sweep("pow", 1.0, binades().step_by(37), |x| pow(x, y), |x| x.powf(y as f64));
        sweep("pow", 1.0, even(0.0, 3.0, 3001), |x| pow(x, y), |x| x.powf(y as f64));
    }
}

#[test]
fn pow_positive_keeps_its_relative_error() {
    for y in even(-40.0, 40.0, 81).chain([0.1, 1.0 / 3.0, 2.2, 200.0]) {
        for x in even(1e-4, 3.0, 2003) {
            let want = (x as f64).powf(y as f64);
            if want > 1e-37 && want < 1e38 {
                let bound = 1e-7 + 6e-10 * (y as f64 * (x as f64).log2()).abs();
                let error = (pow_positive(x, y) as f64 / want - 1.0).abs();
                assert!(error <= bound, "{x:e}^{y}: {error:e}");
            }
        }
    }
    assert_eq!(pow_positive(0.0, 5.0), 0.0);
    assert_eq!(pow_positive(0.0, -5.0), f32::INFINITY);
}

#[test]
fn pow_has_the_special_cases_of_c() {
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        -0.5,
        2.0,
        -2.0,
        3.0,
        -3.0,
        1e30,
        -1e30,
        16_777_217.0,
        1e-45,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        0.3,
        -0.3,
        7.0,
        -7.0,
    ];
    for x in values {
        for y in values {
            let (got, want) = (pow(x, y), (x as f64).powf(y as f64) as f32);
            assert!(got.is_nan() == want.is_nan(), "{x}^{y}: {got} but {want}");
            if !want.is_nan() {
                assert!(ulps(got, want as f64) <= 1.0, "{x}^{y}: {got} but {want}");
                assert_eq!(got.is_sign_negative(), want.is_sign_negative(), "{x}^{y}: {got} but {want}");
            }
        }
    }
}

/// erf and erfc at points whose values an independent `f64` implementation gave.
#[test]
fn error_functions_stay_within_one_ulp() {
    for (x, want_erf, want_erfc) in ERROR_FUNCTION {
        assert!(ulps(erf(x), want_erf) <= 1.0, "erf({x}): {:e} but {want_erf:e}", erf(x));
        assert!(ulps(erfc(x), want_erfc) <= 1.0, "erfc({x}): {:e} but {want_erfc:e}", erfc(x));
    }
    // Both are monotone and complementary; a seam between the two formulas would show here.
    for x in even(-9.0, 9.0, 50_003) {
        assert!((erf(x) as f64 + erfc(x) as f64 - 1.0).abs() < 1.2e-7, "{x}");
    }
}

/// An argument, erf and erfc of it.
#[allow(clippy::excessive_precision)]
const ERROR_FUNCTION: [(f32, f64, f64); 43] = [
    (-12.0, -1.0, 2.0),
    (-6.0, -1.0, 2.0),
    (-3.9000001, -0.9999999652077781, 1.999999965207778),
    (-2.5, -0.999593047982555, 1.999593047982555),
    (-1.5, -0.9661051464753108, 1.9661051464753108),
    (-1.00000012, -0.8427008424343788, 1.842700842434379),
    (-1.0, -0.8427007929497149, 1.842700792949715),
    (-0.75, -0.7111556336535151, 1.7111556336535152),
    (-0.400000006, -0.4283923607779012, 1.4283923607779012),
    (-0.00100000005, -0.0011283788445643173, 1.0011283788445644),
    (-9.99999968e-21, -1.1283791312869893e-20, 1.0),
    (9.9999461e-41, 1.128373085257589e-40, 1.0),
    (9.99999997e-07, 1.1283791642462529e-06, 0.9999988716208358),
    (0.00999999978, 0.011283415303662439, 0.9887165846963376),
    (0.100000001, 0.11246291768297051, 0.8875370823170294),
    (0.25, 0.2763263901682369, 0.7236736098317631),
    (0.5, 0.5204998778130465, 0.4795001221869535),
    (0.800000012, 0.7421009718004437, 0.2578990281995563),
    (0.949999988, 0.8208908018180313, 0.17910919818196874),
    (1.0, 0.8427007929497149, 0.15729920705028513),
    (1.00000012, 0.8427008424343788, 0.15729915756562118),
    (1.10000002, 0.8802050775963802, 0.11979492240361975),
    (1.29999995, 0.9340079350125213, 0.06599206498747866),
    (1.70000005, 0.9837904615810698, 0.016209538418930244),
    (2.0, 0.9953222650189527, 0.004677734981047265),
    (2.29999995, 0.9988568231313698, 0.0011431768686301627),
    (2.9000001, 0.9999589021458579, 4.109785414212784e-05),
    (3.29999995, 0.9999969422892004, 3.0577107995706836e-06),
    (3.79999995, 0.9999999229960437, 7.700395627158505e-08),
    (4.4000001, 0.9999999995108294, 4.891706064174648e-10),
    (5.0, 0.9999999999984626, 1.5374597944280351e-12),
    (5.69999981, 0.9999999999999992, 7.566228319610286e-16),
    (6.5999999, 1.0, 1.0213264679905924e-20),
    (7.30000019, 1.0, 5.502558286344544e-25),
    (8.10000038, 1.0, 2.2162947728997843e-30),
    (9.0, 1.0, 4.13703174651381e-37),
    (9.18999958, 1.0, 1.2786762247193743e-38),
    (9.30000019, 1.0, 1.653238285352942e-39),
    (9.69999981, 1.0, 7.936137083336058e-43),
    (10.0, 1.0, 2.088487583762545e-45),
    (10.0500002, 1.0, 7.626143627405051e-46),
    (10.1999998, 1.0, 3.603844490181559e-47),
    (11.0, 1.0, 1.4408661379436945e-54),
];

/// The bits that matter of a result: NaN of any payload is one value.
fn bits(x: f32) -> u32 {
    if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() }
}

#[test]
fn special_values_are_those_of_the_c_library() {
    const I: f32 = f32::INFINITY;
    type Case = (&'static str, fn(f32) -> f32, [f32; 5]);
    let n = f32::NAN;
    // Results at 0, -0, inf, -inf and NaN.
    let cases: [Case; 22] = [
        ("exp", exp, [1.0, 1.0, I, 0.0, n]),
        ("exp2", exp2, [1.0, 1.0, I, 0.0, n]),
        ("expm1", expm1, [0.0, -0.0, I, -1.0, n]),
        ("ln", ln, [-I, -I, I, n, n]),
        ("log2", log2, [-I, -I, I, n, n]),
        ("log10", log10, [-I, -I, I, n, n]),
        ("logb", logb, [-I, -I, I, I, n]),
        ("sin", sin, [0.0, -0.0, n, n, n]),
        ("cos", cos, [1.0, 1.0, n, n, n]),
        ("tan", tan, [0.0, -0.0, n, n, n]),
        ("asin", asin, [0.0, -0.0, n, n, n]),
        ("acos", acos, [std::f32::consts::FRAC_PI_2, std::f32::consts::FRAC_PI_2, n, n, n]),
        ("atan", atan, [0.0, -0.0, std::f32::consts::FRAC_PI_2, -std::f32::consts::FRAC_PI_2, n]),
        ("sinh", sinh, [0.0, -0.0, I, -I, n]),
        ("cosh", cosh, [1.0, 1.0, I, I, n]),
        ("tanh", tanh, [0.0, -0.0, 1.0, -1.0, n]),
        ("cbrt", cbrt, [0.0, -0.0, I, -I, n]),
        ("erf", erf, [0.0, -0.0, 1.0, -1.0, n]),
        ("erfc", erfc, [1.0, 1.0, 0.0, 2.0, n]),
        ("rsqrt", rsqrt, [I, -I, 0.0, n, n]),
        ("floor", floor, [0.0, -0.0, I, -I, n]),
        ("round", round, [0.0, -0.0, I, -I, n]),
    ];
    for (name, f, want) in cases {
        for (x, want) in [0.0, -0.0, I, -I, n].into_iter().zip(want) {
            assert_eq!(bits(f(x)), bits(want), "{name}({x}) is {} and not {want}", f(x));
        }
    }
}

#[test]
fn atan2_has_the_special_cases_of_c() {
    let values = [0.0, -0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-45, 3e38];
    for y in values {
        for x in values {
            let want = (y as f64).atan2(x as f64) as f32;
            assert_eq!(bits(atan2(y, x)), bits(want), "atan2({y}, {x})");
        }
    }
}

#[test]
fn rounding_is_exact() {
    let halves = (-400..400).map(|i| i as f32 * 0.25);
    let near = [0.49999997, 0.5, 1.5, 2.5, 8_388_607.5, 8_388_608.0, 4_194_303.8, 1e-45, 1e30].into_iter();
    let all = binades().chain(halves).chain(near.flat_map(|x| [x, -x]));
    for x in all {
        assert_eq!(bits(floor(x)), bits(x.floor()), "floor({x})");
        assert_eq!(bits(ceil(x)), bits(x.ceil()), "ceil({x})");
        assert_eq!(bits(trunc(x)), bits(x.trunc()), "trunc({x})");
        assert_eq!(bits(round(x)), bits(x.round()), "round({x})");
        assert_eq!(floor_to_int(x), x.floor() as i32, "floor_to_int({x})");
        assert_eq!(trunc_to_int(x), x as i32, "trunc_to_int({x})");
        if x.abs() < 2.0f32.powi(38) {
            let (whole, rest) = floor_and_rest(x);
            assert_eq!(whole, x.floor() as i64 as u32, "floor_and_rest({x})");
            assert_eq!(rest, x - x.floor(), "floor_and_rest({x})");
        }
    }
}
