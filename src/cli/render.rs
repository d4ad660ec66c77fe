//! `velour render`: a scene in, an image out.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::keep::{Keeping, Signals};
use super::merge::part_of;
use super::said::{debug_pixel, pass_on};
use super::screen::ScreenArgs;
use super::share::Share;
use super::sheet::{Sheet, Sweep};
use super::speak::{leave_output, say, tell};
use super::subject::Subject;
use super::threads::capped;
use super::viewer::{farewell, viewer};
use super::watch::TimeBound;
use crate::closure::settings::{Shadowing, SheenAlbedo, SheenSampling};
use crate::closure::{self, Layering};
use crate::files::Room;
use crate::live::Tev;
use crate::measure::choose::{Asked, Candidate, Reason, choose};
use crate::render::part::Ranges;
use crate::render::{
    About, Explanation, Filter, Frame, LightChoice, LightPoints, Renderer, Settings, Terminator, output,
};
use crate::scene::{Options, Scene, ShaderFiles};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `velour render`.
#[derive(clap::Args)]
pub struct RenderArgs {
    /// A scene file, the text of a scene, or a shader (.osl), which is shown on a ball and a cloth
    scene: String,
    /// The image: .exr (linear, with a note of how it was made), .png or .hdr
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The image, as testrender takes it
    #[arg(value_name = "IMAGE", conflicts_with = "output")]
    image: Option<PathBuf>,
    /// Threads, at most four a core; 0 for one a core
    #[arg(short, long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// Width and height in pixels [default: what the scene states, or 640 480]
    #[arg(short, long, num_args = 2, value_names = ["W", "H"])]
    res: Vec<u32>,
    /// Set a parameter, NAME of a shader, or NAME, LAYER.NAME, GROUP.NAME or GROUP.LAYER.NAME of a scene: numbers with commas between, or a string
    #[arg(long, num_args = 2, value_names = ["NAME", "VALUE"], allow_hyphen_values = true, action = clap::ArgAction::Append)]
    param: Vec<String>,
    /// Make a sheet of pictures with a parameter at N values, such as roughness 0.1:1:10; a second one goes down
    #[arg(long, num_args = 2, value_names = ["NAME", "FROM:TO:N"], allow_hyphen_values = true, action = clap::ArgAction::Append,
          conflicts_with_all = ["samples", "share", "resume", "time", "debug_pixel", "crop"])]
    sweep: Vec<String>,
    /// Also show the picture in tev while it grows; tev listens at 127.0.0.1:14158 unless told otherwise
    #[arg(long, value_name = "HOST[:PORT]")]
    tev: Option<String>,
    #[command(flatten)]
    screen: ScreenArgs,
    /// Print what shaders say at this pixel, layer by layer, and render nothing
    #[arg(long, num_args = 2, value_names = ["X", "Y"])]
    debug_pixel: Vec<u32>,
    /// N x N samples a pixel
    #[arg(long, value_name = "N", conflicts_with = "spp")]
    aa: Option<u32>,
    /// Samples a pixel [default: 64]; the most of them with --noise or --time [default: 65536]
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Sample each tile until its error (root mean square, in units of radiance) is below N, such as 0.01
    #[arg(long, value_name = "N")]
    noise: Option<f32>,
    /// Stop after S seconds; samples go where they lower the error most
    #[arg(long, value_name = "S")]
    time: Option<f64>,
    /// Render these samples of each pixel alone, such as 64..128, and leave a part for `velour merge`
    #[arg(long, value_name = "A..B", conflicts_with_all = ["spp", "aa", "noise", "time"])]
    samples: Option<Ranges>,
    /// Render share K of N of all samples alone, such as 3/8, and leave a part for `velour merge`
    #[arg(long, value_name = "K/N", conflicts_with_all = ["samples", "noise", "time"])]
    share: Option<Share>,
    /// Go on from this part, which a stopped render or --samples has left; the picture goes there if no other is named
    #[arg(long, value_name = "PART", conflicts_with_all = ["noise", "time"])]
    resume: Option<PathBuf>,
    /// Keep what there is every S seconds, for --resume; 0 keeps nothing before the end or a signal
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = checkpoint)]
    checkpoint: f64,
    /// Do not hold room on the disk for the picture while it renders
    #[arg(long)]
    no_hold: bool,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u32,
    /// The most bounces of a path [default: what the scene states, or until nothing is left]
    #[arg(long, value_name = "N")]
    max_bounces: Option<u32>,
    /// Folders to look for shaders and meshes in, after the scene's own; separated by colons
    #[arg(long, value_name = "DIRS", value_delimiter = ':')]
    path: Vec<PathBuf>,
    /// Megabytes that textures may take together [default: half of the memory]
    #[arg(long, value_name = "MB")]
    texture_memory: Option<u64>,
    /// How a base is scaled under its layer: min, view, kelemen or lossless
    #[arg(long, default_value = "min")]
    layering: Layering,
    /// Shadowing term of sheen: exact, published, ashikhmin or series [default: exact]
    #[arg(long)]
    shadowing: Option<Shadowing>,
    /// How the albedo of sheen is found under an exact shadowing term: short, fit, long or table [default: fit]
    #[arg(long)]
    albedo: Option<SheenAlbedo>,
    /// Take the cheapest methods whose measured error is at most this; --shadowing and --albedo win over it
    #[arg(long, value_name = "ERROR", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// Soften the terminator of sheen by eq. 4 of the paper: true or false
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set, value_name = "BOOL")]
    softening: bool,
    /// Render W x H pixels alone, from the pixel X Y of the picture on
    #[arg(long, num_args = 4, value_names = ["X", "Y", "W", "H"])]
    crop: Vec<u32>,
    /// How samples count for pixels: tent (the least noise), box (no two pixels share noise, for denoisers) or blackman-harris
    #[arg(long, default_value = "tent")]
    filter: Filter,
    /// Send every sample through its pixel's centre
    #[arg(long)]
    no_jitter: bool,
    /// Keep an alpha channel: colors are premultiplied, and the background is left out of them
    #[arg(long)]
    alpha: bool,
    /// How directions of sheen are drawn: ltc, uniform, cosine or normals
    #[arg(long, default_value = "ltc")]
    sheen_sampling: SheenSampling,
    /// How a light is chosen among several: tree (by place) or power
    #[arg(long, default_value = "tree")]
    light_choice: LightChoice,
    /// How a point of a flat light is chosen: solid (by solid angle) or area
    #[arg(long, default_value = "solid")]
    light_points: LightPoints,
    /// What is done about facets at the terminator of meshes with smooth normals: origin (light arrives at the smooth surface),
    /// factor (it fades before a facet turns away) or none
    #[arg(long, default_value = "origin")]
    terminator: Terminator,
    /// Say what the scene needs, and what it does not, before rendering
    #[arg(long)]
    explain: bool,
    /// Refuse a scene that gives a shader a parameter it does not have; without, that is a warning
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    compile: CompileArgs,
    #[command(flatten)]
    testrender: TestrenderArgs,
}

