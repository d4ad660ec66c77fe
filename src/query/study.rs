//! A text and all that is known of it.

use crate::check::notes::{Meaning, Notes, Use};
use crate::compile::{Checked, Compiler};
use crate::lang::builtins;
use std::collections::BTreeSet;
use std::ops::Range;
use velour_grammar::Span;
use velour_grammar::places::{MAIN_FILE, RawKind, RawToken, TextRange, raw_tokens};

/// No note.
const NONE: u32 = u32::MAX;

/// A text and all that is known of it.
#[derive(Clone, Debug)]
pub struct Study {
    /// What compiles it.
    pub(super) compiler: Compiler,
    pub(super) name: String,
    pub(super) text: String,
    /// Its tokens as they stand.
    pub(super) raw: Vec<RawToken>,
    pub(super) checked: Checked,
    pub(super) notes: Notes,
    /// Which note is about each expanded token; [`NONE`] where there is none.
    uses: Vec<u32>,
    /// The expanded tokens that are spelled in the text, by where they begin.
    spelled: Vec<(u32, u32)>,
}

/// What stands somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A name of the program.
    Named(Meaning),
    /// A macro, with the place of its name where it is defined.
    Macro(String, Option<TextRange>),
    /// The name of an included file, with its number.
    Include(u32),
}

/// Something found at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// What it is.
    pub symbol: Symbol,
    /// Where it stands in the text, in bytes.
    pub range: Range<usize>,
}

impl Study {
    /// Studies the text of a file of this name.
    pub fn new(compiler: &Compiler, name: &str, text: &str) -> Self {
        let (checked, notes) = compiler.study(name, text);
        let sources = &checked.sources;
        let mut uses = vec![NONE; sources.token_count() as usize];
        for (at, used) in (0..).zip(&notes.uses) {
            if let Some(token) = sources.name_token(used.span, &used.name) {
                uses[token as usize] = at;
            }
        }
        let noted = (0..).zip(&uses).filter(|(_, at)| **at != NONE).map(|(token, _)| token);
        let mut spelled: Vec<(u32, u32)> = noted
            .filter_map(|token: u32| sources.spelled(token).map(|place| (place, token)))
            .filter(|(place, _)| place.file == MAIN_FILE)
            .map(|(place, token)| (place.start, token))
            .collect();
        spelled.sort_unstable();
        let raw = raw_tokens(text);
        let compiler = compiler.clone();
        Study { compiler, name: name.to_owned(), text: text.to_owned(), raw, checked, notes, uses, spelled }
    }

    /// What is noted of an expanded token.
    fn used(&self, token: u32) -> Option<&Use> {
        self.uses.get(token as usize).and_then(|at| self.notes.uses.get(*at as usize))
    }

