//! Bounds of the whole command: memory by `--memory`, time by `--time`.
//!
//! Decision (2026-11-29): a thread looks at what the process holds every ten milliseconds and ends it with a message, instead of a limit of
//! the system's (`ulimit -v`), under which an allocation fails anywhere and the process aborts without one, and instead of an allocator that
//! counts, which every allocation of every render would pay for. What outgrows the bound within those ten milliseconds is at most what
//! one allocation of the budgets in `limits` takes.

use super::speak::tell;
use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time from one look to the next.
const STEP: Duration = Duration::from_millis(10);

/// Ends the process with a message once it holds more than so many bytes; the first bound that is set stays.
pub fn bound_memory(bytes: u64) {
    static BOUND: OnceLock<()> = OnceLock::new();
    if BOUND.set(()).is_ok() {
        std::thread::spawn(move || {
            while resident().is_none_or(|held| held <= bytes) {
                std::thread::sleep(STEP);
            }
            end(&format!("error: the command needs more memory than --memory gives it, {}", shown(bytes)));
        });
    }
}

/// Bytes that the process holds, where the system tells it.
fn resident() -> Option<u64> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

/// Ends the process once its time is up, unless it is dropped before.
#[derive(Debug)]
pub struct TimeBound(Arc<AtomicBool>);

impl TimeBound {
    /// A bound of so many seconds from `start` on; none ends nothing.
    pub fn new(start: Instant, seconds: Option<f64>, what: &'static str) -> Self {
        let done = Arc::new(AtomicBool::new(false));
        let bound = TimeBound(done.clone());
        let Some(seconds) = seconds.filter(|seconds| *seconds > 0.0) else { return bound };
        let deadline = start + Duration::from_secs_f64(seconds.min(1e9));
        std::thread::spawn(move || {
            while !done.load(Ordering::Relaxed) {
                if Instant::now() >= deadline {
                    end(&format!("error: the time of {seconds} s was up {what}"));
                }
                std::thread::sleep(STEP);
            }
        });
        bound
    }
}

impl Drop for TimeBound {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn end(message: &str) -> ! {
    tell(&format!("{message}\n"));
    std::process::exit(2)
}

/// Bytes as `--memory` takes them: a number, or one with K, M, G or T, powers of 1024.
pub fn bytes(text: &str) -> Result<u64, String> {
    let lower = text.trim().to_lowercase();
    let lower = lower.strip_suffix("ib").or(lower.strip_suffix('b')).unwrap_or(&lower);
    let (number, unit) = match lower.char_indices().last() {
        Some((at, letter)) if letter.is_alphabetic() => (&lower[..at], letter),
        _ => (lower, '-'),
    };
    let shift = match unit {
        '-' => 0,
        'k' => 10,
        'm' => 20,
        'g' => 30,
        't' => 40,
        _ => return Err("write bytes as 2G, 512M or 2000000000".to_owned()),
    };
    let number: f64 = number.trim().parse().map_err(|_| "write bytes as 2G, 512M or 2000000000".to_owned())?;
    let bytes = number * f64::from(1u32 << 20) * 2f64.powi(shift - 20);
    if bytes >= f64::from(1u32 << 24) && bytes.is_finite() {
        Ok(bytes as u64)
    } else {
        Err("16M is the least that anything can be done with".to_owned())
    }
}

fn shown(bytes: u64) -> String {
    format!("{} MB", bytes >> 20)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_with_their_units() {
        for (text, expected) in [("2G", 2 << 30), ("512m", 512 << 20), ("1.5GiB", 3 << 29), ("100000000", 100_000_000)]
        {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in ["", "G", "-1G", "nan", "2X", "1e400", "1K"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }
}