impl RenderArgs {
    /// Is the picture to be a part, which more samples can be added to?
    fn leaves_part(&self) -> bool {
        self.samples.is_some() || self.share.is_some() || self.resume.is_some()
    }
}

/// What testrender's command line may say and this renderer has no use for.
#[derive(clap::Args)]
struct TestrenderArgs {
    /// Taken as testrender takes it; changes nothing
    #[arg(short = 'v', hide = true)]
    verbose: bool,
    /// Taken as testrender takes it; changes nothing
    #[arg(long, hide = true)]
    runstats: bool,
    /// Taken as testrender takes it; changes nothing
    #[arg(long = "llvm_opt", hide = true, value_name = "LEVEL")]
    llvm_opt: Option<String>,
    /// Taken as testrender takes it; changes nothing
    #[arg(long, hide = true, value_name = "TEXT")]
    options: Option<String>,
}

impl TestrenderArgs {
    /// Says which of them are there.
    fn note(&self) {
        let given = [
            (self.verbose, "-v"),
            (self.runstats, "--runstats"),
            (self.llvm_opt.is_some(), "--llvm_opt"),
            (self.options.is_some(), "--options"),
        ];
        for (_, flag) in given.iter().filter(|(given, _)| *given) {
            tell(&format!("note: {flag} is of testrender and changes nothing here\n"));
        }
    }
}

