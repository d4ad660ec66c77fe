//! `velour chart`: what each method costs on this machine, and how wrong it is.

use super::{Failure, say, tell};
use crate::measure::chart::{Effort, draw, figure::Figure, figures, table};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};

/// Arguments of `velour chart`.
#[derive(clap::Args)]
pub struct ChartArgs {
    /// The folder to write figures and tables to; made when it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Take less than a minute
    #[arg(long)]
    quick: bool,
}

/// Measures, draws and writes.
pub fn run(args: &ChartArgs) -> Result<(), Failure> {
    // The folder is tried first, so that no measurement is lost.
    std::fs::create_dir_all(&args.output).map_err(|error| unwritable(&args.output, &error))?;
    let effort = if args.quick { Effort::quick() } else { Effort::full() };
    // indicatif draws nothing when standard error is no terminal.
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}") {
        bar.set_style(style);
    }
    let figures = figures(&effort, &|done, total| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    for figure in &figures {
        write_figure(&args.output, figure)?;
    }
    let text = table::markdown(&figures, &table::machine());
    write(&args.output.join("chart.csv"), table::csv(&figures).as_bytes())?;
    write(&args.output.join("chart.md"), text.as_bytes())?;
    say(&text);
    tell(&format!("{}: {} figures\n", args.output.display(), figures.len()));
    Ok(())
}

fn write_figure(folder: &Path, figure: &Figure) -> Result<(), Failure> {
    let wrong = |message: String| Failure::Usage(format!("error: {}: {message}", figure.name));
    let svg = draw::svg(figure).map_err(wrong)?;
    write(&folder.join(format!("{}.svg", figure.name)), svg.as_bytes())?;
    let (width, height, pixels) = draw::pixels(figure).map_err(wrong)?;
    let mut png = Vec::new();
    let encoded = PngEncoder::new(&mut png).write_image(&pixels, width, height, ExtendedColorType::Rgb8);
    encoded.map_err(|error| wrong(error.to_string()))?;
    write(&folder.join(format!("{}.png", figure.name)), &png)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    std::fs::write(path, bytes).map_err(|error| unwritable(path, &error))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("error: cannot write `{}`: {error}", path.display()))
}
