//! `velour merge`: parts of a picture in, the picture out.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::screen::ScreenArgs;
use super::speak::tell;
use super::watch;
use crate::render::output;
use crate::render::part::{self, Part, Ranges};
use std::path::{Path, PathBuf};
use velour_grammar::files::Access;

/// Arguments of `velour merge`.
#[derive(clap::Args)]
pub struct MergeArgs {
    /// The parts, as `velour render --samples` and stopped renders leave them
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// The picture: an .exr is a part as well, which more can be merged with; .png and .hdr are not
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Refuse parts that do not hold these samples, such as 0..128, together
    #[arg(long, value_name = "A..B")]
    samples: Option<Ranges>,
    /// Leave the sums out of an .exr: the file of a plain render, which nothing can be added to
    #[arg(long)]
    picture: bool,
    #[command(flatten)]
    screen: ScreenArgs,
    /// Read no file outside of this folder
    #[arg(long, value_name = "DIR")]
    sandbox: Option<PathBuf>,
    /// Bytes that the command may hold, such as 2G or 512M; it ends when it needs more
    #[arg(long, value_name = "BYTES", value_parser = watch::bytes)]
    memory: Option<u64>,
}

/// Reads a part that may be read.
pub fn part_of(access: &Access, path: &Path) -> Result<Part, Failure> {
    let usage = |message: String| Failure::Usage(format!("error: {message}"));
    if access.sandbox().is_none() {
        return part::read(path).map_err(|error| usage(error.to_string()));
    }
    if !access.covers(path) {
        return Err(usage(format!("{} is not in the sandbox", path.display())));
    }
    let (file, _) = access.open(path, u64::MAX).map_err(|error| usage(format!("{}: {error}", path.display())))?;
    part::read_file(&file, path).map_err(|error| usage(error.to_string()))
}

/// Merges parts and writes the picture.
pub fn run(args: &MergeArgs) -> Result<(), Failure> {
    let format = output::check(&args.output).map_err(|message| Failure::Usage(format!("error: {message}")))?;
    let same = |path: &PathBuf| path.canonicalize().is_ok_and(|a| args.output.canonicalize().is_ok_and(|b| a == b));
    if let Some(part) = args.parts.iter().find(|path| args.picture && same(path)) {
        let text = format!(
            "error: a picture in place of {} would lose its samples\n  help: name another file",
            part.display()
        );
        return Err(Failure::Usage(text));
    }
    let access = CompileArgs::default().bounded(args.sandbox.clone(), args.memory).access()?;
    let mut merged: Option<Part> = None;
    for path in &args.parts {
        let part = part_of(&access, path)?;
        merged = Some(match merged {
            None => part,
            Some(mut all) => {
                let place = |error| Failure::Wrong(format!("error: {}: {error}", path.display()));
                all.merge(part).map_err(place)?;
                all
            }
        });
    }
    let Some(part) = merged else { return Ok(()) };
    complete(args, &part)?;
    let written = if args.picture || format != output::Format::Exr {
        output::write_as(&part.picture(), &args.output, &args.screen.screen())
    } else {
        part::write(&part, &args.output)
    };
    written.map_err(|message| Failure::Usage(format!("error: {message}")))?;
    tell(&format!("{}: {} x {}, {}\n", args.output.display(), part.of.width, part.of.height, part.summary()));
    Ok(())
}

/// Says which samples are missing: those that were asked for, which is a failure, or those between the others.
fn complete(args: &MergeArgs, part: &Part) -> Result<(), Failure> {
    let common = part.common();
    if let Some(wanted) = &args.samples {
        let beyond = part.held.iter().map(|held| wanted.lacking(held)).find(|extra| !extra.is_empty());
        if let Some(extra) = beyond {
            let help = "help: leave out the part that holds them, or ask for them as well";
            return Err(Failure::Wrong(format!("error: samples {extra} are there and were not asked for\n  {help}")));
        }
    }
    let missing = match &args.samples {
        Some(wanted) => common.lacking(wanted),
        None => common.missing(0..part.held.iter().map(Ranges::end).max().unwrap_or(0)),
    };
    if missing.is_empty() {
        return Ok(());
    }
    if args.samples.is_some() {
        let help = "help: render them with --samples and merge that too";
        return Err(Failure::Wrong(format!("error: samples {missing} are missing\n  {help}")));
    }
    tell(&format!("warning: samples {missing} are missing\n"));
    Ok(())
}