/// Renders the scene and writes the image.
pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let path = args.output.as_ref().or(args.image.as_ref()).or(args.resume.as_ref());
    let none = || Failure::Usage("error: no image is named\n  help: add `-o picture.png`".to_owned());
    // To look at one pixel no image is needed.
    let debug = <[u32; 2]>::try_from(&args.debug_pixel[..]).ok();
    let path = match (path, debug) {
        (None, Some(_)) => Path::new(""),
        (path, _) => path.ok_or_else(none)?,
    };
    if debug.is_none() {
        check_output(args, path)?;
    }
    if args.res.len() > 2 || args.debug_pixel.len() > 2 || args.crop.len() > 4 {
        let text = "error: --res, --crop and --debug-pixel are given once\n  help: take one of them out";
        return Err(Failure::Usage(text.to_owned()));
    }
    if output::is_standard_output(path) {
        leave_output();
    }
    let tev = viewer(args.tev.as_deref(), &path.to_string_lossy())?;
    let loading = TimeBound::new(start, args.time, "while the scene was made ready");
    settings(args).check().map_err(|message| Failure::Usage(format!("error: {message}")))?;
    args.testrender.note();
    let mut shaders = ShaderFiles::new(args.compile.compiler()?).lenient(!args.strict);
    let sheet = sheet(args)?;
    shaders.set_params(sheet.first());
    let mut scene = sheet.subject.load(&shaders)?;
    let textures = args.texture_memory.map(|megabytes| megabytes.saturating_mul(1 << 20));
    if let Some(bytes) = textures.or(args.compile.memory.map(|bytes| bytes / 2)) {
        scene.textures = Arc::new(scene.textures.limited(bytes));
    }
    for warning in &scene.warnings {
        tell(&format!("{warning}\n"));
    }
    let mut settings = settings_for(args, &scene, start)?;
    if !sheet.sweeps.is_empty() {
        settings = sheet.settings(&settings, !args.res.is_empty());
    }
    if let Some(tolerance) = args.tolerance {
        settings.closure = chosen(args, tolerance, settings.closure);
    }
    if args.explain {
        say(&Explanation::new(&scene, &settings).to_string());
    }
    let mut renderer = Renderer::new(&scene, &settings).map_err(Failure::of_render)?;
    drop(loading);
    warn_of_black(&renderer, &sheet.subject);
    if let Some(pixel) = debug {
        return debug_pixel(&renderer, pixel);
    }
    if !sheet.sweeps.is_empty() {
        return render_sheet(args, &sheet, (renderer, &scene, &mut shaders), path, (start, tev));
    }
    go_on(args, &mut renderer)?;
    let every = Some(args.checkpoint).filter(|seconds| *seconds > 0.0);
    let screen = args.screen.screen();
    let (parts, resumed) = (args.leaves_part(), args.resume.as_deref());
    let keeping = Keeping { output: path, every, parts, resumed, screen, tev: tev.as_ref() };
    let room = if args.no_hold { None } else { Some(hold(path, &renderer, args.leaves_part())?) };
    let signals = Signals::listen(renderer.stop())?;
    let outcome = keeping.render(&mut renderer, &signals)?;
    let about = renderer.about();
    pass_on(&about.reports);
    keeping.write(&renderer, outcome, room)?;
    farewell(tev);
    if let Some(status) = signals.asked().filter(|_| !outcome.done) {
        return Err(Failure::Stopped(status));
    }
    tell(&last_line(&about, renderer.settings(), path, start.elapsed().as_secs_f64()));
    Ok(())
}

/// Values of parameters, and the sheet of those that are swept; a sheet without a sweep is a picture.
fn sheet(args: &RenderArgs) -> Result<Sheet<'_>, Failure> {
    let subject = Subject { argument: &args.scene, search: &args.path };
    let fixed = args.param.chunks(2).map(|pair| (subject.param(&pair[0]), pair[1].clone())).collect();
    let sweeps = args.sweep.chunks(2).map(|pair| Sweep::read(&pair[0], &pair[1]));
    let sweeps =
        sweeps.collect::<Result<Vec<_>, _>>().map_err(|message| Failure::Usage(format!("error: {message}")))?;
    if sweeps.len() > 2 {
        return Err(Failure::Usage("error: --sweep is given twice at most, across and down".to_owned()));
    }
    Ok(Sheet { subject, fixed, sweeps })
}

