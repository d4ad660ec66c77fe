//! Odd lines that are no mistakes.

/// An odd line, and what becomes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The line, from 1.
    pub line: u32,
    /// One clause.
    pub text: String,
}

/// The first few notes of a file; the others are counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    /// The first ones, in the order of the file.
    pub list: Vec<Note>,
    /// How many there are besides.
    pub more: usize,
}

impl Notes {
    /// How many are kept: a file that is wrong all over says so in a few lines.
    const MOST: usize = 5;

    /// Adds a note.
    pub fn add(&mut self, line: u32, text: impl FnOnce() -> String) {
        if self.list.len() < Self::MOST {
            self.list.push(Note { line, text: text() });
        } else {
            self.more += 1;
        }
    }

    /// The notes as warnings about `file`.
    pub fn warnings(&self, file: &str) -> impl Iterator<Item = String> + use<'_> {
        let more = (self.more > 0).then(|| format!("{file}: warning: {} more lines like these", self.more));
        let file = file.to_owned();
        self.list.iter().map(move |Note { line, text }| format!("{file}:{line}: warning: {text}")).chain(more)
    }
}
