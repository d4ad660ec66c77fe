//! Reading files that input has named: only regular ones, only so many bytes, and with a sandbox only those inside it.
//!
//! Decision (2026-11-29): a file is opened first and judged by what was opened (its kind, and its true name as the system tells it), instead of
//! by its name before: whoever may change a link between the look and the opening gains nothing. A file outside of the sandbox looks like
//! one that is not there, so that no message tells whether there is one; but for the one that the command line names.

use std::collections::BTreeSet;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Which files may be read: all, or those of one folder.
#[derive(Clone, Debug, Default)]
pub struct Access {
    root: Option<Arc<Path>>,
    noted: Option<Noted>,
}

/// The paths that input has named since it was made, whether there is a file or not: what a picture may depend on.
#[derive(Clone, Debug, Default)]
pub struct Noted(Arc<Mutex<BTreeSet<PathBuf>>>);

/// So many paths are noted; those beyond are read all the same.
const MOST_NOTED: usize = 1 << 16;

impl Noted {
    /// All paths so far, as they were named.
    pub fn paths(&self) -> BTreeSet<PathBuf> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// True before any is named.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn note(&self, path: &Path) {
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if paths.len() < MOST_NOTED && !paths.contains(path) {
            paths.insert(path.to_owned());
        }
    }
}

/// Why a file is not read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ReadError {
    /// There is none of that name, or none that may be seen.
    Missing,
    /// A folder, a pipe, a device or a socket.
    NotAFile,
    /// It has more bytes than a file of its kind may have.
    TooLarge {
        /// The most bytes there may be.
        most: u64,
    },
    /// The system does not let it be read.
    System(io::Error),
}

impl Access {
    /// Only what lies in a folder, links followed.
    ///
    /// # Errors
    /// There is no such folder.
    pub fn within(folder: &Path) -> io::Result<Self> {
        let root = folder.canonicalize()?;
        if !root.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        Ok(Access { root: Some(root.into()), noted: None })
    }

    /// The same, which notes what is asked for from now on.
    pub fn noting(&self, noted: &Noted) -> Self {
        Access { root: self.root.clone(), noted: Some(noted.clone()) }
    }

    fn note(&self, path: &Path) {
        self.noted.iter().for_each(|noted| noted.note(path));
    }

    /// The folder that everything has to lie in, if there is one.
    pub fn sandbox(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// May what stands at a path be looked at? Without a sandbox everything may.
    pub fn covers(&self, path: &Path) -> bool {
        match &self.root {
            None => true,
            Some(root) => path.canonicalize().is_ok_and(|whole| whole.starts_with(root)),
        }
    }

    /// Is there a regular file that may be read?
    pub fn is_file(&self, path: &Path) -> bool {
        self.note(path);
        path.is_file() && self.covers(path)
    }

    /// The paths in a folder, sorted by name; none of a folder that may not be looked at.
    pub fn list(&self, folder: &Path) -> Vec<PathBuf> {
        if !self.covers(folder) {
            return Vec::new();
        }
        let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    }

    /// Opens a regular file of at most `most` bytes; gives how many it has now.
    ///
    /// # Errors
    /// It is none, too large, or may not be read.
    pub fn open(&self, path: &Path, most: u64) -> Result<(File, u64), ReadError> {
        let told = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => ReadError::Missing,
            _ => ReadError::System(error),
        };
        self.note(path);
        if !self.covers(path) {
            return Err(ReadError::Missing);
        }
        // To open a device can have effects of its own, so that its name is looked at as well.
        if !std::fs::metadata(path).map_err(told)?.is_file() {
            return Err(ReadError::NotAFile);
        }
        let file = opened(path).map_err(told)?;
        let found = file.metadata().map_err(told)?;
        if !found.is_file() {
            return Err(ReadError::NotAFile);
        }
        if !self.root.as_deref().is_none_or(|root| true_name(&file, path).is_some_and(|name| name.starts_with(root))) {
            return Err(ReadError::Missing);
        }
        if found.len() > most {
            return Err(ReadError::TooLarge { most });
        }
        Ok((file, found.len()))
    }

    /// The bytes of a regular file that has at most `most`, also where the system does not know how many there are.
    ///
    /// # Errors
    /// It is none, too large, or cannot be read.
    pub fn read(&self, path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
        let (file, size) = self.open(path, most)?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(size as usize + 1).map_err(|_| ReadError::TooLarge { most })?;
        file.take(most + 1).read_to_end(&mut bytes).map_err(ReadError::System)?;
        if bytes.len() as u64 > most { Err(ReadError::TooLarge { most }) } else { Ok(bytes) }
    }
}

/// Opens without waiting for the other end of a pipe that has taken the file's place.
fn opened(path: &Path) -> io::Result<File> {
    let mut options = std::fs::OpenOptions::new();
    options.read(true);
    #[cfg(target_os = "linux")]
    {
        // O_NONBLOCK of Linux.
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, 0o4000);
    }
    options.open(path)
}

/// Where an open file lies, all links followed.
fn true_name(file: &File, path: &Path) -> Option<PathBuf> {
    #[cfg(target_os = "linux")]
    {
        let number = std::os::fd::AsRawFd::as_raw_fd(file);
        if let Ok(name) = std::fs::read_link(format!("/proc/self/fd/{number}")) {
            return Some(name);
        }
    }
    let _ = file;
    path.canonicalize().ok()
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReadError::Missing => f.write_str("there is no such file"),
            ReadError::NotAFile => f.write_str("it is no regular file"),
            ReadError::TooLarge { most } => write!(f, "it is longer than {} MB", most >> 20),
            ReadError::System(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ReadError {}

impl From<ReadError> for io::Error {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::System(error) => error,
            ReadError::Missing => io::Error::new(io::ErrorKind::NotFound, error.to_string()),
            ReadError::NotAFile | ReadError::TooLarge { .. } => io::Error::other(error.to_string()),
        }
    }
}