/// Renders a sheet and writes it, also as far as it has come when it is stopped.
fn render_sheet(
    args: &RenderArgs,
    sheet: &Sheet,
    (renderer, scene, shaders): (Renderer, &Scene, &mut ShaderFiles),
    path: &Path,
    (start, tev): (Instant, Option<Tev>),
) -> Result<(), Failure> {
    let signals = Signals::listen(renderer.stop())?;
    let image = sheet.render(renderer, scene, shaders, &signals)?;
    pass_on(&image.about.reports);
    output::write_as(&image, path, &args.screen.screen()).map_err(|error| Failure::Usage(format!("error: {error}")))?;
    tev.iter().for_each(|tev| tev.show(image.clone()));
    farewell(tev);
    if let Some(status) = signals.asked() {
        tell(&format!("stopped: {} holds the cells that were done\n", path.display()));
        return Err(Failure::Stopped(status));
    }
    let (cells, seconds) = (sheet.cells(), start.elapsed().as_secs_f64());
    tell(&format!("{}: {} x {}, {cells} cells, {seconds:.2} s\n", path.display(), image.width, image.height));
    Ok(())
}

/// Says what must be black.
fn warn_of_black(renderer: &Renderer, subject: &Subject) {
    if !renderer.plan().gives_light() {
        tell("warning: nothing in the scene gives light, so it is black\n");
    }
    let mut black = renderer.plan().black(renderer.scene());
    if subject.is_shader() && black.next().is_some() {
        let file = subject.argument;
        tell(&format!("{file}: warning: the shader gives `Ci` no closure and puts nothing else out, so it is black\n"));
    }
    for material in black.filter(|_| !subject.is_shader()) {
        let (place, name) = (&material.place, &material.name);
        tell(&format!("{place}: warning: shader group `{name}` gives `Ci` no closure, so what it shades is black\n"));
    }
}

/// The settings of the command and the scene together.
fn settings_for(args: &RenderArgs, scene: &Scene, start: Instant) -> Result<Settings, Failure> {
    // What the command line says goes before what the scene does.
    let said = args.spp.is_some() || args.aa.is_some();
    let options = Options {
        aa: scene.options.aa.filter(|_| !said),
        max_bounces: scene.options.max_bounces.filter(|_| args.max_bounces.is_none()),
        ..scene.options
    };
    let mut settings = settings(args).with_options(&options);
    if let Some(range) = args.samples.as_ref().and_then(|ranges| ranges.iter().next()) {
        (settings.first_sample, settings.samples) = (range.start, range.end);
    }
    if let Some(share) = args.share {
        let few = format!("error: {} samples are too few for so many shares", settings.samples);
        let few = || Failure::Usage(format!("{few}\n  help: take fewer shares, or more samples with --spp"));
        let range = share.range(settings.samples).ok_or_else(few)?;
        (settings.first_sample, settings.samples) = (range.start, range.end);
    }
    if let ([], Some(stated)) = (&args.res[..], scene.options.resolution) {
        [settings.width, settings.height] = stated;
    }
    if let Ok([x, y, width, height]) = <[u32; 4]>::try_from(&args.crop[..]) {
        settings.frame = Some(Frame { size: [settings.width, settings.height], at: [x, y] });
        (settings.width, settings.height) = (width, height);
    }
    settings.check().map_err(|message| Failure::Usage(format!("error: {message}")))?;
    settings.threads = capped(args.threads);
    settings.seconds = args.time.map(|seconds| time_to_trace(seconds, start, &settings));
    Ok(settings)
}

/// Goes on from the part of `--resume`, if there is one.
fn go_on(args: &RenderArgs, renderer: &mut Renderer) -> Result<(), Failure> {
    let Some(file) = &args.resume else { return Ok(()) };
    let part = part_of(&args.compile.access()?, file)?;
    renderer.resume(part).map_err(|error| Failure::Wrong(format!("error: {error}")))
}

/// Holds room on the disk for what the render will write.
fn hold(path: &Path, renderer: &Renderer, part: bool) -> Result<Room, Failure> {
    let help = "help: make room, name a file elsewhere with -o, or render with --no-hold and hope";
    output::hold(path, renderer.settings(), part).map_err(|error| Failure::Usage(format!("error: {error}\n  {help}")))
}

