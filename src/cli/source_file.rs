//! The text of a file, or of standard input, that an argument names.

use crate::limits::SHADER_BYTES;
use std::io::Read;
use std::path::Path;
use velour_grammar::files::Access;

/// Does an argument name standard input?
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
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
