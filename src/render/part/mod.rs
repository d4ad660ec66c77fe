//! Parts of a picture: some of its samples, as sums that more samples can be added to.
//!
//! A sample is a function of scene, settings and its number, and sums are exact, so parts that were made anywhere and in any order
//! merge into the very bits of a picture that was made in one go.
//!
//! Decision (2026-11-29): a part keeps the sums of pixels, not those of tiles with their rims, because they are half the size and know
//! nothing of tiles. A part of which tiles have unlike samples, left by a render that was stopped, is then a plain weighted mean at
//! their borders until the tiles have caught up.

mod columns;
mod error;
mod file;
mod identity;
mod ranges;
mod samples;

pub use error::PartError;
pub use file::{read, read_bytes, read_file, write, write_into};
pub use identity::fingerprint;
pub use ranges::{Ranges, counts};
pub use samples::{Part, Whole};
