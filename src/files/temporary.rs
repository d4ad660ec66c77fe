//! A file under way, which nobody finds and which goes when it is not finished.

use std::fs::{File, Metadata, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file in the folder of its target; without a name where the system has such files.
#[derive(Debug)]
pub struct Temporary {
    file: File,
    name: Option<PathBuf>,
    /// Room of the disk is held for it, which may be more than it needs.
    holds: bool,
}

impl Temporary {
    /// A new file beside `target`; `private` when nobody else may read it while it grows.
    pub fn beside(target: &Path, private: bool) -> io::Result<Self> {
        let folder = folder_of(target);
        if let Some(file) = nameless(folder) {
            return Ok(Temporary { file, name: None, holds: false });
        }
        let name = unknown_name(target);
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if private {
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        }
        let _ = private;
        let file = options.open(&name)?;
        Ok(Temporary { file, name: Some(name), holds: false })
    }

    /// Holds so many bytes of the disk for it; false where that cannot be, or would be left behind by a process that is killed.
    ///
    /// # Errors
    /// The disk, or what its owner may have of it, has too little room.
    pub fn hold(&mut self, bytes: u64) -> io::Result<bool> {
        self.holds = self.name.is_none() && allocate(&self.file, bytes)?;
        Ok(self.holds)
    }

    /// Puts it, flushed to the disk, in the place of `target`, with the rights and the owner of what was there.
    pub fn finish(mut self, target: &Path, before: Option<&Metadata>) -> io::Result<()> {
        if let Some(before) = before {
            take_over(&self.file, before)?;
        }
        if self.holds {
            // What was held beyond its end is given back.
            self.file.set_len(self.file.metadata()?.len())?;
        }
        self.file.sync_all()?;
        if self.name.is_none() {
            // A name that is free is taken at once; one that is not, by renaming.
            if before.is_none() && link(&self.file, target).is_ok() {
                flush_folder(target);
                return Ok(());
            }
            let name = unknown_name(target);
            link(&self.file, &name)?;
            self.name = Some(name);
        }
        if let Some(name) = &self.name {
            std::fs::rename(name, target)?;
            self.name = None;
        }
        flush_folder(target);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(name) = &self.name {
            // What cannot be removed now cannot be removed; the failure that led here is told.
            let _ = std::fs::remove_file(name);
        }
    }
}

impl Write for Temporary {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Temporary {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// A name beside the file's own, so that renaming stays on one disk. The hash has keys that the system has drawn.
fn unknown_name(target: &Path) -> PathBuf {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let short: String = name.chars().take(40).collect();
    folder_of(target).join(format!(".{short}.{:016x}.part", RandomState::new().hash_one(std::process::id())))
}

/// The rename itself is on the disk when the folder is. Some file systems cannot flush folders.
fn flush_folder(target: &Path) {
    let _ = File::open(folder_of(target)).and_then(|folder| folder.sync_all());
}

/// Mode and owner of the file that is replaced. Only root can give a file away, so that the owner is tried.
#[cfg(unix)]
fn take_over(file: &File, before: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let own = file.metadata()?;
    if (own.uid(), own.gid()) != (before.uid(), before.gid()) {
        let _ = fchown(file, Some(before.uid()), Some(before.gid()));
    }
    file.set_permissions(before.permissions())
}

#[cfg(not(unix))]
fn take_over(_: &File, _: &Metadata) -> io::Result<()> {
    Ok(())
}

/// A file without a name in a folder.
#[cfg(target_os = "linux")]
fn nameless(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags, open};
    // Its later name is given by way of /proc.
    let named = Path::new("/proc/self/fd").is_dir();
    let mode = Mode::from_raw_mode(0o666);
    let open = || open(folder, OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC, mode);
    named.then(|| open().ok().map(File::from)).flatten()
}

/// Takes blocks of the disk for a file, whose length stays; false where the file system does not do that.
#[cfg(target_os = "linux")]
fn allocate(file: &File, bytes: u64) -> io::Result<bool> {
    use rustix::fs::{FallocateFlags, fallocate};
    use rustix::io::Errno;
    match fallocate(file, FallocateFlags::KEEP_SIZE, 0, bytes.max(1)) {
        Ok(()) => Ok(true),
        Err(full @ (Errno::NOSPC | Errno::DQUOT)) => Err(full.into()),
        Err(_) => Ok(false),
    }
}

#[cfg(not(target_os = "linux"))]
fn allocate(_: &File, _: u64) -> io::Result<bool> {
    Ok(false)
}

#[cfg(target_os = "linux")]
fn link(file: &File, name: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    let number = std::os::fd::AsRawFd::as_raw_fd(file);
    linkat(CWD, format!("/proc/self/fd/{number}"), CWD, name, AtFlags::SYMLINK_FOLLOW).map_err(io::Error::from)
}

#[cfg(not(target_os = "linux"))]
fn nameless(_: &Path) -> Option<File> {
    None
}

#[cfg(not(target_os = "linux"))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
