//! `.oso` files that velour writes where oslc would: not code, but how a shader is compiled.
//!
//! Decision (2026-11-29): people who know OSL compile (`oslc -Dfoo=bar ../lib/a.osl`) and then name the shader by itself, wherever its
//! text is. `velour compile`, which a binary called `oslc` is, writes what that needs: the text's path, macros and folders. Shaders
//! are still compiled when they run, so such a file is never older than its text. `velour check` goes on to write nothing: who only
//! checks finds no new files. Rejected: `check` that writes as oslc does, which surprises; preprocessed text, which goes
//! stale and loses the places of messages; OSL's own code, which velour would have to write and read for others' tools alone.

use crate::limits::RECIPE_BYTES;
use std::path::{Path, PathBuf};
use velour_grammar::files::Access;

/// How a shader is compiled.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recipe {
    /// Its text's file.
    pub source: PathBuf,
    /// What messages call that file.
    pub name: String,
    /// Another standard header than the built-in one.
    pub header: Option<PathBuf>,
    /// Folders of included files.
    pub include_dirs: Vec<PathBuf>,
    /// Macros with their values.
    pub defines: Vec<(String, String)>,
    /// Macros that are not set.
    pub undefines: Vec<String>,
}

/// The first line of every such file.
const HEAD: &str = "velour 1: how a shader is compiled, no code; OSL's tools cannot read it";

impl Recipe {
    /// The recipe in a file, when there is one: `.oso` files of OSL's own are none.
    pub fn of_file(path: &Path, access: &Access) -> Option<Self> {
        path.extension().filter(|extension| *extension == "oso")?;
        Recipe::read(&String::from_utf8(access.read(path, RECIPE_BYTES).ok()?).ok()?)
    }

    /// The recipe that a text holds.
    pub fn read(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        lines.next().filter(|line| *line == HEAD)?;
        let mut recipe = Recipe::default();
        for (key, rest) in lines.filter_map(|line| line.split_once(' ')) {
            let (name, value) = rest.split_once(' ').unwrap_or((rest, ""));
            match key {
                "source" => recipe.source = PathBuf::from(rest),
                "name" => recipe.name = rest.to_owned(),
                "header" => recipe.header = Some(PathBuf::from(rest)),
                "include" => recipe.include_dirs.push(PathBuf::from(rest)),
                "define" => recipe.defines.push((name.to_owned(), value.to_owned())),
                "undefine" => recipe.undefines.push(name.to_owned()),
                _ => return None,
            }
        }
        (!recipe.source.as_os_str().is_empty()).then_some(recipe)
    }

    /// As a text that [`Recipe::read`] reads. Nothing where a name has a line break in it, which no line can hold, or
    /// where that text is longer than may be read.
    pub fn text(&self) -> Option<String> {
        let paths = [("source", &self.source)].into_iter().chain(self.header.iter().map(|header| ("header", header)));
        let paths = paths.chain(self.include_dirs.iter().map(|dir| ("include", dir)));
        let mut lines: Vec<String> = vec![HEAD.to_owned()];
        lines.push(format!("name {}", self.name));
        lines.extend(paths.map(|(key, path)| format!("{key} {}", path.display())));
        lines.extend(self.defines.iter().map(|(name, value)| format!("define {name} {value}")));
        lines.extend(self.undefines.iter().map(|name| format!("undefine {name}")));
        let whole = lines.iter().all(|line| !line.contains(['\n', '\r']));
        whole.then(|| lines.join("\n") + "\n").filter(|text| text.len() as u64 <= RECIPE_BYTES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let recipe = Recipe {
            source: "/a folder/a.osl".into(),
            name: "../a folder/a.osl".into(),
            header: Some("h".into()),
            include_dirs: vec!["/b c".into(), "d".into()],
            defines: vec![("TWO".into(), "1 + 1".into()), ("EMPTY".into(), String::new())],
            undefines: vec!["X".into()],
        };
        assert_eq!(Recipe::read(&recipe.text().unwrap()), Some(recipe.clone()));
        assert_eq!(Recipe { source: "a\nsource b".into(), ..recipe.clone() }.text(), None);
        assert_eq!(Recipe { name: "a".repeat(RECIPE_BYTES as usize), ..recipe }.text(), None);
        for text in ["", "OpenShadingLanguage 1.00\nshader a\n", HEAD, &format!("{HEAD}\nsource a\nlater b\n")] {
            assert_eq!(Recipe::read(text), None, "{text}");
        }
    }
}
