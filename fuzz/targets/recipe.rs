//! One of the kinds of input, see tests/mutated/kinds.rs.
#![no_main]

#[allow(dead_code, reason = "the test makes the first inputs, the fuzzer has its own")]
#[path = "../../tests/mutated/kinds.rs"]
mod kinds;

use std::sync::LazyLock;

static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (kinds::RECIPE.read)(bytes, FOLDER.path()));
