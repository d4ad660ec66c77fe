//! `velour live`: a page that shows a scene or a shader while it is edited.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::keep::Signals;
use super::speak::{say, tell};
use super::threads::capped;
use super::viewer::viewer;
use crate::live::{Live, Showing, Source};
use crate::render::{Screen, Settings, View};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Arguments of `velour live`.
#[derive(clap::Args)]
pub struct LiveArgs {
    /// A shader, shown on a built-in scene, or a scene
    #[arg(value_name = "FILE.osl | SCENE.xml")]
    file: String,
    /// The port of 127.0.0.1 [default: 7345, or a free one if that is taken]
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Width and height in pixels [default: what the scene states, or 640 480]
    #[arg(short, long, num_args = 2, value_names = ["W", "H"])]
    res: Vec<u32>,
    /// The most samples a pixel
    #[arg(long, default_value_t = 4096, value_name = "N")]
    spp: u32,
    /// Sample each tile until its error (root mean square, in units of radiance) is below N
    #[arg(long, default_value_t = 0.002, value_name = "N")]
    noise: f32,
    /// How light becomes the colors of a screen, until the page says otherwise: soft, srgb, agx or linear
    #[arg(long, default_value = "soft")]
    view: View,
    /// Also show the picture in tev, which listens at 127.0.0.1:14158 unless told otherwise
    #[arg(long, value_name = "HOST[:PORT]")]
    tev: Option<String>,
    /// Threads, at most four a core; 0 for one a core
    #[arg(short, long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// Folders to look for shaders and meshes in, after the scene's own; separated by colons
    #[arg(long, value_name = "DIRS", value_delimiter = ':')]
    path: Vec<PathBuf>,
    #[command(flatten)]
    compile: CompileArgs,
}

/// How often it is looked whether somebody has asked to end.
const STEP: Duration = Duration::from_millis(50);

/// Serves the page until a signal comes.
pub fn run(args: &LiveArgs) -> Result<(), Failure> {
    if args.res.len() > 2 {
        let text = "error: --res is given once\n  help: take one of them out";
        return Err(Failure::Usage(text.to_owned()));
    }
    let source = Source {
        argument: args.file.clone(),
        search: args.path.clone(),
        compiler: args.compile.compiler()?,
        strict: false,
    };
    let resolution = <[u32; 2]>::try_from(&args.res[..]).ok();
    let defaults = Settings::default();
    let [width, height] = resolution.unwrap_or([defaults.width, defaults.height]);
    let settings = Settings {
        width,
        height,
        samples: args.spp,
        noise: Some(args.noise),
        threads: capped(args.threads),
        ..defaults
    };
    let signals = Signals::listen(&Arc::new(AtomicBool::new(false)))?;
    let screen = Screen { view: args.view, ..Screen::default() };
    let tev = viewer(args.tev.as_deref(), &args.file)?;
    let live = Live::start(source, &settings, Showing { resolution, screen, port: args.port, tev })
        .map_err(|error| Failure::Usage(format!("error: {error}")))?;
    say(&format!("http://{}/ shows {}; Ctrl-C ends it\n", live.address(), args.file));
    let mut told = None;
    loop {
        let trouble = live.trouble();
        if trouble != told {
            tell(&format!("{}\n", trouble.as_deref().map_or("it is right again", str::trim_end)));
            told = trouble;
        }
        if let Some(status) = signals.asked() {
            return Err(Failure::Stopped(status));
        }
        std::thread::park_timeout(STEP);
    }
}
