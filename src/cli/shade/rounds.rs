//! A command line's grid shaded again and again, for benchmarks.

use super::group::group;
use super::host::PatchHost;
use super::job::Job;
use super::options::parse;
use super::run::compile_group;
use crate::cli::compile::CompileArgs;
use crate::cli::failure::Failure;
use crate::exec::{Group, Host};
use std::sync::Arc;

/// The grid that the words of `velour shade` ask for, compiled once.
pub struct Rounds {
    job: Job,
    group: Group,
}

impl std::fmt::Debug for Rounds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rounds").field("group", &self.group).finish_non_exhaustive()
    }
}

impl Rounds {
    /// Makes ready what the words ask for.
    ///
    /// # Errors
    /// What the command would say.
    pub fn new(words: &[&str]) -> Result<Self, String> {
        let ready = || {
            let options = parse(&words.iter().map(|&word| word.to_owned()).collect::<Vec<String>>())?;
            let compile = CompileArgs::of(options.include.clone(), options.define.clone(), options.undefine.clone());
            let (spec, files) = group(&options, compile.compiler()?)?;
            let host: Arc<dyn Host> = Arc::new(PatchHost::new(&options, compile.access()?)?);
            let group = compile_group(&options, &spec, &files)?;
            let job = Job::new(options, host, &group, &spec.name)?;
            Ok(Rounds { job, group })
        };
        ready().map_err(message)
    }

    /// The group.
    pub fn group(&self) -> &Group {
        &self.group
    }

    /// Shades the grid once more, as `--iters` does before the last time.
    ///
    /// # Errors
    /// What the command would say.
    pub fn shade(&mut self) -> Result<(), String> {
        self.job.shade(&self.group, false).map_err(message)
    }
}

fn message(failure: Failure) -> String {
    match failure {
        Failure::Wrong(message) | Failure::Usage(message) => message,
        Failure::Stopped(_) => "stopped".to_owned(),
    }
}
