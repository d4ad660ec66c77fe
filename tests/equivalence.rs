//! One meaning, however a shader is run: optimised or not, in batches of any width, by any instruction set, every bit is
//! the same.
//!
//! The corpus is a handful of shaders written for their control flow, and programs made up at random from one seed.

use std::sync::{Mutex, PoisonError};
use velour::compile::Compiler;
use velour::exec::{Group, MAX_LANES, Machine, Points, ReportKind, Values};
use velour::ir::verify::verify;
use velour::math::instruction_set::InstructionSet;

/// The seed of all programs that are made up.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// How many programs are made up.
const PROGRAMS: u64 = 200;

/// Batch widths: one lane, a few, the default, and one that is no multiple of a vector.
const WIDTHS: [usize; 4] = [1, 8, MAX_LANES, 100];

/// Points in all; a prime, so that no width divides them.
const POINTS: usize = 521;

fn points(first: usize, len: usize) -> Points {
    let mut points = Points::new(len);
    for lane in 0..len {
        let at = (first + lane) as f32 / POINTS as f32;
        points.u[lane] = at;
        points.v[lane] = (at * 37.0).fract();
        points.p.x[lane] = 8.0 * at;
        points.p.y[lane] = 3.0 * points.v[lane];
        points.p.z[lane] = 1.0;
        points.dudx[lane] = 0.01;
        points.dvdy[lane] = 0.02;
        points.dpdx.x[lane] = 0.08;
        points.dpdy.y[lane] = 0.06;
        points.n.z[lane] = 1.0;
        points.ray_type[lane] = 1 + (lane as i32 & 2);
    }
    points
}

/// Everything a group gives over all points: what it prints, and the bits of its outputs point by point.
fn results(group: &Group, width: usize) -> (Vec<String>, Vec<u64>) {
    let mut machine = Machine::new();
    let (mut printed, mut bits) = (Vec::new(), Vec::new());
    let mut first = 0;
    while first < POINTS {
        let len = width.min(POINTS - first);
        machine.shade(group, &points(first, len));
        for report in machine.take_reports() {
            match report.kind {
                ReportKind::Output => printed.push(report.text),
                // What is said once a batch depends on the width by design.
                ReportKind::Error | ReportKind::Mistake(_) | ReportKind::Warning | ReportKind::File(_) => {}
                ReportKind::Fatal => panic!("{report}"),
            }
        }
        for lane in 0..len {
            for output in &group.program().outputs {
                match machine.output(group, &output.name).unwrap().lane(lane) {
                    Values::Floats(values) => bits.extend(values.iter().map(|x| u64::from(x.to_bits()))),
                    Values::Ints(values) => bits.extend(values.iter().map(|&x| x as u64)),
                    Values::Strings(values) => bits.extend(values.iter().map(|text| hash(text))),
                    Values::Closures(values) => bits.push(values.len() as u64),
                }
            }
        }
        first += len;
    }
    (printed, bits)
}

/// A number that is the same for equal texts.
fn hash(text: &str) -> u64 {
    text.bytes().fold(1, |sum, byte| sum.wrapping_mul(SEED) ^ u64::from(byte))
}

/// The set in use is the whole process's: one test at a time turns it down.
static SET: Mutex<()> = Mutex::new(());

