//! Why a part cannot be used.

use super::ranges::Ranges;
use std::fmt;
use std::path::PathBuf;

/// What is wrong with a part of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PartError {
    /// R0301: its file cannot be read, or is none.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// R0302: it is part of another picture, for this reason.
    OfAnother(String),
    /// R0303: it holds samples that are there already.
    Twice {
        /// Which.
        samples: Ranges,
        /// In which tile.
        tile: usize,
    },
    /// R0304: a render that stops by noise or time cannot go on from one.
    Adapts,
}

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PartError::Unreadable { path, reason } => {
                write!(f, "R0301: {} is no part of a picture: {reason}", path.display())
            }
            PartError::OfAnother(difference) => write!(
                f,
                "R0302: this is part of another picture: {difference}\n  help: parts are of one picture when scene, shaders, textures, settings, size and seed are the same"
            ),
            PartError::Twice { samples, .. } => {
                write!(
                    f,
                    "R0303: samples {samples} would count twice\n  help: leave out one of the parts that hold them"
                )
            }
            PartError::Adapts => f.write_str(
                "R0304: a render that stops by noise or time has no fixed samples, so it cannot go on from a part",
            ),
        }
    }
}

impl std::error::Error for PartError {}
