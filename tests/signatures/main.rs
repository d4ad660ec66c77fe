//! Every function and closure of OSL's library by its signature: each is taken with arguments of just those types, runs, and gives
//! finite numbers; what is mathematics gives at five points what `f64` gives.

mod values;

use velour::compile::Compiler;
use velour::exec::{Machine, Points, Values};

/// The points at which everything is asked.
const POINTS: usize = 5;

/// A signature, in parts.
struct Signature {
    returns: String,
    name: String,
    /// Types, with their brackets.
    args: Vec<String>,
}

fn signatures() -> Vec<Signature> {
    include_str!("list.txt").lines().map(parsed).collect()
}

fn parsed(line: &str) -> Signature {
    let (head, args) = line.trim_end_matches(')').split_once('(').unwrap_or_else(|| panic!("{line}"));
    let (returns, name) = head.rsplit_once(' ').unwrap_or_else(|| panic!("{line}"));
    let args = args.split(',').map(str::trim);
    let args = args.filter(|arg| !arg.is_empty() && *arg != "..." && !arg.starts_with("[token") && *arg != "value]*");
    Signature { returns: returns.to_owned(), name: name.to_owned(), args: args.map(of_type).collect() }
}

/// The type of an argument that may have a name: `output matrix M`, `string basis`, `ANY[]`.
fn of_type(arg: &str) -> String {
    let words: Vec<&str> = arg.split_whitespace().filter(|word| *word != "output").collect();
    let array = if arg.contains("[]") { "[]" } else { "" };
    let base = if words[0] == "closure" { "closure color" } else { words[0].trim_end_matches("[]") };
    format!("{}{array}", if base == "ANY" { "float" } else { base })
}

/// A text that makes sense to a function, by the place of the argument.
fn text_for(name: &str, at: usize) -> &'static str {
    match (name, at) {
        ("dict_find", 0) => "<a x='1'/>",
        ("dict_find", _) => "//a",
        ("dict_value", _) => "x",
        ("noise" | "pnoise", 0) => "perlin",
        ("snoise" | "psnoise" | "cellnoise", 0) => "perlin",
        ("spline" | "splineinverse", 0) => "linear",
        ("transformc", _) => "hsv",
        ("raytype", _) => "camera",
        ("gettextureinfo", _) => "channels",
        ("getattribute", _) => "osl:version",
        ("regex_match" | "regex_search", _) => "m",
        ("printf" | "error" | "warning" | "format" | "fprintf", _) => "said",
        ("microfacet" | "dielectric_bsdf" | "conductor_bsdf" | "generalized_schlick_bsdf", _) => "ggx",
        ("texture" | "environment" | "texture3d", 0)
        | ("pointcloud_search" | "pointcloud_get" | "pointcloud_write", 0) => "none.tif",
        _ => "common",
    }
}

/// The declaration of one argument's variable.
fn declared(signature: &Signature, at: usize) -> String {
    let ty = &signature.args[at];
    let number = |k: usize| format!("(0.{}1 + 0.{}7 * u - 0.1 * v * {k})", 2 + (at + k) % 3, 3 + (at * 2 + k) % 4);
    let element = |base: &str, k: usize| match base {
        "int" => format!("{}", 1 + at + k),
        "float" => number(k),
        "string" => format!("\"{}\"", text_for(&signature.name, at)),
        "matrix" => format!("matrix({}, 0, 0, 0, 0, 1, 0, 0.1, 0, 0.2, 1, 0, 0, 0, 0, 1)", number(k)),
        "closure color" => "diffuse(N)".to_owned(),
        triple => format!("{triple}({}, {}, {})", number(k), number(k + 1), number(k + 2)),
    };
    match ty.strip_suffix("[]") {
        Some(base) => {
            format!("{base} x{at}[4] = {{{}}};", (0..4).map(|k| element(base, k)).collect::<Vec<_>>().join(", "))
        }
        None => format!("{ty} x{at} = {};", element(ty, 0)),
    }
}

