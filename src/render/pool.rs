//! Threads that outlive a renderer: the next one takes them over.
//!
//! Decision (2026-11-30): threads are kept when a renderer goes, for the next one that wants as many, instead of ending with it, because
//! an allocator keeps memory for each thread that was (glibc has an arena for each), so that a process which previewed scene after
//! scene grew by 4 kB a scene; with one arena it did not. Renderers at the same time have threads of their own, or the rounds of one
//! would wait for those of the other.

use super::error::RenderError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

/// Pools that nobody uses now, and the number of threads that each was asked for.
static IDLE: Mutex<Vec<(usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// So many of them are kept.
const MOST_IDLE: usize = 2;

/// Threads of one renderer, kept for the next one when it goes.
#[derive(Debug)]
pub struct Threads {
    asked: usize,
    pool: Arc<ThreadPool>,
}

impl Threads {
    /// So many threads; 0 for one a core.
    pub fn new(asked: usize) -> Result<Self, RenderError> {
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(at) = idle.iter().position(|(threads, _)| *threads == asked) {
            return Ok(Threads { asked, pool: idle.remove(at).1 });
        }
        drop(idle);
        let pool = ThreadPoolBuilder::new().num_threads(asked).build();
        Ok(Threads { asked, pool: Arc::new(pool.map_err(|error| RenderError::Threads(error.to_string()))?) })
    }
}

impl Deref for Threads {
    type Target = ThreadPool;

    fn deref(&self) -> &ThreadPool {
        &self.pool
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        idle.push((self.asked, self.pool.clone()));
        // The oldest ones end, once nobody holds the lock.
        let more = idle.len().saturating_sub(MOST_IDLE);
        let ended: Vec<_> = idle.drain(..more).collect();
        drop(idle);
        drop(ended);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_taken_over_and_never_shared() {
        // A number that no other test asks for.
        let number = 3;
        let first = Threads::new(number).unwrap();
        let id = first.broadcast(|_| std::thread::current().id());
        let second = Threads::new(number).unwrap();
        let others = second.broadcast(|_| std::thread::current().id());
        assert!(others.iter().all(|other| !id.contains(other)));
        drop(second);
        let third = Threads::new(number).unwrap();
        assert_eq!(third.broadcast(|_| std::thread::current().id()), others);
        assert_eq!(first.current_num_threads(), number);
    }
}
