//! Files that are finished: written whole or not at all, whatever stands at their name.
//!
//! Decision (2026-11-29): a file is made without a name beside its target (`O_TMPFILE`), flushed to the disk, linked under a name
//! that nobody can guess and renamed, instead of under `.NAME.PID.part`: a process that is killed leaves nothing, and whoever may write to the
//! folder cannot put a link where the name will be. Where the file system has no files without names, a named one is opened exclusively.
//! What cannot be replaced without harm (a file with several names, a file in a folder that takes none) is overwritten from memory, its new
//! end first, so that a full disk leaves the old file whole; only a power cut in between does not. Pipes, devices and standard output
//! get the bytes in one go.
//!
//! Decision (2026-11-30): before a long render the room that its file may take at the most is held, by blocks of the very file without a
//! name that is filled in the end (`fallocate`), instead of asking how much the disk has left: what is there at the start another process
//! takes before the end. A process that is killed holds nothing.

mod destination;
mod temporary;

pub use destination::{Destination, Room, Sink};