    /// The expanded tokens of which something is noted, in order.
    pub(super) fn noted(&self) -> impl Iterator<Item = (u32, &Use)> {
        (0..self.uses.len() as u32).filter_map(|token| self.used(token).map(|used| (token, used)))
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Did all of it parse?
    pub fn is_whole(&self) -> bool {
        !self.checked.diagnostics.list.iter().any(|d| d.code.starts_with("E02") || d.code.starts_with("E03"))
    }

    /// The names of the files that were read for it.
    pub fn files(&self) -> Vec<&str> {
        self.checked.sources.files()
    }

    /// The name and text of a file that was read, by its number.
    pub fn file(&self, number: u32) -> (&str, &str) {
        (self.checked.sources.name_of(number), self.checked.sources.text_of(number))
    }

    /// Is a file one that comes with velour?
    pub fn comes_with_velour(&self, name: &str) -> bool {
        self.compiler.options.own_files.iter().any(|(own, _)| own == name)
    }

    /// What stands at a byte of the text, or ends there.
    pub fn at(&self, offset: usize) -> Option<Found> {
        let includes = self.checked.sources.includes_of(MAIN_FILE);
        let on = |place: &TextRange| (place.start as usize..=place.end as usize).contains(&offset);
        if let Some((place, file)) = includes.into_iter().find(|(place, _)| on(place)) {
            let range = place.start as usize..place.end as usize;
            return Some(Found { symbol: Symbol::Include(file), range });
        }
        let token = self.name_at(offset)?;
        let symbol = self.symbol_of(token)?;
        Some(Found { symbol, range: token.start..token.end })
    }

    /// The name that a byte belongs to, or that ends there.
    pub(super) fn name_at(&self, offset: usize) -> Option<&RawToken> {
        let at = self.raw.partition_point(|token| token.end < offset);
        let near = self.raw[at..].iter().take_while(|token| token.start <= offset);
        near.filter(|token| token.kind == RawKind::Name).last()
    }

    fn symbol_of(&self, token: &RawToken) -> Option<Symbol> {
        let start = token.start as u32;
        let at = self.spelled.partition_point(|(place, _)| *place < start);
        // A macro that is called twice has made its names twice: the last one stands for all.
        let expanded = self.spelled[at..].iter().take_while(|(place, _)| *place == start).last();
        if let Some(used) = expanded.and_then(|(_, token)| self.used(*token)) {
            return Some(Symbol::Named(used.meaning));
        }
        let word = &self.text[token.start..token.end];
        let here = |place: &TextRange| place.file == MAIN_FILE && place.start == start;
        let mut macros = self.checked.sources.macro_uses();
        let called = macros.find(|m| here(&m.place) || m.defined.as_ref().is_some_and(here));
        if let Some(called) = called {
            return Some(Symbol::Macro(word.to_owned(), called.defined));
        }
        if let Some(place) = self.defines().find(|(name, _)| *name == word).map(|(_, place)| place) {
            return Some(Symbol::Macro(word.to_owned(), Some(place)));
        }
        self.by_name(word).map(Symbol::Named)
    }

    /// The macros that the text defines, and where.
    pub(super) fn defines(&self) -> impl Iterator<Item = (&str, TextRange)> {
        self.raw.windows(3).filter_map(|tokens| {
            let [hash, word, name] = tokens else { return None };
            let text = |token: &RawToken| &self.text[token.start..token.end];
            let defines = hash.directive && text(hash) == "#" && text(word) == "define" && name.directive;
            let place = TextRange { file: MAIN_FILE, start: name.start as u32, end: name.end as u32 };
            (defines && name.kind == RawKind::Name).then(|| (text(name), place))
        })
    }

    /// What a name stands for wherever it is: something built in.
    pub(super) fn by_name(&self, name: &str) -> Option<Meaning> {
        let closure = || self.compiler.closures.named(name).next().map(|(id, _)| Meaning::Closure(id));
        let header = || {
            let functions = self.notes.uses.iter().filter(|used| used.declares && used.name == *name);
            let mut found = functions.filter(|used| matches!(used.meaning, Meaning::Function(_)));
            found.next().map(|used| used.meaning)
        };
        builtins::static_name(name).map(Meaning::Builtin).or_else(closure).or_else(header)
    }

    /// Where an expanded token stands for people: in the text, or, where a macro has made it, at the macro's call.
    pub(super) fn position(&self, token: u32) -> Option<TextRange> {
        let sources = &self.checked.sources;
        let place = sources.spelled(token)?;
        if !sources.is_expanded(token) || self.is_argument(place) {
            return Some(place);
        }
        sources.written(Span { first: token, last: token })
    }

    /// Is this, of what macros have made, an argument as it was written?
    fn is_argument(&self, place: TextRange) -> bool {
        if self.checked.sources.is_made(place.file) {
            return false;
        }
        if place.file == MAIN_FILE {
            let at = self.raw.partition_point(|token| token.start < place.start as usize);
            return self.raw.get(at).is_some_and(|token| !token.directive);
        }
        let text = self.checked.sources.text_of(place.file);
        raw_tokens(text).iter().any(|token| token.start == place.start as usize && !token.directive)
    }

    /// The expanded tokens that stand for a meaning; only those that declare it, if that is asked.
    pub(super) fn tokens_of(&self, meaning: Meaning, declaring: bool) -> BTreeSet<u32> {
        let wanted = |used: &Use| used.meaning == meaning && (used.declares || !declaring);
        self.noted().filter(|(_, used)| wanted(used)).map(|(token, _)| token).collect()
    }

    /// Where something is declared, the body of a function before its prototypes; of an include the start of its file.
    pub fn definition(&self, found: &Found) -> Option<TextRange> {
        match &found.symbol {
            Symbol::Named(meaning) => {
                let tokens = self.tokens_of(*meaning, true);
                tokens.iter().next_back().and_then(|token| self.position(*token))
            }
            Symbol::Macro(_, defined) => *defined,
            Symbol::Include(file) => Some(TextRange { file: *file, start: 0, end: 0 }),
        }
    }

    /// All places of something, in order; with those where it is declared, if that is asked.
    pub fn references(&self, found: &Found, declarations: bool) -> Vec<TextRange> {
        let places: BTreeSet<TextRange> = match &found.symbol {
            Symbol::Named(meaning) => {
                let mut tokens = self.tokens_of(*meaning, false);
                if !declarations {
                    let declaring = self.tokens_of(*meaning, true);
                    tokens.retain(|token| !declaring.contains(token));
                }
                tokens.into_iter().filter_map(|token| self.position(token)).collect()
            }
            Symbol::Macro(name, defined) => {
                let uses = self.checked.sources.macro_uses().filter(|m| m.name == name);
                let uses = uses.map(|m| m.place).filter(|place| !self.checked.sources.is_made(place.file));
                uses.chain(defined.filter(|_| declarations)).collect()
            }
            Symbol::Include(_) => BTreeSet::new(),
        };
        places.into_iter().collect()
    }
}
