//! The commands, how their arguments are read, and what the process ends with.

use super::failure::Failure;
use super::names::named;
use super::speak::{lost, tell};
use super::{chart, check, fmt, info, live, lsp, merge, new, render, shade, tree, verify};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// An OSL-style closure interpreter and renderer.
#[derive(Parser)]
#[command(name = "velour", version, about, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a first scene and shader
    New(new::NewArgs),
    /// Render a scene to an image
    Render(Box<render::RenderArgs>),
    /// Show a scene or a shader on a page of this machine while it is edited
    Live(Box<live::LiveArgs>),
    /// Merge parts of a picture, which were rendered apart
    Merge(merge::MergeArgs),
    /// Check shaders and report every mistake
    Check(check::CheckArgs),
    /// Check shaders and write .oso files that say how they are compiled, as OSL's oslc is used
    Compile(check::CheckArgs),
    /// Lay shaders out anew: indentation and spaces
    Fmt(fmt::FmtArgs),
    /// Serve an editor, as a language server over standard input and output
    Lsp(lsp::LspArgs),
    /// Show the closure tree of a shader
    Tree(tree::TreeArgs),
    /// Run shaders on a grid of points, as OSL's testshade does
    Shade(shade::ShadeArgs),
    /// Verify that closures or shaders keep energy, sample what they say, and stay finite
    Verify(verify::VerifyArgs),
    /// Measure cost and error of every method on this machine, and draw them
    Chart(chart::ChartArgs),
    /// List closures and functions, or what a shader declares
    Info(info::InfoArgs),
}

/// Runs the command line and gives the exit status: 0 done, 1 a shader or scene is wrong, 2 usage or files, 130 and 143 a render that
/// was stopped by SIGINT and SIGTERM.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse_from(gnu_style(named(std::env::args_os().collect()))) {
        Ok(arguments) => arguments,
        Err(error) => {
            // A pipe that closes early is no reason to complain.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let result = match arguments.command {
        Command::New(args) => new::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Live(args) => live::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Check(args) => check::run(&args, false),
        Command::Compile(args) => check::run(&args, true),
        Command::Fmt(args) => fmt::run(&args),
        Command::Lsp(args) => lsp::run(&args),
        Command::Tree(args) => tree::run(&args),
        Command::Shade(args) => shade::run(&args.words),
        Command::Verify(args) => verify::run(&args),
        Command::Chart(args) => chart::run(&args),
        Command::Info(args) => info::run(&args),
    };
    match result {
        Ok(()) if lost() => fail("error: standard output did not take all that was printed", 2),
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Wrong(message)) => fail(&message, 1),
        Err(Failure::Usage(message)) => fail(&message, 2),
        Err(Failure::Stopped(status)) => ExitCode::from(status),
    }
}

/// Writes long options that begin with one dash, as OSL's tools took them, with two.
///
/// Whatever follows `velour shade` is left alone: that command reads its own words.
fn gnu_style(words: Vec<OsString>) -> Vec<OsString> {
    let command = Arguments::command();
    let named = words.get(1).and_then(|word| word.to_str()).unwrap_or_default();
    let Some(chosen) = command.find_subcommand(named).filter(|_| named != "shade") else { return words };
    let names = |argument: &'_ clap::Arg| -> Vec<String> {
        let aliases = argument.get_all_aliases().unwrap_or_default();
        argument.get_long().into_iter().chain(aliases).map(str::to_owned).collect()
    };
    let longs: Vec<String> = chosen.get_arguments().flat_map(names).collect();
    let long = |name: &str| longs.iter().any(|known| known == name);
    let short = |word: &str| word.len() == 1 && chosen.get_arguments().any(|a| a.get_short() == word.chars().next());
    let fixed = |word: OsString| match word.to_str().and_then(|text| text.strip_prefix('-')) {
        Some(bare) if !short(bare) && long(bare.split('=').next().unwrap_or(bare)) => {
            OsString::from(format!("--{bare}"))
        }
        // Compilers take the file of these without a space.
        Some(bare) if bare.starts_with("MF") && long("MF") => OsString::from(format!("--MF={}", &bare[2..])),
        Some(bare) if bare.starts_with("MT") && long("MT") => OsString::from(format!("--MT={}", &bare[2..])),
        _ => word,
    };
    words.into_iter().map(fixed).collect()
}

fn fail(message: &str, status: u8) -> ExitCode {
    if !message.is_empty() {
        tell(&format!("{message}\n"));
    }
    ExitCode::from(status)
}
