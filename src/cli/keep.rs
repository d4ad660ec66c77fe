//! What a render keeps: a part now and then while it runs, and what there is when it is stopped.

use super::failure::Failure;
use super::speak::tell;
use crate::render::part::{self, Part};
use crate::render::{Progress, Renderer, output};
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
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
            // In this order: the one that looks at the flag comes before the one that sets it.
            let second = signal_hook::flag::register_conditional_shutdown(signal, i32::from(status), flag.clone());
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

/// A bar on a terminal, nothing elsewhere; stops a round when a part is to be written.
struct Watch {
    bar: ProgressBar,
    due: Option<Instant>,
    /// Tiles that the rounds before this one have done.
    before: AtomicUsize,
    total: AtomicUsize,
}

impl Progress for Watch {
    fn tiles(&self, done: usize, total: usize) {
        // A round that goes on where another was stopped has fewer tiles than all.
        let all = self.total.fetch_max(total, Ordering::Relaxed).max(total);
        self.before.fetch_max(all - total + done, Ordering::Relaxed);
        self.bar.set_length(all as u64);
        self.bar.set_position(self.before.load(Ordering::Relaxed) as u64);
    }

    fn cancelled(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }
}

/// Where parts go, and how often.
pub struct Keeping<'a> {
    /// The picture.
    pub output: &'a Path,
    /// Seconds from one part to the next; none are written while it runs where there is no number.
    pub every: Option<f64>,
    /// The file itself is a part when it is done.
    pub parts: bool,
}

impl Keeping<'_> {
    /// The file of parts: the picture itself where it is an EXR, one beside it where it is not; none beside a stream.
    pub fn part_file(&self) -> Option<PathBuf> {
        if output::is_standard_output(self.output) || self.output.exists() && !self.output.is_file() {
            return None;
        }
        if self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            return Some(self.output.to_owned());
        }
        let mut name = self.output.as_os_str().to_owned();
        name.push(".part.exr");
        Some(PathBuf::from(name))
    }

    /// Renders to the end, or until it is asked to stop; writes parts on the way. True says that all was done.
    pub fn render(&self, renderer: &mut Renderer, signals: &Signals) -> Result<bool, Failure> {
        let bar = ProgressBar::new(0);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        let every = self.every.filter(|_| self.part_file().is_some()).map(Duration::from_secs_f64);
        let due = || every.map(|every| Instant::now() + every);
        let (before, total) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let mut watch = Watch { bar, due: due(), before, total };
        let done = loop {
            let left = renderer.round(&watch).map_err(Failure::of_render)?;
            if !left || signals.asked().is_some() {
                break !left;
            }
            if watch.due.is_some_and(|due| Instant::now() >= due) {
                self.checkpoint(&renderer.part());
                watch.due = due();
            }
        };
        watch.bar.finish_and_clear();
        Ok(done)
    }

    /// Writes a part while the render goes on, which a disk that is full for a while does not end.
    fn checkpoint(&self, part: &Part) {
        let Some(path) = self.part_file() else { return };
        if let Err(message) = part::write(part, &path) {
            tell(&format!("warning: this part of the picture was not kept: {message}\n"));
        }
    }

    /// Writes what a finished or a stopped render leaves.
    pub fn write(&self, renderer: &Renderer, done: bool) -> Result<(), Failure> {
        let part_file = self.part_file();
        let beside = part_file.as_ref().filter(|file| *file != self.output);
        let is_part = part_file.is_some() && beside.is_none() && (self.parts || !done);
        let written = if is_part {
            part::write(&renderer.part(), self.output)
        } else {
            output::write(&renderer.picture(), self.output)
        };
        if let Err(message) = written {
            return Err(Failure::Usage(format!("error: {message}{}", self.rescue(renderer))));
        }
        match beside {
            // A part that was written on the way has done its work; there may be none.
            Some(file) if done => drop(std::fs::remove_file(file)),
            Some(file) => {
                let kept = part::write(&renderer.part(), file);
                kept.map_err(|message| Failure::Usage(format!("error: {message}")))?;
            }
            None => {}
        }
        if !done {
            self.tell_stopped(renderer, part_file.as_deref());
        }
        Ok(())
    }

    /// Says what a stopped render has left, and how to go on.
    fn tell_stopped(&self, renderer: &Renderer, part_file: Option<&Path>) {
        let held = renderer.part().summary();
        let go_on = match part_file {
            Some(file) if renderer.settings().adapts() => {
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
        let path = std::env::temp_dir().join(format!("velour-{}-{name}.part.exr", std::process::id()));
        match part::write(&renderer.part(), &path) {
            Ok(()) => {
                format!("\n  help: its samples are in {}; `velour merge` makes a picture of them", path.display())
            }
            Err(_) => String::new(),
        }
    }
}
