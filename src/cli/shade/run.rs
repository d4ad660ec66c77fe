//! From a command line to printed text and images.

use super::group;
use super::group::group;
use super::host::PatchHost;
use super::job::Job;
use super::options::{Options, Step, help, parse};
use super::wording;
use crate::cli::compile::CompileArgs;
use crate::cli::failure::Failure;
use crate::cli::speak::{say, tell};
use crate::cli::watch::TimeBound;
use crate::exec::{Group, Host};
use crate::files::Destination;
use crate::ir::lower::Lazy;
use crate::scene::{GroupCompiler, GroupSpec, SceneError, SceneProblem, ShaderFiles};
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;

/// Shades the grid that the words ask for.
pub fn run(words: &[String]) -> Result<(), Failure> {
    let options = parse(words)?;
    if options.help {
        say(&help());
        return Ok(());
    }
    let _bound = TimeBound::new(Instant::now(), options.time, "before all was shaded");
    let compile = CompileArgs::of(options.include.clone(), options.define.clone(), options.undefine.clone());
    let compile = compile.bounded(options.sandbox.clone(), options.memory);
    let (mut spec, files) = group(&options, compile.compiler()?)?;
    let host: Arc<dyn Host> = Arc::new(PatchHost::new(&options, compile.access()?)?);
    announce(&options, &spec);
    let mut compiled = compile_group(&options, &spec, &files)?;
    list_layers(&options, &spec, &files)?;
    let mut job = Job::new(options.clone(), host, &compiled, &spec.name)?;
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
            for (param, variable) in shader.typed.declared().filter(|_| options.query) {
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

/// Compiles the layers as the options say.
pub fn compile_group(options: &Options, spec: &GroupSpec, files: &ShaderFiles) -> Result<Group, Failure> {
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
    if options.is_set("opt_warnings", false) {
        group.error_calls().iter().for_each(|place| say(&wording::error_call(place, &spec.name)));
    }
    if let Some(path) = &options.archive {
        let written = Destination::at(path).and_then(|file| file.write(|sink| sink.write_all(spec.text().as_bytes())));
        written.map_err(|error| Failure::Usage(format!("{}: error: {error}", path.display())))?;
    }
    Ok(group)
}

/// Which layers wait, by OSL's settings.
fn lazy(options: &Options) -> Lazy {
    let on = |name: &str| options.is_set(name, true);
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
