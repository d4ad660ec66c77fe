//! The texts that an editor has open, and what is known of each.

use super::text::Text;
use super::uri::path_of;
use crate::compile::Compiler;
use crate::limits::SHADER_BYTES;
use crate::query::Study;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An open text.
#[derive(Debug)]
pub(super) struct Document {
    pub text: Text,
    pub version: i64,
    /// Its name for the compiler: the path, or the address where there is none.
    pub name: String,
    /// The file it stands for, links followed.
    path: Option<PathBuf>,
    /// Its text, for those that include it.
    shared: Arc<str>,
    /// What is known of it; nothing after a change.
    study: Option<Arc<Study>>,
    /// What was known before the change: to free it takes time, which there is when the editor has been told.
    old: Option<Arc<Study>>,
    /// What was known when it last was whole.
    whole: Option<Arc<Study>>,
    /// The editor has not been told what is wrong with it.
    pub stale: bool,
}

impl Document {
    /// Is it too long to be looked at?
    pub(super) fn is_too_long(&self) -> bool {
        self.text.as_str().len() as u64 > SHADER_BYTES
    }
}

/// All open texts, by address.
#[derive(Debug)]
pub(super) struct Documents {
    compiler: Compiler,
    pub open: BTreeMap<String, Document>,
}

/// What makes a file the same one.
pub(super) fn key(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

impl Documents {
    pub(super) fn new(compiler: Compiler) -> Self {
        Documents { compiler, open: BTreeMap::new() }
    }

    /// What compiles the texts.
    pub(super) fn compiler(&self) -> &Compiler {
        &self.compiler
    }

    /// The same, to set it otherwise; all texts are looked at anew.
    pub(super) fn compiler_mut(&mut self) -> &mut Compiler {
        self.forget();
        &mut self.compiler
    }

    /// A text is opened.
    pub(super) fn open(&mut self, uri: &str, version: i64, text: String) {
        let path = path_of(uri);
        let name = path.as_ref().map_or_else(|| uri.to_owned(), |path| path.display().to_string());
        let path = path.map(|path| key(&path));
        let shared = Arc::from(text.as_str());
        let text = Text::new(text);
        let document = Document { text, version, name, path, shared, study: None, old: None, whole: None, stale: true };
        self.open.insert(uri.to_owned(), document);
        // It may be what others include.
        self.forget();
    }

    /// A text is closed; what the disk has counts again.
    pub(super) fn close(&mut self, uri: &str) {
        self.open.remove(uri);
        self.forget();
    }

    /// Files have changed: everything is looked at anew.
    pub(super) fn forget(&mut self) {
        for document in self.open.values_mut() {
            (document.study, document.stale) = (None, true);
        }
    }

    /// A text is changed.
    pub(super) fn change(&mut self, uri: &str, version: i64, change: impl FnOnce(&mut Text)) {
        let Some(document) = self.open.get_mut(uri) else { return };
        change(&mut document.text);
        document.shared = Arc::from(document.text.as_str());
        document.old = document.study.take().or(document.old.take());
        (document.version, document.stale) = (version, true);
        let Some(path) = document.path.clone() else { return };
        for (other, document) in &mut self.open {
            let includes = |study: &Arc<Study>| study.files().iter().any(|file| key(Path::new(file)) == path);
            if other != uri && document.study.as_ref().is_some_and(includes) {
                (document.study, document.stale) = (None, true);
            }
        }
    }

    /// What is known of a text.
    pub(super) fn study(&mut self, uri: &str) -> Option<Arc<Study>> {
        let document = self.open.get(uri)?;
        if let Some(study) = &document.study {
            return Some(study.clone());
        }
        if document.is_too_long() {
            return None;
        }
        let mut compiler = self.compiler.clone();
        let others = self.open.iter().filter(|(other, _)| *other != uri);
        let buffers = others.filter_map(|(_, other)| Some((other.path.clone()?, other.shared.clone())));
        compiler.options.buffers = buffers.collect();
        let study = Arc::new(Study::new(&compiler, &document.name, document.text.as_str()));
        let document = self.open.get_mut(uri)?;
        if study.is_whole() {
            document.old = document.whole.replace(study.clone()).or(document.old.take());
        }
        document.study = Some(study.clone());
        Some(study)
    }

    /// Frees what nobody asks for any more.
    pub(super) fn clear(&mut self) {
        self.open.values_mut().for_each(|document| document.old = None);
    }

    /// What was known of a text when it last was whole.
    pub(super) fn whole(&self, uri: &str) -> Option<Arc<Study>> {
        self.open.get(uri).and_then(|document| document.whole.clone())
    }
}
