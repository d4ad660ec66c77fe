//! `velour check` and `velour compile`: report every mistake in shader files, with the options of OSL's oslc; the second also
//! writes how right ones are compiled.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::source_file::read;
use super::speak::{colored, say, say_as_it_is, tell};
use super::watch::TimeBound;
use crate::compile::{Checked, Compiler, Recipe, Shader};
use crate::files::Destination;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use velour_grammar::{Diagnostics, Format, Sources};

/// How messages look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum MessageFormat {
    /// One line a message: file:line:column: error: message
    Short,
    /// The text with the place marked
    #[default]
    Full,
    /// One JSON object a message
    Json,
}

/// Arguments of `velour check` and `velour compile`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Shader files; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// How messages look
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
    /// Warn of what is odd though it works: variables that are never read or never written
    #[arg(long = "Wall")]
    all_warnings: bool,
    /// Take warnings for errors
    #[arg(long = "Werror")]
    strict: bool,
    /// Say nothing but errors
    #[arg(short)]
    quiet: bool,
    /// Say what is done
    #[arg(short)]
    verbose: bool,
    /// Stop after the preprocessor and print its output
    #[arg(short = 'E')]
    preprocess: bool,
    /// Where the output of -E or -M goes, or the .oso file of `compile` [default: the shader's name ending with .oso]
    #[arg(short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// End with an error when this takes more than S seconds
    #[arg(long, value_name = "S")]
    time: Option<f64>,
    #[command(flatten)]
    depend: DependArgs,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Rules for make, as C compilers write them.
#[derive(clap::Args)]
struct DependArgs {
    /// Print the files that a shader is made of, as a rule for make
    #[arg(long = "M", visible_alias = "MM")]
    only: bool,
    /// Check, and write the rule beside the shader, its name ending with .d
    #[arg(long = "MD", visible_alias = "MMD")]
    beside: bool,
    /// Write the rule to this file
    #[arg(long = "MF", value_name = "FILE")]
    file: Option<PathBuf>,
    /// The rule's target [default: the shader's name ending with .oso]
    #[arg(long = "MT", value_name = "TARGET")]
    target: Option<String>,
}

/// Checks the files; all of them, whatever the first ones contain.
pub fn run(args: &CheckArgs, make: bool) -> Result<(), Failure> {
    let _bound = TimeBound::new(Instant::now(), args.time, "before all was checked");
    let compiler = args.compile.compiler()?;
    let (mut wrong, mut unreadable) = (false, false);
    let mut last = None;
    for path in &args.files {
        let (name, bytes) = match read(path, &compiler.options.access) {
            Ok(read) => read,
            Err(message) => {
                tell(&message);
                unreadable = true;
                continue;
            }
        };
        wrong |= !one(args, &compiler, (&name, &bytes), make, &mut last)?;
    }
    // The process ends with it: to free a large shader piece by piece takes a tenth of the time of checking it.
    std::mem::forget(last);
    match (unreadable, wrong) {
        (true, _) => Err(Failure::Usage(String::new())),
        (_, true) => Err(Failure::Wrong(String::new())),
        _ => Ok(()),
    }
}

/// Checks one file, and writes how it is compiled where that is wanted; true when it is right. What there was to it takes the place of the
/// one before.
fn one(
    args: &CheckArgs,
    compiler: &Compiler,
    (name, bytes): (&str, &[u8]),
    make: bool,
    last: &mut Option<Checked>,
) -> Result<bool, Failure> {
    let right = if args.preprocess {
        let text = String::from_utf8_lossy(bytes);
        let (output, diagnostics, sources) = velour_grammar::preprocess(name, &text, &compiler.options);
        put(args.output.as_deref(), &output)?;
        report(args, diagnostics, &sources)
    } else {
        let mut checked =
            if args.all_warnings { compiler.check_closely(name, bytes) } else { compiler.check_bytes(name, bytes) };
        depend(args, compiler, name, &checked.sources)?;
        let right = report(args, std::mem::take(&mut checked.diagnostics), &checked.sources);
        if make && !args.depend.only {
            write_recipe(args, compiler, name, checked.shader.as_ref().filter(|_| right))?;
        }
        *last = Some(checked);
        right
    };
    if args.verbose && right {
        say(&format!("{name}: right\n"));
    }
    Ok(right)
}

