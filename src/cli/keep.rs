//! What a render keeps: a part now and then while it runs, and what there is when it is stopped.

use super::failure::Failure;
use super::speak::tell;
use crate::files::Room;
use crate::live::Tev;
use crate::render::part::{self, Part};
use crate::render::{Progress, Renderer, Screen, output};
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The signals that ask a render to end, and what it ends with then.
const SIGNALS: [(i32, u8); 2] = [(SIGINT, 130), (SIGTERM, 143)];

/// Whether somebody has asked this process to end.
///
/// The first signal asks, the second one ends the process where it is.
pub struct Signals([Arc<AtomicBool>; 2]);

impl Signals {
    /// Listens from now on, and has `stop` set by either.
    pub fn listen(stop: &Arc<AtomicBool>) -> Result<Self, Failure> {
        let asked = [Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false))];
        for ((signal, status), flag) in SIGNALS.into_iter().zip(&asked) {
            // In this order: the one that looks at `stop` comes before the one that sets it.
            let second = signal_hook::flag::register_conditional_shutdown(signal, i32::from(status), stop.clone());
            let first = second.and_then(|_| signal_hook::flag::register(signal, flag.clone()));
            let all = first.and_then(|_| signal_hook::flag::register(signal, stop.clone()));
            all.map_err(|error| Failure::Usage(format!("error: signals cannot be listened to: {error}")))?;
        }
        Ok(Signals(asked))
    }

    /// The exit status that goes with what was asked, if anything was.
    pub fn asked(&self) -> Option<u8> {
        let asked = SIGNALS.iter().zip(&self.0).find(|(_, flag)| flag.load(Ordering::Relaxed));
        asked.map(|((_, status), _)| *status)
    }
}

/// Samples of each pixel from one round to the next: as many as fill a wave. A render that is stopped has whole rounds of all pixels, and
/// of some pixels one more.
const SAMPLES_A_ROUND: u32 = 32;

/// When a viewer sees something first, and how often then; seldomer where a picture takes long to make.
const FIRST_SHOWN: Duration = Duration::from_millis(200);
const SHOWN_EVERY: Duration = Duration::from_millis(500);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// A bar on a terminal, nothing elsewhere; stops a round when a part is to be written.
struct Watch {
    bar: ProgressBar,
    due: Option<Instant>,
    /// What part of the whole was done before this round, and what this round adds.
    share: [f64; 2],
}

impl Progress for Watch {
    fn tiles(&self, done: usize, total: usize) {
        let [before, round] = self.share;
        self.bar.set_position((STEPS * (before + round * done as f64 / total.max(1) as f64)) as u64);
    }

    fn cancelled(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }
}

/// Parts that were not kept on the way: each reason is told once, the others are counted.
#[derive(Default)]
struct Missed {
    reason: String,
    more: u32,
}

impl Missed {
    fn tell(&mut self, reason: String) {
        if self.reason == reason {
            self.more += 1;
            return;
        }
        self.sum_up();
        tell(&format!("warning: this part of the picture was not kept: {reason}\n"));
        *self = Missed { reason, more: 0 };
    }

    /// Says how many there were of the last reason.
    fn sum_up(&self) {
        if self.more > 0 {
            tell(&format!("warning: and {} more parts for that reason\n", self.more));
        }
    }
}

/// What has become of a render.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// All was done.
    pub done: bool,
    /// A part was written on the way.
    pub kept: bool,
}

/// Where parts go, and how often.
pub struct Keeping<'a> {
    /// The picture.
    pub output: &'a Path,
    /// Seconds from one part to the next; none are written while it runs where there is no number.
    pub every: Option<f64>,
    /// The file itself is a part when it is done.
    pub parts: bool,
    /// The part that the render goes on from.
    pub resumed: Option<&'a Path>,
    /// How a PNG shows light.
    pub screen: Screen,
    /// A viewer that sees the picture grow.
    pub tev: Option<&'a Tev>,
}

