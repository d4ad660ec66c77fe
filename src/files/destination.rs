//! Where a finished file goes, and how it gets there.

use super::temporary::Temporary;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Cursor, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A place that takes a finished file: a name, through links; a pipe or a device; or standard output, `-`.
#[derive(Clone, Debug)]
pub struct Destination {
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// Standard output.
    Standard,
    /// A pipe or a device, which is written through.
    Stream(PathBuf),
    /// A file that is there or will be; no link.
    File(PathBuf),
}

/// Room on a disk that is held for a file.
#[derive(Debug)]
pub struct Room {
    destination: Destination,
    held: Option<Temporary>,
}

/// What a file is written to: it can be sought in, wherever it goes.
#[derive(Debug)]
pub struct Sink(Bytes);

#[derive(Debug)]
enum Bytes {
    File(BufWriter<Temporary>),
    Memory(Cursor<Vec<u8>>),
}

/// How many links are followed, as Linux does.
const MOST_LINKS: usize = 40;

impl Destination {
    /// The destination of a path, tried as far as that changes nothing and waits for nobody.
    ///
    /// # Errors
    /// There is a folder of that name, its folder is missing, or neither it nor its folder can be written.
    pub fn at(path: &Path) -> io::Result<Self> {
        if path == Path::new("-") {
            return Ok(Destination { kind: Kind::Standard });
        }
        let kind = match std::fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => Kind::Stream(path.to_owned()),
            Ok(_) | Err(_) => Kind::File(followed(path)?),
        };
        if let Kind::File(target) = &kind {
            match std::fs::metadata(target) {
                // To be replaced it must be ours to write: a file without write permission is meant to stay.
                Ok(_) => drop(OpenOptions::new().write(true).open(target)?),
                Err(_) => drop(Temporary::beside(target, false)?),
            }
        }
        Ok(Destination { kind })
    }

    /// Is it a pipe, a device or standard output, which takes what it gets at once and for good?
    pub fn is_stream(&self) -> bool {
        matches!(self.kind, Kind::Standard | Kind::Stream(_))
    }

    /// Is it standard output?
    pub fn is_standard_output(&self) -> bool {
        matches!(self.kind, Kind::Standard)
    }

    /// The file that will be written, links followed; nothing for a stream.
    pub fn file(&self) -> Option<&Path> {
        match &self.kind {
            Kind::File(path) => Some(path),
            Kind::Standard | Kind::Stream(_) => None,
        }
    }

    /// Writes the file that `fill` makes. On any failure what was there before stays as it was, and nothing is left beside it. May be
    /// called again: each time the file is replaced.
    ///
    /// # Errors
    /// Those of `fill`, and of the disk.
    pub fn write(&self, fill: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
        self.write_into(None, fill)
    }

    /// Holds so many bytes of the disk for the file until it is written, by [`Room::write`] and nobody else. Nothing is held for streams,
    /// for files that are written over, and where the system cannot.
    ///
    /// # Errors
    /// There is not so much room.
    pub fn hold(self, bytes: u64) -> io::Result<Room> {
        let mut held = None;
        if let Some(target) = self.file() {
            let before = std::fs::metadata(target).ok();
            if before.as_ref().is_none_or(|found| names_of(found) == 1)
                && let Ok(mut temporary) = Temporary::beside(target, before.is_some())
            {
                held = temporary.hold(bytes)?.then_some(temporary);
            }
        }
        Ok(Room { destination: self, held })
    }

    fn write_into(&self, held: Option<Temporary>, fill: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
        let target = match &self.kind {
            Kind::File(target) => target,
            Kind::Standard => {
                let bytes = in_memory(fill)?;
                let mut out = io::stdout().lock();
                return out.write_all(&bytes).and_then(|()| out.flush());
            }
            Kind::Stream(path) => {
                let bytes = in_memory(fill)?;
                let mut out = OpenOptions::new().write(true).open(path)?;
                return out.write_all(&bytes).and_then(|()| out.flush());
            }
        };
        let before = std::fs::metadata(target).ok();
        if before.as_ref().is_some_and(|found| names_of(found) > 1) {
            drop(held);
            return overwrite(target, &in_memory(fill)?);
        }
        let temporary = match held.map_or_else(|| Temporary::beside(target, before.is_some()), Ok) {
            Err(_) if before.is_some() => return overwrite(target, &in_memory(fill)?),
            temporary => temporary?,
        };
        let mut sink = Sink(Bytes::File(BufWriter::new(temporary)));
        fill(&mut sink)?;
        let Sink(Bytes::File(writer)) = sink else { return Ok(()) };
        let temporary = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        temporary.finish(target, before.as_ref())
    }
}

impl Room {
    /// Is anything held?
    pub fn is_held(&self) -> bool {
        self.held.is_some()
    }

    /// [`Destination::write`] into what is held; what the file does not need is given back.
    ///
    /// # Errors
    /// Those of `fill`, and of the disk.
    pub fn write(self, fill: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
        self.destination.write_into(self.held, fill)
    }
}

/// The bytes of a file that is not written as it grows.
fn in_memory(fill: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<Vec<u8>> {
    let mut sink = Sink(Bytes::Memory(Cursor::new(Vec::new())));
    fill(&mut sink)?;
    match sink.0 {
        Bytes::Memory(cursor) => Ok(cursor.into_inner()),
        Bytes::File(_) => Ok(Vec::new()),
    }
}

/// The file at the end of a chain of links, which need not be there.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&path) {
            Ok(to) => path = path.parent().unwrap_or(Path::new("")).join(to),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many links"))
}

/// Writes over a file, with all its names. What is new at the end comes first, so that a full disk is met before anything is lost.
fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    let old = file.metadata()?.len();
    let shared = bytes.len().min(usize::try_from(old).unwrap_or(usize::MAX));
    let longer = append(&mut file, old, &bytes[shared..]);
    if longer.is_err() {
        // It is the first failure that is told.
        let _ = file.set_len(old);
        return longer;
    }
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&bytes[..shared])?;
    file.set_len(bytes.len() as u64)?;
    file.sync_all()
}

fn append(file: &mut File, at: u64, bytes: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(at))?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// How many names a file has.
#[cfg(unix)]
fn names_of(found: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(found)
}

#[cfg(not(unix))]
fn names_of(_: &Metadata) -> u64 {
    1
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Bytes::File(file) => file.write(bytes),
            Bytes::Memory(memory) => memory.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Bytes::File(file) => file.flush(),
            Bytes::Memory(memory) => memory.flush(),
        }
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.0 {
            Bytes::File(file) => file.seek(to),
            Bytes::Memory(memory) => memory.seek(to),
        }
    }
}
