//! From a command line to printed text and images.

use super::group::group;
use super::host::PatchHost;
use super::options::{Options, Step, help, parse};
use super::save::{Grid, Numbers, save};
use super::wording::{self, line};
use super::{grid, group};
use crate::cli::compile::CompileArgs;
use crate::cli::failure::Failure;
use crate::cli::speak::{say, tell};
use crate::cli::threads::capped;
use crate::exec::{Group, Host, MAX_LANES, Machine, Points, Report, ReportKind, Values};
use crate::ir::lower::Lazy;
use crate::ops::format::{FormatArg, format};
use crate::scene::{GroupCompiler, GroupSpec, SceneError, SceneProblem, ShaderFiles};
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Batches that are shaded before what they say is told.
const WAVE: usize = 64;

/// Shades the grid that the words ask for.
pub fn run(words: &[String]) -> Result<(), Failure> {
    let options = parse(words)?;
    if options.help {
        say(&help());
        return Ok(());
    }
    let compile = CompileArgs::of(options.include.clone(), options.define.clone(), options.undefine.clone());
    let (mut spec, files) = group(&options, compile.compiler()?)?;
    let host: Arc<dyn Host> = Arc::new(PatchHost::new(&options)?);
    announce(&options, &spec);
    let mut compiled = compile_group(&options, &spec, &files)?;
    list_layers(&options, &spec, &files)?;
    let mut job = Job::new(&options, host, &compiled, &spec.name)?;
    for round in 0..options.iters.max(1) {
        if round == 1 && !options.reparams.is_empty() {
            change(&options, &mut spec)?;
            compiled = compile_group(&options, &spec, &files)?;
        }
        job.shade(&compiled, round + 1 == options.iters.max(1))?;
    }
    job.finish(&compiled)
}

/// What is told before anything runs.
fn announce(options: &Options, spec: &GroupSpec) {
    for c in &spec.connections {
        say(&format!("Connect {}.{} to {}.{}\n", c.source_layer, c.source_param, c.target_layer, c.target_param));
    }
    if options.verbose || options.query {
        say(&format!("Shader group:\n---\n{}\n---\n\n", spec.text()));
    }
}

/// Lists the layers, with `--oslquery` also their parameters.
fn list_layers(options: &Options, spec: &GroupSpec, files: &ShaderFiles) -> Result<(), Failure> {
    if options.verbose || options.query {
        say(&format!("Shader group \"{}\" layers are:\n", spec.name));
        for layer in &spec.layers {
            say(&format!("    {}\n", layer.layer_name));
            let shader = files.shader_of(spec, layer).map_err(|error| Failure::Wrong(error.to_string()))?;
            for param in shader.typed.params.iter().filter(|_| options.query) {
                let variable = &shader.typed.variables[param.var.0 as usize];
                let output = if param.output { "output " } else { "" };
                say(&format!("\t{output}{} {}\n", variable.ty, variable.name));
            }
        }
        say("\n");
    }
    if !options.outputs.is_empty() {
        say("\n");
    }
    Ok(())
}

fn compile_group(options: &Options, spec: &GroupSpec, files: &ShaderFiles) -> Result<Group, Failure> {
    let text = options.steps.iter().any(|step| matches!(step, Step::Group(_)));
    let wrong = |error: SceneError| Failure::Wrong(wording::group_error(&error, spec, text));
    let (mut missing, mut help) = (Vec::new(), None);
    for layer in &spec.layers {
        if let Err(error) = files.shader_of(spec, layer)
            && matches!(*error.problem, SceneProblem::ShaderNotFound { .. })
        {
            missing.push(layer.shader.as_str());
            help = help.or(error.help);
        }
    }
    if let Some(help) = help {
        return Err(Failure::Wrong(wording::missing(&missing, &help, spec)));
    }
    let mut builder = files.builder(spec).map_err(wrong)?.group_name(&spec.name);
    builder = builder.lazy(lazy(options)).working_space(options.colorspace).watched(options.watch);
    if !options.outputs.is_empty() {
        builder = builder.keep_outputs();
    }
    if options.userdata_isconnected {
        builder = builder.userdata_connects();
    }
    if options.unoptimized {
        builder = builder.unoptimized();
    }
    let group = files.finish(builder, spec).map_err(wrong)?;
    files.take_warnings().iter().for_each(|warning| tell(&format!("{warning}\n")));
    if is_set(options, "opt_warnings", false) {
        group.error_calls().iter().for_each(|place| say(&wording::error_call(place, &spec.name)));
    }
    if let Some(path) = &options.archive {
        let written = std::fs::write(path, spec.text());
        written.map_err(|error| Failure::Usage(format!("{}: error: {error}", path.display())))?;
    }
    Ok(group)
}

/// Is a setting of OSL's on?
fn is_set(options: &Options, name: &str, otherwise: bool) -> bool {
    let last = options.settings.iter().rev().find(|(known, _)| known == name);
    last.map_or(otherwise, |(_, value)| value != "0")
}

/// Which layers wait, by OSL's settings.
fn lazy(options: &Options) -> Lazy {
    let on = |name: &str| is_set(options, name, true);
    Lazy {
        layers: on("lazylayers"),
        globals: on("lazyglobals"),
        unconnected: on("lazyunconnected"),
        traces: on("lazytrace"),
        errors: on("lazyerror"),
    }
}