/// Says before the render what could not be written after it.
fn check_output(args: &RenderArgs, path: &Path) -> Result<(), Failure> {
    let format = output::check(path).map_err(|message| Failure::Usage(format!("error: {message}")))?;
    if format != output::Format::Png && args.screen.is_given() {
        tell("note: --view and --exposure are of .png; this file keeps linear light as it is\n");
    }
    let usage = |text: &str| Err(Failure::Usage(format!("error: {text}")));
    if args.samples.as_ref().is_some_and(|ranges| ranges.iter().count() != 1) {
        return usage("--samples takes one range, such as 64..128\n  help: render the ranges apart and merge them");
    }
    if (args.samples.is_some() || args.share.is_some()) && format != output::Format::Exr {
        return usage(
            "--samples and --share leave a part of a picture, which is an .exr\n  help: `velour merge part.exr -o picture.png` makes another file of it",
        );
    }
    Ok(())
}

fn settings(args: &RenderArgs) -> Settings {
    let defaults = Settings::default();
    let adapts = args.noise.is_some() || args.time.is_some();
    let [width, height] = <[u32; 2]>::try_from(&args.res[..]).unwrap_or([defaults.width, defaults.height]);
    Settings {
        width,
        height,
        samples: args.spp.or(args.aa.map(|aa| aa.saturating_mul(aa))).unwrap_or(if adapts { 1 << 16 } else { 64 }),
        noise: args.noise,
        seconds: args.time,
        seed: args.seed,
        threads: args.threads,
        max_bounces: args.max_bounces.unwrap_or(defaults.max_bounces),
        jitter: !args.no_jitter,
        filter: args.filter,
        alpha: args.alpha,
        light_choice: args.light_choice,
        light_points: args.light_points,
        terminator: args.terminator,
        closure: closure::Settings {
            layering: args.layering,
            shadowing: args.shadowing.unwrap_or_default(),
            sheen_sampling: args.sheen_sampling,
            softening: args.softening,
            sheen_albedo: args.albedo.unwrap_or_default(),
        },
        ..defaults
    }
}

/// Seconds between parts: 0, or enough for something to be done in between.
fn checkpoint(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    let known = value == 0.0 || (value >= 0.01 && value.is_finite());
    if known { Ok(value) } else { Err("seconds are 0 or at least 0.01".to_owned()) }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("a tolerance is a number above 0".to_owned()) }
}

/// The closures' settings for a tolerance; says what was asked for against it, and what no method reaches.
fn chosen(args: &RenderArgs, tolerance: f64, closure: closure::Settings) -> closure::Settings {
    let choice = choose(tolerance, Asked { shadowing: args.shadowing, albedo: args.albedo }, closure);
    if args.explain {
        say(&choice.to_string());
    }
    for pick in choice.missed() {
        let Candidate { method, error, .. } = &pick.taken;
        let why = if pick.reason == Reason::Asked { "was asked for" } else { "is the most exact" };
        tell(&format!(
            "warning: {}: {method} {why}, with an error of {error:.1e} above the tolerance of {tolerance:e}\n",
            pick.place
        ));
    }
    choice.closure
}

/// What loading has left of a time, and writing the picture will need of it: a tenth of a microsecond a pixel.
fn time_to_trace(seconds: f64, start: Instant, settings: &Settings) -> f64 {
    let writing = f64::from(settings.width) * f64::from(settings.height) * 1e-7;
    (seconds - start.elapsed().as_secs_f64() - writing.min(0.5 * seconds)).max(1e-3)
}

fn last_line(about: &About, settings: &Settings, path: &std::path::Path, seconds: f64) -> String {
    let rate = about.paths as f64 / about.seconds_tracing.max(1e-9) / 1e6;
    let [fewest, most] = about.taken;
    let samples = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    let noise = about.noise.map_or(String::new(), |noise| format!("error {noise:.2e}, "));
    format!(
        "{}: {} x {}, {samples} samples a pixel, {noise}{seconds:.2} s, {rate:.2} million paths a second\n",
        path.display(),
        settings.width,
        settings.height,
    )
}
