//! The memory and time that a command may use, checked before its work begins.

use crate::{Faults, short};
use std::sync::atomic::{AtomicU64, Ordering};

/// The limit of the user, MiB; 0 without one.
static LIMIT_MIB: AtomicU64 = AtomicU64::new(0);
/// The longest time of a command, hours.
static LIMIT_HOURS: AtomicU64 = AtomicU64::new(24);
/// Fraction of the free memory that may be used.
const SHARE: f64 = 0.8;
/// Free memory where the system does not state it, bytes.
const UNSTATED: f64 = 4.0 * GIB;
/// Memory for which no one is asked, bytes.
const SMALL: f64 = GIB / 16.0;
const GIB: f64 = 1024.0 * 1024.0 * 1024.0;

/// Sets the limit of [`check_memory`], MiB.
pub fn limit_memory(mib: u64) {
    LIMIT_MIB.store(mib, Ordering::Relaxed);
}

/// Sets the limit of [`check_time`], hours; it is 24 hours without.
pub fn limit_hours(hours: u64) {
    LIMIT_HOURS.store(hours, Ordering::Relaxed);
}

/// Checks that the least time of some work is within the limit of [`limit_hours`].
///
/// # Errors
/// E0006 with both figures.
///
/// ```
/// use poinsot_files::check_time;
///
/// assert!(check_time("3 rows", 3.0e-6).is_ok());
/// let refused = check_time("1e18 rows", 3.6e11).unwrap_err().to_string();
/// assert!(refused.starts_with("E0006 1e18 rows take at least 1e8 hours, and the limit is 24"), "{refused}");
/// ```
pub fn check_time(what: &str, seconds: f64) -> Result<(), Faults> {
    let (hours, limit) = (seconds / 3600.0, LIMIT_HOURS.load(Ordering::Relaxed));
    match hours <= limit as f64 {
        true => Ok(()),
        false => Err(Faults::time(format!(
            "{what} take at least {} hours, and the limit is {limit}",
            short(hours)
        ))),
    }
}

/// The limit of [`check_memory`], bytes.
///
/// ```
/// assert!(poinsot_files::memory_limit() > 0.0);
/// ```
pub fn memory_limit() -> f64 {
    match LIMIT_MIB.load(Ordering::Relaxed) {
        0 => SHARE * free(),
        mib => mib as f64 * 1024.0 * 1024.0,
    }
}

/// Checks that the estimated memory of some work is within the limit: that of [`limit_memory`], or 80 % of what is
/// free.
///
/// # Errors
/// E0006 with both figures.
///
/// ```
/// use poinsot_files::check_memory;
///
/// assert!(check_memory("3 rows", 3.0 * 64.0).is_ok());
/// let refused = check_memory("1e18 rows", 64e18).unwrap_err().to_string();
/// assert!(refused.starts_with("E0006 1e18 rows need about 5.96"), "{refused}");
/// ```
pub fn check_memory(what: &str, bytes: f64) -> Result<(), Faults> {
    if LIMIT_MIB.load(Ordering::Relaxed) == 0 && bytes < SMALL {
        return Ok(());
    }
    let limit = memory_limit();
    match bytes <= limit {
        true => Ok(()),
        false => Err(Faults::memory(format!(
            "{what} need about {} GiB of memory, and the limit is {} GiB",
            short(bytes / GIB),
            short(limit / GIB)
        ))),
    }
}

/// Free memory of the machine, of its container, and of the address space of this process, bytes.
fn free() -> f64 {
    let number = |path: &str, key: &str, unit: f64| {
        let text = std::fs::read_to_string(path).ok()?;
        let line = text.lines().find_map(|line| line.strip_prefix(key))?;
        let word = line.split_whitespace().next()?;
        word.parse().ok().map(|x: f64| x * unit)
    };
    let of_process = |key| number("/proc/self/status", key, 1024.0).unwrap_or(0.0);
    let limits = [
        number("/proc/meminfo", "MemAvailable:", 1024.0),
        number("/sys/fs/cgroup/memory.max", "", 1.0).map(|x| x - of_process("VmRSS:")),
        number("/proc/self/limits", "Max address space", 1.0).map(|x| x - of_process("VmSize:")),
    ];
    let least = limits.into_iter().flatten().reduce(f64::min);
    least.map_or(UNSTATED, |x| x.max(0.0))
}
