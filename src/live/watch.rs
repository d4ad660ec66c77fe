//! Watches the folders of all files that a picture is made of.
//!
//! Decision (2026-11-30): folders instead of files, because editors save by putting another file in the place of the old one, and because
//! what was looked for and not found may come to be.

use super::inbox::{Inbox, Wish};
use super::paths::keys;
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The folders that are watched, and the files that matter in them.
#[derive(Debug)]
pub struct Watched {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    matters: Arc<Mutex<Matters>>,
}

#[derive(Debug, Default)]
struct Matters {
    /// A key of a file, and the key that it is known by: a link is known by its own name.
    files: BTreeMap<PathBuf, PathBuf>,
    /// Something is wrong, which a file that nobody has asked for yet may mend.
    any: bool,
}

impl Watched {
    /// Watches nothing yet; changes become wishes.
    ///
    /// # Errors
    /// The system watches nothing for this process.
    pub fn new(inbox: Arc<Inbox>) -> Result<Self, notify::Error> {
        let matters: Arc<Mutex<Matters>> = Arc::default();
        let known = matters.clone();
        let watcher = notify::recommended_watcher(move |event: Result<notify::Event, notify::Error>| {
            let Ok(event) = event else { return };
            if matches!(event.kind, EventKind::Access(_)) {
                return;
            }
            let matters = known.lock().unwrap_or_else(PoisonError::into_inner);
            for path in event.paths {
                if let Some(key) = matters.files.get(&path) {
                    inbox.push(Wish::Changed(key.clone()));
                } else if matters.any && !is_an_editors_own(&path) {
                    inbox.push(Wish::Changed(path));
                }
            }
        })?;
        Ok(Watched { watcher, folders: BTreeSet::new(), matters })
    }

    /// Watches the folders of these files; changes of others no longer matter, unless `any` is true.
    pub fn follow(&mut self, files: &BTreeSet<PathBuf>, any: bool) {
        let mut known = BTreeMap::new();
        let mut folders = BTreeSet::new();
        for file in files {
            let keys = keys(file);
            for key in &keys {
                folders.extend(key.parent().filter(|folder| folder.is_dir()).map(Path::to_owned));
                known.insert(key.clone(), keys[0].clone());
            }
        }
        *self.matters.lock().unwrap_or_else(PoisonError::into_inner) = Matters { files: known, any };
        for gone in self.folders.difference(&folders) {
            let _ = self.watcher.unwatch(gone);
        }
        let watcher = &mut self.watcher;
        let old = std::mem::take(&mut self.folders);
        // One that cannot be watched, such as one of too many, is left out.
        let watch =
            |folder: &PathBuf| old.contains(folder) || watcher.watch(folder, RecursiveMode::NonRecursive).is_ok();
        self.folders = folders.into_iter().filter(watch).collect();
    }

    /// Whether changes of all files in the folders matter.
    pub fn any(&self, any: bool) {
        self.matters.lock().unwrap_or_else(PoisonError::into_inner).any = any;
    }
}

/// Is it a file that editors keep for themselves, such as vim's swap file?
fn is_an_editors_own(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with('.') || name.ends_with('~') || name == "4913"
}
