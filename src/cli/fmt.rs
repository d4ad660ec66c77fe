//! `velour fmt`: lays shader files out anew.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::source_file::{is_standard, read};
use super::speak::{colored, say, say_as_it_is, tell};
use crate::files::Destination;
use std::io::Write;
use std::path::{Path, PathBuf};
use velour_grammar::{Format, FormatError, format_bytes};

/// Arguments of `velour fmt`.
#[derive(clap::Args)]
pub struct FmtArgs {
    /// Shader files and headers, which are written anew; `-` for standard input, which goes to standard output
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write nothing; name the files that would change, and end with status 1 if there are any
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Lays out the files; all of them, whatever the first ones contain.
pub fn run(args: &FmtArgs) -> Result<(), Failure> {
    let options = args.compile.compiler()?.options;
    let (mut wrong, mut unreadable) = (false, false);
    for path in &args.files {
        let (name, bytes) = match read(path, &options.access) {
            Ok(read) => read,
            Err(message) => {
                tell(&message);
                unreadable = true;
                continue;
            }
        };
        let new = match format_bytes(&name, &bytes, &options) {
            Ok(new) => new,
            Err(error) => {
                tell(&reason(&name, &error));
                wrong = true;
                continue;
            }
        };
        let changed = new != bytes;
        if args.check {
            wrong |= changed;
            if changed {
                say(&format!("{name}\n"));
            }
        } else if changed || is_standard(path) {
            put(path, &new)?;
        }
    }
    match (unreadable, wrong) {
        (true, _) => Err(Failure::Usage(String::new())),
        (_, true) => Err(Failure::Wrong(String::new())),
        _ => Ok(()),
    }
}

/// Why a file stays as it is.
fn reason(name: &str, error: &FormatError) -> String {
    match error {
        FormatError::Wrong(diagnostics, sources) => {
            let mut errors = (**diagnostics).clone();
            errors.drop_warnings();
            format!("{}\n{name}: left as it is\n", sources.render(&errors, Format::Full, colored()).trim_end())
        }
        other => format!("{name}: error: {other}\n  help: the file is left as it is\n"),
    }
}

/// Writes a text over its file, or to standard output.
fn put(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if is_standard(path) {
        say_as_it_is(bytes);
        return Ok(());
    }
    let written = Destination::at(path).and_then(|file| file.write(|sink| sink.write_all(bytes)));
    written.map_err(|error| Failure::Usage(format!("{}: error: cannot be written: {error}", path.display())))
}
