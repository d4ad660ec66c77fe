//! Interned strings: every string a shader handles is a number, equal exactly when the texts are equal.
//!
//! The table is global and only grows, as shading compares and passes strings across shaders, threads and renders.

use std::collections::HashMap;
use std::fmt;
use std::sync::{LazyLock, RwLock};

/// An interned string; number 0 is the empty string.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Symbol(pub i32);

#[derive(Default)]
struct Table {
    ids: HashMap<&'static str, i32>,
    texts: Vec<&'static str>,
}

static TABLE: LazyLock<RwLock<Table>> = LazyLock::new(|| {
    let mut table = Table::default();
    table.ids.insert("", 0);
    table.texts.push("");
    RwLock::new(table)
});

impl Symbol {
    /// The symbol of a text.
    pub fn new(text: &str) -> Symbol {
        if let Some(&id) = TABLE.read().unwrap_or_else(|e| e.into_inner()).ids.get(text) {
            return Symbol(id);
        }
        let mut table = TABLE.write().unwrap_or_else(|e| e.into_inner());
        if let Some(&id) = table.ids.get(text) {
            return Symbol(id);
        }
        let id = table.texts.len() as i32;
        let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
        table.texts.push(kept);
        table.ids.insert(kept, id);
        Symbol(id)
    }

    /// Is there a text of this number?
    pub fn exists(self) -> bool {
        let table = TABLE.read().unwrap_or_else(|e| e.into_inner());
        usize::try_from(self.0).is_ok_and(|i| i < table.texts.len())
    }

    /// The text of the symbol; an unknown number is the empty string.
    pub fn text(self) -> &'static str {
        let table = TABLE.read().unwrap_or_else(|e| e.into_inner());
        usize::try_from(self.0).ok().and_then(|i| table.texts.get(i).copied()).unwrap_or("")
    }
}

impl fmt::Debug for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text())
    }
}
