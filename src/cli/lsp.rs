//! `velour lsp`: serves an editor over standard input and output.

use super::compile::CompileArgs;
use super::failure::Failure;
use crate::lsp::{Settings, serve};
use std::path::PathBuf;

/// Arguments of `velour lsp`.
#[derive(clap::Args)]
pub struct LspArgs {
    /// Taken and without effect: standard input and output are what it speaks over anyway
    #[arg(long)]
    stdio: bool,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Serves until the editor says that this is all.
pub fn run(args: &LspArgs) -> Result<(), Failure> {
    let settings = Settings { compiler: args.compile.compiler()?, headers: headers() };
    match serve(std::io::stdin(), std::io::stdout(), settings) {
        Ok(true) => Ok(()),
        // As the protocol asks: the status of an exit without `shutdown` is 1.
        Ok(false) => Err(Failure::Wrong(String::new())),
        Err(error) => Err(Failure::Usage(format!("error: standard output: {error}"))),
    }
}

/// The folder of this user for files that can be made again.
fn headers() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("LOCALAPPDATA"));
    let cache = cache.or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    Some(cache.join("velour").join(env!("CARGO_PKG_VERSION")).join("headers"))
}
