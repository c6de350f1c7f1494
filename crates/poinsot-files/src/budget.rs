//! The memory and time that a command may use, checked before its work begins.

use crate::{Faults, short};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

/// The limit of the user, MiB; 0 without one.
static LIMIT_MIB: AtomicU64 = AtomicU64::new(0);
/// The longest time of a command, hours, as bits.
static LIMIT_HOURS: AtomicU64 = AtomicU64::new(24.0_f64.to_bits());
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
pub fn limit_hours(hours: f64) {
    LIMIT_HOURS.store(hours.to_bits(), Ordering::Relaxed);
}

/// The limit of [`check_time`], hours.
pub fn time_limit() -> f64 {
    f64::from_bits(LIMIT_HOURS.load(Ordering::Relaxed))
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
    let (hours, limit) = (seconds / 3600.0, time_limit());
    (hours <= limit).then_some(()).ok_or_else(|| {
        let (hours, limit) = (short(hours), short(limit));
        Faults::time(format!(
            "{what} take at least {hours} hours, and the limit is {limit}"
        ))
    })
}

/// Time of the first parts, s, from which that of all is estimated, and how many times as long as others they may take.
const BEGUN: f64 = 1.0;
const UNEVEN: f64 = 3.0;

/// The pace of some work: from the time of its first parts that of all is estimated while it goes on.
pub struct Pace {
    what: String,
    /// `None` where there is no clock.
    begun: Option<Instant>,
    done: AtomicUsize,
    over: OnceLock<Faults>,
}

impl Pace {
    /// The pace of work that begins now; `what` names it in the error.
    pub fn new(what: String) -> Self {
        Self {
            what,
            begun: (!cfg!(target_family = "wasm")).then(Instant::now),
            done: AtomicUsize::new(0),
            over: OnceLock::new(),
        }
    }

    /// Counts `parts` of the work as done, of `total` or more, and checks the time of all of them; 0 of 0 checks that it took.
    ///
    /// # Errors
    /// E0006 with both figures where the work has taken longer than the limit of [`limit_hours`], or by its pace will; from
    /// then on always.
    ///
    /// ```
    /// let pace = poinsot_files::Pace::new("the 2 rows".to_owned());
    /// assert!(pace.check(1, 2).is_ok() && pace.check(1, 2).is_ok());
    /// ```
    pub fn check(&self, parts: usize, total: usize) -> Result<(), Faults> {
        let done = self.done.fetch_add(parts, Ordering::Relaxed) + parts;
        let spent = self.begun.map_or(0.0, |b| b.elapsed().as_secs_f64());
        let of_all = spent * total as f64 / done.max(1) as f64 / UNEVEN;
        let least = spent.max(if spent > BEGUN { of_all } else { 0.0 });
        if let Err(over) = check_time(&self.what, least) {
            let _ = self.over.set(over);
        }
        self.over()
    }

    /// The error of an earlier [`Self::check`].
    ///
    /// # Errors
    /// The same.
    pub fn over(&self) -> Result<(), Faults> {
        self.over.get().map_or(Ok(()), |over| Err(over.clone()))
    }
}

/// The limit of [`check_memory`], bytes.
///
/// ```
/// assert!(poinsot_files::memory_limit() > 0.0);
/// ```
pub fn memory_limit() -> f64 {
    given_memory_limit().unwrap_or_else(|| SHARE * free())
}

/// The limit of [`limit_memory`], bytes; `None` without one. What an answer holds may depend on this one alone, not on what is free.
///
/// ```
/// assert_eq!(poinsot_files::given_memory_limit(), None);
/// ```
pub fn given_memory_limit() -> Option<f64> {
    let mib = LIMIT_MIB.load(Ordering::Relaxed);
    (mib > 0).then_some(mib as f64 * 1024.0 * 1024.0)
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
    (bytes <= limit).then_some(()).ok_or_else(|| {
        let (need, limit) = (short(bytes / GIB), short(limit / GIB));
        let both = format!("need about {need} GiB of memory, and the limit is {limit} GiB");
        Faults::memory(format!("{what} {both}"))
    })
}

/// A number that the system states in a file, after a word at the start of a line, in units of `unit`; `None` without one.
///
/// ```
/// assert_eq!(poinsot_files::stated("/nowhere", "VmHWM:", 1024.0), None);
/// ```
pub fn stated(path: &str, key: &str, unit: f64) -> Option<f64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let word = line.split_whitespace().next()?;
    word.parse().ok().map(|x: f64| x * unit)
}

/// Free memory of the machine, of its container, and of the address space of this process, bytes.
fn free() -> f64 {
    let of_process = |key| stated("/proc/self/status", key, 1024.0).unwrap_or(0.0);
    let limits = [
        stated("/proc/meminfo", "MemAvailable:", 1024.0),
        stated("/sys/fs/cgroup/memory.max", "", 1.0).map(|x| x - of_process("VmRSS:")),
        stated("/proc/self/limits", "Max address space", 1.0).map(|x| x - of_process("VmSize:")),
    ];
    let least = limits.into_iter().flatten().reduce(f64::min);
    least.map_or(UNSTATED, |x| x.max(0.0))
}
