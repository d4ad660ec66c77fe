//! Derivatives of every builtin that has one, against differences of the values.

use velour::compile::Compiler;
use velour::exec::{Group, Machine, Points, Values};
use velour::lang::builtins;

/// How far the points on both sides lie from the middle one.
const STEP: f32 = 2e-3;

/// The point at `t` along a line on the surface, with the derivatives of moving along it as those along x, and with half the
/// speed as those along y.
fn line(ts: &[f32]) -> Points {
    let mut points = Points::new(ts.len());
    let (du, dv, dp, di) = (0.7, -0.4, glam::Vec3::new(0.9, 0.3, -0.6), glam::Vec3::new(0.2, -0.3, 0.1));
    for (lane, &t) in ts.iter().enumerate() {
        points.u[lane] = 0.41 + t * du;
        points.v[lane] = 0.57 + t * dv;
        points.p.set(lane, glam::Vec3::new(0.37, 1.62, -0.83) + t * dp);
        points.i.set(lane, glam::Vec3::new(0.1, 0.2, -0.97) + t * di);
        points.n.set(lane, glam::Vec3::Z);
        (points.dudx[lane], points.dvdx[lane]) = (du, dv);
        (points.dudy[lane], points.dvdy[lane]) = (0.5 * du, 0.5 * dv);
        points.dpdx.set(lane, dp);
        points.dpdy.set(lane, 0.5 * dp);
        points.didx.set(lane, di);
        points.didy.set(lane, 0.5 * di);
    }
    points
}

/// The floats of an output in one lane.
fn output(machine: &Machine, group: &Group, name: &str, lane: usize) -> Vec<f32> {
    match machine.output(group, name).unwrap().lane(lane) {
        Values::Floats(values) => values,
        other => panic!("{name} is {other:?}"),
    }
}

/// Compares the derivatives of a value of a type with its differences, and says whether they are not all zero.
#[track_caller]
fn compared(before: &str, ty: &str, expression: &str) -> bool {
    let text = format!(
        "{before} shader s(output {ty} x = 0, output {ty} dx = 0, output {ty} dy = 0) {{
            {ty} y = {expression}; x = y; dx = Dx(y); dy = Dy(y); }}"
    );
    let group = Compiler::new().compile("d.osl", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let group = group.group().keep_outputs().build().unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut machine = Machine::new();
    machine.shade(&group, &line(&[-STEP, 0.0, STEP]));
    let of = |name: &str, lane: usize| output(&machine, &group, name, lane);
    let (low, middle, high, dx, dy) = (of("x", 0), of("x", 1), of("x", 2), of("dx", 1), of("dy", 1));
    for c in 0..middle.len() {
        let difference = (high[c] - low[c]) / (2.0 * STEP);
        let tolerance = 0.02 * difference.abs() + 2e-4 * middle[c].abs() + 2e-3;
        let told = format!("`{expression}`, component {c}: value {}, difference {difference}", middle[c]);
        assert!((dx[c] - difference).abs() <= tolerance, "{told}, Dx {}", dx[c]);
        assert!((2.0 * dy[c] - difference).abs() <= tolerance, "{told}, Dy {}", dy[c]);
    }
    dx.iter().any(|d| *d != 0.0)
}

