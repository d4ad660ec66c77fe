//! The command line: arguments, subcommands, messages to people. All printing and all exit codes are here.

mod chart;
mod check;
mod info;
mod info_file;
mod render;
mod tree;
mod verify;

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// What a command ends with.
#[derive(Debug)]
pub enum Failure {
    /// A shader or a scene is wrong: status 1.
    Wrong(String),
    /// The command was used wrongly, or a file cannot be read or written: status 2.
    Usage(String),
}

/// An OSL-style closure interpreter and renderer.
#[derive(Parser)]
#[command(name = "velour", version, about, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene to an image
    Render(render::RenderArgs),
    /// Check shaders and report every mistake
    Check(check::CheckArgs),
    /// Show the closure tree of a shader
    Tree(tree::TreeArgs),
    /// Verify that closures or shaders keep energy, sample what they say, and stay finite
    Verify(verify::VerifyArgs),
    /// Measure cost and error of every method on this machine, and draw them
    Chart(chart::ChartArgs),
    /// List closures and functions, or what a shader declares
    Info(info::InfoArgs),
}

/// How shaders are compiled.
#[derive(Args, Clone, Debug, Default)]
struct CompileArgs {
    /// Add a folder to look for included files in
    #[arg(short = 'I', value_name = "DIR")]
    include: Vec<PathBuf>,
    /// Define a macro
    #[arg(short = 'D', value_name = "NAME[=VALUE]")]
    define: Vec<String>,
    /// Undefine a macro
    #[arg(short = 'U', value_name = "NAME")]
    undefine: Vec<String>,
    /// Use another standard header than the built-in one
    #[arg(long, value_name = "FILE")]
    stdosl: Option<PathBuf>,
}

/// How messages look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum MessageFormat {
    /// One line a message: file:line:column: error: message
    Short,
    /// The text with the place marked
    #[default]
    Full,
}

impl CompileArgs {
    fn compiler(&self) -> Result<crate::compile::Compiler, Failure> {
        let mut compiler = crate::compile::Compiler::new();
        if let Some(path) = &self.stdosl {
            let text = std::fs::read_to_string(path)
                .map_err(|error| Failure::Usage(format!("{}: error: {error}", path.display())))?;
            compiler = compiler.with_header(&path.display().to_string(), &text);
        }
        compiler.options.include_dirs = self.include.clone();
        compiler.options.undefines = self.undefine.clone();
        let pair = |text: &String| match text.split_once('=') {
            Some((name, value)) => (name.to_owned(), value.to_owned()),
            None => (text.clone(), "1".to_owned()),
        };
        compiler.options.defines = self.define.iter().map(pair).collect();
        Ok(compiler)
    }
}

/// Runs the command line and gives the exit status: 0 done, 1 a shader or scene is wrong, 2 usage or files.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // A pipe that closes early is no reason to complain.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let result = match arguments.command {
        Command::Render(args) => render::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Tree(args) => tree::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Chart(args) => chart::run(&args),
        Command::Info(args) => info::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Wrong(message)) => fail(&message, 1),
        Err(Failure::Usage(message)) => fail(&message, 2),
    }
}

fn fail(message: &str, status: u8) -> ExitCode {
    if !message.is_empty() {
        tell(&format!("{message}\n"));
    }
    ExitCode::from(status)
}

/// Prints to standard output. A pipe that closes early is no reason to complain.
fn say(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Prints to standard error.
fn tell(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// True when messages may be coloured.
fn colored() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
