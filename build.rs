//! Tells the lane loops whether they are compiled to run fast; see `src/math/instruction_set.rs`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(one_instruction_set)");
    if std::env::var("OPT_LEVEL").is_ok_and(|level| level == "0") {
        println!("cargo::rustc-cfg=one_instruction_set");
    }
}