/// Type and value, with a derivative that is not zero; between them they call every builtin that has one.
const SMOOTH: &[(&str, &str)] = &[
    ("float", "sin(3 * u) + cos(2 * v) + tan(u)"),
    ("color", "asin(color(u, v, u * v)) + acos(color(v, u, .3))"),
    ("float", "atan(4 * u) + atan2(u, v) + atan2(-u, v * v)"),
    ("float", "sinh(u) + cosh(v) + tanh(2 * u)"),
    ("float", "exp(u) + exp2(v) + expm1(u * v)"),
    ("float", "log(u) + log2(v) + log10(u + v)"),
    ("vector", "sqrt(vector(u, v, 2)) + inversesqrt(vector(v, u, 3)) + cbrt(vector(u, 2, v))"),
    ("float", "erf(u) + erfc(2 * v) + pow(u, v) + pow(v, 3)"),
    ("color", "pow(color(u, v, 2), v)"),
    ("float", "abs(u - .9) + fabs(v - 2)"),
    ("float", "fmod(7 * u, 1) + min(u, v) + max(u, v * .1) + max(u, 3)"),
    ("color", "mix(color(u), color(v, 1, 2), v * u)"),
    ("color", "select(color(u), color(v), color(1, 0, 1)) + select(u, v, u > .3)"),
    ("float", "smoothstep(.2, .9, u) + smoothstep(v, 1, .8)"),
    ("vector", "cross(P, vector(v, u, 1)) + normalize(P)"),
    ("float", "dot(P, I) + length(P) + distance(P, point(u, v, 1))"),
    ("float", "luminance(color(u, v, u * v))"),
    ("color", "blackbody(2000 + 3000 * u)"),
    ("color", "blackbody(13000 + 3000 * u) * 1e-4"),
    ("color", "wavelength_color(611 + u)"),
    ("color", "wavelength_color(480 + 4 * u)"),
    ("color", "transformc(\"hsv\", \"rgb\", color(u, v, .7)) + color(\"hsl\", v, u, .5)"),
    ("color", "transformc(\"rgb\", \"sRGB\", color(u, v, .7)) + transformc(\"xyY\", \"YIQ\", color(u, v, .3))"),
    ("float", "transformu(\"cm\", u) + transformu(\"m\", \"ft\", v)"),
    ("float", "determinant(matrix(u, v, 1, 2, .3, u * v, 1, 0, .2, 1, v, 3, 1, u, .5, 1))"),
    ("point", "transform(matrix(u, v, 1, 0, .3, u * v, 1, 0, .2, 1, v, 0, 1, u, .5, 1), P)"),
    ("vector", "transform(matrix(u, v, 1, 0, .3, u * v, 1, 0, .2, 1, v, 0, 1, u, .5, 1), vector(P))"),
    ("normal", "transform(matrix(u, v, 1, 0, .3, u * v, 1, 0, .2, 1, v, 0, 1, u, .5, 1), normal(v, 1, u))"),
    ("normal", "transform(transpose(1 / matrix(2 + u)), normal(v, 1, u))"),
    ("point", "transform(\"common\", P)"),
    ("float", "noise(u * 3) + snoise(u * 3, v) + noise(P) + snoise(P, u)"),
    ("color", "noise(u * 3) + snoise(u * 3, v) + noise(P) + snoise(P, u)"),
    ("vector", "noise(\"simplex\", P) + noise(\"usimplex\", P, u) + noise(\"uperlin\", u, v)"),
    ("float", "pnoise(u * 3, 5) + psnoise(P, point(3)) + pnoise(\"perlin\", P, u, point(3), 4)"),
    ("color", "noise(u > .3 ? \"perlin\" : \"simplex\", 3 * u)"),
    ("float", "spline(\"catmull-rom\", u, 5, a) + splineinverse(\"linear\", 2 * u, a)"),
    ("float", "spline(\"linear\", .5, n) + spline(\"bspline\", u, n)"),
    ("float", "spline(\"bezier\", v, n) - spline(\"hermite\", u, n) + spline(\"constant\", .9, n)"),
    ("color", "spline(\"linear\", v, c)"),
    ("vector", "spline(\"catmull-rom\", .3, 4, w)"),
    ("float", "splineinverse(\"linear\", 1 + u, n) + splineinverse(\"catmull-rom\", 1.5, n)"),
    ("float", "splineinverse(\"bspline\", v + 1, 5, n)"),
    ("float", "n[2] + n[(int)(u * 4)]"),
    ("float", "copied(n)"),
    ("float", "looped(n)"),
    ("vector", "held(c)"),
    ("float", "sinus(u)"),
    ("color", "filled(u)"),
];

/// Builtins whose derivative is zero, as they give ints or strings, are steps, or see nothing that moves along the surface;
/// textures, messages and what moves the surface have tests of their own.
const FLAT: &[&str] = &[
    "Dx",
    "Dy",
    "Dz",
    "area",
    "arraylength",
    "backfacing",
    "bump",
    "calculatenormal",
    "ceil",
    "cellnoise",
    "concat",
    "dict_find",
    "dict_next",
    "dict_value",
    "displace",
    "endswith",
    "environment",
    "error",
    "exit",
    "filterwidth",
    "floor",
    "format",
    "fprintf",
    "getattribute",
    "getchar",
    "getmatrix",
    "getmessage",
    "gettextureinfo",
    "hash",
    "hashnoise",
    "isconnected",
    "isconstant",
    "isfinite",
    "isinf",
    "isnan",
    "logb",
    "pointcloud_get",
    "pointcloud_search",
    "pointcloud_write",
    "printf",
    "random",
    "raytype",
    "regex_match",
    "regex_search",
    "round",
    "setmessage",
    "sign",
    "split",
    "startswith",
    "step",
    "stof",
    "stoi",
    "strlen",
    "substr",
    "surfacearea",
    "texture",
    "texture3d",
    "trace",
    "trunc",
    "warning",
];

