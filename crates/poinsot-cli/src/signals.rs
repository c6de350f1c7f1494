//! Signals: an interruption removes drafts; reaching a file-size or memory limit gives exit code 3.

/// Exit code for errors of the operating system.
#[cfg(unix)]
const ENVIRONMENT: i32 = 3;

/// Installs the signal handlers.
#[cfg(unix)]
pub fn install() {
    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    // With SIGXFSZ caught, the write returns an error instead of ending the process.
    let _ = signal_hook::flag::register(libc::SIGXFSZ, Arc::new(AtomicBool::new(false)));
    // Rust aborts after a failed allocation and prints a line about it; the program is not at fault.
    let always = Arc::new(AtomicBool::new(true));
    let _ = signal_hook::flag::register_conditional_shutdown(SIGABRT, ENVIRONMENT, always);
    let ignored = ignored_signals();
    let caught: Vec<i32> = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| ignored & (1 << (signal - 1)) == 0)
        .collect();
    let (ready, is_ready) = std::sync::mpsc::channel::<()>();
    // Without the thread, signals keep their default action.
    let _ = std::thread::Builder::new().spawn(move || {
        let Ok(mut signals) = signal_hook::iterator::Signals::new(caught) else {
            return;
        };
        drop(ready);
        for signal in signals.forever() {
            // A running search stops and returns its best result; the next interruption ends the program.
            if signal == SIGINT && poinsot_design::interrupt::request() {
                continue;
            }
            poinsot_files::remove_stages();
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
    // Wait until the handler is installed, before any draft is written.
    let _ = is_ready.recv();
}

/// Other systems: no signal handlers.
#[cfg(not(unix))]
pub fn install() {}

/// Signals that the parent process ignores (`nohup`, background job), as the bit mask of /proc on Linux. Zero
/// elsewhere: the query needs unsafe code.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = poinsot_files::read_text("/proc/self/status".as_ref(), 1 << 20);
    status
        .unwrap_or_default()
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}
