//! Interned strings: every string a shader handles is a number, equal exactly when the texts are equal.
//!
//! What program texts and hosts name is in a table that is global and only grows, as it is compared and passed across
//! shaders, threads and renders. What shaders make while they run is in [`Strings`], which die with their batch.
//!
//! Decision (2026-11-29): strings made at run time have numbers of their own, below zero, in a table that belongs to the batch,
//! because a shader that formats its position makes millions of them, which the global table kept for ever (283 MB for a small
//! picture) behind one lock for all threads; instead of counting references to each.

use crate::limits::TEXT_BYTES;
use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::{LazyLock, RwLock};

/// An interned string; number 0 is the empty string.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Symbol(pub i32);

#[derive(Default)]
struct Table {
    ids: HashMap<&'static str, i32, BuildHasherDefault<TextHasher>>,
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

    /// The symbol of a text, if it has one already.
    pub fn find(text: &str) -> Option<Symbol> {
        TABLE.read().unwrap_or_else(|e| e.into_inner()).ids.get(text).map(|&id| Symbol(id))
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

/// The strings that shaders made in one batch. Their symbols are below zero and mean nothing after [`Strings::clear`].
#[derive(Clone, Debug, Default)]
pub struct Strings {
    /// All texts, one after the other.
    bytes: String,
    /// Where each text ends.
    ends: Vec<u32>,
    /// A hash table: a power of two of places, each 0 or the number of a text plus one.
    places: Vec<u32>,
    full: bool,
}

impl Strings {
    /// Forgets all strings. Memory stays for the next batch, unless this one had uncommonly much.
    pub fn clear(&mut self) {
        let (bytes, count) = (self.bytes.len(), self.ends.len());
        self.bytes.clear();
        self.ends.clear();
        self.places.clear();
        self.full = false;
        if self.bytes.capacity() > 4 * bytes + (1 << 20) {
            self.bytes.shrink_to(2 * bytes);
            self.ends.shrink_to(2 * count);
            self.places.shrink_to(4 * count);
        }
    }

    /// How many strings there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// How many bytes they have together.
    pub fn bytes(&self) -> usize {
        self.bytes.len()
    }

    /// True when nothing was made yet.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// True once a string did not fit into [`TEXT_BYTES`]; it counts as empty.
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// The symbol of a text: the one that the program or the host gave it, or one of this batch.
    pub fn symbol(&mut self, text: &str) -> Symbol {
        // This batch's own come first, as another thread may give a text a symbol for ever at any moment, and the text must keep
        // the one that it has here.
        let place = match self.place(text) {
            Ok(number) => return Symbol(-1 - number as i32),
            Err(place) => place,
        };
        if let Some(known) = Symbol::find(text) {
            return known;
        }
        if self.bytes.len() + text.len() > TEXT_BYTES {
            self.full = true;
            return Symbol(0);
        }
        self.bytes.push_str(text);
        self.ends.push(self.bytes.len() as u32);
        self.insert(place, self.ends.len());
        Symbol(-(self.ends.len() as i32))
    }

    /// The text of a symbol of the program or of this batch; an unknown number is the empty string.
    pub fn text(&self, symbol: Symbol) -> &str {
        match usize::try_from(-1 - i64::from(symbol.0)) {
            Ok(number) => self.numbered(number),
            Err(_) => symbol.text(),
        }
    }

    fn numbered(&self, number: usize) -> &str {
        let Some(&end) = self.ends.get(number) else { return "" };
        let start = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start as usize..end as usize]
    }

    /// The number of a text, or the place in the table where it would stand.
    fn place(&self, text: &str) -> Result<usize, usize> {
        let Some(mask) = self.places.len().checked_sub(1) else { return Err(0) };
        let mut at = hash(text) as usize & mask;
        while self.places[at] != 0 {
            let number = self.places[at] as usize - 1;
            if self.numbered(number) == text {
                return Ok(number);
            }
            at = (at + 1) & mask;
        }
        Err(at)
    }

    /// Puts the newest text at its place, in a table of twice the size when half of this one is taken.
    fn insert(&mut self, place: usize, number: usize) {
        if 2 * number <= self.places.len() {
            self.places[place] = number as u32;
            return;
        }
        let size = (4 * number).next_power_of_two().max(64);
        self.places.clear();
        self.places.resize(size, 0);
        for number in 0..self.ends.len() {
            let mut at = hash(self.numbered(number)) as usize & (size - 1);
            while self.places[at] != 0 {
                at = (at + 1) & (size - 1);
            }
            self.places[at] = number as u32 + 1;
        }
    }
}

/// The hash of a text.
fn hash(text: &str) -> u64 {
    let mut hasher = TextHasher::default();
    hasher.write(text.as_bytes());
    hasher.finish()
}

/// Hashes texts eight bytes at a step.
#[derive(Default)]
struct TextHasher(u64);

impl Hasher for TextHasher {
    fn write(&mut self, bytes: &[u8]) {
        self.0 = hash_bytes(self.0, bytes);
    }

    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
}

fn hash_bytes(before: u64, bytes: &[u8]) -> u64 {
    // An odd number with its bits well mixed: 2^64 over the golden ratio.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut sum = before ^ bytes.len() as u64;
    for chunk in bytes.chunks(8) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        sum = (sum.rotate_left(5) ^ u64::from_le_bytes(word)).wrapping_mul(FACTOR);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_of_a_batch_are_equal_when_their_texts_are() {
        let mut strings = Strings::default();
        let known = Symbol::new("a text of the program");
        assert_eq!(strings.symbol("a text of the program"), known);
        assert_eq!(strings.symbol(""), Symbol(0));
        let made: Vec<Symbol> = (0..2000).map(|i| strings.symbol(&format!("made {i}"))).collect();
        for (i, &symbol) in made.iter().enumerate() {
            assert!(symbol.0 < 0 && !symbol.exists());
            assert_eq!(strings.text(symbol), format!("made {i}"));
            assert_eq!(strings.symbol(&format!("made {i}")), symbol);
        }
        assert_eq!(strings.len(), 2000);
        // A text that becomes a symbol for ever in the middle of a batch keeps its number there.
        Symbol::new("made 7");
        assert_eq!(strings.symbol("made 7"), made[7]);
        strings.clear();
        assert!(strings.is_empty() && strings.text(made[7]).is_empty());
        assert!(strings.symbol("made 7").exists() && Symbol::find("made 8").is_none());
    }

    #[test]
    fn a_batch_has_room_for_so_much_text() {
        let mut strings = Strings::default();
        let long = "x".repeat(TEXT_BYTES - 10);
        let symbol = strings.symbol(&long);
        assert_eq!(strings.text(symbol).len(), long.len());
        assert_eq!((strings.symbol("eleven bytes"), strings.is_full()), (Symbol(0), true));
        assert!(strings.symbol("ten bytes.").0 < 0);
        strings.clear();
        assert!(!strings.is_full() && strings.bytes.capacity() <= 2 * TEXT_BYTES);
        strings.clear();
        assert!(strings.bytes.capacity() <= 1 << 20);
    }
}
