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
    /// Work has been left unfinished since it was last begun, whether or not somebody still asks.
    cut: AtomicBool,
}

impl Stop {
    /// A stop for a render that begins now; `asked` may be set from anywhere.
    pub fn new(asked: Arc<AtomicBool>) -> Self {
        Stop { begin: Instant::now(), until: AtomicU64::new(u64::MAX), asked, cut: AtomicBool::new(false) }
    }

    /// Has the time of `settings` run from `start` on.
    pub fn begin(&self, settings: &Settings, start: Instant) {
        let nanoseconds = |deadline: Instant| deadline.saturating_duration_since(self.begin).as_nanos() as u64;
        self.until.store(settings.deadline(start).map_or(u64::MAX, nanoseconds), Ordering::Relaxed);
    }

    /// Is it to end now?
    #[inline]
    pub fn now(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.late()
    }

    /// Is the time up?
    #[inline]
    pub fn late(&self) -> bool {
        match self.until.load(Ordering::Relaxed) {
            u64::MAX => false,
            until => self.begin.elapsed() >= Duration::from_nanos(until),
        }
    }

    /// [`now`](Stop::now), for work that is left where it is when the answer is yes.
    #[inline]
    pub fn cuts(&self) -> bool {
        let now = self.now();
        if now {
            self.cut.store(true, Ordering::Relaxed);
        }
        now
    }

    /// Does `work`; false says that something of it was left unfinished.
    pub fn whole<T>(&self, work: impl FnOnce() -> T) -> (T, bool) {
        self.cut.store(false, Ordering::Relaxed);
        let done = work();
        (done, !self.cut.load(Ordering::Relaxed))
    }

    /// What is set to ask for an end.
    pub fn asked(&self) -> &Arc<AtomicBool> {
        &self.asked
    }
}
