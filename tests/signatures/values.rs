//! What functions are, in `f64`.

/// The result of a function of arguments, each of one number or three, or nothing where it is no mathematics.
pub fn expected(name: &str, args: &[&[f64]], components: usize) -> Option<Vec<f64>> {
    if let Some(whole) = of_vectors(name, args) {
        return Some(whole);
    }
    let at = |k: usize, c: usize| args.get(k).map_or(0.0, |arg| if arg.len() == 1 { arg[0] } else { arg[c] });
    (0..components).map(|c| by_component(name, args.len(), [at(0, c), at(1, c), at(2, c), at(3, c)])).collect()
}

fn by_component(name: &str, count: usize, [x, y, z, w]: [f64; 4]) -> Option<f64> {
    let unit = |low: f64, high: f64, x: f64| ((x - low) / (high - low)).clamp(0.0, 1.0);
    let truth = |b: bool| f64::from(u8::from(b));
    Some(match (name, count) {
        ("degrees", 1) => x.to_degrees(),
        ("radians", 1) => x.to_radians(),
        ("sin", 1) => x.sin(),
        ("cos", 1) => x.cos(),
        ("tan", 1) => x.tan(),
        ("asin", 1) => x.asin(),
        ("acos", 1) => x.acos(),
        ("atan", 1) => x.atan(),
        ("atan2" | "atan", 2) => x.atan2(y),
        ("sinh", 1) => x.sinh(),
        ("cosh", 1) => x.cosh(),
        ("tanh", 1) => x.tanh(),
        ("pow", 2) => x.powf(y),
        ("exp", 1) => x.exp(),
        ("exp2", 1) => x.exp2(),
        ("expm1", 1) => x.exp_m1(),
        ("log", 1) => x.ln(),
        ("log", 2) => x.ln() / y.ln(),
        ("log2", 1) => x.log2(),
        ("log10", 1) => x.log10(),
        ("logb", 1) => x.abs().log2().floor(),
        ("sqrt", 1) => x.sqrt(),
        ("inversesqrt", 1) => 1.0 / x.sqrt(),
        ("cbrt", 1) => x.cbrt(),
        ("hypot", 2) => x.hypot(y),
        ("hypot", 3) => (x * x + y * y + z * z).sqrt(),
        ("abs" | "fabs", 1) => x.abs(),
        ("sign", 1) => truth(x > 0.0) - truth(x < 0.0),
        ("floor", 1) => x.floor(),
        ("ceil", 1) => x.ceil(),
        ("round", 1) => x.round(),
        ("trunc", 1) => x.trunc(),
        ("fmod" | "mod", 2) if y == 0.0 => 0.0,
        ("fmod", 2) => x % y,
        ("mod", 2) => x - y * (x / y).floor(),
        ("min", 2) => x.min(y),
        ("max", 2) => x.max(y),
        ("clamp", 3) => x.min(z).max(y),
        ("mix", 3) => x * (1.0 - z) + y * z,
        ("step", 2) => truth(y >= x),
        // A ramp may fall.
        ("linearstep", 3) if x != y => unit(x, y, z),
        ("smoothstep", 3) => {
            let t = if y > x { unit(x, y, z) } else { truth(z >= x) };
            t * t * (3.0 - 2.0 * t)
        }
        ("smooth_linearstep", 4) if 2.0 * w < y - x => smooth_linearstep(x, y, z, w),
        ("erf", 1) => erf(x),
        ("erfc", 1) => 1.0 - erf(x),
        ("isnan" | "isinf", 1) => 0.0,
        ("isfinite", 1) => 1.0,
        ("select", 3) => {
            if z != 0.0 {
                y
            } else {
                x
            }
        }
        _ => return None,
    })
}

/// A ramp whose ends are rounded by parabolas of half width `w`.
fn smooth_linearstep(low: f64, high: f64, x: f64, w: f64) -> f64 {
    // The ramp is the integral of a box; rounding it is averaging over 2 w.
    let ramp = |x: f64| ((x - low) / (high - low)).clamp(0.0, 1.0);
    let steps = 20_000;
    (0..steps).map(|i| ramp(x + w * ((2.0 * i as f64 + 1.0) / steps as f64 - 1.0))).sum::<f64>() / steps as f64
}

/// By its series (Abramowitz and Stegun 7.1.6).
fn erf(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..60 {
        term *= 2.0 * x * x / (2.0 * n as f64 + 1.0);
        sum += term;
    }
    2.0 / std::f64::consts::PI.sqrt() * (-x * x).exp() * sum
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Functions of whole vectors.
fn of_vectors(name: &str, args: &[&[f64]]) -> Option<Vec<f64>> {
    let along =
        |a: &[f64], b: &[f64], f: f64, g: f64| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| f * a + g * b).collect() };
    Some(match (name, args) {
        ("dot", [a, b]) => vec![dot(a, b)],
        ("cross", [a, b]) => {
            vec![a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        }
        ("length", [a]) => vec![dot(a, a).sqrt()],
        ("normalize", [a]) => a.iter().map(|x| x / dot(a, a).sqrt()).collect(),
        ("distance", [a, b]) => {
            let d = minus(a, b);
            vec![dot(&d, &d).sqrt()]
        }
        ("distance", [a, b, q]) => {
            let (ab, aq) = (minus(b, a), minus(q, a));
            let t = (dot(&ab, &aq) / dot(&ab, &ab)).clamp(0.0, 1.0);
            let d: Vec<f64> = aq.iter().zip(&ab).map(|(q, b)| q - t * b).collect();
            vec![dot(&d, &d).sqrt()]
        }
        ("reflect", [i, n]) => along(i, n, 1.0, -2.0 * dot(i, n)),
        ("faceforward", [n, i, reference]) => n.iter().map(|x| if dot(i, reference) > 0.0 { -x } else { *x }).collect(),
        ("refract", [i, n, eta]) if eta.len() == 1 => {
            let (cos, eta) = (dot(i, n), eta[0]);
            let k = 1.0 - eta * eta * (1.0 - cos * cos);
            if k < 0.0 { vec![0.0; 3] } else { along(i, n, eta, -(eta * cos + k.sqrt())) }
        }
        ("luminance", [c]) => vec![dot(c, &[0.212_507_28, 0.715_35, 0.072_142_72])],
        ("rotate", [p, angle, a, b]) => rotated(p, angle[0], a, &minus(b, a)),
        ("rotate", [p, angle, axis]) => rotated(p, angle[0], &[0.0; 3], axis),
        _ => return None,
    })
}

/// Rodrigues's formula.
fn rotated(p: &[f64], angle: f64, from: &[f64], axis: &[f64]) -> Vec<f64> {
    let length = dot(axis, axis).sqrt();
    let k: Vec<f64> = axis.iter().map(|x| x / length).collect();
    let v = minus(p, from);
    let cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
    let (sin, cos) = angle.sin_cos();
    (0..3).map(|c| from[c] + v[c] * cos + cross[c] * sin + k[c] * dot(&k, &v) * (1.0 - cos)).collect()
}
