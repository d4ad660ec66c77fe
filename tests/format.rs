//! The layout of shaders: what `velour_grammar::format` makes of them is stable and is the same shader.
//!
//! With `VELOUR_CORPUS`, a folder, every shader and header in it is looked at as well.

use std::path::{Path, PathBuf};
use velour::compile::Compiler;
use velour_grammar::{FormatError, format_bytes};

/// What a file came to.
enum Outcome {
    /// It is wrong, and stays as it is.
    Wrong,
    /// Its macros look at its layout.
    Counted,
    /// It was laid out; true when that changed it.
    Done(bool),
}

/// Lays a text out twice and compares what is checked, spans of tokens included.
fn same(name: &str, bytes: &[u8]) -> Outcome {
    let compiler = Compiler::new();
    let new = match format_bytes(name, bytes, &compiler.options) {
        Ok(new) => new,
        Err(FormatError::Wrong(..)) => return Outcome::Wrong,
        Err(_) => return Outcome::Counted,
    };
    let again = format_bytes(name, &new, &compiler.options).unwrap();
    assert!(again == new, "{name} does not stay as it is:\n{}", first_difference(&new, &again));
    let [old, new_checked] = [bytes, &new].map(|bytes| compiler.check_bytes(name, bytes));
    let codes = |checked: &velour::compile::Checked| {
        checked.diagnostics.list.iter().map(|d| (d.code, d.span, d.message.clone())).collect::<Vec<_>>()
    };
    assert_eq!(codes(&old), codes(&new_checked), "{name}");
    let typed = |checked: velour::compile::Checked| checked.shader.map(|shader| format!("{:?}", shader.typed));
    assert!(typed(old) == typed(new_checked), "{name} is another shader");
    Outcome::Done(new != bytes)
}

fn first_difference(a: &[u8], b: &[u8]) -> String {
    let [a, b] = [a, b].map(String::from_utf8_lossy);
    let lines = a.lines().zip(b.lines()).find(|(a, b)| a != b);
    lines.map_or(String::new(), |(a, b)| format!("{a:?}\n{b:?}"))
}

/// The shaders and headers of a folder and those in it.
fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().filter_map(Result::ok) {
        let (path, kind) = (entry.path(), entry.file_type().unwrap());
        let named = path.extension().is_some_and(|end| end == "osl" || end == "h");
        match kind.is_dir() {
            true => files(&path, out),
            false if kind.is_file() && named => out.push(path),
            false => {}
        }
    }
}

#[test]
fn shaders_stay_the_same_and_are_laid_out_once() {
    let mut all = Vec::new();
    files(Path::new("shaders"), &mut all);
    assert!(all.len() > 15);
    let own = all.len();
    if let Some(folder) = std::env::var_os("VELOUR_CORPUS") {
        files(Path::new(&folder), &mut all);
    }
    all.sort();
    let (mut wrong, mut counted, mut changed, mut done) = (Vec::new(), Vec::new(), 0, 0);
    for path in &all {
        match same(path.to_str().unwrap(), &std::fs::read(path).unwrap()) {
            Outcome::Wrong => wrong.push(path),
            Outcome::Counted => counted.push(path),
            Outcome::Done(new) => {
                done += 1;
                changed += usize::from(new);
            }
        }
    }
    let shaders =
        |list: &[&PathBuf]| list.iter().filter(|path| path.extension().is_some_and(|end| end == "osl")).count();
    println!("{} shaders, {} of them wrong", shaders(&all.iter().collect::<Vec<_>>()), shaders(&wrong));
    println!(
        "{} files: {done} laid out, {changed} changed by it; {} wrong; layout counts: {counted:?}",
        all.len(),
        wrong.len()
    );
    assert!(done >= own, "{wrong:?} {counted:?}");
}
