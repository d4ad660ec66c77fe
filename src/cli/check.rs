//! `velour check`: reports every mistake in shader files.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::speak::{colored, say, tell};
use std::path::PathBuf;
use velour_grammar::Format;

/// How messages look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum MessageFormat {
    /// One line a message: file:line:column: error: message
    Short,
    /// The text with the place marked
    #[default]
    Full,
}

/// Arguments of `velour check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Shader files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// How messages look
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
    /// Stop after the preprocessor and print its output
    #[arg(short = 'E')]
    preprocess: bool,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Checks the files; all of them, whatever the first ones contain.
pub fn run(args: &CheckArgs) -> Result<(), Failure> {
    let compiler = args.compile.compiler()?;
    let format = match args.message_format {
        MessageFormat::Short => Format::Short,
        MessageFormat::Full => Format::Full,
    };
    let (mut wrong, mut unreadable) = (false, false);
    for path in &args.files {
        let name = path.display().to_string();
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) => {
                tell(&format!("{name}: error: cannot be read: {error}\n"));
                unreadable = true;
                continue;
            }
        };
        let (diagnostics, sources) = if args.preprocess {
            let text = String::from_utf8_lossy(&bytes);
            let (output, diagnostics, sources) = velour_grammar::preprocess(&name, &text, &compiler.options);
            say(&output);
            (diagnostics, sources)
        } else {
            let checked = compiler.check_bytes(&name, &bytes);
            (checked.diagnostics, checked.sources)
        };
        wrong |= diagnostics.has_errors();
        let text = sources.render(&diagnostics, format, colored());
        if !text.is_empty() {
            tell(&format!("{}\n", text.trim_end()));
        }
    }
    match (unreadable, wrong) {
        (true, _) => Err(Failure::Usage(String::new())),
        (_, true) => Err(Failure::Wrong(String::new())),
        _ => Ok(()),
    }
}