/// What the expressions call.
const BEFORE: &str = "
    float copied(float k[5]) { float l[5] = {0, 0, 0, 0, 0}; for (int i = 0; i < 5; ++i) l[4 - i] = k[i] * k[i]; return l[0] + l[3]; }
    float looped(float k[5]) { float sum = 0; for (int i = 0; i < 5; ++i) { if (k[i] > .5) sum += sin(k[i]); } return sum; }
    struct Held { color c[4]; float f; };
    vector held(color c[4]) { Held h; h.c = c; h.f = c[1][0]; Held g = h; g.c[0] = g.c[3] * h.f; return vector(g.c[0]); }
    float sinus(float x) { float s, c; sincos(2 * x, s, c); return s + 3 * c; }
    color filled(float x) { color c = 0; c[(int)(x + .7)] = x * x; return c + cellnoise(x * .1) + floor(x); }
    ";

/// Arrays that the expressions read.
fn with_arrays(expression: &str) -> String {
    let arrays = [
        ("a[", "float a[5] = {0, .5, 1, 1.7, 2};"),
        ("a)", "float a[5] = {0, .5, 1, 1.7, 2};"),
        ("n[", "float n[5] = {0*u, 1*u, 2*u + v, 3*u + 1, 4*u + 2};"),
        ("n)", "float n[5] = {0*u, 1*u, 2*u + v, 3*u + 1, 4*u + 2};"),
        ("c)", "color c[4] = {color(u, v, 1), color(v), color(u * v, 2, u), color(1, u, v)};"),
        ("w)", "vector w[4] = {vector(u, v, 1), vector(P), vector(I), vector(1, u, v)};"),
    ];
    let mut text = String::new();
    for (name, declaration) in arrays {
        let used = expression.contains(&format!(" {name}"))
            || expression.contains(&format!("({name}"))
            || expression.starts_with(name);
        if used && !text.contains(declaration) {
            text.push_str(declaration);
        }
    }
    text
}

#[test]
fn derivatives_are_what_differences_say() {
    for (ty, expression) in SMOOTH {
        let body = with_arrays(expression);
        let value = format!("value_of_{ty}()");
        let function = format!("{BEFORE} {ty} value_of_{ty}() {{ {body} {ty} r = {expression}; return r; }}");
        assert!(compared(&function, ty, &value), "`{expression}` has a derivative of zero");
    }
}

#[test]
fn what_has_no_derivative_gives_zero() {
    for (ty, expression) in [
        ("float", "floor(u * 3) + ceil(v) + round(u) + trunc(v * 4) + sign(u) + logb(u) + step(.2, u)"),
        ("float", "cellnoise(u, v) + hashnoise(.3) + stof(format(\"%d\", (int)(u * 4)))"),
        ("float", "Dx(u * u) * 0 + hash((int)(u * 3)) * 1e-9 + surfacearea()"),
    ] {
        assert!(!compared("", ty, expression), "`{expression}` has a derivative");
    }
}

#[test]
fn every_builtin_is_one_or_the_other() {
    let called = |name: &str| {
        let all = SMOOTH.iter().map(|(_, expression)| *expression).chain([BEFORE]);
        all.into_iter().any(|text| text.contains(&format!("{name}(")))
    };
    for name in builtins::names() {
        let flat = FLAT.contains(&name);
        assert!(flat || called(name), "no derivative of `{name}` is compared");
    }
}

#[test]
fn derivatives_of_slices_of_arrays_and_of_the_inverse_spline_reach_closures() {
    let text = "surface s() { float k[4] = {0,1,2,3}; Ci = Dx(splineinverse(\"linear\", u + 1, k)) * diffuse(N); }";
    let group = Compiler::new().compile("b.osl", text).unwrap().group().build().unwrap();
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &line(&[0.0]));
    assert_eq!(velour::closure::print::tree_text(group.table(), tree, 0), "(0.7, 0.7, 0.7) * diffuse ((0, 0, 1))");
}
