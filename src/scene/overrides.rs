//! Values for parameters that go before what a scene says.

use crate::compile::Shader;
use crate::lang::nearest::nearest;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Values by the paths of their parameters, and which of them have found one.
#[derive(Debug, Default)]
pub struct Overrides {
    values: Vec<(String, String)>,
    seen: Mutex<Seen>,
}

/// What was met while groups were compiled.
#[derive(Debug, Default)]
struct Seen {
    used: BTreeSet<usize>,
    /// Paths that values could have had.
    params: BTreeSet<String>,
}

impl Overrides {
    /// Paths and texts of values; of several for one parameter the last one wins.
    pub fn new(values: Vec<(String, String)>) -> Self {
        Overrides { values, seen: Mutex::default() }
    }

    /// The values for a layer of a group: the parameter's own path, and the text.
    pub fn of(&self, group: &str, layer: &str, shader: &Shader) -> Vec<(&str, &str)> {
        if self.values.is_empty() {
            return Vec::new();
        }
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let mut found = Vec::new();
        for (number, (path, text)) in self.values.iter().enumerate() {
            if let Some(own) = own_paths(path, group, layer).find(|own| shader.has(own)) {
                seen.used.insert(number);
                found.push((own, text.as_str()));
            }
        }
        let paths = |name: &str| {
            [name.to_owned(), format!("{layer}.{name}"), format!("{group}.{name}"), format!("{group}.{layer}.{name}")]
        };
        seen.params.extend(shader.params().flat_map(paths));
        found
    }

    /// Is there a value for the parameter `name` of a layer?
    pub fn gives(&self, group: &str, layer: &str, name: &str) -> bool {
        self.values.iter().any(|(path, _)| own_paths(path, group, layer).any(|own| own == name))
    }

    /// The values that no parameter has taken: the path of each, and the one that may be meant.
    pub fn unused(&self) -> Vec<(&str, Option<String>)> {
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let params: Vec<&str> = seen.params.iter().map(String::as_str).collect();
        let unused = self.values.iter().enumerate().filter(|(number, _)| !seen.used.contains(number));
        unused.map(|(_, (path, _))| (path.as_str(), nearest(path, &params).map(str::to_owned))).collect()
    }
}

/// What a path may mean in a layer of a group.
fn own_paths<'p>(path: &'p str, group: &str, layer: &str) -> impl Iterator<Item = &'p str> {
    let inside = |path: &'p str, outer: &str| path.strip_prefix(outer)?.strip_prefix('.');
    let of_group = inside(path, group);
    [Some(path), inside(path, layer), of_group.and_then(|path| inside(path, layer)), of_group].into_iter().flatten()
}

/// Is one of two paths the other, or a part of it?
pub fn overlap(path: &str, other: &str) -> bool {
    let part_of = |part: &str, whole: &str| {
        part.strip_prefix(whole).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    part_of(path, other) || part_of(other, path)
}
