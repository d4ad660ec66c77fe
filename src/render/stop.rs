//! When a render ends before its samples are done: its time is up, or somebody asks.

use super::settings::Settings;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What threads look at now and then, in the middle of a shader too.
#[derive(Debug)]
pub struct Stop {
    begin: Instant,
    /// Nanoseconds from `begin` on; the largest number where there is no time.
    until: AtomicU64,
    /// Set by whoever wants an end.
    asked: Arc<AtomicBool>,
}

impl Stop {
    /// A stop for a render that begins now; `asked` may be set from anywhere.
    pub fn new(asked: Arc<AtomicBool>) -> Self {
        Stop { begin: Instant::now(), until: AtomicU64::new(u64::MAX), asked }
    }

    /// Has the time of `settings` run from `start` on.
    pub fn begin(&self, settings: &Settings, start: Instant) {
        let nanoseconds = |deadline: Instant| deadline.saturating_duration_since(self.begin).as_nanos() as u64;
        self.until.store(settings.deadline(start).map_or(u64::MAX, nanoseconds), Ordering::Relaxed);
    }

    /// Is it to end now?
    #[inline]
    pub fn now(&self) -> bool {
        let late = || match self.until.load(Ordering::Relaxed) {
            u64::MAX => false,
            until => self.begin.elapsed() >= Duration::from_nanos(until),
        };
        self.asked.load(Ordering::Relaxed) || late()
    }

    /// What is set to ask for an end.
    pub fn asked(&self) -> &Arc<AtomicBool> {
        &self.asked
    }
}