impl Keeping<'_> {
    /// The file of parts: the picture itself where it is an EXR, one beside it where it is not; none beside a stream.
    pub fn part_file(&self) -> Option<PathBuf> {
        let special = self.output.exists() && !self.output.is_file();
        if special || output::is_standard_output(self.output) {
            return None;
        }
        if self.is_exr() {
            return Some(self.output.to_owned());
        }
        let mut name = self.output.as_os_str().to_owned();
        name.push(".part.exr");
        Some(PathBuf::from(name))
    }

    fn is_exr(&self) -> bool {
        output::format(self.output).is_ok_and(|format| format == output::Format::Exr)
    }

    /// Renders to the end, or until it is asked to stop; writes parts on the way.
    pub fn render(&self, renderer: &mut Renderer, signals: &Signals) -> Result<Outcome, Failure> {
        // indicatif draws nothing when standard error is no terminal.
        let bar = ProgressBar::new(STEPS as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        // Above this the clock has no number.
        let every = self.every.filter(|_| self.part_file().is_some()).map(|s| Duration::from_secs_f64(s.min(1e9)));
        let due = || every.map(|every| Instant::now() + every);
        let (mut part_due, mut shown_due) = (due(), self.tev.map(|_| Instant::now() + FIRST_SHOWN));
        let mut watch = Watch { bar, due: None, share: [0.0, 1.0] };
        let (mut kept, mut missed) = (false, Missed::default());
        // Rounds of a render that stops by itself are its own.
        let settings = renderer.settings();
        let (adapts, wanted) = (settings.adapts(), f64::from(settings.samples - settings.first_sample));
        let most = if adapts { u32::MAX } else { SAMPLES_A_ROUND };
        let done = loop {
            if !adapts {
                let before = f64::from(renderer.taken()[0]) / wanted;
                watch.share = [before.min(1.0), f64::from(most) / wanted];
            }
            watch.due = part_due.into_iter().chain(shown_due).min();
            let left = renderer.round_of(most, &watch).map_err(Failure::of_render)?;
            if !left || signals.asked().is_some() {
                break !left;
            }
            let now = Instant::now();
            if part_due.is_some_and(|due| now >= due) {
                kept |= self.checkpoint(&renderer.part(), &mut missed);
                part_due = due();
            }
            if let Some(tev) = self.tev.filter(|_| shown_due.is_some_and(|due| now >= due)) {
                tev.show(renderer.picture());
                shown_due = Some(Instant::now() + SHOWN_EVERY.max(10 * now.elapsed()));
            }
        };
        watch.bar.finish_and_clear();
        missed.sum_up();
        Ok(Outcome { done, kept })
    }

    /// Writes a part while the render goes on, which a disk that is full for a while does not end; true when it is there.
    fn checkpoint(&self, part: &Part, missed: &mut Missed) -> bool {
        let Some(path) = self.part_file() else { return false };
        let written = part::write(part, &path);
        if let Err(message) = &written {
            missed.tell(message.to_string());
        }
        written.is_ok()
    }

    /// Writes what a finished or a stopped render leaves, the picture's file into `room`.
    pub fn write(&self, renderer: &Renderer, outcome: Outcome, room: Option<Room>) -> Result<(), Failure> {
        let done = outcome.done;
        let part_file = self.part_file();
        let beside = part_file.as_ref().filter(|file| *file != self.output);
        let failed = |message| Failure::Usage(format!("error: {message}{}", self.rescue(renderer)));
        let is_part = self.is_exr() && (self.parts || !done);
        let part = (is_part || !done).then(|| renderer.part());
        let picture = part.as_ref().map_or_else(|| renderer.picture(), Part::picture);
        if let Some(tev) = self.tev {
            tev.show(picture.clone());
        }
        if let (Some(part), Some(file)) = (part.as_ref().filter(|_| !done), beside) {
            // The samples first: a picture of them can be made at any time.
            part::write_into(part, &picture, file, None).map_err(failed)?;
        }
        let written = match &part {
            Some(part) if is_part => part::write_into(part, &picture, self.output, room),
            _ => output::write_into(&picture, self.output, &self.screen, room),
        };
        written.map_err(failed)?;
        // A part that was written on the way, or gone on from, has done its work; one that another render has left is that one's.
        if let Some(file) = beside.filter(|file| done && (outcome.kept || self.resumed == Some(file))) {
            let _ = std::fs::remove_file(file);
        }
        if let Some(part) = part.filter(|_| !done) {
            self.tell_stopped(&part, renderer.settings().adapts(), part_file.as_deref());
        }
        Ok(())
    }

    /// Says what a stopped render has left, and how to go on.
    fn tell_stopped(&self, part: &Part, adapts: bool, part_file: Option<&Path>) {
        let held = part.summary();
        let go_on = match part_file {
            Some(file) if adapts => {
                format!("; `--resume {} --spp N` instead of --noise or --time adds more", file.display())
            }
            Some(file) => format!("; `--resume {}` goes on", file.display()),
            None => String::new(),
        };
        tell(&format!("stopped: {} holds {held}{go_on}\n", self.output.display()));
    }

    /// Where the picture goes when its file cannot be written: into the folder for temporary files.
    fn rescue(&self, renderer: &Renderer) -> String {
        let name = self.output.file_name().unwrap_or_default().to_string_lossy();
        // A folder is made or not: nobody can have put a link in its place.
        let nanoseconds = std::time::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_nanos());
        let folder = std::env::temp_dir().join(format!("velour-{}-{nanoseconds}", std::process::id()));
        if let Err(error) = std::fs::create_dir(&folder) {
            return format!("\n  nor were its samples kept elsewhere: {}: {error}", folder.display());
        }
        let path = folder.join(format!("{name}.part.exr"));
        match part::write(&renderer.part(), &path) {
            Ok(()) => {
                format!("\n  help: its samples are in {}; `velour merge` makes a picture of them", path.display())
            }
            Err(message) => format!("\n  nor were its samples kept elsewhere: {message}"),
        }
    }
}
