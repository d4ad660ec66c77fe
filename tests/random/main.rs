//! Programs made at random through the public interface: whatever `ir::verify` accepts runs without a panic.
//!
//! `VELOUR_LONG_TESTS=1 cargo test --test random` makes 100,000 of them.

mod mutate;
mod scratch;

use mutate::{Choice, mutated};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use velour::closure::Library;
use velour::compile::Compiler;
use velour::exec::{Group, Machine, Points};
use velour::ir::op::*;
use velour::ir::print::listing;
use velour::ir::program::*;
use velour::ir::verify::{Problem, verify};
use velour::lang::closures::ClosureId;
use velour::lang::types::Type;
use velour_grammar::Span;

/// The seed of all programs.
const SEED: u64 = 0x5851_f42d_4c95_7f2d;

fn count() -> u64 {
    if std::env::var_os("VELOUR_LONG_TESTS").is_some() { 100_000 } else { 3_000 }
}

/// Shaders whose programs are changed.
const TEXTS: &[&str] = &[
    "shader s(output float y = 0, output color c = 0) { y = noise(P * 3) + Dx(u * v); c = transformc(\"rgb\", \"hsv\", color(u, v, y)); }",
    "struct S { float a; int k[3]; }; shader s(output int k[3] = {1, 2, 3}) { S s = {u, {4, 5, 6}}; for (int i = 0; i < 3; ++i) { s.k[(int)(v * 3)] += i; k[i] = s.k[2 - i]; } }",
    "surface s() { closure color c[2]; c[u > 0.5] = diffuse(N); if (v > 0.3) c[0] += v * emission(); Ci = c[0] + u * c[1]; if (u > 0.9) exit(); Ci = sheen(Ci, N, color(u), v); }",
    "shader s(output string t = \"\") { t = u > 0.5 ? \"a\" : \"b\"; for (int i = 0; i < v * 4; ++i) t = concat(t, format(\"%d %g\", i, u)); printf(\"%s\", t); warning(\"%g\", v); }",
    "shader s(output float a = 0) { float x = u; float k[5] = {0, 1, u, 1, 2}; while (x < 3) { x += spline(\"linear\", x, k) + 0.3; if (x > 2 * v) break; } a = filterwidth(splineinverse(\"bspline\", x, k)); }",
    "surface s(string d = \"ggx\") { matrix m; int ok = getmatrix(\"common\", d, m); string r[3]; int n = split(format(\"%g,%g\", u, v), r, \",\"); float f = 0; getattribute(\"f\", f); Ci = microfacet(d, N, 0.1 * n + f, 1.5, 0) + raytype(\"camera\") * transparent(); }",
    "surface s() { int p[4]; if (regex_search(u > .5 ? \"abc\" : \"xb\", p, \"b\")) Ci = p[0] * diffuse(N); Ci += layer(sheen_bsdf(N, color(u), .3), diffuse(N)); if (!Ci) Ci = holdout(); }",
    "surface s() { color c = 0; for (int i = 0; i < 4; ++i) { if (u > v) { c[i] = i; continue; } c += blackbody(3000 * u) * 1e-6; } Ci = c * generalized_schlick_bsdf(N, vector(1, 0, 0), c, c, .1, .1, c, color(1), 5, \"ggx\"); }",
];

fn points(lanes: usize) -> Points {
    let mut points = Points::new(lanes);
    for lane in 0..lanes {
        points.u[lane] = (lane as f32 + 0.5) / lanes as f32;
        points.v[lane] = (lane as f32 * 0.37).fract();
        points.p.set(lane, glam::Vec3::new(lane as f32, 0.5, -1.0));
        points.n.set(lane, glam::Vec3::Z);
        points.dudx[lane] = 0.1;
        points.ray_type[lane] = 1 + (lane as i32 & 2);
    }
    points
}

fn group(program: Program, library: &Arc<Library>) -> Result<Group, velour::ir::verify::VerifyError> {
    Group::new(program, library.clone(), Arc::new(|_| velour::exec::ReportPlace::default()))
}

