//! Typed shaders made up at random: optimised, unoptimised and one lane at a time give the same bits.
//!
//! `cargo test --test generated` runs a few thousand; with `VELOUR_LONG_TESTS=1` it runs a hundred thousand. A shader that
//! fails is cut down before it is shown. `VELOUR_FIRST=n` begins with program n.

mod compare;
mod expression;
mod maker;
mod shrink;

use compare::{compile, problem};
use maker::Maker;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use velour::compile::Compiler;

/// The seed of all programs.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// How many failures are shown before the run ends.
const MOST_SHOWN: usize = 6;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

fn lines_of(program: u64) -> Vec<String> {
    Maker::new(SEED.wrapping_mul(2 * program + 1)).shader()
}

#[test]
fn made_up_shaders_mean_one_thing() {
    let long = std::env::var_os("VELOUR_LONG_TESTS").is_some();
    let first = number("VELOUR_FIRST").unwrap_or(0);
    let count = number("VELOUR_COUNT").unwrap_or(if long { 100_000 } else { 3_000 });
    let (next, failures) = (AtomicU64::new(first), Mutex::new(Vec::new()));
    let run = || {
        let compiler = Compiler::new();
        loop {
            let program = next.fetch_add(1, Ordering::Relaxed);
            if program >= first + count || failures.lock().unwrap().len() >= MOST_SHOWN {
                return;
            }
            let lines = lines_of(program);
            let shader = compile(&compiler, &lines.join("\n"))
                .unwrap_or_else(|error| panic!("program {program} does not compile: {error}\n{}", lines.join("\n")));
            if problem(&shader).is_some() {
                let lines = shrink::shrunk(&compiler, &lines);
                let said = compile(&compiler, &lines.join("\n")).ok().and_then(|shader| problem(&shader));
                let said = said.unwrap_or_else(|| "fails no more when it is run again".to_owned());
                failures.lock().unwrap().push(format!("program {program}: {said}\n{}", lines.join("\n")));
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    std::thread::scope(|scope| {
        let workers: Vec<_> =
            (0..threads).map(|_| std::thread::Builder::new().stack_size(16 << 20).spawn_scoped(scope, run)).collect();
        assert!(workers.into_iter().all(|worker| worker.unwrap().join().is_ok()), "a worker failed");
    });
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

#[test]
fn a_difference_is_found_and_cut_down() {
    // What is known before a shader runs is a matter of optimisation, and this function tells.
    let lines = [
        "shader s(output float x = 0.5) {",
        "x += u;",
        "if (v > 0.5) {",
        "x = 2;",
        "}",
        "for (int n = 0; n < 2; ++n) {",
    ];
    let lines = [&lines[..], &["printf(\"%d\\n\", isconstant(1.0 + 1));", "}", "}"]].concat();
    let lines: Vec<String> = lines.into_iter().map(str::to_owned).collect();
    let compiler = Compiler::new();
    let found = problem(&compile(&compiler, &lines.join("\n")).unwrap()).unwrap();
    assert!(found.starts_with("optimised, alone: print 0"), "{found}");
    let short = shrink::shrunk(&compiler, &lines);
    assert_eq!(short, [lines[0].clone(), lines[6].clone(), "}".to_owned()]);
}

#[test]
fn programs_are_long_and_of_all_kinds() {
    let texts: Vec<String> = (0..200).map(|program| lines_of(program).join("\n")).collect();
    for word in [
        "for (", "while (", "do {", "break", "continue", "return", "exit()", "noise(", "sheen(", "matrix(", "output ",
        "[-1]", "1e39",
    ] {
        let count = texts.iter().filter(|text| text.contains(word)).count();
        assert!(count >= 10, "{word} in {count} of {}", texts.len());
    }
    assert!(lines_of(7) == lines_of(7) && lines_of(7) != lines_of(8));
}