/// Puts the values of `--reparam` in place of those the group was built with.
fn change(options: &Options, spec: &mut GroupSpec) -> Result<(), Failure> {
    for (name, value) in &options.reparams {
        let value = group::param(value)?;
        let Some(layer) = spec.layers.iter_mut().find(|layer| layer.layer_name == *name) else {
            return Err(Failure::Usage(format!("error: there is no layer {name} to change")));
        };
        layer.params.retain(|old| old.name != value.name);
        layer.params.push(value);
    }
    Ok(())
}

/// An output that was asked for and that the group has.
struct Output {
    name: String,
    file: PathBuf,
    grid: Grid,
}

struct Job<'o> {
    options: &'o Options,
    host: Arc<dyn Host>,
    ray_type: i32,
    outputs: Vec<Output>,
    /// Messages are told once; `None` where every one is wanted.
    told: Option<HashSet<String>>,
    pool: rayon::ThreadPool,
    /// The group's name.
    group: String,
    seconds: f64,
}

/// What a batch leaves: its reports, and for each output the numbers of its lanes.
struct Shaded {
    reports: Vec<Report>,
    values: Vec<Vec<f32>>,
}

impl<'o> Job<'o> {
    fn new(options: &'o Options, host: Arc<dyn Host>, group: &Group, group_name: &str) -> Result<Self, Failure> {
        let threads = capped(options.threads);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| Failure::Usage(format!("error: threads cannot be started: {error}")))?;
        let repeats = is_set(options, "error_repeats", false);
        let mut job = Job {
            options,
            ray_type: host.ray_type(&options.raytype),
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
            let Some((numbers, ints)) = group.output_shape(name) else { continue };
            if file.as_os_str() != "null" {
                say(&format!("Output {name} to {}\n", file.display()));
            }
            let size = self.options.res;
            let values = vec![0.0; numbers * size[0] as usize * size[1] as usize];
            let grid = Grid { size, channels: numbers, ints, values };
            self.outputs.push(Output { name: name.clone(), file: file.clone(), grid });
        }
    }

    /// Shades all points once.
    fn shade(&mut self, group: &Group, keep: bool) -> Result<(), Failure> {
        let [width, height] = self.options.res.map(|side| side as usize);
        let total = width * height;
        let start = Instant::now();
        let step = MAX_LANES;
        let mut first = 0;
        while first < total {
            let batches: Vec<usize> = (first..total.min(first + WAVE * step)).step_by(step).collect();
            let (options, host, ray_type, outputs) = (self.options, &self.host, self.ray_type, &self.outputs);
            let shaded: Vec<Shaded> = self.pool.install(|| {
                let machine = || (Machine::with_host(host.clone()), Points::default());
                let one = |(machine, points): &mut (Machine, Points), &at: &usize| {
                    let len = step.min(total - at);
                    grid::fill(options, ray_type, at, len, points);
                    machine.shade(group, points);
                    let values = outputs.iter().map(|output| read(machine, group, output, len)).collect();
                    Shaded { reports: machine.take_reports(), values }
                };
                batches.par_iter().map_init(machine, one).collect()
            });
            for (&at, shaded) in batches.iter().zip(shaded) {
                self.tell(shaded.reports, at, &shaded.values)?;
                for (output, values) in self.outputs.iter_mut().zip(&shaded.values).filter(|_| keep) {
                    let start = at * output.grid.channels;
                    output.grid.values[start..start + values.len()].copy_from_slice(values);
                }
            }
            first += WAVE * step;
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(())
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
    fn finish(self, group: &Group) -> Result<(), Failure> {
        // testshade ends so where it saves no image, and its references have it.
        if matches!(&self.options.outputs[..], [] | [(_, _)])
            && self.outputs.iter().all(|o| o.file.as_os_str() == "null")
        {
            say("\n");
        }
        let numbers = match self.options.format.as_deref() {
            None => None,
            Some(name) => Some(Numbers::named(name).ok_or_else(|| {
                Failure::Usage(format!("error: `{name}` are no numbers of files\n  help: uint8, half or float"))
            })?),
        };
        for output in self.outputs.iter().filter(|output| output.file.as_os_str() != "null" && !self.options.print) {
            // Without a word on it numbers are kept as they are.
            let numbers = numbers.or(output.grid.ints.then_some(Numbers::Ints));
            let saved = save(&output.grid, &output.file, numbers);
            saved.map_err(|error| {
                Failure::Usage(format!("{}: error: cannot be written: {error}", output.file.display()))
            })?;
        }
        if self.options.stats {
            let points = f64::from(self.options.iters.max(1)) * self.options.res.map(f64::from).iter().product::<f64>();
            say(&format!(
                "\nInstructions: {}\nTime: {:.1} ns a point, {:.3} s\n",
                group.program().instructions(),
                self.seconds / points * 1e9,
                self.seconds
            ));
        }
        Ok(())
    }
}

/// The numbers of an output, lane by lane.
fn read(machine: &Machine, group: &Group, output: &Output, len: usize) -> Vec<f32> {
    let view = machine.output(group, &output.name);
    let mut out = Vec::with_capacity(len * output.grid.channels);
    for lane in 0..len {
        match view.as_ref().map(|view| view.lane(lane)) {
            Some(Values::Floats(values)) => out.extend(values),
            Some(Values::Ints(values)) => out.extend(values.iter().map(|&x| x as f32)),
            _ => out.resize(out.len() + output.grid.channels, 0.0),
        }
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
    let file = std::fs::OpenOptions::new().append(true).create(true).open(name);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| Failure::Usage(format!("{name}: error: cannot be written: {error}")))
}
