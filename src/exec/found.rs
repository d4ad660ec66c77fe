//! What a machine keeps of the dictionaries that shaders have searched.

use crate::ops::dictionary::Dictionary;
use std::collections::HashMap;
use std::sync::Arc;

/// Dictionaries that a machine remembers, so that shaders which make up new ones do not fill the memory.
const REMEMBERED: usize = 64;

/// What is known of dictionaries.
#[derive(Debug, Default)]
pub(super) struct Dictionaries {
    /// By text, or by name of file; nothing for what is no XML.
    pub numbers: HashMap<String, Option<usize>>,
    pub parsed: Vec<Dictionary>,
    /// Lane by lane what was found: dictionary, node, and the rest of the same search. A shader holds the number of an entry plus one,
    /// so that no other lane changes it.
    pub found: Vec<Vec<Found>>,
}

/// What a search has found, at one of its nodes.
#[derive(Debug)]
pub(super) struct Found {
    pub dictionary: usize,
    /// All that it has found, which the entries of one search share.
    pub nodes: Arc<[usize]>,
    /// Which of them this is.
    pub at: usize,
}

impl Dictionaries {
    /// Forgets what the batch before has found.
    pub(super) fn begin(&mut self) {
        self.found.iter_mut().for_each(Vec::clear);
        if self.numbers.len() > REMEMBERED {
            *self = Dictionaries::default();
        }
    }
}