/// Writes how a right shader is compiled to the working folder, and says so as oslc does.
fn write_recipe(args: &CheckArgs, compiler: &Compiler, name: &str, shader: Option<&Shader>) -> Result<(), Failure> {
    let Some(shader) = shader else {
        if !args.quiet {
            say(&format!("FAILED {name}\n"));
        }
        return Ok(());
    };
    let failed = |reason: String| Failure::Usage(format!("{name}: error: {reason}"));
    let whole = |path: &Path| std::path::absolute(path).map_err(|error| failed(error.to_string()));
    if !compiler.options.access.is_file(Path::new(name)) {
        return Err(failed("what is to be compiled must be in a file, which is read again when it runs".to_owned()));
    }
    let include_dirs: Result<Vec<PathBuf>, Failure> =
        compiler.options.include_dirs.iter().map(|folder| whole(folder)).collect();
    let header = args.compile.header().map(whole).transpose()?;
    let recipe = Recipe {
        header,
        source: whole(Path::new(name))?,
        name: name.to_owned(),
        include_dirs: include_dirs?,
        defines: compiler.options.defines.clone(),
        undefines: compiler.options.undefines.clone(),
    };
    let text = recipe.text().ok_or_else(|| {
        failed("names with line breaks, or of more than 64 kB together, cannot be written".to_owned())
    })?;
    let target = args.output.clone().unwrap_or_else(|| format!("{}.oso", shader.name()).into());
    put(Some(&target), &text)?;
    if !args.quiet {
        say(&format!("Compiled {name} -> {}\n", target.display()));
    }
    Ok(())
}

/// Tells the messages; true when none is an error.
fn report(args: &CheckArgs, mut diagnostics: Diagnostics, sources: &Sources) -> bool {
    if args.strict {
        diagnostics.promote_warnings();
    }
    if args.quiet {
        diagnostics.drop_warnings();
    }
    let format = match args.message_format {
        MessageFormat::Short => Format::Short,
        MessageFormat::Full => Format::Full,
        MessageFormat::Json => Format::Json,
    };
    let text = sources.render(&diagnostics, format, colored());
    if !text.is_empty() {
        tell(&format!("{}\n", text.trim_end()));
    }
    !diagnostics.has_errors()
}

/// Writes the rule that `-M`, `-MD` or `-MF` ask for.
fn depend(args: &CheckArgs, compiler: &Compiler, name: &str, sources: &Sources) -> Result<(), Failure> {
    let asked = &args.depend;
    if !(asked.only || asked.beside || asked.file.is_some()) {
        return Ok(());
    }
    let own = |file: &&str| !file.starts_with('<') && !compiler.options.own_files.iter().any(|(own, _)| own == file);
    let files: Vec<&str> = sources.files().into_iter().filter(own).collect();
    let target = asked.target.clone().unwrap_or_else(|| Path::new(name).with_extension("oso").display().to_string());
    let rule = format!("{target}: {}\n", files.join(" \\\n  "));
    let beside = asked.beside.then(|| Path::new(name).with_extension("d"));
    let file = asked.file.clone().or(beside).or_else(|| args.output.clone());
    put(file.as_deref(), &rule)
}

/// Writes a text to a file, or to standard output.
fn put(file: Option<&Path>, text: &str) -> Result<(), Failure> {
    let Some(file) = file else {
        say_as_it_is(text.as_bytes());
        return Ok(());
    };
    let written = Destination::at(file).and_then(|file| file.write(|sink| sink.write_all(text.as_bytes())));
    written.map_err(|error| Failure::Usage(format!("{}: error: cannot be written: {error}", file.display())))
}
