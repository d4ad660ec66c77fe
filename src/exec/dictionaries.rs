//! Dictionaries that shaders search, and the nodes that each lane has found.

use super::found::Found;
use super::lane::Lane;
use super::report::Mistake;
use super::run::Run;
use crate::ir::op::AttributeType;
use crate::ir::program::Reg;
use crate::limits::{DICTIONARIES, FOUND_NODES};
use crate::ops::dictionary::Dictionary;
use std::sync::Arc;
use velour_grammar::Span;

impl Run<'_> {
    /// The dictionary of a text or a file.
    fn dictionary(&mut self, text: &str, lane: usize, span: Span) -> Option<usize> {
        if let Some(&known) = self.s.dictionaries.numbers.get(text) {
            return known;
        }
        if self.s.dictionaries.numbers.len() >= DICTIONARIES {
            let message = format!("a batch reads more than {DICTIONARIES} dictionaries");
            self.report_once(lane, span, Mistake::Other, message);
            return None;
        }
        let read = if text.trim_start().starts_with('<') { Ok(text.to_owned()) } else { self.host.read_text(text) };
        let unread = |reason| (Mistake::NoDictionary { name: text.to_owned() }, reason);
        let parsed = read.map_err(unread).and_then(|read| {
            Dictionary::parse(&read).map_err(|reason| (Mistake::Other, format!("this is no dictionary: {reason}")))
        });
        let found = match parsed {
            Ok(dictionary) => {
                self.s.dictionaries.parsed.push(dictionary);
                Some(self.s.dictionaries.parsed.len() - 1)
            }
            Err((mistake, reason)) => {
                self.report_once(lane, span, mistake, reason);
                None
            }
        };
        self.s.dictionaries.numbers.insert(text.to_owned(), found);
        found
    }

    /// Keeps one of what was found, and gives its number; 0 where there is none, or where the lane holds too many.
    fn keep(&mut self, lane: usize, dictionary: usize, nodes: Arc<[usize]>, at: usize, span: Span) -> i32 {
        if at >= nodes.len() {
            return 0;
        }
        let lists = &mut self.s.dictionaries.found;
        if lists.len() < self.n {
            lists.resize_with(self.n, Vec::new);
        }
        if lists[lane].len() >= FOUND_NODES {
            let message = format!("a point holds more than {FOUND_NODES} nodes of dictionaries");
            self.report_once(lane, span, Mistake::Other, message);
            return 0;
        }
        lists[lane].push(Found { dictionary, nodes, at });
        lists[lane].len() as i32
    }

    /// The number of what a path finds from a node of a dictionary.
    fn search(&mut self, (dictionary, node): (usize, usize), path: &str, lane: usize, span: Span) -> i32 {
        let Some(nodes) = self.s.dictionaries.parsed[dictionary].find(node, path) else {
            let text = format!("`{path}` is no path: write names with / or // before them, and conditions in []");
            self.report_once(lane, span, Mistake::Other, text);
            return 0;
        };
        self.keep(lane, dictionary, nodes.into(), 0, span)
    }

    fn found(&self, lane: usize, number: i32) -> Option<&Found> {
        let at = usize::try_from(number).ok()?.checked_sub(1)?;
        self.s.dictionaries.found.get(lane)?.get(at)
    }

    /// `dict_find` of a text: -1 for what is no dictionary.
    pub(super) fn dict_find(&mut self, dst: Reg, src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let (text, path) = (args.s(0).to_owned(), args.s(1).to_owned());
            let number = match self.dictionary(&text, lane, span) {
                Some(dictionary) => self.search((dictionary, 0), &path, lane, span),
                None => -1,
            };
            self.regs.ints[dst.0 as usize][lane] = number;
        }
    }

    /// `dict_find` below a node that was found.
    pub(super) fn dict_find_below(&mut self, dst: Reg, src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let below = self.found(lane, args.i(0)).map(|found| (found.dictionary, found.nodes[found.at]));
            let path = args.s(1).to_owned();
            let number = below.map_or(0, |from| self.search(from, &path, lane, span));
            self.regs.ints[dst.0 as usize][lane] = number;
        }
    }

    /// `dict_next`: the next node of the same search.
    pub(super) fn dict_next(&mut self, dst: Reg, src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let next = self.found(lane, args.i(0)).map(|found| (found.dictionary, found.nodes.clone(), found.at + 1));
            let number = next.map_or(0, |(dictionary, nodes, at)| self.keep(lane, dictionary, nodes, at, span));
            self.regs.ints[dst.0 as usize][lane] = number;
        }
    }

    /// `dict_value`: numbers are separated by commas or spaces.
    pub(super) fn dict_value(&mut self, ty: AttributeType, dst: &[Reg], src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let found = self.found(lane, args.i(0));
            let text = found.and_then(|f| self.s.dictionaries.parsed[f.dictionary].value(f.nodes[f.at], args.s(1)));
            let text = text.map(str::to_owned);
            let there = text.is_some_and(|text| self.put_value(ty, &dst[1..], lane, &text));
            self.regs.ints[dst[0].0 as usize][lane] = i32::from(there);
        }
        self.check_strings(span);
    }

    fn put_value(&mut self, ty: AttributeType, dst: &[Reg], lane: usize, text: &str) -> bool {
        let parts = || text.split([',', ' ', '\t', '\n']).filter(|part| !part.is_empty());
        match ty {
            AttributeType::Strings(1) => {
                self.regs.ints[dst[0].0 as usize][lane] = self.tree.strings.symbol(text).0;
                true
            }
            AttributeType::Strings(_) => false,
            AttributeType::Floats(count) => {
                let numbers: Vec<f32> = parts().map_while(|part| part.parse().ok()).collect();
                let enough = numbers.len() >= count as usize;
                for (reg, number) in dst.iter().zip(numbers).filter(|_| enough) {
                    self.regs.floats[reg.0 as usize][lane] = number;
                }
                enough
            }
            AttributeType::Ints(count) => {
                let numbers: Vec<i32> = parts().map_while(|part| part.parse().ok()).collect();
                let enough = numbers.len() >= count as usize;
                for (reg, number) in dst.iter().zip(numbers).filter(|_| enough) {
                    self.regs.ints[reg.0 as usize][lane] = number;
                }
                enough
            }
        }
    }
}
