//! `velour verify`: does a closure, or a user's shader, keep the laws that a material has to keep?

use super::compile::CompileArgs;
use super::failure::Failure;
use super::speak::{colored, say, tell};
use super::threads::capped;
use super::watch::TimeBound;
use crate::closure::settings::Shadowing;
use crate::closure::{Layering, Settings};
use crate::compile::{Compiler, GroupError, Shader};
use crate::lang::nearest::nearest;
use crate::limits::SHADER_BYTES;
use crate::measure::verify::{
    ClosureSubject, Effort, Line, Report, ShaderSubject, Subject, Verdict, cannot_run, verify,
};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;
use std::time::Instant;
use velour_grammar::Format;

/// Arguments of `velour verify`.
#[derive(clap::Args)]
pub struct VerifyArgs {
    /// Closures and shader files; nothing for every built-in closure
    #[arg(value_name = "CLOSURE | FILE.osl")]
    subjects: Vec<String>,
    /// Fewer samples, views and parameters
    #[arg(long)]
    quick: bool,
    /// Show every variant, not only the worst
    #[arg(long, short)]
    verbose: bool,
    /// Set a parameter of the shader files, or try several values: numbers with commas between, or strings
    #[arg(long, num_args = 2, value_names = ["NAME", "V[,V...]"], allow_hyphen_values = true, action = clap::ArgAction::Append)]
    param: Vec<String>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Threads; 0 for one a core
    #[arg(short, long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// How a base is scaled under its layer where the shader does not say: min, view, kelemen or lossless
    #[arg(long, default_value = "min")]
    layering: Layering,
    /// Shadowing term of sheen where the shader does not say: exact, published, ashikhmin or series
    #[arg(long, default_value = "exact")]
    shadowing: Shadowing,
    /// End with an error when this takes more than S seconds
    #[arg(long, value_name = "S")]
    time: Option<f64>,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Verifies the subjects and prints the table.
pub fn run(args: &VerifyArgs) -> Result<(), Failure> {
    let _bound = TimeBound::new(Instant::now(), args.time, "before all was verified");
    let subjects = subjects(args)?;
    let subjects: Vec<&dyn Subject> = subjects.iter().map(AsRef::as_ref).collect();
    let effort = args.effort();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(capped(args.threads)).build();
    let pool = pool.map_err(|error| Failure::Usage(format!("error: no threads: {error}")))?;
    // indicatif draws nothing when standard error is no terminal.
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
        bar.set_style(style);
    }
    let report = pool.install(|| {
        verify(&subjects, &effort, &|done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        })
    });
    bar.finish_and_clear();
    let lines = if args.verbose { report.lines.clone() } else { report.worst() };
    say(&table(&lines));
    say(&summary(&subjects, &report));
    if report.passed() { Ok(()) } else { Err(Failure::Wrong(String::new())) }
}

/// What is to be verified, in the order of the command line.
fn subjects(args: &VerifyArgs) -> Result<Vec<Box<dyn Subject>>, Failure> {
    let compiler = args.compile.compiler()?;
    let settings = Settings { layering: args.layering, shadowing: args.shadowing, ..Settings::default() };
    let mut out: Vec<Box<dyn Subject>> = Vec::new();
    let (mut wrong, mut files) = (false, false);
    let all: Vec<String> = compiler.closures.specs().iter().map(|spec| spec.name.to_owned()).collect();
    let mut names = if args.subjects.is_empty() { all } else { args.subjects.clone() };
    // Overloads share a name and are verified together.
    let mut seen = std::collections::HashSet::new();
    names.retain(|name| seen.insert(name.clone()));
    for name in &names {
        if name.ends_with(".osl") || Path::new(name).is_file() {
            files = true;
            match shader(&compiler, name)? {
                Some(shader) => out.push(shader_subject(args, name, &shader, settings)?),
                None => wrong = true,
            }
            continue;
        }
        let mut found = false;
        for (id, _) in compiler.closures.named(name) {
            let subject = ClosureSubject::new(&compiler, id, !args.quick, settings).map_err(Failure::Wrong)?;
            out.push(Box::new(subject));
            found = true;
        }
        if !found {
            return Err(Failure::Usage(unknown(&compiler, name)));
        }
    }
    if !files && !args.param.is_empty() {
        let message = "error: --param sets parameters of shader files, and none is named";
        return Err(Failure::Usage(message.to_owned()));
    }
    if wrong { Err(Failure::Wrong(String::new())) } else { Ok(out) }
}

