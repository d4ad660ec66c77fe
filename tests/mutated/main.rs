//! Texts and files changed at random, for everything that reads what others wrote: no panic, and none takes more than five seconds.
//!
//! `VELOUR_COUNT=1000000 cargo test --release --test mutated` makes as many of each kind; `VELOUR_FIRST=n` begins with input n;
//! `VELOUR_CORPUS=DIR` takes the files of a folder besides our own. An input that fails is kept in the folder for temporary files.

mod change;
mod kinds;

use change::{Random, changed};
use kinds::Kind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The most seconds that an input may take, in a machine that has other things to do.
const SECONDS: f64 = 5.0;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

/// The files of `folder` that are of this kind.
fn files(folder: &Path, kind: &Kind, found: &mut Vec<Vec<u8>>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, kind, found);
        } else if path.extension().is_some_and(|e| kind.extensions.iter().any(|known| e == *known)) {
            found.extend(std::fs::read(&path).ok().filter(|bytes| bytes.len() < 1 << 15));
        }
    }
}

fn corpus(kind: &Kind) -> Vec<Vec<u8>> {
    let mut corpus = (kind.own)();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), kind, &mut corpus);
    if let Some(folder) = std::env::var_os("VELOUR_CORPUS") {
        files(Path::new(&folder), kind, &mut corpus);
    }
    corpus
}

/// What is wrong with how an input was taken, if anything.
fn flaw(kind: &Kind, bytes: &[u8], folder: &Path) -> Option<String> {
    let start = Instant::now();
    let panicked = catch_unwind(AssertUnwindSafe(|| (kind.read)(bytes, folder))).is_err();
    let seconds = start.elapsed().as_secs_f64();
    match (panicked, seconds > SECONDS) {
        (true, _) => Some("a panic".to_owned()),
        (_, true) => Some(format!("{seconds:.1} s")),
        _ => None,
    }
}

fn try_kind(kind: &Kind) {
    let corpus = corpus(kind);
    assert!(!corpus.is_empty());
    let first = number("VELOUR_FIRST").unwrap_or(0);
    let count = number("VELOUR_COUNT").unwrap_or(kind.few);
    let (next, failures) = (AtomicU64::new(first), Mutex::new(Vec::new()));
    let work = || {
        let folder = tempfile::tempdir().unwrap();
        loop {
            let input = next.fetch_add(1, Ordering::Relaxed);
            if input >= first + count || failures.lock().unwrap().len() >= 5 {
                return;
            }
            let bytes = changed(&mut Random::new(input), &corpus, kind.words);
            if let Some(flaw) = flaw(kind, &bytes, folder.path()) {
                let kept = std::env::temp_dir().join(format!("velour-{}-{input}", kind.name));
                std::fs::write(&kept, &bytes).unwrap();
                failures.lock().unwrap().push(format!("input {input}: {flaw}; it is in {}", kept.display()));
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads)
            .map(|_| std::thread::Builder::new().stack_size(16 << 20).spawn_scoped(scope, work).unwrap())
            .collect();
        threads.into_iter().for_each(|thread| thread.join().unwrap());
    });
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{}: {}", kind.name, failures.join("\n"));
}

#[test]
fn shaders() {
    try_kind(&kinds::SHADER);
}

#[test]
fn groups() {
    try_kind(&kinds::GROUP);
}

#[test]
fn scenes() {
    try_kind(&kinds::SCENE_XML);
}

#[test]
fn meshes() {
    try_kind(&kinds::MESH);
}

#[test]
fn materials() {
    try_kind(&kinds::MATERIALS);
}

#[test]
fn parts() {
    try_kind(&kinds::PART);
}

#[test]
fn textures() {
    try_kind(&kinds::TEXTURE);
}

#[test]
fn recipes() {
    try_kind(&kinds::RECIPE);
}

#[test]
fn a_panic_and_a_long_time_are_found() {
    let panics = |_: &[u8], _: &Path| panic!("as it must");
    let kind = Kind { read: panics, ..kinds::SHADER };
    assert_eq!(flaw(&kind, b"", Path::new("")).as_deref(), Some("a panic"));
    let slow = |_: &[u8], _: &Path| std::thread::sleep(std::time::Duration::from_secs_f64(SECONDS + 0.1));
    assert!(flaw(&Kind { read: slow, ..kinds::SHADER }, b"", Path::new("")).is_some_and(|flaw| flaw.ends_with(" s")));
}
