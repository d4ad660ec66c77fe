//! How many threads a command starts.

use super::speak::tell;
use crate::limits::THREADS_A_CORE;

/// No more threads than four for each processor; says so when more were asked for.
pub fn capped(threads: usize) -> usize {
    let most = std::thread::available_parallelism().map_or(16, |n| THREADS_A_CORE * n.get());
    if threads > most {
        tell(&format!("warning: {threads} threads are too many for this machine; {most} are started\n"));
    }
    threads.min(most)
}
