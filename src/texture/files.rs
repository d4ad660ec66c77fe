//! The textures of a session: found in folders, read once, held while the session lasts.

use super::file::{TextureError, read};
use super::pyramid::Texture;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

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
}

impl TextureFiles {
    /// Textures of these folders, looked in one after the other, and of the working folder; those of `TEXTUREPATH` follow.
    pub fn new(folders: Vec<PathBuf>) -> Self {
        let mut folders = folders;
        if let Some(path) = std::env::var_os("TEXTUREPATH") {
            folders.extend(std::env::split_paths(&path));
        }
        TextureFiles::of(folders, default_budget())
    }

    /// Those of the same folders with another limit of the bytes of all together, which by default is half of the machine's memory; none of
    /// them is read yet.
    pub fn limited(&self, bytes: u64) -> Self {
        TextureFiles::of(self.folders.clone(), bytes)
    }

    fn of(folders: Vec<PathBuf>, budget: u64) -> Self {
        let (used, known, reading) = (AtomicU64::new(0), RwLock::default(), Mutex::default());
        TextureFiles { folders, budget, used, known, reading }
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
        let path = self.find(name).ok_or_else(|| TextureError::NotFound { name: name.to_owned() })?;
        let left = self.budget.saturating_sub(self.used.load(Ordering::Relaxed));
        let texture = read(&path, left)?;
        self.used.fetch_add(texture.resident().1 as u64, Ordering::Relaxed);
        Ok(Arc::new(texture))
    }

    /// The text of a file that lies where textures do, such as a dictionary.
    ///
    /// # Errors
    /// One clause: it is not there, no text, or longer than 64 MB.
    pub fn text(&self, name: &str) -> Result<String, String> {
        let path = self.find(name).ok_or_else(|| format!("there is no file `{name}`"))?;
        let unread = |reason: std::io::Error| format!("`{}` cannot be read: {reason}", path.display());
        let mut text = String::new();
        std::fs::File::open(&path).map_err(unread)?.take(MOST_TEXT + 1).read_to_string(&mut text).map_err(unread)?;
        if text.len() as u64 > MOST_TEXT {
            return Err(format!("`{}` is longer than {} MB", path.display(), MOST_TEXT >> 20));
        }
        Ok(text)
    }

    /// Where the file of a name is.
    pub fn find(&self, name: &str) -> Option<PathBuf> {
        let here = Path::new(name);
        let beside = self.folders.iter().map(|folder| folder.join(name));
        std::iter::once(here.to_owned()).chain(beside).find(|path| !name.is_empty() && path.is_file())
    }
}

/// The most bytes of a text.
const MOST_TEXT: u64 = 64 << 20;

/// Half of the machine's memory where that can be told, else 4 GB.
fn default_budget() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"));
    let kilobytes: Option<u64> = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
    kilobytes.map_or(4 << 30, |kilobytes| kilobytes * 512)
}