/// A shader that calls a signature once and puts out what it gives and was given.
fn shader(signature: &Signature) -> String {
    let Signature { returns, name, args } = signature;
    let variables: Vec<String> = (0..args.len()).map(|at| declared(signature, at)).collect();
    let given: Vec<String> = (0..args.len()).map(|at| format!("x{at}")).collect();
    let call = format!("{name}({})", given.join(", "));
    let plain = |ty: &str| matches!(ty, "float" | "color" | "point" | "vector" | "normal" | "int");
    let outputs: String = args
        .iter()
        .enumerate()
        .filter(|(_, ty)| plain(ty))
        .map(|(at, ty)| format!(", output {ty} a{at} = 0"))
        .collect();
    let kept: String =
        args.iter().enumerate().filter(|(_, ty)| plain(ty)).map(|(at, _)| format!("a{at} = x{at}; ")).collect();
    let zero = if returns == "string" { "\"\"" } else { "0" };
    let (result, ending) = match returns.as_str() {
        "void" => (String::new(), format!("{call};")),
        // A closure is what the shader gives.
        "closure color" => (String::new(), format!("Ci = {call};")),
        ty => (format!(", output {ty} r = {zero}"), format!("r = {call};")),
    };
    format!("shader s(float unused = 0{result}{outputs}) {{ {} {kept} {ending} }}", variables.join(" "))
}

/// What the result and the arguments are at each point, as numbers.
struct Answer {
    result: Vec<Vec<f64>>,
    args: Vec<Vec<Vec<f64>>>,
}

fn asked(signature: &Signature) -> Answer {
    let text = shader(signature);
    let shader = Compiler::new().compile("s.osl", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let group = shader.group().keep_outputs().build().unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut points = Points::new(POINTS);
    for lane in 0..POINTS {
        (points.u[lane], points.v[lane]) = (0.1 + 0.19 * lane as f32, 0.9 - 0.17 * lane as f32);
        points.p.set(lane, glam::Vec3::new(points.u[lane], points.v[lane], 0.3));
        points.n.set(lane, glam::Vec3::Z);
        points.i.set(lane, glam::Vec3::new(0.0, 0.6, -0.8));
        points.dudx[lane] = 0.01;
        points.dvdy[lane] = 0.01;
        points.dpdx.set(lane, glam::Vec3::X * 0.01);
        points.dpdy.set(lane, glam::Vec3::Y * 0.01);
    }
    let mut machine = Machine::new();
    machine.shade(&group, &points);
    let read = |name: &str| -> Vec<Vec<f64>> {
        let Some(view) = machine.output(&group, name) else { return Vec::new() };
        let numbers = |lane| match view.lane(lane) {
            Values::Floats(values) => values.into_iter().map(f64::from).collect(),
            Values::Ints(values) => values.into_iter().map(f64::from).collect(),
            Values::Strings(_) | Values::Closures(_) => Vec::new(),
        };
        (0..POINTS).map(numbers).collect()
    };
    let args = (0..signature.args.len()).map(|at| read(&format!("a{at}"))).collect();
    Answer { result: read("r"), args }
}

#[test]
fn every_signature_is_taken_and_runs() {
    let all = signatures();
    assert!(all.len() > 540, "{}", all.len());
    for signature in &all {
        let answer = asked(signature);
        let text = shader(signature);
        assert!(answer.result.iter().flatten().all(|x| x.is_finite()), "{text}: {:?}", answer.result);
    }
}

#[test]
fn mathematics_is_what_f64_says() {
    let (mut checked, mut names) = (0, std::collections::BTreeSet::new());
    for signature in signatures() {
        let answer = asked(&signature);
        for point in 0..answer.result.len() {
            let args: Vec<&[f64]> = answer.args.iter().filter_map(|a| a.get(point)).map(Vec::as_slice).collect();
            let Some(expected) = values::expected(&signature.name, &args, answer.result[point].len()) else { continue };
            for (k, (is, should)) in answer.result[point].iter().zip(&expected).enumerate() {
                let tolerance = 2e-5 * should.abs() + 4e-6;
                assert!(
                    (is - should).abs() <= tolerance,
                    "{}: component {k}: {is}, not {should}, of {args:?}",
                    shader(&signature)
                );
            }
            checked += expected.len();
            names.insert(signature.name.clone());
        }
    }
    // Noise, textures, splines, strings and questions to the host have tests of their own.
    assert!(names.len() >= 59 && checked > 3000, "{} names, {checked} numbers", names.len());
}
