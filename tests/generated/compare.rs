//! Runs a shader in all ways and compares what comes out: prints, trees, and the bits of every output.

use std::panic::{AssertUnwindSafe, catch_unwind};
use velour::closure::print::tree_text;
use velour::compile::{Compiler, Shader};
use velour::exec::{Group, Machine, Points, ReportKind, Values};
use velour::ir::verify::verify;

const POINTS: usize = 6;

/// What a shader gives over all points.
#[derive(PartialEq)]
struct Seen {
    printed: Vec<String>,
    trees: Vec<String>,
    bits: Vec<u64>,
}

fn points(first: usize, len: usize) -> Points {
    let mut points = Points::new(len);
    for lane in 0..len {
        let at = (first + lane) as f32 / POINTS as f32;
        (points.u[lane], points.v[lane]) = (at, (at * 37.0).fract());
        (points.p.x[lane], points.p.y[lane], points.p.z[lane]) = (8.0 * at, 3.0 * points.v[lane], 1.0);
        (points.dudx[lane], points.dvdy[lane]) = (0.01, 0.02);
        (points.dpdx.x[lane], points.dpdy.y[lane]) = (0.08, 0.06);
        (points.n.x[lane], points.n.z[lane], points.ng.z[lane]) = (0.1 * at, 1.0, 1.0);
        (points.i.z[lane], points.dpdu.x[lane]) = (-1.0, 8.0);
        points.ray_type[lane] = 1 + ((first + lane) as i32 & 2);
    }
    points
}

/// The bits of a float. Which not-a-number an operation gives is not defined, so all are one.
fn float_bits(x: f32) -> u64 {
    if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() as u64 }
}

/// A number that is the same for equal texts.
fn hash(text: &str) -> u64 {
    text.bytes().fold(1, |sum, byte| sum.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(byte))
}

fn seen(group: &Group, width: usize) -> Seen {
    let mut machine = Machine::new();
    machine.budget = 2_000_000;
    let mut seen = Seen { printed: Vec::new(), trees: Vec::new(), bits: Vec::new() };
    let mut first = 0;
    while first < POINTS {
        let len = width.min(POINTS - first);
        let tree = machine.shade(group, &points(first, len));
        seen.trees.extend((0..len).map(|lane| tree_text(group.table(), tree, lane)));
        for report in machine.take_reports() {
            match report.kind {
                ReportKind::Output => seen.printed.push(report.text),
                // What is said once a batch depends on the width by design.
                ReportKind::Error | ReportKind::Mistake(_) | ReportKind::Warning | ReportKind::File(_) => {}
                ReportKind::Fatal => panic!("{report}"),
            }
        }
        for lane in 0..len {
            for output in &group.program().outputs {
                match machine.output(group, &output.name).unwrap().lane(lane) {
                    Values::Floats(values) => seen.bits.extend(values.iter().map(|&x| float_bits(x))),
                    Values::Ints(values) => seen.bits.extend(values.iter().map(|&x| x as u64)),
                    Values::Strings(values) => seen.bits.extend(values.iter().map(|text| hash(text))),
                    Values::Closures(values) => seen.bits.push(values.len() as u64),
                }
            }
        }
        first += len;
    }
    seen
}

fn first_difference(a: &Seen, b: &Seen) -> Option<String> {
    let list = |what: &str, a: &[String], b: &[String]| {
        let at = (0..a.len().max(b.len())).find(|&at| a.get(at) != b.get(at))?;
        Some(format!("{what} {at}: {:?}, not {:?}", b.get(at), a.get(at)))
    };
    list("print", &a.printed, &b.printed).or_else(|| list("tree", &a.trees, &b.trees)).or_else(|| {
        let at = (0..a.bits.len().max(b.bits.len())).find(|&at| a.bits.get(at) != b.bits.get(at))?;
        Some(format!("number {at}: {:x?}, not {:x?}", b.bits.get(at), a.bits.get(at)))
    })
}

fn compare(shader: &Shader) -> Option<String> {
    let plain = shader.group().keep_outputs().unoptimized().build().unwrap();
    let best = shader.group().keep_outputs().build().unwrap();
    for group in [&plain, &best] {
        if let Err(problem) = verify(group.program(), group.table()) {
            return Some(format!("{problem:?}"));
        }
    }
    let reference = seen(&plain, 1);
    for (group, width, way) in
        [(&plain, POINTS, "unoptimised, in a batch"), (&best, 1, "optimised, alone"), (&best, POINTS, "optimised")]
    {
        if let Some(difference) = first_difference(&reference, &seen(group, width)) {
            return Some(format!("{way}: {difference}"));
        }
    }
    None
}

/// A text that cannot be compiled is a mistake of the maker.
pub fn compile(compiler: &Compiler, text: &str) -> Result<Shader, String> {
    compiler.compile("generated.osl", text).map_err(|error| format!("{error}"))
}

/// What is wrong with a shader, if anything.
pub fn problem(shader: &Shader) -> Option<String> {
    catch_unwind(AssertUnwindSafe(|| compare(shader))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        Some(format!("panic: {}", text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default()))
    })
}
