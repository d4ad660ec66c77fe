//! The commands, how their arguments are read, and what the process ends with.

use super::failure::Failure;
use super::speak::tell;
use super::{chart, check, info, new, render, tree, verify};
use clap::{Parser, Subcommand};
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
        Command::New(args) => new::run(&args),
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
