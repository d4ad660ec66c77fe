//! Paths that name the same file alike, whether it is there or not.

use std::path::{Path, PathBuf};

/// The folder of a file with all links followed, and the file's own name: an editor may take the file away and put another there.
pub fn key(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

/// The keys of a path: that of its name, and of what it is a link to.
pub fn keys(path: &Path) -> Vec<PathBuf> {
    let own = key(path);
    let target = path.canonicalize().ok().filter(|target| *target != own);
    std::iter::once(own).chain(target).collect()
}
