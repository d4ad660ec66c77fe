//! Text to leaves: a shader is compiled, shaded at one point, and its closures are read with names, weights and arguments.
//!
//! `cargo run --example closure_tree`

use std::error::Error;
use velour::closure::reading::{Leaves, Value};
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
    show(tree.lane(group.table(), 0), "");
    Ok(())
}

/// Prints leaves, and those nested in them further in.
fn show(leaves: Leaves, margin: &str) {
    for leaf in leaves {
        println!("{margin}{} of weight {:?}", leaf.name(), leaf.weight());
        for (name, value) in leaf.arguments() {
            match value {
                Value::Closure(nested) => {
                    println!("{margin}  {name}:");
                    show(nested, &format!("{margin}    "));
                }
                value => println!("{margin}  {name} = {value:?}"),
            }
        }
    }
}
