//! The arguments of all commands that compile shaders.

use super::failure::Failure;
use super::watch;
use crate::compile::Compiler;
use crate::limits::SHADER_BYTES;
use clap::Args;
use std::path::{Path, PathBuf};
use velour_grammar::files::Access;

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
    /// Read no file outside of this folder, whatever input names
    #[arg(long, value_name = "DIR")]
    pub sandbox: Option<PathBuf>,
    /// Bytes that the command may hold, such as 2G or 512M; it ends when it needs more
    #[arg(long, value_name = "BYTES", value_parser = watch::bytes)]
    pub memory: Option<u64>,
}

impl CompileArgs {
    /// Folders of included files, and macros that are set and unset.
    pub fn of(include: Vec<PathBuf>, define: Vec<String>, undefine: Vec<String>) -> Self {
        CompileArgs { include, define, undefine, ..CompileArgs::default() }
    }

    /// The same, with a sandbox and a bound of the memory.
    pub fn bounded(self, sandbox: Option<PathBuf>, memory: Option<u64>) -> Self {
        CompileArgs { sandbox, memory, ..self }
    }

    /// What may be read. From here on the memory is bounded, too.
    pub fn access(&self) -> Result<Access, Failure> {
        self.memory.iter().for_each(|&bytes| watch::bound_memory(bytes));
        match &self.sandbox {
            None => Ok(Access::default()),
            Some(folder) => Access::within(folder)
                .map_err(|error| Failure::Usage(format!("error: the sandbox {}: {error}", folder.display()))),
        }
    }

    /// Another standard header than the built-in one.
    pub fn header(&self) -> Option<&Path> {
        self.stdosl.as_deref()
    }

    /// The compiler they ask for.
    pub fn compiler(&self) -> Result<Compiler, Failure> {
        let mut compiler = Compiler::new();
        let access = self.access()?;
        if let Some(path) = &self.stdosl {
            let unread = |error: String| Failure::Usage(format!("{}: error: {error}", path.display()));
            let bytes = access.read(path, SHADER_BYTES).map_err(|error| unread(error.to_string()))?;
            let text = String::from_utf8(bytes).map_err(|_| unread("it is not UTF-8 text".to_owned()))?;
            compiler = compiler.with_header(&path.display().to_string(), &text);
        }
        compiler.options.access = access;
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
