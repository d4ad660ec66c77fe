//! The text of a file, or of standard input, that an argument names.

use super::failure::Failure;
use crate::compile::{CompileError, Compiler, Shader};
use crate::limits::SHADER_BYTES;
use crate::scene::shipped_shader;
use std::io::Read;
use std::path::Path;
use velour_grammar::files::Access;

/// Does an argument name standard input?
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// Compiles the shader of a file, or of the binary where there is no file of the name.
pub fn compile(compiler: &Compiler, path: &Path) -> Result<Shader, Failure> {
    let own = Some(path).filter(|path| !compiler.options.access.is_file(path));
    let compiled = match own.and_then(|path| shipped_shader(path.to_str()?)) {
        Some((file, text)) => compiler.compile(file, text),
        None => compiler.compile_file(path),
    };
    compiled.map_err(|error| match error {
        CompileError::File { .. } => Failure::Usage(error.to_string()),
        other => Failure::Wrong(other.to_string()),
    })
}

/// A file's name for messages and what is in it.
///
/// # Errors
/// The message, when it cannot be read.
pub fn read(path: &Path, access: &Access) -> Result<(String, Vec<u8>), String> {
    let standard = is_standard(path);
    let name = if standard { "<stdin>".to_owned() } else { path.display().to_string() };
    let mut bytes = Vec::new();
    let read = match standard {
        true => std::io::stdin().lock().take(SHADER_BYTES).read_to_end(&mut bytes).map(|_| bytes),
        false => access.read(path, SHADER_BYTES).map_err(std::io::Error::from),
    };
    read.map(|bytes| (name.clone(), bytes)).map_err(|error| format!("{name}: error: cannot be read: {error}\n"))
}
