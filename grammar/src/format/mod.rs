//! A text laid out anew: indentation, spaces and empty lines, with comments, directives and macros as they are.
//!
//! Decision (2026-11-30): the layout works on the tokens of the text and leaves the ends of its lines where they are, instead of on
//! the tree, which knows neither comments nor macros, and instead of filling lines, since whoever has broken a line meant it. What stands
//! in a bracket is one step of four spaces further in than the line the bracket is on, or begins in the column of what follows the
//! bracket, where the text had it so. That the program stays the same is not trusted but looked at: what the preprocessor makes of the new
//! text must be the same tokens.

mod frames;
mod layout;
mod lines;
mod pieces;
mod spaces;

use crate::diagnostic::Diagnostics;
use crate::source::Sources;
use crate::{Options, decode, parse, preprocessor};
use std::fmt;

/// Why a text stays as it is.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FormatError {
    /// It is wrong.
    Wrong(Box<Diagnostics>, Sources),
    /// Its macros look at spaces or numbers of lines, so that another layout would be another program.
    Counted,
    /// It is partly UTF-8 and partly Latin-1.
    Mixed,
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FormatError::Wrong(..) => "the text is wrong",
            FormatError::Mixed => "the text is partly UTF-8 and partly Latin-1",
            FormatError::Counted => {
                "its macros count lines or look at spaces, so that another layout would be another program"
            }
        })
    }
}

impl std::error::Error for FormatError {}

/// How often a text is laid out until nothing changes. Once nearly always suffices.
const MOST_ROUNDS: usize = 8;

/// Lays out a text.
///
/// The result is stable: laid out again it stays as it is. It has the line ends of the text's first line.
///
/// # Errors
/// The text is wrong, or its layout matters.
pub fn format(name: &str, text: &str, options: &Options) -> Result<String, FormatError> {
    let parsed = parse(name, text, options);
    if parsed.diagnostics.has_errors() {
        return Err(FormatError::Wrong(Box::new(parsed.diagnostics), parsed.sources));
    }
    let new = laid_out(text);
    if new != text && !means_the_same(name, text, &new, options) {
        return Err(FormatError::Counted);
    }
    Ok(new)
}

/// The same for the bytes of a file, in UTF-8 or, in strings and comments, in Latin-1, which they then stay in.
///
/// # Errors
/// The text is wrong, or its layout matters.
pub fn format_bytes(name: &str, bytes: &[u8], options: &Options) -> Result<Vec<u8>, FormatError> {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok(format(name, text, options)?.into_bytes());
    }
    let Some(text) = decode::decode(bytes) else {
        let parsed = crate::not_text(name);
        return Err(FormatError::Wrong(Box::new(parsed.diagnostics), parsed.sources));
    };
    // Which of its characters were of which is not known any more where there are both.
    if text.chars().count() != bytes.len() {
        return Err(FormatError::Mixed);
    }
    format(name, &text, options)?.chars().map(|c| u8::try_from(c).map_err(|_| FormatError::Mixed)).collect()
}

/// The text, laid out until it stays as it is.
fn laid_out(text: &str) -> String {
    let crlf = text.find('\n').is_some_and(|end| text[..end].ends_with('\r'));
    let mark = if text.starts_with('\u{feff}') { "\u{feff}" } else { "" };
    let mut old = text.replace("\r\n", "\n");
    for _ in 0..MOST_ROUNDS {
        let new = {
            let (parts, quoting) = pieces::parts(&old);
            layout::lay_out(&parts, &quoting)
        };
        if new == old {
            break;
        }
        old = new;
    }
    let text = if crlf { old.replace('\n', "\r\n") } else { old };
    [mark, &text].concat()
}

/// Does the preprocessor make the same tokens of two texts?
fn means_the_same(name: &str, old: &str, new: &str, options: &Options) -> bool {
    let [old, new] = [old, new].map(|text| preprocessor::run(name, text, options));
    let spelled = |done: &'_ preprocessor::Preprocessed, token: &preprocessor::Terminal| {
        done.table.text(done.table.expanded[token.index as usize].place).to_owned()
    };
    old.tokens.len() == new.tokens.len()
        && old.tokens.iter().zip(&new.tokens).all(|(a, b)| a.kind == b.kind && spelled(&old, a) == spelled(&new, b))
}
