//! A grid of points under way: batches, what they say, and what they put out.

use super::grid;
use super::options::Options;
use super::save::{Grid, Numbers, save};
use super::wording::line;
use crate::cli::failure::Failure;
use crate::cli::speak::{say, tell};
use crate::cli::threads::capped;
use crate::exec::{Group, Host, MAX_LANES, Machine, Points, Report, ReportKind};
use crate::ops::format::{FormatArg, format};
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Batches that are shaded before what they say is told.
const WAVE: usize = 64;

/// An output that was asked for and that the group has.
struct Output {
    name: String,
    file: PathBuf,
    grid: Grid,
}

impl Output {
    /// Is it for more than to look at?
    fn kept(&self) -> bool {
        self.file.as_os_str() != "null"
    }
}

/// A machine and the points it works on; both keep their memory from batch to batch.
struct Desk {
    machine: Machine,
    points: Points,
}

impl Desk {
    fn new(host: &Arc<dyn Host>) -> Self {
        Desk { machine: Machine::with_host(host.clone()), points: Points::default() }
    }
}

/// A grid that is shaded, once or often.
pub struct Job {
    options: Options,
    host: Arc<dyn Host>,
    ray_type: i32,
    outputs: Vec<Output>,
    /// Messages are told once; `None` where every one is wanted.
    told: Option<HashSet<String>>,
    /// Nothing where one thread does all.
    pool: Option<rayon::ThreadPool>,
    /// One a thread.
    desks: Vec<Mutex<Desk>>,
    /// The group's name.
    group: String,
    seconds: f64,
}

/// What a batch leaves: its reports, and for each output the numbers of its lanes.
struct Shaded {
    reports: Vec<Report>,
    values: Vec<Vec<f32>>,
}

impl Job {
    /// A grid for a group, and the files its outputs go to.
    ///
    /// # Errors
    /// Threads cannot be started.
    pub fn new(options: Options, host: Arc<dyn Host>, group: &Group, group_name: &str) -> Result<Self, Failure> {
        let threads = capped(options.threads);
        let pool = (threads > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build()).transpose();
        let pool = pool.map_err(|error| Failure::Usage(format!("error: threads cannot be started: {error}")))?;
        let repeats = options.is_set("error_repeats", false);
        let mut job = Job {
            ray_type: host.ray_type(&options.raytype),
            desks: (0..threads.max(1)).map(|_| Mutex::new(Desk::new(&host))).collect(),
            options,
            host,
            outputs: Vec::new(),
            told: (!repeats).then(HashSet::new),
            pool,
            group: group_name.to_owned(),
            seconds: 0.0,
        };
        job.find_outputs(group);
        Ok(job)
    }

    /// Finds the outputs that were asked for, and says where they go.
    fn find_outputs(&mut self, group: &Group) {
        for (name, file) in &self.options.outputs {
            let Some((numbers, ints)) = group.output_shape(name) else {
                say(&format!("Output {name} not found, skipping.\n"));
                continue;
            };
            let kept = file.as_os_str() != "null";
            if kept {
                say(&format!("Output {name} to {}\n", file.display()));
            }
            let size = self.options.res;
            let values = if kept { vec![0.0; numbers * size[0] as usize * size[1] as usize] } else { Vec::new() };
            let grid = Grid { size, channels: numbers, ints, values };
            self.outputs.push(Output { name: name.clone(), file: file.clone(), grid });
        }
    }