/// Runs a text in all ways and compares.
fn same_everywhere(text: &str) {
    let shader = Compiler::new().compile("equal.osl", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let plain = shader.group().keep_outputs().unoptimized().build().unwrap();
    let best = shader.group().keep_outputs().build().unwrap();
    for group in [&plain, &best] {
        verify(group.program(), group.table()).unwrap_or_else(|problem| panic!("{problem}\n{text}"));
    }
    let reference = results(&plain, 1);
    let hold = |group: &Group, width: usize, name: &str| {
        let (printed, bits) = results(group, width);
        assert!(
            printed == reference.0,
            "{name}, {width} lanes, print {:?}, not {:?}\n{text}",
            printed.first(),
            reference.0.first()
        );
        let differ = bits.iter().zip(&reference.1).position(|(a, b)| a != b);
        assert!(
            differ.is_none() && bits.len() == reference.1.len(),
            "{name}, {width} lanes, differ at {differ:?}\n{text}"
        );
    };
    for (group, name) in [(&plain, "unoptimised"), (&best, "optimised")] {
        WIDTHS.iter().for_each(|&width| hold(group, width, name));
    }
    let _alone = SET.lock().unwrap_or_else(PoisonError::into_inner);
    for set in InstructionSet::ALL {
        let used = InstructionSet::most(set);
        hold(&best, MAX_LANES, &format!("optimised, {used:?}"));
    }
}

#[test]
fn shaders_with_much_control_flow() {
    let texts = [
        "float f(float z) { float x = z; for (int i = 0; i < 4; ++i) { if (x * i > 2) return i; x += 0.1; } return x; }
         shader s(output float y = 0, output float d = 0) { y = f(u * 3); d = Dx(f(v)); }",
        "shader s(output int n = 0) { while (n < 20) { n++; if (n % 2 == (u > 0.5)) continue; if (n > v * 20) break; n += 2; } }",
        "shader s(output color c = 0) { color k = noise(P); c = k * noise(\"simplex\", P, u); if (k[0] > 0.5) { c[1] = Dx(c[0]); return; } c.b += snoise(P * 2); }",
        "struct S { float a; int k[3]; }; S g(S x, output float y) { S r = x; r.k[(int)(u * 3)] += 2; y += r.a; if (v > 0.5) return x; r.a *= 2; return r; }
         shader s(output float a = 0, output int k[3] = {1, 2, 3}) { S s = {u, {4, 5, 6}}; for (int i = 0; i < 3; ++i) { s = g(s, a); k[i] = s.k[2 - i]; } a += s.a; }",
        "shader s() { closure color c[2]; c[u > 0.5] = diffuse(N); if (v > 0.3) c[0] += v * emission(); Ci = c[0] + u * c[1];
           if (u > 0.9) exit(); Ci = sheen(Ci, N, color(u), v); printf(\"%s\\n\", Ci); }",
        "shader s(output string t = \"\") { t = u > 0.5 ? \"a\" : \"b\"; for (int i = 0; i < v * 4; ++i) t = concat(t, format(\"%d\", i)); printf(\"%s\", t); }",
        "void f(output float a, output float b) { a = b + 1; b = a * 2; } shader s(output float x = 1, output float y = 2) { if (u > 0.3) f(x, y); do { f(y, x); if (x > 40 * v) break; } while (x < 30); }",
        "shader s(output float a = 0, output float b = 0) { float x = u; float k[4] = {0, 1, 0, 1}; for (int i = 0; i < 3; ++i) { if (v > 0.5) x = sin(x) * P[0]; else x += x * x; } a = Dx(x); b = Dy(x) + filterwidth(spline(\"bspline\", x, k)); }",
    ];
    for text in texts {
        same_everywhere(text);
    }
}

/// Makes up programs; every choice comes from one stream of numbers.
struct Maker {
    state: u64,
    text: String,
    loops: u32,
    depth: u32,
}

impl Maker {
    fn below(&mut self, n: u64) -> u64 {
        // xorshift64*: enough for choices.
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        (self.state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % n
    }

    fn pick(&mut self, list: &[&str]) -> String {
        list[self.below(list.len() as u64) as usize].to_owned()
    }

    fn float(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.pick(&["x", "y", "u", "v", "0.25", "2.0", "q.f", "P[0]", "c[1]", "a[0]"]);
        }
        let (l, r) = (self.float(depth - 1), self.float(depth - 1));
        match self.below(12) {
            0 => format!("({l} + {r})"),
            1 => format!("({l} - {r})"),
            2 => format!("({l} * {r})"),
            3 => format!("({l} / {r})"),
            4 => format!("min({l}, {r})"),
            5 => format!("sin({l})"),
            6 => format!("floor({l} * 4)"),
            7 => format!("a[{} % 3]", self.int(depth - 1)),
            8 => format!("({} ? {l} : {r})", self.condition(depth - 1)),
            9 => format!("f({l}, {})", self.int(depth - 1)),
            10 => format!("Dx({l} * {r})"),
            _ => format!("noise({l}, {r})"),
        }
    }

    fn int(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.pick(&["i", "j", "1", "3", "q.k[1]", "(int)(u * 5)"]);
        }
        let (l, r) = (self.int(depth - 1), self.int(depth - 1));
        match self.below(6) {
            0 => format!("({l} + {r})"),
            1 => format!("({l} * {r} % 17)"),
            2 => format!("abs({l} - {r})"),
            3 => format!("({l} ^ {r})"),
            4 => format!("q.k[abs({l}) % 2]"),
            _ => format!("({l} < {r})"),
        }
    }

    fn condition(&mut self, depth: u32) -> String {
        match self.below(4) {
            0 => format!("{} > {}", self.float(depth), self.float(0)),
            1 => format!("{} % 3 == 1", self.int(depth)),
            2 => format!("({} > 0.5 && {} < 2)", self.float(0), self.int(depth)),
            _ => "(v > 0.4 || (i = 2) > 3)".to_owned(),
        }
    }

    fn statement(&mut self) {
        if self.depth > 3 {
            self.text.push_str("x += 0.5;\n");
            return;
        }
        self.depth += 1;
        let line = match self.below(14) {
            0 | 1 => format!("x = {};\n", self.float(2)),
            2 => format!("y {} {};\n", self.pick(&["+=", "-=", "*="]), self.float(1)),
            3 => format!("i = {};\n", self.int(2)),
            4 => format!("a[abs({}) % 3] = {};\n", self.int(1), self.float(1)),
            5 => format!("c[abs({}) % 3] += {};\n", self.int(1), self.float(1)),
            6 => format!("q.k[abs({}) % 2] = {}; q.f = {};\n", self.int(1), self.int(1), self.float(1)),
            7 => format!("g(q, {}, y);\n", self.pick(&["x", "a[1]", "c[0]"])),
            8 | 9 => {
                let condition = self.condition(1);
                self.text.push_str(&format!("if ({condition}) {{\n"));
                self.statements();
                self.text.push_str("} else {\n");
                self.statements();
                "}\n".to_owned()
            }
            10 | 11 => {
                let name = format!("n{}", self.state % 1000);
                let limit = self.pick(&["3", "u * 4", "(i & 3)"]);
                self.text.push_str(&format!("for (int {name} = 0; {name} < {limit}; ++{name}) {{\n"));
                self.loops += 1;
                self.statements();
                self.loops -= 1;
                "}\n".to_owned()
            }
            12 if self.loops > 0 => format!("if ({}) {};\n", self.condition(1), self.pick(&["break", "continue"])),
            13 => format!("if ({}) return;\n", self.condition(1)),
            _ => "q = q; j++;\n".to_owned(),
        };
        self.text.push_str(&line);
        self.depth -= 1;
    }

    fn statements(&mut self) {
        for _ in 0..1 + self.below(4) {
            self.statement();
        }
    }
}

#[test]
fn programs_made_up_at_random() {
    let head = "struct Q { float f; int k[2]; };
        float f(float z, int n) { float x = z; for (int i = 0; i < 3; ++i) { if (x > 1) return x - i; x += 0.3 * n; } return -x; }
        void g(output Q q, output float x, output float y) { if (x > y) { q.f = x; return; } q.k[1] += 1; x = y + 0.25; }
        shader s(output float x = 0, output float y = 1, output int i = 0, output float a[3] = {1, 2, 3}, output color c = 0.5) {
        int j = 2; Q q = {u, {1, 2}};\n";
    for program in 0..PROGRAMS {
        let state = SEED.wrapping_mul(2 * program + 1);
        let mut maker = Maker { state, text: head.to_owned(), loops: 0, depth: 0 };
        for _ in 0..4 {
            maker.statements();
        }
        maker.text.push_str("printf(\"%g %g %d %g\\n\", x, y, i, c); }\n");
        same_everywhere(&maker.text);
    }
}
