//! The arguments of all commands that compile shaders.

use super::failure::Failure;
use crate::compile::Compiler;
use clap::Args;
use std::path::{Path, PathBuf};

/// How shaders are compiled.
#[derive(Args, Clone, Debug, Default)]
pub struct CompileArgs {
    /// Add a folder to look for included files in
    #[arg(short = 'I', value_name = "DIR")]
    include: Vec<PathBuf>,
    /// Define a macro
    #[arg(short = 'D', value_name = "NAME[=VALUE]")]
    define: Vec<String>,
    /// Undefine a macro
    #[arg(short = 'U', value_name = "NAME")]
    undefine: Vec<String>,
    /// Use another standard header than the built-in one
    #[arg(long, value_name = "FILE")]
    stdosl: Option<PathBuf>,
}

impl CompileArgs {
    /// Folders of included files, and macros that are set and unset.
    pub fn of(include: Vec<PathBuf>, define: Vec<String>, undefine: Vec<String>) -> Self {
        CompileArgs { include, define, undefine, stdosl: None }
    }

    /// Another standard header than the built-in one.
    pub fn header(&self) -> Option<&Path> {
        self.stdosl.as_deref()
    }

    /// The compiler they ask for.
    pub fn compiler(&self) -> Result<Compiler, Failure> {
        let mut compiler = Compiler::new();
        if let Some(path) = &self.stdosl {
            let text = std::fs::read_to_string(path)
                .map_err(|error| Failure::Usage(format!("{}: error: {error}", path.display())))?;
            compiler = compiler.with_header(&path.display().to_string(), &text);
        }
        compiler.options.include_dirs = self.include.clone();
        compiler.options.undefines = self.undefine.clone();
        let pair = |text: &String| match text.split_once('=') {
            Some((name, value)) => (name.to_owned(), value.to_owned()),
            None => (text.clone(), "1".to_owned()),
        };
        compiler.options.defines = self.define.iter().map(pair).collect();
        Ok(compiler)
    }
}