    /// Shades all points once; `keep` says whether this time what they put out goes to the files.
    ///
    /// # Errors
    /// A shader gave up, or what it prints to a file cannot be written.
    pub fn shade(&mut self, group: &Group, keep: bool) -> Result<(), Failure> {
        let [width, height] = self.options.res.map(|side| side as usize);
        let total = width * height;
        let start = Instant::now();
        let step = MAX_LANES;
        let mut first = 0;
        while first < total {
            let batches: Vec<usize> = (first..total.min(first + WAVE * step)).step_by(step).collect();
            let one = |&at: &usize| self.batch(group, at, step.min(total - at), keep);
            let shaded: Vec<Shaded> = match &self.pool {
                Some(pool) => pool.install(|| batches.par_iter().map(one).collect()),
                None => batches.iter().map(one).collect(),
            };
            for (&at, shaded) in batches.iter().zip(shaded) {
                self.tell(shaded.reports, at, &shaded.values)?;
                for (output, values) in self.outputs.iter_mut().zip(&shaded.values).filter(|_| keep) {
                    let start = at * output.grid.channels;
                    if let Some(out) = output.grid.values.get_mut(start..start + values.len()) {
                        out.copy_from_slice(values);
                    }
                }
            }
            first += WAVE * step;
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Shades the points from one on.
    fn batch(&self, group: &Group, first: usize, len: usize, keep: bool) -> Shaded {
        let run = |desk: &mut Desk| {
            grid::fill(&self.options, self.ray_type, first, len, &mut desk.points);
            desk.machine.shade(group, &desk.points);
            let wanted = |output: &Output| self.options.print || (keep && output.kept());
            let read =
                |output: &Output| if wanted(output) { read(&desk.machine, group, output, len) } else { Vec::new() };
            let values = self.outputs.iter().map(read).collect();
            Shaded { reports: desk.machine.take_reports(), values }
        };
        let desk = rayon::current_thread_index().and_then(|thread| self.desks.get(thread)).or(self.desks.first());
        match desk.map(Mutex::try_lock) {
            Some(Ok(mut desk)) => run(&mut desk),
            // A thread that waits within a batch, for a file that others decode, may begin another one.
            _ => run(&mut Desk::new(&self.host)),
        }
    }

    /// Tells what the points of a batch have said, and with `--print` what they put out.
    fn tell(&mut self, reports: Vec<Report>, first: usize, values: &[Vec<f32>]) -> Result<(), Failure> {
        let mut reports = reports.into_iter().peekable();
        if !self.options.print {
            return reports.try_for_each(|report| self.tell_one(report));
        }
        let len = values.first().zip(self.outputs.first()).map_or(0, |(v, o)| v.len() / o.grid.channels.max(1));
        for lane in 0..len {
            while let Some(report) = reports.next_if(|report| report.lane <= lane) {
                self.tell_one(report)?;
            }
            let at = first + lane;
            let width = self.options.res[0] as usize;
            say(&format!("Pixel ({}, {}):\n", at % width, at / width));
            for (output, values) in self.outputs.iter().zip(values) {
                let channels = output.grid.channels;
                let name = output.name.rsplit('.').next().unwrap_or(&output.name);
                let numbers =
                    values[lane * channels..][..channels].iter().map(|x| format!(" {}", shown(*x, output.grid.ints)));
                say(&format!("  {name} :{}\n", numbers.collect::<String>()));
            }
        }
        reports.try_for_each(|report| self.tell_one(report))
    }

    fn tell_one(&mut self, report: Report) -> Result<(), Failure> {
        match &report.kind {
            ReportKind::Output => say(&report.text),
            // In a sandbox shaders write nothing, as they do in renders.
            ReportKind::File(_) if self.options.sandbox.is_some() => tell(&report.to_string()),
            ReportKind::File(name) => append(name, &report.text)?,
            ReportKind::Warning | ReportKind::Error | ReportKind::Mistake(_) => {
                let line = line(&report, &self.group);
                if self.told.as_mut().is_none_or(|told| told.insert(line.clone())) {
                    say(&line);
                }
            }
            ReportKind::Fatal => return Err(Failure::Wrong(report.to_string())),
        }
        Ok(())
    }

    /// Saves images and tells figures.
    ///
    /// # Errors
    /// An image cannot be written.
    pub fn finish(self, group: &Group) -> Result<(), Failure> {
        // testshade ends so where it saves no image, and its references have it.
        if matches!(&self.options.outputs[..], [] | [(_, _)]) && !self.outputs.iter().any(Output::kept) {
            say("\n");
        }
        let numbers = match self.options.format.as_deref() {
            None => None,
            Some(name) => Some(Numbers::named(name).ok_or_else(|| {
                Failure::Usage(format!("error: `{name}` are no numbers of files\n  help: uint8, half or float"))
            })?),
        };
        for output in self.outputs.iter().filter(|output| output.kept() && !self.options.print) {
            // Without a word on it numbers are kept as they are.
            let numbers = numbers.or(output.grid.ints.then_some(Numbers::Ints));
            let saved = save(&output.grid, &output.file, numbers);
            saved.map_err(|error| {
                Failure::Usage(format!("{}: error: cannot be written: {error}", output.file.display()))
            })?;
        }
        if self.options.stats {
            let (before, after) = (group.program().lowered, group.program().instructions());
            let (time, seconds) = (self.nanoseconds(), self.seconds);
            say(&format!(
                "\nInstructions: {before} before optimising, {after} after\nTime: {time:.1} ns a point, {seconds:.3} s\n"
            ));
        }
        Ok(())
    }

    /// The time that a point has taken so far, when the grid has been shaded as often as the options say.
    fn nanoseconds(&self) -> f64 {
        let points = f64::from(self.options.iters.max(1)) * self.options.res.map(f64::from).iter().product::<f64>();
        self.seconds / points * 1e9
    }
}

/// The numbers of an output, lane by lane.
fn read(machine: &Machine, group: &Group, output: &Output, len: usize) -> Vec<f32> {
    let mut out = vec![0.0; len * output.grid.channels];
    if let Some(view) = machine.output(group, &output.name) {
        view.copy_numbers(&mut out);
    }
    out
}

/// A number as `%g` has it.
fn shown(x: f32, int: bool) -> String {
    if int { format!("{x}") } else { format("%g", &[FormatArg::Float(&[x])]).unwrap_or_default() }
}

/// `fprintf` goes to its file.
fn append(name: &str, text: &str) -> Result<(), Failure> {
    use std::io::Write;
    if std::fs::metadata(name).is_ok_and(|found| !found.is_file()) {
        return Err(Failure::Usage(format!("{name}: error: cannot be written: it is no regular file")));
    }
    let file = std::fs::OpenOptions::new().append(true).create(true).open(name);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| Failure::Usage(format!("{name}: error: cannot be written: {error}")))
}