impl VerifyArgs {
    fn effort(&self) -> Effort {
        let effort = if self.quick { Effort::quick() } else { Effort::full() };
        Effort { seed: self.seed, ..effort }
    }
}

/// Compiles a file, with all it has to say; nothing when it is wrong.
fn shader(compiler: &Compiler, name: &str) -> Result<Option<Shader>, Failure> {
    let bytes = compiler
        .options
        .access
        .read(Path::new(name), SHADER_BYTES)
        .map_err(|error| Failure::Usage(format!("{name}: error: cannot be read: {error}")))?;
    let checked = compiler.check_bytes(name, &bytes);
    let text = checked.sources.render(&checked.diagnostics, Format::Full, colored());
    if !text.is_empty() {
        tell(&format!("{}\n", text.trim_end()));
    }
    Ok(checked.shader)
}

fn shader_subject(
    args: &VerifyArgs,
    name: &str,
    shader: &Shader,
    settings: Settings,
) -> Result<Box<dyn Subject>, Failure> {
    let given: Vec<(String, String)> = args.param.chunks(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect();
    let wrong = |error: GroupError| Failure::Wrong(error.to_string());
    // A shader that cannot be run is not tried at thousands of places.
    let group = given.iter().fold(shader.group(), |group, (name, text)| group.text(name, text)).build();
    if let Ok(group) = group
        && let Some(report) = cannot_run(&group)
    {
        return Err(Failure::Wrong(report.to_string()));
    }
    Ok(Box::new(ShaderSubject::new(name, shader, &given, settings, &args.effort()).map_err(wrong)?))
}

fn unknown(compiler: &Compiler, name: &str) -> String {
    let names: Vec<&str> = compiler.closures.specs().iter().map(|spec| spec.name).collect();
    let help = match nearest(name, &names) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`velour info` lists all closures".to_owned(),
    };
    format!("error: `{name}` is no closure or shader file\n  help: {help}")
}

/// The findings in columns, one a line.
fn table(lines: &[Line]) -> String {
    let head = ["subject", "check", "worst", "bound", "verdict", "where"].map(str::to_owned);
    let rows: Vec<[String; 6]> = std::iter::once(head).chain(lines.iter().map(Line::cells)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 5] = std::array::from_fn(width);
    let mut out = String::new();
    for row in &rows {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(widths) {
            line += &format!("{cell:<width$}  ");
        }
        line += &row[5];
        out += line.trim_end();
        out.push('\n');
    }
    out
}

/// What was done and how it ended, in a line.
fn summary(subjects: &[&dyn Subject], report: &Report) -> String {
    let variants: usize = subjects.iter().map(|subject| subject.variants()).sum();
    let failed: Vec<&Line> = report.lines.iter().filter(|line| line.finding.verdict == Verdict::Fail).collect();
    let mut names: Vec<&str> = failed.iter().map(|line| line.subject.as_str()).collect();
    names.dedup();
    let verdict = if failed.is_empty() {
        "nothing fails".to_owned()
    } else {
        format!("{} of {} checks FAIL, in {}", failed.len(), report.lines.len(), names.join(", "))
    };
    let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    format!(
        "{}, {}, {} (at most 1 % together): {verdict}\n",
        plural(subjects.len(), "subject"),
        plural(variants, "variant"),
        plural(report.tests as usize, "chi-square test")
    )
}
