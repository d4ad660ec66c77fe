//! Text to leaves: a shader is compiled, shaded at one point, and its closures are read with names, weights and arguments.
//!
//! `cargo run --example closure_tree`

use std::error::Error;
use velour::closure::print::tree_text;
use velour::exec::{Machine, Points};
use velour::glam::Vec3;

const SHADER: &str = "surface cloth(color base = color(0.6, 0.05, 0.05), float r = 0.3)
{
    Ci = sheen(base * diffuse(N), N, color(1), r) + 0.1 * emission();
}";

fn main() -> Result<(), Box<dyn Error>> {
    let group = velour::compile::compile(SHADER)?.group().param("r", &[0.5]).build()?;
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &Points::single(Vec3::Z));
    println!("{}", tree_text(group.table(), tree, 0));
    Ok(())
}