/// Runs a group over two batches and reads everything back.
fn run(group: &Group, lanes: [usize; 2]) {
    let mut machine = Machine::new();
    machine.budget = 400;
    for lanes in lanes {
        let tree = machine.shade(group, &points(lanes));
        // A loop that adds a closure to itself makes a text of exponential length.
        if tree.nodes.len() < 20 {
            (0..lanes).for_each(|lane| drop(velour::closure::print::tree_text(group.table(), tree, lane)));
        }
        machine.take_reports();
    }
}

#[test]
fn what_is_accepted_runs() {
    let library = Arc::new(Library::standard());
    let table = library.table();
    let programs: Vec<Program> = TEXTS
        .iter()
        .flat_map(|text| {
            let shader = Compiler::new().compile("r.osl", text).unwrap_or_else(|e| panic!("{e}"));
            let best = shader.group().keep_outputs().build().unwrap();
            let plain = shader.group().keep_outputs().unoptimized().build().unwrap();
            [best.program().clone(), plain.program().clone()]
        })
        .collect();
    let mut choice = Choice::new(SEED);
    let (mut accepted, mut refused) = ([0u64; 2], [0u64; 2]);
    for number in 0..count() {
        let scratch = number % 2 == 0;
        let program = match scratch {
            true => scratch::program(&mut choice, table),
            false => mutated(&programs[choice.below(programs.len())], &mut choice),
        };
        let lanes = [1 + choice.below(9), 1 + choice.below(9)];
        match group(program.clone(), &library) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused[scratch as usize] += 1;
            }
            Ok(group) => {
                accepted[scratch as usize] += 1;
                let ran = catch_unwind(AssertUnwindSafe(|| run(&group, lanes)));
                assert!(ran.is_ok(), "number {number} panics in batches of {lanes:?}:\n{}", listing(&program, table));
            }
        }
    }
    // Neither side may be empty, or the test says nothing.
    for kind in 0..2 {
        let all = accepted[kind] + refused[kind];
        assert!(accepted[kind] * 10 > all && refused[kind] * 20 > all, "{accepted:?} accepted, {refused:?} refused");
    }
}

/// A program of one block over a few registers: `r0` a float input, `r1` an int, `r2` a closure, `r3` a float of code.
fn small(body: Vec<Instr>) -> Program {
    let mut program = Program::default();
    let info = |kind, source| RegInfo { kind, source, mutable: false, uniform: false };
    program.regs = vec![
        info(Kind::Float, Source::Input(Input::Global(velour::lang::globals::Global::U, 0))),
        info(Kind::Int, Source::Const(Const::Int(1))),
        info(Kind::Closure, Source::Code),
        info(Kind::Float, Source::Code),
    ];
    program.body = body.into_iter().map(Node::Instr).collect();
    program
}

fn problem(program: Program) -> Problem {
    verify(&program, Library::standard().table()).expect_err("it must be refused").problem
}

