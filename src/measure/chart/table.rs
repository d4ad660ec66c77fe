//! The chart as text: comma-separated values, and Markdown for people.

use super::figure::Figure;
use std::fmt::Write;

/// One line a point, the first line names the columns. Texts are quoted.
pub fn csv(figures: &[Figure]) -> String {
    let mut out =
        "figure,group,method,cost,cost_low_quartile,cost_high_quartile,error,front,cost_axis,error_axis\n".to_owned();
    for figure in figures {
        for p in &figure.points {
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "{},{},{},{:.6e},{:.6e},{:.6e},{:.6e},{},{},{}",
                figure.name,
                quoted(&p.group),
                quoted(&p.method),
                p.cost,
                p.spread[0],
                p.spread[1],
                p.error,
                u8::from(p.front),
                quoted(&figure.cost),
                quoted(&figure.error)
            );
        }
    }
    out
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// A section a figure: what its cost and its error mean, its picture, and a table in which the front is set bold.
pub fn markdown(figures: &[Figure], machine: &str) -> String {
    let mut out = format!(
        "# Speed against accuracy\n\nMeasured on: {machine}.\n\nA method in bold lies on the front: none of its group is both cheaper and at least as exact.\n"
    );
    for figure in figures {
        let name = figure.name;
        let _ = write!(out, "\n## {}\n\n{}\n\n![{}]({name}.svg)\n\n", figure.title, figure.meaning, figure.title);
        let _ =
            writeln!(out, "| group | method | {} | quartiles | {} |\n|---|---|---|---|---|", figure.cost, figure.error);
        for p in &figure.points {
            let mark = if p.front { "**" } else { "" };
            let [low, high] = p.spread.map(short);
            let _ = writeln!(
                out,
                "| {} | {mark}{}{mark} | {} | {low} to {high} | {} |",
                p.group,
                p.method,
                short(p.cost),
                short(p.error)
            );
        }
    }
    out
}

/// A number in three digits.
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        v if !(0.001..10_000.0).contains(&v) => format!("{value:.2e}"),
        v => {
            let digits = (2.0 - v.log10().floor()).clamp(0.0, 5.0) as usize;
            format!("{value:.digits$}")
        }
    }
}

/// The processor, its number of cores, and the instruction sets that the lane loops may take.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = name.map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    format!("{name}, {cores} threads, {}, velour {}", std::env::consts::OS, env!("CARGO_PKG_VERSION"))
}
