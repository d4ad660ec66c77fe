//! `velour tree`: shows what a shader's `Ci` is, at one point, as a tree or as flattened lobes.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::source_file::compile;
use super::speak::{say, tell};
use crate::closure::print::tree_text;
use crate::closure::settings::Shadowing;
use crate::closure::{Layering, Lobes, Settings};
use crate::exec::{Group, Machine, Points, ReportKind};
use crate::math::columns::Column3;
use glam::Vec3;
use std::path::PathBuf;

/// Arguments of `velour tree`.
#[derive(clap::Args)]
pub struct TreeArgs {
    /// A shader file, or the name of a shader in the binary
    file: PathBuf,
    /// Set a parameter: numbers with commas between, or a string
    #[arg(long, num_args = 2, value_names = ["NAME", "VALUE"], allow_hyphen_values = true, action = clap::ArgAction::Append)]
    param: Vec<String>,
    /// Show the flattened lobes with their weights and albedos
    #[arg(long)]
    lobes: bool,
    /// Cosine of the angle of view
    #[arg(long, default_value_t = 1.0, value_name = "COS")]
    view: f32,
    /// Surface coordinates of the point
    #[arg(long, num_args = 2, value_names = ["U", "V"], default_values_t = [0.5, 0.5])]
    uv: Vec<f32>,
    /// How a base is scaled under its layer: min, view, kelemen or lossless
    #[arg(long, default_value = "min")]
    layering: Layering,
    /// Shadowing term of sheen: exact, published, ashikhmin or series
    #[arg(long, default_value = "exact")]
    shadowing: Shadowing,
    /// Show the program as well
    #[arg(long)]
    program: bool,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Shades one point and prints its tree.
pub fn run(args: &TreeArgs) -> Result<(), Failure> {
    if !args.view.is_finite() || args.uv.iter().any(|x| !x.is_finite()) {
        return Err(Failure::Usage("error: --view and --uv take finite numbers".to_owned()));
    }
    let shader = compile(&args.compile.compiler()?, &args.file)?;
    let mut builder = shader.group();
    for pair in args.param.chunks(2) {
        builder = builder.text(&pair[0], &pair[1]);
    }
    let group = builder.build().map_err(|error| Failure::Wrong(error.to_string()))?;
    if args.program {
        say(&crate::ir::print::listing(group.program(), group.table()));
    }
    let points = point(args);
    let mut machine = Machine::new();
    let tree = machine.shade(&group, &points);
    let text = if args.lobes { lobe_table(args, &group, tree, &points) } else { tree_text(group.table(), tree, 0) };
    for report in machine.take_reports() {
        match &report.kind {
            ReportKind::Output => say(&report.text),
            ReportKind::File(_) => tell(&report.to_string()),
            ReportKind::Warning | ReportKind::Error | ReportKind::Mistake(_) => tell(&format!("{report}\n")),
            ReportKind::Fatal => return Err(Failure::Wrong(report.to_string())),
        }
    }
    say(&format!("{}\n", if text.is_empty() { "0" } else { &text }));
    Ok(())
}

fn point(args: &TreeArgs) -> Points {
    let cos = args.view.clamp(-1.0, 1.0);
    let eye = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut points = Points::single(eye);
    points.u[0] = args.uv[0];
    points.v[0] = args.uv[1];
    points.p.set(0, Vec3::new(args.uv[0], args.uv[1], 0.0));
    points
}

fn lobe_table(args: &TreeArgs, group: &Group, tree: &crate::closure::tree::Tree, points: &Points) -> String {
    let settings = Settings { layering: args.layering, shadowing: args.shadowing, ..Settings::default() };
    let mut lobes = Lobes::new(settings);
    let wo = Column3::splat(-points.i.get(0), 1);
    lobes.flatten(group.library(), tree, &wo, &points.ng);
    let mut out =
        format!("{:<14} {:<26} {:>7} {:>6} {:>8} {:>6}", "lobe", "weight", "albedo", "depth", "through", "pick");
    for lobe in lobes.describe(0) {
        let [r, g, b] = lobe.weight;
        let weight = format!("({r:.4}, {g:.4}, {b:.4})");
        out += &format!(
            "\n{:<14} {weight:<26} {:>7.4} {:>6} {:>8.4} {:>6.4}",
            lobe.closure, lobe.albedo, lobe.depth, lobe.through, lobe.pick
        );
    }
    let emission = lobes.emission().get(0);
    if emission != Vec3::ZERO {
        out += &format!("\nemission       ({:.4}, {:.4}, {:.4})", emission.x, emission.y, emission.z);
    }
    out
}
