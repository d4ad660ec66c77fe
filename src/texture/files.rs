//! The textures of a session: found in folders, read once, held while the session lasts.

use super::file::{TextureError, read_allowed};
use super::pyramid::Texture;
use crate::limits::{SHADER_BYTES, TEXTURE_BYTES};
use std::collections::HashMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use velour_grammar::files::Access;

/// A texture, or why there is none; the same answer each time.
type Entry = Result<Arc<Texture>, TextureError>;

/// Textures by name. Many threads ask at the same time; a file is read by the first that does.
#[derive(Debug)]
pub struct TextureFiles {
    folders: Vec<PathBuf>,
    budget: u64,
    used: AtomicU64,
    known: RwLock<HashMap<String, Entry>>,
    reading: Mutex<()>,
    access: Access,
}

impl TextureFiles {
    /// Textures of these folders, looked in one after the other, and of the working folder; those of `TEXTUREPATH` follow.
    pub fn new(folders: Vec<PathBuf>) -> Self {
        let mut folders = folders;
        if let Some(path) = std::env::var_os("TEXTUREPATH") {
            folders.extend(std::env::split_paths(&path));
        }
        TextureFiles::of(folders, default_budget(), Access::default())
    }

    /// The same, of which only those are read that may be.
    pub fn with_access(self, access: Access) -> Self {
        TextureFiles::of(self.folders, self.budget, access)
    }

    /// Those of the same folders with another limit of the bytes of all together, which by default is half of the machine's memory; none of
    /// them is read yet.
    pub fn limited(&self, bytes: u64) -> Self {
        TextureFiles::of(self.folders.clone(), bytes, self.access.clone())
    }

    fn of(folders: Vec<PathBuf>, budget: u64, access: Access) -> Self {
        let (used, known, reading) = (AtomicU64::new(0), RwLock::default(), Mutex::default());
        TextureFiles { folders, budget, used, known, reading, access }
    }

    /// The texture of a name.
    ///
    /// # Errors
    /// It is not found, cannot be read, or does not fit.
    pub fn get(&self, name: &str) -> Result<Arc<Texture>, TextureError> {
        if let Some(known) = self.known.read().unwrap_or_else(PoisonError::into_inner).get(name) {
            return known.clone();
        }
        let _turn = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        // Another thread may have read it while this one waited.
        if let Some(known) = self.known.read().unwrap_or_else(PoisonError::into_inner).get(name) {
            return known.clone();
        }
        let entry = self.load(name);
        self.known.write().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), entry.clone());
        entry
    }

    fn load(&self, name: &str) -> Entry {
        let path = self
            .find(name)
            .ok_or_else(|| TextureError::NotFound { name: name.to_owned(), folders: self.folders.clone() })?;
        let left = self.budget.saturating_sub(self.used.load(Ordering::Relaxed));
        let texture = read_allowed(&path, left, &self.access)?;
        self.used.fetch_add(texture.resident().1 as u64, Ordering::Relaxed);
        Ok(Arc::new(texture))
    }

    /// The text of a file that lies where textures do, such as a dictionary.
    ///
    /// # Errors
    /// One clause: it is not there, no text, or longer than 64 MB.
    pub fn text(&self, name: &str) -> Result<String, String> {
        let path = self.find(name).ok_or_else(|| format!("there is no file `{name}`"))?;
        let unread = |reason: String| format!("`{}` cannot be read: {reason}", path.display());
        let bytes = self.access.read(&path, SHADER_BYTES).map_err(|error| unread(error.to_string()))?;
        String::from_utf8(bytes).map_err(|_| unread("it is not UTF-8 text".to_owned()))
    }

    /// The file of a name, and how many bytes it has; nothing where there is none, or one that is too large.
    pub fn open(&self, name: &str) -> Option<(File, u64)> {
        self.access.open(&self.find(name)?, TEXTURE_BYTES).ok()
    }

    fn find(&self, name: &str) -> Option<PathBuf> {
        let here = Path::new(name);
        let beside = self.folders.iter().map(|folder| folder.join(name));
        std::iter::once(here.to_owned()).chain(beside).find(|path| !name.is_empty() && self.access.is_file(path))
    }
}

/// Half of the machine's memory where that can be told, else 4 GB.
fn default_budget() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"));
    let kilobytes: Option<u64> = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
    kilobytes.map_or(4 << 30, |kilobytes| kilobytes * 512)
}
