//! What has been told already: a shader that prints at every point would fill all memory.

use crate::exec::Report;
use crate::limits::{PRINTED, SAID_BYTES};
use std::collections::HashSet;

/// How many different reports are kept: one more than a command prints, so that it can say that there are more.
const MOST_REPORTS: usize = PRINTED + 1;

/// The texts of all reports so far.
#[derive(Debug, Default)]
pub struct Told {
    texts: HashSet<String>,
    bytes: usize,
}

impl Told {
    /// Is this a report to be kept: one that was not told before, while there are not too many, or that a shader cannot be run?
    pub fn is_new(&mut self, report: &Report) -> bool {
        let room = self.texts.len() < MOST_REPORTS && self.bytes < SAID_BYTES;
        if !room || !self.texts.insert(report.key()) {
            return report.is_fatal();
        }
        self.bytes += report.text.len();
        true
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Told::default();
    }
}
