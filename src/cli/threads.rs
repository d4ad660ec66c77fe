//! How many threads a command starts.

use super::speak::tell;

/// No more threads than 64 or four for each processor, which any machine bears; says so when more were asked for.
pub fn capped(threads: usize) -> usize {
    let most = std::thread::available_parallelism().map_or(64, |n| 4 * n.get()).max(64);
    if threads > most {
        tell(&format!("warning: {threads} threads are too many for this machine; {most} are started\n"));
    }
    threads.min(most)
}
