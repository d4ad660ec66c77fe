//! How text reaches people: the only place that prints.

use std::io::{IsTerminal, Write};

/// Prints to standard output. A pipe that closes early is no reason to complain.
pub fn say(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Prints to standard error.
pub fn tell(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// True when messages may be coloured.
pub fn colored() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
