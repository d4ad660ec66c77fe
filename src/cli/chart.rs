//! `velour chart`: what each method costs on this machine, and how wrong it is.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::speak::{say, tell};
use crate::files::Destination;
use crate::measure::chart::{Budget, Effort, density, draw, figure::Figure, figures, scene_figure, table};
use crate::scene::{Scene, ShaderFiles};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of `velour chart`.
#[derive(clap::Args)]
pub struct ChartArgs {
    /// A scene to measure at equal time too: a file, or the text of a scene
    scene: Option<String>,
    /// The folder to write figures and tables to; made when it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Take less than a minute
    #[arg(long)]
    quick: bool,
    /// Folders to look for shaders and meshes in, after the scene's own; separated by colons
    #[arg(long, value_name = "DIRS", value_delimiter = ':')]
    path: Vec<PathBuf>,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Measures, draws and writes.
pub fn run(args: &ChartArgs) -> Result<(), Failure> {
    // The folder is tried first, so that no measurement is lost.
    std::fs::create_dir_all(&args.output).map_err(|error| unwritable(&args.output, &error))?;
    let scene = match &args.scene {
        Some(scene) => {
            let compiler = ShaderFiles::new(args.compile.compiler()?);
            Some(Scene::load(scene, &args.path, &compiler).map_err(Failure::of_scene)?)
        }
        None => None,
    };
    let effort = if args.quick { Effort::quick() } else { Effort::full() };
    // indicatif draws nothing when standard error is no terminal.
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}") {
        bar.set_style(style);
    }
    let progress = |done, total| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    };
    let mut figures = figures(&effort, &progress).map_err(Failure::Wrong)?;
    if let Some(scene) = &scene {
        let budget = if args.quick { Budget::quick() } else { Budget::full() };
        figures.push(scene_figure(scene, &budget, &progress).map_err(Failure::Wrong)?);
    }
    bar.finish_and_clear();
    for figure in figures.iter().chain([&density()]) {
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
    let written = Destination::at(path).and_then(|file| file.write(|sink| sink.write_all(bytes)));
    written.map_err(|error| unwritable(path, &error))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("error: cannot write `{}`: {error}", path.display()))
}