#[test]
fn programs_made_by_hand_are_refused() {
    let (index, dst, span) = (Reg(1), Reg(3), Span::NONE);
    let get = Instr::ArrayGet { dst, array: ArrayId(0), component: 0, index, span };
    assert_eq!(problem(small(vec![get.clone()])), Problem::NoArray(ArrayId(0)));
    let mut program = small(vec![Instr::ArrayGet { dst, array: ArrayId(0), component: 3, index, span }]);
    program.arrays.push(ArrayInfo { kind: Kind::Float, len: 2, components: 3, uniform: false });
    assert_eq!(problem(program), Problem::NoComponent(ArrayId(0), 3));
    let mut program = small(vec![get]);
    program.arrays.push(ArrayInfo { kind: Kind::Float, len: u32::MAX, components: u32::MAX, uniform: false });
    assert!(matches!(problem(program), Problem::TooLarge(_)));

    let leaf = |closure, params: Vec<Reg>, keywords| Instr::Leaf { dst: Reg(2), closure, params, keywords, span };
    let diffuse = Library::standard().named("diffuse").next().unwrap().0;
    let bare = small(vec![leaf(diffuse, vec![], vec![])]);
    assert_eq!(problem(bare), Problem::WrongCount { of: "parameters", given: 0, wanted: 3 });
    let unknown = small(vec![leaf(ClosureId(9999), vec![], vec![])]);
    assert_eq!(problem(unknown), Problem::NoClosure(ClosureId(9999)));
    let keyword = small(vec![leaf(diffuse, vec![Reg(0); 3], vec![(77, vec![Reg(0)])])]);
    assert_eq!(problem(keyword), Problem::NoKeyword(diffuse, 77));
    let wrong = small(vec![leaf(diffuse, vec![Reg(0), Reg(0), Reg(1)], vec![])]);
    assert_eq!(problem(wrong), Problem::WrongKind { holds: Kind::Int, wanted: Kind::Float });

    let call = |routine, dst: &[Reg], src: &[Reg]| {
        problem(small(vec![Instr::Call { routine, dst: dst.to_vec(), src: src.to_vec(), span }]))
    };
    assert_eq!(
        call(Routine::Smooth(Smooth::Determinant), &[Reg(3)], &[]),
        Problem::WrongCount { of: "sources", given: 0, wanted: 16 }
    );
    assert_eq!(call(Routine::HashInt, &[], &[Reg(1)]), Problem::WrongCount { of: "results", given: 0, wanted: 1 });
    let noise = Noise { kind: NoiseKind::Cell, dims: 9, outputs: 1, periodic: false, gradient: false, filtered: false };
    assert_eq!(call(Routine::Noise(noise), &[Reg(3)], &[Reg(0)]), Problem::NoRoutine("noise"));

    assert_eq!(problem(small(vec![Instr::Unary(Unary::Sin, Reg(3), Reg(40))])), Problem::NoRegister(Reg(40)));
    assert_eq!(problem(small(vec![Instr::Unary(Unary::Sin, Reg(40), Reg(0))])), Problem::NoRegister(Reg(40)));
    assert_eq!(problem(small(vec![Instr::Unary(Unary::Sin, Reg(3), Reg(3))])), Problem::Unwritten(Reg(3)));
    assert_eq!(problem(small(vec![Instr::Unary(Unary::Sin, Reg(0), Reg(0))])), Problem::Unwritable(Reg(0)));
    let mut program = small(vec![Instr::Unary(Unary::Sin, Reg(3), Reg(0))]);
    program.regs[3].uniform = true;
    assert_eq!(problem(program), Problem::Varies(Reg(3)));
}

#[test]
fn promises_beside_the_instructions_are_checked() {
    let with = |change: &dyn Fn(&mut Program)| {
        let mut program = small(vec![Instr::Unary(Unary::Sin, Reg(3), Reg(0))]);
        assert_eq!(verify(&program, Library::standard().table()), Ok(()));
        change(&mut program);
        problem(program)
    };
    assert_eq!(with(&|p| p.result = Some(Reg(2))), Problem::Unwritten(Reg(2)));
    assert_eq!(with(&|p| p.result = Some(Reg(99))), Problem::NoRegister(Reg(99)));
    assert_eq!(with(&|p| p.body.push(Node::Leave(ScopeId(0)))), Problem::NoScope(ScopeId(0)));
    assert_eq!(
        with(&|p| {
            p.scopes = 1;
            p.body.push(Node::Leave(ScopeId(0)));
        }),
        Problem::LeftFromOutside(ScopeId(0))
    );
    let string = |number| RegInfo {
        kind: Kind::String,
        source: Source::Const(Const::String(number)),
        mutable: false,
        uniform: true,
    };
    assert_eq!(with(&|p| p.regs.push(string(i32::MAX))), Problem::NoSymbol(i32::MAX));
    assert_eq!(with(&|p| p.regs.push(string(-1))), Problem::NoSymbol(-1));
    let output = |value| Output { layer: String::new(), name: "x".to_owned(), ty: Type::FLOAT, value };
    assert_eq!(with(&|p| p.outputs.push(output(OutputValue::Array(ArrayId(7))))), Problem::NoArray(ArrayId(7)));
    assert_eq!(
        with(&|p| p.outputs.push(output(OutputValue::Regs(vec![Reg(3), Reg(3)])))),
        Problem::WrongCount { of: "numbers", given: 2, wanted: 1 }
    );
    let deep = with(&|p| {
        for _ in 0..3_000 {
            p.body = vec![Node::If(Reg(1), std::mem::take(&mut p.body), vec![])];
        }
    });
    assert!(matches!(deep, Problem::TooDeep(_)));
}
