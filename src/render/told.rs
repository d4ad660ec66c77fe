//! What has been told already: a shader that prints at every point would fill all memory.

use crate::exec::Report;
use std::collections::HashSet;

/// How many different reports are told.
const MOST_REPORTS: usize = 1000;

/// The texts of all reports so far.
#[derive(Debug, Default)]
pub struct Told(HashSet<String>);

impl Told {
    /// Is this a report to be kept: one that was not told before, while there are not too many, or that a shader cannot be run?
    pub fn is_new(&mut self, report: &Report) -> bool {
        self.0.len() < MOST_REPORTS && self.0.insert(report.key()) || report.is_fatal()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}
